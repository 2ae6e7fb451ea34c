"""One step of a machine: pure functions from where it stands to where it stands next."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from argo_compiler.hfsm.conditions import Measured, holds, words
from argo_compiler.hfsm.events import Cause, TraceEntry
from argo_compiler.hfsm.model import (
    DONE,
    MISSION,
    Composite,
    Hfsm,
    Leaf,
    Transition,
    TransitionKind,
)

_CAUSES = {
    TransitionKind.CONDITIONAL: Cause.CONDITION,
    TransitionKind.REPEAT: Cause.REPEAT,
    TransitionKind.DEFAULT: Cause.DEFAULT,
}


@dataclass(frozen=True, slots=True)
class Frame:
    """A group that is active: the round it is in, from 1, and when it was entered (s)."""

    group: Composite
    round: int
    entered: float

    @property
    def time_up(self) -> float | None:
        """When its duration is over (s), or None without a limit."""
        repeat = self.group.repeat
        return self.entered + repeat.duration if repeat and repeat.duration else None

    def wants_another_round(self, now: float) -> bool:
        repeat, time_up = self.group.repeat, self.time_up
        if repeat is None or (repeat.count and self.round >= repeat.count):
            return False
        return time_up is None or now < time_up


@dataclass(frozen=True, slots=True)
class State:
    """Where a machine stands. `leaf` is None when the mission has ended."""

    time: float
    """s, of the last step"""
    leaf: Leaf | None
    visit: int
    """how many leaves have been entered: tells two visits of a task apart"""
    frames: tuple[Frame, ...]
    """the active groups, outermost first"""
    values: Mapping[str, Measured]
    """by object_id; never changed, only replaced"""


class Machine:
    """A machine with its states looked up by id; it does not change."""

    def __init__(self, hfsm: Hfsm) -> None:
        self._initial = hfsm.mission.initial
        self._leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self._composites = {composite.id: composite for composite in hfsm.composites}
        # The position of a group's frame; the mission, which has none, stands at -1.
        self._depth = {MISSION: -1}
        for composite in hfsm.composites:
            if composite.parent is not None:
                self._depth[composite.id] = self._depth[composite.parent] + 1

    def leaf(self, id: str) -> Leaf | None:
        return self._leaves.get(id)

    def groups_around(self, leaf: Leaf, domain: str = MISSION) -> tuple[Composite, ...]:
        """The groups below `domain` that the leaf lies in, outermost first."""
        groups = []
        id = leaf.parent
        while id != domain:
            group = self._composites[id]
            groups.append(group)
            id = group.parent or MISSION
        return tuple(reversed(groups))

    def initial(self, now: float) -> tuple[State, TraceEntry]:
        nowhere = State(time=now, leaf=None, visit=0, frames=(), values={})
        state = self._enter(nowhere, self._initial, MISSION)
        return state, TraceEntry(now, None, _task_name(state), Cause.START)

    def action_ended(self, state: State, failure: str | None) -> tuple[State, TraceEntry]:
        """The step at the end of the running action, at the state's time."""
        assert state.leaf is not None
        return self._step(state, state.leaf.transitions, failure=failure)

    def timed_out(self, state: State, group: Composite) -> tuple[State, TraceEntry]:
        """The step when the time of an active group is up, at the state's time."""
        assert group.timeout is not None
        return self._step(state, (group.timeout,), timed_out=group.name)

    def _step(
        self,
        state: State,
        transitions: tuple[Transition, ...],
        failure: str | None = None,
        timed_out: str | None = None,
    ) -> tuple[State, TraceEntry]:
        taken = self._first_possible(state, transitions)
        while taken.completes is not None:
            taken = self._first_possible(state, self._composites[taken.completes].transitions)
        assert taken.target is not None
        assert taken.domain is not None
        after = self._enter(state, taken.target, taken.domain)
        repeated = None
        if taken.kind is TransitionKind.REPEAT:
            at = self._depth[taken.domain]
            frame = state.frames[at]
            repeated = frame.group.name
            again = replace(frame, round=frame.round + 1)
            after = replace(after, frames=(*after.frames[:at], again, *after.frames[at + 1 :]))
        return after, TraceEntry(
            state.time,
            _task_name(state),
            _task_name(after),
            _CAUSES[taken.kind] if timed_out is None else Cause.TIMEOUT,
            tuple(words(condition) for condition in taken.conditions),
            timed_out,
            repeated,
            failure,
        )

    def _first_possible(self, state: State, transitions: tuple[Transition, ...]) -> Transition:
        return next(t for t in transitions if self._possible(state, t))

    def _possible(self, state: State, transition: Transition) -> bool:
        if transition.kind is TransitionKind.REPEAT:
            frame = state.frames[self._depth[transition.domain or MISSION]]
            return frame.wants_another_round(state.time)
        return all(holds(c, state.values, state.time) for c in transition.conditions)

    def _enter(self, state: State, target: str, domain: str) -> State:
        """The state after leaving all below `domain` and entering what leads to `target`."""
        leaf = None if target == DONE else self._leaves[target]
        frames = state.frames[: self._depth[domain] + 1]
        if leaf is not None and leaf.parent != domain:
            entered = self.groups_around(leaf, domain)
            frames += tuple(Frame(group, 1, state.time) for group in entered)
        return State(state.time, leaf, state.visit + 1, frames, state.values)


def next_timeout(state: State) -> tuple[float, Composite] | None:
    """When the time of an active group with a time-out is up next (s), and the group.

    Of several at the same time it is the outermost one, as leaving it leaves the others too.
    """
    found: tuple[float, Composite] | None = None
    for frame in state.frames:
        if frame.group.timeout is None or frame.time_up is None:
            continue
        if found is None or frame.time_up < found[0]:
            found = frame.time_up, frame.group
    return found


def _task_name(state: State) -> str | None:
    return state.leaf.task.name if state.leaf else None
