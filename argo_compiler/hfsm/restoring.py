"""From where a machine stands to progress, and back."""

from collections import deque
from collections.abc import Iterable, Mapping

from argo_compiler.errors import Conflict
from argo_compiler.hfsm.interrupts import Stage
from argo_compiler.hfsm.model import RETURN, task_id
from argo_compiler.hfsm.progress import (
    ByHand,
    GroupProgress,
    Phase,
    Progress,
    Reacting,
    ValueProgress,
    Waiting,
)
from argo_compiler.hfsm.rounds_and_clocks import Configuration, Frame
from argo_compiler.hfsm.standing import InterruptState, Pending, drives
from argo_compiler.hfsm.tables import GroupNode, LeafNode, Tables
from argo_compiler.il import EventKind, Reaction, Response
from argo_compiler.il.reserved import RETURN_TASK

_OTHER = "use the mission that it was saved from, or match it to this one first"


def place_of(tables: Tables, progress: Progress, now: float, away: float) -> Configuration:
    """Where a machine stands that goes on from `progress` at `now`, after `away` seconds.

    Raises:
        ArgoError: the progress is not one of this machine.
    """
    place = Configuration(tables)
    place.visit = place.new_visit()
    place.attempt = progress.attempt
    if progress.paused or progress.reaction:
        place.interrupted_at = now
    # What was done by hand took its part of the time away; its clocks run when it is come to.
    away = max(0.0, away - sum(done.duration for done in progress.by_hand))
    place.values = {v.object_id: (v.value, now - v.age - away) for v in progress.values}
    if progress.active is None:
        return place
    place.leaf = _leaf(tables, progress.active)
    for group, known in zip(_groups(place.leaf, progress), progress.groups, strict=True):
        elapsed = known.elapsed + (away if group.counts_interruptions else 0.0)
        place.frames.append(Frame(group, known.round, now - elapsed))
    return place


def standing_of(tables: Tables, progress: Progress) -> InterruptState:
    """Who has the robot: the reactions that are active and wait, and whether it is paused.

    Raises:
        ArgoError: the machine does not have the reactions.
    """
    if progress.outcome is not None:
        return InterruptState(Stage.ENDING, outcome=progress.outcome)
    active = progress.reaction
    pending = tuple(
        Pending(_reaction(tables, waiting.event).event, waiting.over)
        for waiting in ((active,) if active else ()) + progress.waiting
    )
    stage = Stage.CHOOSING if pending else Stage.GOING
    if active is not None:
        driving = active.phase is Phase.DRIVING and drives(_reaction(tables, active.event))
        stage = Stage.DRIVING if driving else Stage.HOLDING
    elif progress.paused:
        stage = Stage.STOPPED
    return InterruptState(stage, progress.paused, None if active is None else active.event, pending)


def group_progress(place: Configuration, now: float) -> tuple[GroupProgress, ...]:
    """The active groups, outermost first."""
    return tuple(
        GroupProgress(
            group=frame.group.name,
            round=frame.round,
            elapsed=max(0.0, place.clock(now, frame.group) - frame.entered),
        )
        for frame in place.frames
    )


def value_progress(place: Configuration, now: float) -> tuple[ValueProgress, ...]:
    """The values with their ages."""
    clock = now + place.shift
    return tuple(
        ValueProgress(object_id=id, value=value, age=max(0.0, clock - measured))
        for id, (value, measured) in place.values.items()
    )


def reaction_progress(standing: InterruptState) -> tuple[Reacting | None, tuple[Waiting, ...]]:
    """The active reaction and those that wait."""
    waiting = tuple(Waiting(event=p.event, over=p.over) for p in standing.waiting)
    if standing.active is None:
        return None, waiting
    phase = Phase.DRIVING if standing.stage is Stage.DRIVING else Phase.HOLDING
    return Reacting(event=standing.active, over=standing.over, phase=phase), waiting


def queues(done: Iterable[ByHand]) -> dict[str, deque[ByHand]]:
    """What was done by hand, by task."""
    found: dict[str, deque[ByHand]] = {}
    for one in done:
        found.setdefault(one.task, deque()).append(one)
    return found


def remaining_by_hand(queues: Mapping[str, deque[ByHand]]) -> tuple[ByHand, ...]:
    """What was done by hand and has not been come to."""
    return tuple(one for queue in queues.values() for one in queue)


def _leaf(tables: Tables, name: str) -> LeafNode:
    leaf = tables.leaves.get(RETURN if name == RETURN_TASK else task_id(name))
    if leaf is None:
        raise Conflict(
            f"the progress is at task '{name}', which the mission does not have; {_OTHER}"
        )
    return leaf


def _groups(leaf: LeafNode, progress: Progress) -> list[GroupNode]:
    groups = []
    group = leaf.parent
    while group is not None:
        groups.append(group)
        group = group.parent
    groups.reverse()
    if [group.name for group in groups] != [known.group for known in progress.groups]:
        raise Conflict(
            f"the progress has task '{leaf.name}' in other groups than the mission; {_OTHER}"
        )
    return groups


def _reaction(tables: Tables, event: EventKind) -> Reaction:
    """The reaction to an event. One that aborts is neither active nor waits."""
    node = tables.reactions.get(event)
    reaction = None if node is None else node.state.reaction
    if reaction is None or reaction.response in (Response.REPORT, Response.ABORT):
        raise Conflict(
            f"the progress has a reaction to {event}, which the mission does not have; {_OTHER}"
        )
    return reaction
