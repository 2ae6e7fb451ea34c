"""Conversion of an executor's state to progress, and back."""

from collections.abc import Mapping

from argo_compiler.base.errors import Conflict
from argo_compiler.base.message import Message
from argo_compiler.hfsm.conditions import CheckpointReading
from argo_compiler.hfsm.configuration import Configuration, Frame
from argo_compiler.hfsm.interrupt_state import InterruptState, Pending
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
from argo_compiler.hfsm.tables import GroupNode, LeafNode, Tables
from argo_compiler.hfsm.visits import TaskVisit
from argo_compiler.il import EventKind, Reaction, Response
from argo_compiler.il.reserved import RETURN_TASK

_OTHER = Message("use the mission that it was saved from, or match it to this one first")


def restore_configuration(
    tables: Tables, progress: Progress, now: float, away: float
) -> Configuration:
    """Return the configuration that continues from `progress` at time `now` (s).

    `away` is the time (s) since the progress was taken.

    Raises:
        ArgoError: the progress does not belong to this machine.
    """
    configuration = Configuration(tables)
    configuration.started_at = now - progress.elapsed - away
    leaf = None if progress.active is None else leaf_for(tables, progress.active)
    number = configuration.new_visit_or_turn_number()
    configuration.visit = TaskVisit(
        leaf,
        number,
        number,
        now - progress.since - away,
        now,
        progress.attempt,
        progress.occurred,
    )
    if progress.paused or progress.reaction:
        configuration.interrupted_at = now
    configuration.readings = {
        r.object_id: CheckpointReading(r.kind, now - r.age - away, r.value, r.abnormal)
        for r in progress.readings
    }
    if leaf is None:
        return configuration
    for group, known in zip(_groups(leaf, progress), progress.groups, strict=True):
        elapsed = known.elapsed + (away if group.counts_interruptions else 0.0)
        configuration.frames.append(Frame(group, known.round, now - elapsed))
    if progress.round_of is not None:
        awaited = (
            f for f in configuration.frames if f.group.name == progress.round_of and f.group.every
        )
        configuration.awaited_round = next(awaited, None)
        if configuration.awaited_round is None:
            raise Conflict(
                Message(
                    "the progress waits for a round of group '{round_of}', but task '{leaf}' "
                    "is not in a group of that name whose rounds start at planned times; "
                    "{other}",
                    round_of=progress.round_of,
                    leaf=leaf.name,
                    other=_OTHER,
                )
            )
    return configuration


def restore_interrupt_state(tables: Tables, progress: Progress) -> InterruptState:
    """Return who controls the robot: active and waiting reactions, and if it is paused.

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


def group_progress(configuration: Configuration, now: float) -> tuple[GroupProgress, ...]:
    """Return the progress of the active groups at time `now` (s), outermost first.

    If the next round of a group is awaited, the clocks of the groups in it have not started.
    """
    started = (
        len(configuration.frames)
        if configuration.awaited_round is None
        else configuration.awaited_round.group.depth + 1
    )
    return tuple(
        GroupProgress(
            group=frame.group.name,
            round=frame.round,
            elapsed=max(0.0, configuration.clock_time_at(now, frame.group) - frame.entered)
            if i < started
            else 0.0,
            counts_interruptions=frame.group.counts_interruptions,
        )
        for i, frame in enumerate(configuration.frames)
    )


def reading_progress(configuration: Configuration, now: float) -> tuple[ReadingProgress, ...]:
    """Return the readings of checkpoints with their ages at time `now` (s)."""
    return tuple(
        ReadingProgress(
            object_id=id,
            kind=reading.kind,
            value=reading.value,
            abnormal=reading.abnormal,
            age=max(0.0, now - reading.time),
        )
        for id, reading in configuration.readings.items()
    )


def tally_progress(tallies: Mapping[str, list[int]]) -> tuple[TaskTally, ...]:
    """Return the numbers of ended visits of each task: done, failed, and done by hand."""
    return tuple(
        TaskTally(task=task, done=done, failed=failed, by_hand=by_hand)
        for task, (done, failed, by_hand) in tallies.items()
    )


def reaction_progress(
    state: InterruptState, held_seconds: float
) -> tuple[Reacting | None, tuple[Waiting, ...]]:
    """Return the active reaction, if any, and the waiting ones.

    `held_seconds` is the time (s) since the hold of the active reaction began, if it holds.
    """
    waiting = tuple(Waiting(event=p.event, over=p.until_occurred) for p in state.waiting)
    if state.active is None:
        return None, waiting
    active = Reacting(event=state.active, over=state.active_until_occurred, phase=Phase.DRIVING)
    if state.stage is Stage.HOLDING:
        active = active.model_copy(update={"phase": Phase.HOLDING, "held": max(0.0, held_seconds)})
    return active, waiting


def leaf_for(tables: Tables, name: str) -> LeafNode:
    """Return the leaf of task `name`, which a progress names; raise ArgoError if there is none."""
    leaf = tables.leaves.get(RETURN if name == RETURN_TASK else task_id(name))
    if leaf is None:
        raise Conflict(
            Message(
                "the progress is at task '{name}', which the mission does not have; {other}",
                name=name,
                other=_OTHER,
            )
        )
    return leaf


def _groups(leaf: LeafNode, progress: Progress) -> list[GroupNode]:
    groups = [*leaf.groups_outward][::-1]
    if [group.name for group in groups] != [known.group for known in progress.groups]:
        raise Conflict(
            Message(
                "task '{leaf}' is in other groups in the progress than in the mission; {other}",
                leaf=leaf.name,
                other=_OTHER,
            )
        )
    return groups


def _reaction(tables: Tables, event: EventKind) -> Reaction:
    """Return the machine's reaction to an event of a progress.

    Raises ArgoError if it has none, or one that can't be active or wait: REPORT or ABORT.
    """
    node = tables.reactions.get(event)
    reaction = None if node is None else node.state.reaction
    if reaction is None or reaction.response in (Response.REPORT, Response.ABORT):
        raise Conflict(
            Message(
                "the progress has a reaction to {event}, which the mission does not have; {other}",
                event=event,
                other=_OTHER,
            )
        )
    return reaction
