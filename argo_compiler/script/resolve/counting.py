"""Steps that are counted from the one that is being planned: `the next step`."""

from dataclasses import fields, replace
from functools import cache
from typing import Any

from argo_compiler.script.resolve.context import Context
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.orders import ScriptOrder
from argo_compiler.script.syntax.tree.places import Steps


def counted(order: ScriptOrder, context: Context) -> ScriptOrder:
    """The order with the numbers of the steps that it means."""
    kind: Any = type(order)
    for name in _fields(kind):
        steps = getattr(order, name)
        if type(steps) is Steps and steps.ahead:
            given: dict[str, Any] = {name: _numbered(steps, context)}
            return replace(order, **given)
    return order


@cache
def _fields(type_: type[Any]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(type_))


def skipping(order: ScriptOrder, context: Context) -> ScriptOrder:
    """`Skip the next step`, in one case only: it goes on behind it."""
    if not isinstance(order, orders.Delete) or not isinstance(order.what, Steps):
        return order
    steps = _numbered(order.what, context) if order.what.ahead else order.what
    following = (context.number or 0) + 1
    several = steps.points == (*range(following, following + len(steps.points)),)
    neighbours = steps.points[0] == following and (steps.through or several)
    if not order.what.ahead and not (neighbours and context.number):
        return order
    return orders.Jump(span=order.span, step=replace(steps, behind=True))


def _numbered(steps: Steps, context: Context) -> Steps:
    if context.number is None:
        message = "it is not clear which one the next step is"
        hint = "number the steps, and name it: `step 4`"
        context.diagnostics.refuse("step-range", message, steps.span, hint)
    points = tuple(context.number + n for n in steps.points if isinstance(n, int))
    return replace(steps, points=points, ahead=False)
