"""Whether a mission comes to where an order stands."""

from argo_compiler.diagnostics import Span
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import ProgramBlock, leads_away
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.orders import ScriptOrder


def require_reached(span: Span, block: ProgramBlock, context: Context) -> None:
    """That the mission comes to the end of a block, or a step begins there. Raises RefusedError."""
    last, step = block.last, context.step
    begins = block is context.program and (not step or last is not step[-1])
    if leads_away(last) and not begins:
        message = "the mission never comes here: what stands before this leads elsewhere"
        hint = "write it before the words that lead elsewhere, or as a step of its own"
        context.diagnostics.refuse("second-route", message, span, hint)


def is_back(order: ScriptOrder, block: ProgramBlock, context: Context) -> bool:
    """Whether the robot is in its docking station, and is only told to go there again. Raises
    RefusedError if it is told anything else."""
    docked = context.docked
    if docked is None or not docked.listed or block is not context.program:
        return False
    if docked.ways or isinstance(order, orders.Plain):
        return False
    if isinstance(order, orders.Home):
        if order.dock.area is None:
            return True
        context.program.remove(docked)  # `go home and dock in area 2`
        return False
    if isinstance(order, orders.WaitOrder) and order.manner and order.manner.duration:
        context.docked = None  # `stay there for 5 minutes`: it goes on behind that
        return False
    line = docked.source.line if docked.source else 0
    message = f"the robot is back in its docking station since line {line}"
    hint = "move the return to the end, or say how it goes on: `then go to step 3`"
    context.diagnostics.refuse("after-docking", message, order.span, hint)
