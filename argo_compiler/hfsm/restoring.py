"""From where a machine stands to progress, and back."""

from collections.abc import Mapping

from argo_compiler.base.errors import Conflict
from argo_compiler.hfsm.conditions import CheckpointReading
from argo_compiler.hfsm.configuration import Configuration, Frame
from argo_compiler.hfsm.interrupts import Stage
from argo_compiler.hfsm.model import RETURN, task_id
from argo_compiler.hfsm.progress import (
    GroupProgress,
    Phase,
    Progress,
    Reacting,
    ReadingProgress,
    TaskTally,
    Waiting,
)
from argo_compiler.hfsm.standing import InterruptState, Pending
from argo_compiler.hfsm.tables import GroupNode, LeafNode, Tables
from argo_compiler.hfsm.visits import TaskVisit
from argo_compiler.il import EventKind, Reaction, Response
from argo_compiler.il.reserved import RETURN_TASK

_OTHER = "use the mission that it was saved from, or match it to this one first"


def place_of(tables: Tables, progress: Progress, now: float, away: float) -> Configuration:
    """Where a machine stands that goes on from `progress` at `now`, after `away` seconds.

    Raises:
        ArgoError: the progress is not one of this machine.
    """
    place = Configuration(tables)
    place.began = now - progress.elapsed - away
    leaf = None if progress.active is None else leaf_of(tables, progress.active)
    number = place.new_number()
    place.visit = TaskVisit(
        leaf,
        number,
        number,
        now - progress.since - away,
        now,
        progress.attempt,
        progress.occurred,
    )
    if progress.paused or progress.reaction:
        place.interrupted_at = now
    place.readings = {
        r.object_id: CheckpointReading(r.kind, now - r.age - away, r.value, r.abnormal)
        for r in progress.readings
    }
    if leaf is None:
        return place
    for group, known in zip(_groups(leaf, progress), progress.groups, strict=True):
        elapsed = known.elapsed + (away if group.counts_interruptions else 0.0)
        place.frames.append(Frame(group, known.round, now - elapsed))
    if progress.round_of is not None:
        waited = (f for f in place.frames if f.group.name == progress.round_of and f.group.every)
        place.round_of = next(waited, None)
        if place.round_of is None:
            raise Conflict(
                f"the progress waits for a round of group '{progress.round_of}', of which task "
                f"'{leaf.name}' is not in a planned round; {_OTHER}"
            )
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
        driving = active.phase is Phase.DRIVING and _reaction(tables, active.event).response.drives
        stage = Stage.DRIVING if driving else Stage.HOLDING
    elif progress.paused:
        stage = Stage.STOPPED
    return InterruptState(stage, progress.paused, None if active is None else active.event, pending)


def group_progress(place: Configuration, now: float) -> tuple[GroupProgress, ...]:
    """The active groups, outermost first. The clocks of those that a round is awaited for have not
    begun."""
    begun = len(place.frames) if place.round_of is None else place.round_of.group.depth + 1
    return tuple(
        GroupProgress(
            group=frame.group.name,
            round=frame.round,
            elapsed=max(0.0, place.clock(now, frame.group) - frame.entered) if i < begun else 0.0,
            counts_interruptions=frame.group.counts_interruptions,
        )
        for i, frame in enumerate(place.frames)
    )


def reading_progress(place: Configuration, now: float) -> tuple[ReadingProgress, ...]:
    """The readings with their ages."""
    return tuple(
        ReadingProgress(
            object_id=id,
            kind=reading.kind,
            value=reading.value,
            abnormal=reading.abnormal,
            age=max(0.0, now - reading.time),
        )
        for id, reading in place.readings.items()
    )


def tally_progress(tallies: Mapping[str, list[int]]) -> tuple[TaskTally, ...]:
    """How often visits of each task have ended."""
    return tuple(
        TaskTally(task=task, done=done, failed=failed, by_hand=by_hand)
        for task, (done, failed, by_hand) in tallies.items()
    )


def reaction_progress(
    standing: InterruptState, held: float
) -> tuple[Reacting | None, tuple[Waiting, ...]]:
    """The active reaction, which has held so long (s) if it holds, and those that wait."""
    waiting = tuple(Waiting(event=p.event, over=p.over) for p in standing.waiting)
    if standing.active is None:
        return None, waiting
    active = Reacting(event=standing.active, over=standing.over, phase=Phase.DRIVING)
    if standing.stage is Stage.HOLDING:
        active = active.model_copy(update={"phase": Phase.HOLDING, "held": max(0.0, held)})
    return active, waiting


def leaf_of(tables: Tables, name: str) -> LeafNode:
    """Return the leaf of the task that a mission stands at. Raises ArgoError if there is none."""
    leaf = tables.leaves.get(RETURN if name == RETURN_TASK else task_id(name))
    if leaf is None:
        raise Conflict(
            f"the progress is at task '{name}', which the mission does not have; {_OTHER}"
        )
    return leaf


def _groups(leaf: LeafNode, progress: Progress) -> list[GroupNode]:
    groups = [*leaf.groups][::-1]
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
