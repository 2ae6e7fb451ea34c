"""Hierarchical state machine (HFSM) of a mission, as data.

Leaf states are tasks; composite states are the mission and its groups. The mission's reactions,
which interrupt it, lie beside it. The tables are flat and refer to each other by id, so that any
depth of nesting can be written and read. Running or exporting a machine needs no knowledge of the
IL:

- When the action of a leaf has ended, the leaf's transitions are tried in order, and the first one
  that is possible is taken. The last one always is.
- A transition with `target` leaves all states below its `domain` and enters the states from there
  to the target anew. A composite that is entered starts its first round and its clock.
- A transition with `completes` neither leaves nor enters a state: the round of that composite has
  ended, and the composite's own transitions are tried in order.
- REPEAT starts the next round of its composite; it can be taken while the composite's `repeat`
  wants another round.
- The time-out of a composite is taken when its clock reaches the duration: the running action is
  cancelled, and the composite's round has ended. As its time is up, it wants no other round.
- An action that failed is tried again `task.retries` times. Then the leaf's `failure` is taken, or,
  if it has none, one of the leaf's transitions, as after any other end.
- A leaf whose task has a hard window takes `missed` when the window is over, or, if it has none,
  does the same as after a failure.
- A leaf whose task is a WAIT has no action: it ends by time, an event or conditions (`task.wait`).
- A reaction is entered when its event occurs. It suspends the mission, which keeps its states.
"""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Literal

from pydantic import Field, model_validator

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Span
from argo_compiler.il import Condition, Reaction, Stop, Task

MISSION = "mission"
"""id of the composite in which all other states lie"""

DONE: Literal["done"] = "done"
"""id of the final state"""

RETURN = "return"
"""id of the leaf in which the robot drives back to the dock after a failure"""


def reaction_id(event: str) -> str:
    """Return the id of the state of the reaction to an event."""
    return f"reaction:{event}"


def task_id(name: str) -> str:
    """Return the id of a task's leaf. Tasks and groups may have the same name; their ids differ."""
    return f"task:{name}"


def group_id(name: str) -> str:
    """Return the id of a group's composite."""
    return f"group:{name}"


class TransitionKind(StrEnum):
    """Kind of a transition: the reason for which it is taken."""

    CONDITIONAL = "conditional"
    """all its conditions are satisfied"""
    REPEAT = "repeat"
    """the composite wants another round"""
    DEFAULT = "default"
    """no transition before it could be taken"""
    TIMEOUT = "timeout"
    """the composite's time is up"""
    FAILURE = "failure"
    """the action has failed for good, and the task defines a transition for that"""
    MISSED = "missed"
    """the task's hard window is over"""


class StateTransition(Model):
    """Transition of a state. Exactly one of `target` and `completes` is given."""

    kind: TransitionKind
    target: str | None = None
    """the leaf to enter, or the final state"""
    domain: str | None = None
    """with `target`: the composite that stays active while everything below it is left"""
    completes: str | None = None
    """the composite whose round has ended, and whose transitions are tried next"""
    conditions: tuple[Condition, ...] = ()
    """CONDITIONAL only: all of them must be satisfied"""


class RepeatRule(Model):
    """Rule for further rounds of a group: it wants another one until a limit is reached.

    The limits are `count`, `duration` and `until`.
    """

    count: int = Field(ge=0)
    """total number of rounds; 0: no limit"""
    duration: float = Field(ge=0)
    """s since the group was entered; 0: no limit"""
    stop: Stop
    """behaviour when the duration is over in the middle of a round"""
    count_interruptions: bool = False
    """whether the group's clock runs while the mission is interrupted"""
    every: float = Field(default=0.0, ge=0)
    """s from the start of one round to that of the next; 0: the next round starts at once"""
    until: tuple[Condition, ...] = ()
    """no other round is wanted once all of these are satisfied; empty: no such limit"""


class Composite(Model):
    """State that contains others: the mission or a group."""

    id: str
    name: str
    """name of the group, or designation of the mission"""
    parent: str | None
    """the composite around it; None for the mission"""
    children: tuple[str, ...]
    """the states that lie in it directly, in the mission's order"""
    initial: str
    """the leaf that a round begins with; it may lie in a composite further down"""
    repeat: RepeatRule | None = None
    """rule of the rounds; None for the mission, which has a single round"""
    transitions: tuple[StateTransition, ...] = ()
    """for the end of a round, in the order in which they are tried"""
    timeout: StateTransition | None = None
    """taken when the repeat's duration is over; None: the round is completed first"""
    source: Span | None = None


class Leaf(Model):
    """State in which the action of a task runs."""

    id: str
    parent: str
    task: Task
    transitions: tuple[StateTransition, ...]
    """for the end of the action, in the order in which they are tried"""
    failure: StateTransition | None = None
    """for an action that failed for good; None: `transitions`"""
    missed: StateTransition | None = None
    """for a hard window that is over; None: `failure`, or else `transitions`"""

    @property
    def source(self) -> Span | None:
        return self.task.source


class ReactionState(Model):
    """State that an event leads to. It lies beside the mission, not in it."""

    id: str
    reaction: Reaction
    task: Task | None = None
    """the drive, for RETURN and SAFE_AREA"""


