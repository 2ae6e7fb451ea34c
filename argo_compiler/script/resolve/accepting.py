"""Which orders make use of what is said of how, when and how often something is done.

All that a manner can say is either used by the order that it is said of, or an error: nothing is
passed over. A test tries each with each.
"""

from collections.abc import Iterable, Mapping
from dataclasses import fields

from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import PlainWord, ScriptOrder

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
    orders.WaitOrder: OF_TASKS - {"speed"} | _CASE | {"duration", "until", "pose", "person"},
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
    "leaving": "a speed of leaving",
    "delay": "a wait before it",
    "time_limit": "a limit of time",
    "reading_limit": "a time to read",
    "optional": "that it may be left out",
    "earliest": "a time before which it is not done",
    "latest": "a time by which it is done",
    "soft_window": "that a time is only preferred",
    "times": "how often",
    "more": "that it is done again",
    "at_most": "how often at most",
    "every": "every so often",
    "pause": "a pause between rounds",
    "duration": "for how long",
    "until": "until when",
    "finishing": "whether a round is finished",
    "count_interruptions": "that interruptions count",
    "endless": "that it never ends",
    "in_circles": "that it is done in circles",
    "condition": "in which case",
    "joints": "joints",
    "shown_in": "where it is shown",
    "object_id": "an object",
    "pose": "where it stands",
    "order": "an order",
    "backwards": "that it is done backwards",
    "floors": "floors",
    "rank": "a priority",
    "by_importance": "that some are more important than others",
    "mission_time": "how long the mission may take",
    "person": "a person to wait for",
    "on_limit": "what happens when a hold is over",
}


_FIELDS = [(field.name, field.default) for field in fields(Manner)]


def said(manner: Manner) -> frozenset[str]:
    """The fields that say something."""
    return frozenset(name for name, default in _FIELDS if getattr(manner, name) != default)


def words_of(names: Iterable[str]) -> str:
    """Fields in words."""
    return " and ".join(_WORDS.get(name, f"a {name}") for name in names)


def require_used(order: ScriptOrder, diagnostics: Diagnostics) -> None:
    """That an order makes use of all that is said of it. Raises RefusedError if not."""
    meets = isinstance(order, orders.Plain) and order.word is PlainWord.MEET
    if order.name is not None and not meets and not isinstance(order, _NAMED):
        message = f"the name `{order.name}` stands before what is no task"
        hint = "write it before the order that plans the task, or leave it out"
        diagnostics.refuse("stray-clause", message, order.span, hint)
    if order.manner is None:
        return
    used = _OF_MEETING if meets else _USED.get(type(order), _NOTHING)
    given = said(order.manner)
    if isinstance(order, orders.WaitOrder) and order.manner.more and order.manner.times == 1:
        used |= _ONCE_MORE  # `wait again`
    if isinstance(order, orders.WaitOrder) and order.where is not None:
        used |= {"speed"}  # of the way to the place
    left = [name for name, _ in _FIELDS if name in given - used] if given - used else []
    if left:
        message = f"this can't be said here: {words_of(left)}"
        hint = "write it behind what is to be done so, or leave it out"
        diagnostics.refuse("stray-clause", message, order.span, hint)
