"""Which orders make use of what is said of how, when and how often something is done.

All that a manner can say is either used by the order that it is said of, or an error: nothing is
passed over. A test tries each with each.
"""

from collections.abc import Iterable, Mapping
from dataclasses import fields

from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.manner import NOTHING_SAID, Manner
from argo_compiler.script.sentences.tree.orders import PlainWord, ScriptOrder

ROUND = frozenset(
    {
        *("times", "more", "at_most", "every", "pause", "duration", "until", "endless"),
        *("in_circles", "finishing", "count_interruptions"),
    }
)
"""what makes a round of an order, or is said of one"""
OF_TASKS = frozenset(
    {
        *("speed", "leaving", "time_limit", "reading_limit", "optional", "priority", "earliest"),
        *("rank", "by_importance"),
        *("latest", "soft_window", "joints", "shown_in", "object_id"),
    }
)
"""what is said of each task of an order"""
_CASE = frozenset(["delay", "condition"])
_ONCE_MORE = frozenset(["times", "more"])
_OF_MEETING = OF_TASKS - {"speed", "time_limit"} | _CASE
_NOTHING: frozenset[str] = frozenset()

_USED: Mapping[type[ScriptOrder], frozenset[str]] = {
    orders.Measure: OF_TASKS | ROUND | _CASE | {"pose", "order", "backwards", "floors"},
    orders.Add: OF_TASKS | ROUND | _CASE | {"pose"},
    orders.Go: OF_TASKS | ROUND | _CASE,
    orders.Home: OF_TASKS | ROUND | _CASE,
    orders.VisitOrder: frozenset(["speed"]),
    orders.Start: OF_TASKS,
    orders.WaitOrder: OF_TASKS - {"speed"}
    | _CASE
    | {"duration", "until", "pose", "person", "task_pair"}
    | {"charge", "charge_time"},
    orders.Patrol: OF_TASKS - {"reading_limit", "object_id"} | ROUND | _CASE | {"order"},
    orders.Repeat: ROUND | {"time_limit", "order"},
    orders.Follow: ROUND | {"time_limit", "order", "by_importance"},
    orders.Amend: OF_TASKS | {"pose", "order"},
    orders.Retry: _ONCE_MORE | {"at_most"},
}
"""of other orders nothing can be said"""
_NAMED = (
    *(orders.Measure, orders.Add, orders.Go, orders.Home, orders.Start, orders.WaitOrder),
    *(orders.Patrol, orders.Repeat, orders.Follow),
)
"""what a name can be given to"""
_WORDS = {
    "leaving": "a speed for leaving",
    "delay": "a wait before it",
    "time_limit": "a time limit",
    "reading_limit": "a time to read",
    "optional": "that it is optional",
    "earliest": "an earliest time",
    "latest": "a latest time",
    "soft_window": "that a time is only a preference",
    "times": "a number of rounds",
    "more": "that it is repeated",
    "at_most": "the maximum number of rounds",
    "every": "an interval",
    "pause": "a pause between rounds",
    "duration": "a duration",
    "until": "a condition that ends it",
    "finishing": "whether the round is finished",
    "count_interruptions": "that interruptions count",
    "endless": "that it never ends",
    "in_circles": "that it goes round in circles",
    "condition": "a condition",
    "joints": "joints",
    "shown_in": "the group that it is shown in",
    "object_id": "an object",
    "pose": "the robot's position",
    "task_pair": "the tasks between which it is done",
    "order": "an order",
    "backwards": "that it is reversed",
    "floors": "floors",
    "rank": "a priority",
    "by_importance": "an order of importance",
    "mission_time": "the duration of the mission",
    "person": "a person to wait for",
    "on_limit": "what happens when the waiting time ends",
    "charge": "a charge of the battery",
    "charge_time": "a least time for charging",
}


_FIELDS = [(field.name, field.default) for field in fields(Manner)]


def said(manner: Manner) -> frozenset[str]:
    """The fields that say something."""
    if manner is NOTHING_SAID:
        return frozenset()
    return frozenset(name for name, default in _FIELDS if getattr(manner, name) != default)


def words_of(names: Iterable[str]) -> str:
    """Fields in words."""
    return " and ".join(_WORDS.get(name, f"a {name}") for name in names)


def require_used(order: ScriptOrder, diagnostics: Diagnostics) -> None:
    """That an order makes use of all that is said of it. Raises RefusedError if not."""
    meets = isinstance(order, orders.Plain) and order.word is PlainWord.MEET
    if order.name is not None and not meets and not isinstance(order, _NAMED):
        message = f"the name `{order.name}` is in front of something that is not a task"
        hint = "write it in front of the command of a task, or remove it"
        diagnostics.refuse("stray-clause", message, order.span, hint)
    if not order.manner:
        return
    used = _OF_MEETING if meets else _USED.get(type(order), _NOTHING)
    given = said(order.manner)
    if isinstance(order, orders.WaitOrder) and order.manner.more and order.manner.times == 1:
        used |= _ONCE_MORE  # `wait again`
    if isinstance(order, orders.WaitOrder) and order.where is not None:
        used |= {"speed"}  # of the way to the place
    left = [name for name, _ in _FIELDS if name in given - used] if given - used else []
    if left:
        message = f"this has no meaning here: {words_of(left)}"
        hint = "write it after the command that it belongs to, or remove it"
        diagnostics.refuse("stray-clause", message, order.span, hint)