class Hfsm(Model):
    """State machine. The composite `mission` begins in its `initial` state and ends in `final`."""

    version: Literal[4] = 4
    """version of this format"""
    composites: tuple[Composite, ...]
    """the mission first; each one before those that lie in it"""
    leaves: tuple[Leaf, ...]
    """in the mission's order"""
    reactions: tuple[ReactionState, ...] = ()
    """by rank, the highest first; one for each event"""
    max_duration: float | None = None
    """s since the mission's start, interruptions included, after which TIME_UP occurs"""
    supervised: bool = False
    """whether it is paused at its start, until a person resumes it (M9)"""
    final: Literal["done"] = DONE

    @property
    def mission(self) -> Composite:
        return self.composites[0]

    def transitions(self) -> Iterator[StateTransition]:
        """Yield all transitions: those of the leaves first, then those of the composites."""
        for leaf in self.leaves:
            yield from leaf.transitions
            if leaf.failure:
                yield leaf.failure
            if leaf.missed:
                yield leaf.missed
        for composite in self.composites:
            yield from composite.transitions
            if composite.timeout:
                yield composite.timeout

    @model_validator(mode="after")
    def _check_structure(self) -> "Hfsm":
        _validate(self)
        return self


def _validate(hfsm: Hfsm) -> None:
    """Check the properties that the executor and exporters rely on, in linear time.

    Raises:
        ValueError: a state is missing, duplicated or in a wrong place, or a state has a transition
            that can't be taken from it.
    """
    composites = _composites(hfsm)
    nesting = _Nesting(hfsm.composites)
    leaves = {leaf.id: leaf for leaf in hfsm.leaves}
    if len({*leaves, *composites}) < len(hfsm.leaves) + len(hfsm.composites):
        raise ValueError("two states have the same id")
    parents = {leaf.id: leaf.parent for leaf in hfsm.leaves} | {hfsm.final: hfsm.mission.id}
    for leaf in hfsm.leaves:
        if leaf.parent not in composites:
            raise ValueError(f"there is no composite '{leaf.parent}' around '{leaf.id}'")
    states = {*parents, *composites}
    for composite in hfsm.composites:
        for state in (composite.initial, *composite.children):
            if state not in states:
                raise ValueError(f"there is no state '{state}' in '{composite.id}'")

    def check(id: str, parent: str, transitions: Sequence[StateTransition], completes: str) -> None:
        for t in transitions:
            if (t.target is None) == (t.completes is None):
                raise ValueError(f"a transition of '{id}' needs either target or completes")
            if t.completes is not None:
                if t.completes != completes:
                    raise ValueError(f"'{id}' can't complete '{t.completes}'")
            elif t.target not in parents or t.domain not in composites:
                raise ValueError(f"there is no state '{t.target}' in '{t.domain}' for '{id}'")
            elif t.domain != parent and not nesting.lies_in(parent, t.domain):
                raise ValueError(f"'{id}' can't take a transition in '{t.domain}'")
            elif t.domain != parents[t.target] and not nesting.lies_in(parents[t.target], t.domain):
                raise ValueError(f"'{t.target}' does not lie in '{t.domain}'")

    completed = {t.completes for t in hfsm.transitions()}
    for leaf in hfsm.leaves:
        check(leaf.id, leaf.parent, leaf.transitions, leaf.parent)
        if leaf.failure:
            check(leaf.id, leaf.parent, (leaf.failure,), "")
        if leaf.missed:
            check(leaf.id, leaf.parent, (leaf.missed,), "")
        last = leaf.transitions[-1] if leaf.transitions else None
        if last is None or last.kind != "default" or last.conditions:
            raise ValueError(f"the last transition of '{leaf.id}' may be impossible")
    for composite in hfsm.composites[1:]:
        check(composite.id, composite.id, composite.transitions, composite.parent or "")
        if composite.timeout:
            check(composite.id, composite.id, (composite.timeout,), composite.id)
        if composite.id not in completed:
            continue
        last = composite.transitions[-1] if composite.transitions else None
        repeat = composite.repeat
        endless = repeat and not (repeat.count or repeat.duration or repeat.until)
        if last is None or (last.kind != "default" and not endless) or last.conditions:
            raise ValueError(f"the last transition of '{composite.id}' may be impossible")


def _composites(hfsm: Hfsm) -> set[str]:
    known: set[str] = set()
    for composite in hfsm.composites:
        if (composite.parent is None) != (not known):
            raise ValueError(f"only the mission has no parent; '{composite.id}' breaks this rule")
        if composite.parent is not None and composite.parent not in known:
            raise ValueError(f"composite '{composite.id}' comes before its parent")
        known.add(composite.id)
    if not hfsm.composites or hfsm.composites[0].id != "mission":
        raise ValueError("there is no composite 'mission'")
    return known


class _Nesting:
    """Nesting of the composites: each has an interval that lies within that of its parent."""

    def __init__(self, composites: Sequence[Composite]) -> None:
        children: dict[str | None, list[str]] = {c.id: [] for c in composites}
        for c in composites[1:]:
            children[c.parent].append(c.id)
        self._first: dict[str, int] = {}
        self._last: dict[str, int] = {}
        pending: list[tuple[str, bool]] = [(composites[0].id, False)]
        while pending:
            id, done = pending.pop()
            if done:
                self._last[id] = len(self._first)
                continue
            self._first[id] = len(self._first)
            pending.append((id, True))
            pending += [(child, False) for child in children[id]]

    def lies_in(self, inner: str, outer: str) -> bool:
        return self._first[outer] <= self._first[inner] < self._last[outer]
