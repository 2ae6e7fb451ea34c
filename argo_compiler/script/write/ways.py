"""How the canonical script says where a mission goes on after a task."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from argo_compiler.il import OnFailure, Task
from argo_compiler.script.write.conditions import conditions
from argo_compiler.script.write.text import UnwritableError, quote

_POLICIES = {
    OnFailure.RETURN: "return to the docking station",
    OnFailure.ABORT: "abort the mission",
}


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
            raise UnwritableError("it does not say where it goes on: `failure_target`")
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
        raise UnwritableError("it has several ways without conditions: `transitions`")
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
