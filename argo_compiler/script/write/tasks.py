"""The canonical script's steps: a task with all that it has, as a command and its clauses."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from argo_compiler.catalog import Catalog
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    OnFailure,
    Task,
    Transition,
    WaitRule,
)
from argo_compiler.model import Pose
from argo_compiler.number_text import number
from argo_compiler.script.syntax.protocol import protocol_grammar
from argo_compiler.script.syntax.shapes import StumbleError
from argo_compiler.script.write.sayable import require_sayable
from argo_compiler.script.write.text import UnwritableError, duration, point, quote, times

_WORDS = re.compile(r"[a-z]+(?: [a-z]+)*")
_ON_FAILURE = {
    OnFailure.CONTINUE: "if it fails continue",
    OnFailure.RETURN: "if it fails return to the docking station",
    OnFailure.ABORT: "if it fails abort the mission",
}
SAID = frozenset(
    [
        "name",
        "action",
        "group",
        "object_id",
        "pose",
        "wait",
        "velocity",
        "joint_states",
        "retries",
        "on_failure",
        "transitions",
        "source",
    ]
)
"""the fields of a task that a script can say"""
_SAID_OF_JOINTS = frozenset(["names", "positions"])


class Places:
    """The site's places by their poses, as a script names them."""

    def __init__(self, catalog: Catalog) -> None:
        self._areas = {area.dock: area.number for area in reversed(catalog.areas)}
        self._docks = {area.number: area.dock for area in reversed(catalog.areas)}
        self._names = {place.pose: _name(place.name) for place in reversed(catalog.places)}

    def name(self, pose: Pose) -> str | None:
        """What the site calls the place with this pose."""
        return self._names.get(pose)

    def dock(self, area: int) -> Pose | None:
        """The docking station in the starting area of this number."""
        return self._docks.get(area)

    def location(self, pose: Pose) -> str:
        """The pose as a place or area of the site if it is one, else in coordinates."""
        if pose in self._names:
            return self._names[pose]
        return f"starting area {self._areas[pose]}" if pose in self._areas else point(pose)


def _name(place: str) -> str:
    """The place's name, in quotation marks unless it is understood without."""
    plain = f"the {place}"
    if _WORDS.fullmatch(place) and is_place(plain):
        return plain
    return quote(place)


@dataclass(frozen=True)
class TaskContext:
    """What a task's clauses depend on besides the task."""

    following: str | None
    """the next task of the mission's list"""
    group: str
    """the innermost group around it"""
    ends: bool
    """whether a round ends with it"""
    steps: Mapping[str, int]
    """the steps of those tasks that can be named by one"""


def clauses(task: Task, around: TaskContext) -> Iterator[str]:
    """All that the task has besides its name and its command."""
    require_sayable(task, SAID if task.action is Action.WAIT else SAID - {"wait"})
    if task.action in (Action.MEASURE, Action.WAIT) and task.pose is not None:
        yield f"standing at {point(task.pose)}"
    if task.action is not Action.MEASURE and task.object_id is not None:
        yield f"about object {quote(task.object_id)}"
    if task.joint_states is not None:
        require_sayable(task.joint_states, _SAID_OF_JOINTS, "joint_states.")
        names = ",\n".join(quote(name) for name in task.joint_states.names)
        positions = ",\n".join(number(value) for value in task.joint_states.positions)
        yield f"with joints [{names}]\nat [{positions}]"
    if task.group != around.group:
        yield f"shown in {quote(task.group)}"
    if task.velocity is not None:
        yield f"at {number(task.velocity)} m/s"
    if task.retries:
        yield f"retry {times(task.retries)}"
    if task.on_failure is OnFailure.BRANCH:
        raise UnwritableError("can't be said in a script yet: `on_failure` branch")
    if task.on_failure is not OnFailure.CONTINUE:
        yield _ON_FAILURE[task.on_failure]
    yield from _ways(task.transitions, around)


def _ways(transitions: tuple[Transition, ...], around: TaskContext) -> Iterator[str]:
    """The transitions, except for what is meant if nothing is said."""
    conditional = any(t.conditions for t in transitions)
    # Otherwise is one of the cases in a round; what comes then, comes after the last round.
    word = "otherwise" if conditional and not around.ends else "then"
    unconditional = False
    for i, transition in enumerate(transitions):
        if transition.conditions:
            held = "\nand ".join(condition(c) for c in transition.conditions)
            yield f"if {held},\n{_jump(transition.target, around)}"
            continue
        unconditional = True
        if transition.target != around.following:
            yield f"{word} {_jump(transition.target, around)}"
        elif i + 1 < len(transitions):
            yield "otherwise go on"
    if not unconditional and around.following is not None:
        yield f"{word} end the mission"


def _jump(target: str, around: TaskContext) -> str:
    return f"go to {step_of(target, around.steps)}"


def step_of(task: str, steps: Mapping[str, int]) -> str:
    """The task as a step: by number where it has one of its own, else by name."""
    return f"step {steps[task]}" if task in steps else f"step {quote(task)}"


def condition(c: Condition) -> str:
    """`checkpoint #1 is above 2.5`"""
    details = []
    if c.id:
        details.append(f"called {quote(c.id)}")
    if not c.type.compares or c.param1 is None:
        raise UnwritableError(f"can't be said in a script yet: a condition of type {c.type}")
    low, high = number(c.param1), None if c.param2 is None else number(c.param2)
    if c.type is ConditionType.WITHIN:
        if high is None:
            raise UnwritableError("a WITHIN condition has no second bound")
        test = f"from {low} to {high}" if c.inclusive else f"between {low} and {high}"
    else:
        words = {
            (ConditionType.LESS, False): "below",
            (ConditionType.LESS, True): "at most",
            (ConditionType.GREATER, False): "above",
            (ConditionType.GREATER, True): "at least",
        }
        test = f"{words[c.type, c.inclusive]} {low}"
        if high is not None:
            details.append(f"with second bound {high}")
    said = f"checkpoint #{_checkpoint(c.object_id)}"
    if details:
        said += f" ({', '.join(details)})"
    if c.max_age is not None:
        said += f" measured within the last {duration(c.max_age)}"
    return f"{said} is {test}"


def _checkpoint(object_id: str) -> str:
    if not (object_id.isascii() and object_id.isdecimal()) or object_id != str(int(object_id)):
        raise UnwritableError(f"a script names checkpoints by number, and `{object_id}` is none")
    return object_id


def command(task: Task, places: Places) -> str:
    """What the task does, in its shortest form."""
    if task.action is Action.MEASURE:
        if task.object_id is None:
            raise UnwritableError("it measures nothing")
        return f"check checkpoint #{_checkpoint(task.object_id)}"
    if task.action is Action.START:
        return "start here" if task.pose is None else f"start here at {point(task.pose)}"
    if task.action is Action.WAIT:
        if task.wait != WaitRule(duration=0):
            raise UnwritableError("can't be said in a script yet: how it waits (`wait`)")
        return "go on here"
    if task.pose is None:
        raise UnwritableError("it is a waypoint without a pose")
    return f"go to {places.location(task.pose)}"


def is_place(words: str) -> bool:
    """Whether the words stand for a place, and for nothing else, behind `go to`."""
    text = f"go to {words}"
    try:
        tree = protocol_grammar().parse("line", text)
    except StumbleError:
        return False
    found = list(tree.find_data("place"))
    return len(found) == 1 and found[0].meta.end_pos == len(text)
