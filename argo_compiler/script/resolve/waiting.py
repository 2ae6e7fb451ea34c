"""From `wait until ...` to what a task waits for."""

from dataclasses import replace

from argo_compiler.il import EventKind, WaitRule
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Do, ProgramBlock, all_nodes, in_branch
from argo_compiler.script.syntax.tree.conditions import Occurs
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import Plain, PlainWord, ScriptOrder, WaitOrder
from argo_compiler.script.syntax.tree.script import ScriptHeader


def staying(order: ScriptOrder, block: ProgramBlock, context: Context) -> ScriptOrder:
    """`Stay there` is the end of the mission, unless another order comes behind it; then it has to
    say how long."""
    if context.stays is not None and not isinstance(order, Plain):
        hint = "write `stay there for 90 s`, or move it to the end if the mission ends with it"
        context.diagnostics.error("wait", "this does not say how long", context.stays, hint)
        context.stays = None
        context.fail()
    if not isinstance(order, WaitOrder) or not order.stays or in_branch(block):
        return order
    if order.manner is not None or order.where is not None:
        return order
    context.stays = order.span
    return Plain(span=order.span, word=PlainWord.END)


def wait_rule(order: WaitOrder, context: Context) -> WaitRule:
    """How long it waits, or for what. Raises RefusedError if that is not clear."""
    diagnostics = context.diagnostics
    manner = order.manner or Manner()
    until, duration, limit = manner.until, manner.duration, manner.time_limit
    if order.person:
        hint = "let somebody pause it there, or write how long: `wait 5 minutes`"
        diagnostics.refuse("wait", "a mission does not wait for a person", order.span, hint)
    if until is None:
        if duration is None:
            hint = "write `wait 90 s`, `wait until #1 is below 3` or `wait for the all-clear`"
            diagnostics.refuse("wait", "this does not say how long, or for what", order.span, hint)
        if limit is not None:
            message = "a wait that lasts for a time has no other limit"
            diagnostics.refuse("wait", message, order.span, "leave one of them out")
        return WaitRule(duration=duration)
    if limit is not None and duration is not None:
        message = "how long it waits at most is said twice"
        diagnostics.refuse("repeated-limit", message, order.span, "leave one of them out")
    limit = duration if limit is None else limit
    event: EventKind | None = None
    match until.alternatives:
        case ((Occurs(event=EventKind() as awaited),), *others) if len(others) < 2:
            event, until = awaited, replace(until, alternatives=tuple(others))
    conditions = context.conditions.alternatives(until)
    if len(conditions) > 1:
        message = "a wait ends by conditions that all hold, not by one of several"
        diagnostics.refuse("wait", message, until.span, "join them by `and`")
    return WaitRule(event=event, conditions=conditions[0] if conditions else (), limit=limit)


def warn_of_long_waits(context: Context, header: ScriptHeader) -> None:
    """Warns of each wait that lasts at least as long as the whole mission may take."""
    if header.max_duration is None:
        return
    most_s = header.max_duration[0]
    for do in all_nodes(context.program):
        if not isinstance(do, Do) or do.wait is None or (do.wait.duration or 0) < most_s:
            continue
        message = f"this wait takes {do.wait.duration:g} s, and the whole mission may take "
        message += f"{most_s:g} s"
        hint = "wait for a shorter time, or give the mission more"
        context.diagnostics.warning("long-wait", message, do.source, hint)
