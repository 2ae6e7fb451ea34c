"""Which manners fit which orders: what an order could not make use of is an error."""

from dataclasses import fields

from argo_compiler.script.resolve.context import Context
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import Order, Word

_ROUNDS = frozenset(
    ["times", "more", "at_most", "every", "duration", "until", "finishing", "count_interruptions"]
    + ["endless", "time_limit"]
)
_PLACED = frozenset(["shown_in", "optional", "priority", "earliest", "latest", "soft_window"])
_EACH = _PLACED | frozenset(
    ["speed", "leaving", "time_limit", "reading_limit", "joints", "pose", "object_id"]
)
_WAITS = (_PLACED | {"duration", "until", "time_limit", "condition", "object_id"}) - {"pose"}
_SAID = {
    "speed": "a speed",
    "leaving": "a speed",
    "time_limit": "a limit of time",
    "reading_limit": "a limit of time for reading",
    "priority": "a priority",
    "optional": "`if there is time`",
    "condition": "a condition",
    "until": "`until`",
    "every": "`every`",
    "times": "a number of rounds",
    "more": "`again`",
    "at_most": "a number of rounds",
    "duration": "a duration",
    "delay": "a delay",
    "endless": "`endlessly`",
}


def fits(order: Order, context: Context) -> bool:
    """Whether an order can make use of all that is said of it; else an error says what it is."""
    if order.manner is None:
        return True
    strange = [name for name in _given(order.manner) if name not in _useful(order)]
    if not strange:
        return True
    what = _SAID.get(strange[0], "such a thing")
    message = f"{what} can't be said of this"
    hint = "write it behind the task that it is said of"
    context.diagnostics.error("stray-clause", message, order.span, hint)
    return False


def _given(manner: Manner) -> list[str]:
    """The names of the fields that are given."""
    values = ((field.name, getattr(manner, field.name)) for field in fields(manner))
    return [name for name, value in values if value is not None and value is not False]


def _useful(order: Order) -> frozenset[str]:
    match order:
        case orders.Measure() | orders.Go() | orders.Home():
            return _EACH | _ROUNDS | {"delay", "condition"}
        case orders.Patrol():
            return _EACH | _ROUNDS
        case orders.Repeat() | orders.Follow():
            return _ROUNDS
        case orders.Wait():
            return _WAITS
        case orders.Start() | orders.Add():
            return _EACH
        case orders.Plain(word=Word.MEET):
            return _PLACED | {"object_id"}
        case orders.Retry():
            return frozenset(["times", "at_most", "more"])
        case orders.Amend():
            return frozenset(field.name for field in fields(Manner))
    return frozenset()
