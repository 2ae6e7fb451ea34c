"""What is said of measurements that are planned: `Valve R25 has to be read within 5 minutes`."""

from argo_compiler.script.resolve.accepting import said
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Do
from argo_compiler.script.syntax.tree.orders import Measure

_DEMANDS = frozenset(["latest", "earliest", "priority", "rank"])


def demanded_of(order: Measure, context: Context) -> list[Do]:
    """The tasks of which a sentence in the passive only says when they are due, or how important;
    none if it plans them. Raises RefusedError if both may be meant."""
    asked = said(order.manner) if order.passive and order.manner is not None else frozenset()
    if not asked or not asked <= _DEMANDS:
        return []
    planned = [context.measurements(c) for c in context.nouns.all(order.what)]
    if not all(planned):
        return []
    own_step = bool(context.steps) and not context.step
    if own_step or any(len(tasks) > 1 for tasks in planned):
        message = "this can be said of what is measured before, or ask for it once more"
        hint = "say it where it is measured: `check checkpoint 4 within 5 minutes`"
        context.diagnostics.refuse("ambiguous-demand", message, order.span, hint)
    return [task for tasks in planned for task in tasks]
