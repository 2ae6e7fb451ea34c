"""The canonical script's steps: a task as a command, with all that is said of how it is done, and
where the mission goes on after it."""

from collections.abc import Iterator, Mapping

from argo_compiler.base.records import dataclass
from argo_compiler.il import Action, JointState, OnFailure, Task, TimeWindow, WaitRule
from argo_compiler.script.write.conditions import (
    awaited,
    checkpoint,
    conditions,
    recharges_for_time,
)
from argo_compiler.script.write.text import (
    Places,
    UnwritableError,
    duration,
    listed,
    number,
    point,
    quote,
    times,
)

_POLICIES = {
    OnFailure.RETURN: "return to the docking station",
    OnFailure.ABORT: "abort the mission",
}


def command(task: Task, places: Places) -> str:
    """What the task does, in its shortest form."""
    match task.action:
        case Action.MEASURE:
            if task.object_id is None:
                raise UnwritableError("it measures nothing")
            return f"check checkpoint #{checkpoint(task.object_id)}"
        case Action.START:
            return "start here" if task.pose is None else f"start here at {point(task.pose)}"
        case Action.WAIT:
            if task.wait is None:
                raise UnwritableError("it has no duration of the wait: `wait`")
            return _wait(task.wait)
        case Action.WAYPOINT:
            if task.pose is None:
                raise UnwritableError("it is a waypoint without a pose")
            return f"go to {places.location(task.pose)}"


def _wait(rule: WaitRule) -> str:
    if rule.duration is not None:
        if rule.event is not None or rule.conditions or rule.limit is not None:
            raise UnwritableError("a wait for a time has nothing else: `event`, `limit`")
        return f"wait {duration(rule.duration)}" if rule.duration else "go on here"
    if recharges_for_time(rule.event, rule) and not rule.conditions:
        assert rule.charge_for is not None
        said = f"recharge for at least {duration(rule.charge_for)}"
    else:
        said = f"wait {_until(rule)}"
    return said if rule.limit is None else f"{said},\nfor at most {duration(rule.limit)}"


def _until(rule: WaitRule) -> str:
    """Return the words for the end of a wait: `until all clear is given or #1 is above 3`."""
    if rule.event is None:
        if not rule.conditions:
            raise UnwritableError("it has no condition to wait for: `wait`")
        if (rule.charge_to, rule.charge_for) != (None, None):
            raise UnwritableError("nothing is charged: `charge_to`, `charge_for`")
        return f"until {conditions(rule.conditions)}"
    if not rule.conditions:
        return awaited(rule.event, rule)
    joint = ", or " if len(rule.conditions) > 1 else " or "
    return awaited(rule.event, rule, f"{joint}{conditions(rule.conditions)}")


def manners(task: Task, group: str) -> Iterator[str]:
    """All that is said of how and when the task is done; `group` is the innermost one around it."""
    _require_used(task)
    if task.action in (Action.MEASURE, Action.WAIT) and task.pose is not None:
        yield f"standing at {point(task.pose)}"
    if task.action is not Action.MEASURE and task.object_id is not None:
        yield f"about object {quote(task.object_id)}"
    if task.joint_states is not None:
        yield _joints(task.joint_states)
    if task.group != group:
        yield f"shown in {quote(task.group)}"
    if task.velocity is not None:
        yield f"at {number(task.velocity)} m/s"
    if task.time_limit is not None:
        yield f"taking at most {duration(task.time_limit)}"
    if task.reading_limit is not None:
        yield f"reading for at most {duration(task.reading_limit)}"
    if task.window is not None:
        yield _window(task.window)
    if task.optional:
        yield "if there is time"
    if task.priority != 1:
        yield f"with priority {task.priority}"
    if task.retries:
        yield f"retry {times(task.retries)}"


def _require_used(task: Task) -> None:
    """That nothing is said that no script says of such a task. Raises UnwritableError."""
    if task.action is Action.WAIT and task.time_limit is not None:
        raise UnwritableError("a wait has a limit of its own: `time_limit`")
    if task.action is not Action.WAIT and task.wait is not None:
        raise UnwritableError("only a WAIT waits: `wait`")


def _joints(joints: JointState) -> str:
    said = f"with joints [{listed(map(quote, joints.names))}]"
    given = {"at": joints.positions, "velocities": joints.velocities, "efforts": joints.efforts}
    for what, values in given.items():
        if values:
            said += f" {what} [{listed(map(number, values))}]"
    return said


def _window(window: TimeWindow) -> str:
    """`not before 60 s and not later than 120 s after the start`"""
    bounds = []
    if window.earliest:
        bounds.append(f"not before {duration(window.earliest)}")
    if window.latest is not None:
        bounds.append(f"not later than {duration(window.latest)}")
    said = f"{' and '.join(bounds)} after the start" if bounds else "at any time"
    return said if window.hard else f"preferably {said}"


# ---- where the mission goes on


@dataclass(frozen=True, slots=True)
class Around:
    """What the words for a task's ways depend on besides the task."""

    following: str | None
    """the next task of the mission's list"""
    ends_round: bool
    """whether a round ends with it"""
    steps: Mapping[str, int]
    """the steps of those tasks that can be named by one"""
    ends: Mapping[str, str]
    """the words for going to those tasks that have no step"""


def ways(task: Task, around: Around) -> Iterator[str]:
    """The sentences for where the mission goes on, except for what is meant if nothing is said."""
    yield from _transitions(task, around)
    if task.on_failure is OnFailure.BRANCH:
        if task.failure_target is None:
            raise UnwritableError("it has no task to go on with: `failure_target`")
        yield f"if it fails, {_jump(task.failure_target, around)}"
    elif task.failure_target is not None:
        raise UnwritableError(f"it has no use for `failure_target`: it will {task.on_failure}")
    elif task.on_failure is not OnFailure.CONTINUE:
        yield f"if it fails, {_POLICIES[task.on_failure]}"
    if task.window is not None and task.window.missed_target is not None:
        yield f"if it is too late, {_jump(task.window.missed_target, around)}"


def _transitions(task: Task, around: Around) -> Iterator[str]:
    conditional = any(t.conditions for t in task.transitions)
    if sum(not t.conditions for t in task.transitions) > 1:
        raise UnwritableError("it has several transitions without conditions: `transitions`")
    unconditional = False
    for i, transition in enumerate(task.transitions):
        if transition.conditions:
            held = conditions(transition.conditions)
            yield f"if {held},\n{_jump(transition.target, around)}"
            continue
        unconditional = True
        last = i + 1 == len(task.transitions)
        if transition.target == around.following:
            if not last:
                yield f"{_rest(around, conditional, last)} go on"
        else:
            yield f"{_rest(around, conditional, last)} {_jump(transition.target, around)}"
    if not unconditional and around.following is not None:
        yield f"{_rest(around, conditional, True)} end the mission"


def _rest(around: Around, conditional: bool, last: bool) -> str:
    """When the way without conditions is taken."""
    if around.ends_round:
        return "after the last round,"
    if not conditional:
        return "then"
    return "otherwise" if last else "in all other cases"


def _jump(target: str, around: Around) -> str:
    return around.ends.get(target) or f"go to {step_of(target, around.steps)}"


def step_of(task: str, steps: Mapping[str, int]) -> str:
    """The task as a step: by number where it has one of its own, else by name."""
    return f"step {steps[task]}" if task in steps else f"step {quote(task)}"
