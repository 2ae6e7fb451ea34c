"""Handover of a mission to a person and back: tasks done by hand, and an edited mission plan."""

from collections.abc import Iterator, Sequence
from typing import TypeVar

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.hfsm.progress import ByHand, GroupProgress, Progress
from argo_compiler.il import Action, Mission, OnFailure, Response
from argo_compiler.il.grouping import valid_ranges_parents_first
from argo_compiler.il.reserved import RETURN_TASK

AnyModel = TypeVar("AnyModel", bound=Model)


def hand_over(progress: Progress, by_hand: Sequence[ByHand], away: float = 0.0) -> Progress:
    """Return the progress at the end of a supervision of `away` seconds by a person.

    `by_hand` are the tasks that the person did or skipped, in this order. The robot is given back
    at the end, and from then on these tasks age: `away` of a later `Executor.restore` is the time
    since then only.
    """
    aged = add_time_away(progress, away)
    dated = (task.model_copy(update={"age": task.age or 0.0}) for task in by_hand)
    return aged.model_copy(update={"by_hand": (*aged.by_hand, *dated)})


def add_time_away(progress: Progress, away: float) -> Progress:
    """Return the progress after `away` seconds in which nothing happened (rule H2)."""
    if not away >= 0:
        raise ValueError(f"{away} is not a time in seconds")
    return progress.model_copy(
        update={
            "since": progress.since + away,
            "elapsed": progress.elapsed + away,
            "groups": tuple(
                _add_seconds(group, "elapsed", away) if group.counts_interruptions else group
                for group in progress.groups
            ),
            "readings": tuple(_add_seconds(reading, "age", away) for reading in progress.readings),
            "reaction": progress.reaction and _add_seconds(progress.reaction, "held", away),
            "by_hand": tuple(_add_seconds(done, "age", away) for done in progress.by_hand),
        }
    )


def _add_seconds(model: AnyModel, field: str, seconds: float) -> AnyModel:
    return model.model_copy(update={field: (getattr(model, field) or 0.0) + seconds})


def match_to_mission(
    progress: Progress, mission: Mission
) -> tuple[Progress | None, tuple[Diagnostic, ...]]:
    """Return the progress in a mission that was edited since, and diagnostics of what is lost.

    Tasks and groups are matched by their names. `check` must find no errors in the mission. The
    progress is None if the mission can't continue without a decision; then a diagnostic is an
    error.
    """
    if progress.outcome is not None:
        return progress, ()
    errors = tuple(_check_active(progress, mission))
    if errors:
        return None, errors
    groups, group_diagnostics = _match_groups(progress, mission)
    by_hand, by_hand_diagnostics = _match_by_hand(progress, mission)
    planned = {g.name for g in mission.groups if g.every} & {g.group for g in groups}
    update = {
        "groups": groups,
        "round_of": progress.round_of if progress.round_of in planned else None,
        "by_hand": by_hand,
    }
    matched = progress.model_copy(update=update)
    matched, reaction_diagnostics = _match_reactions(matched, mission)
    return matched, (*group_diagnostics, *by_hand_diagnostics, *reaction_diagnostics)


def _check_active(progress: Progress, mission: Mission) -> Iterator[Diagnostic]:
    name = progress.active
    if name is None:
        return
    if name == RETURN_TASK:
        if all(task.on_failure is not OnFailure.RETURN for task in mission.tasks):
            yield diagnostic_of(
                "handover.no-return",
                "the robot is driving back to the dock after a failure, but no task of the mission "
                "plan has `on_failure` return any more",
                "give a task `on_failure` return, or cancel the mission",
            )
        return
    task = mission.task(name)
    if task is None or task.action is Action.START:
        yield diagnostic_of(
            "handover.task-gone",
            Message(
                "the mission is at task '{name}', which the mission plan does not have any more",
                name=name,
            ),
            "add a task of that name again, or set `active` in the progress to the task at which "
            "the mission is to continue",
        )


def _match_groups(
    progress: Progress, mission: Mission
) -> tuple[tuple[GroupProgress, ...], list[Diagnostic]]:
    """Return the edited mission's groups around the active task, and diagnostics.

    Groups that the progress has keep their rounds and clocks.
    """
    position = next((i for i, t in enumerate(mission.tasks) if t.name == progress.active), None)
    around = [
        r.group.name
        for r in valid_ranges_parents_first(mission)
        if position is not None and r.contains(position)
    ]
    known = {p.group: p for p in progress.groups}
    diagnostics = [
        diagnostic_of(
            "handover.new-group",
            Message(
                "group '{name}' is new around task '{active}': it starts in round 1, with "
                "its clock at 0",
                name=name,
                active=progress.active,
            ),
            "set its round in the progress if it has to start in another one",
        )
        for name in around
        if name not in known
    ]
    diagnostics += [
        diagnostic_of(
            "handover.group-gone",
            Message(
                "group '{name}' is not around task '{active}' any more: its round {round} "
                "and its clock are dropped",
                name=name,
                active=progress.active,
                round=p.round,
            ),
            "keep the group if its rounds have to be completed",
        )
        for name, p in known.items()
        if name not in around
    ]
    groups = (known.get(name) or GroupProgress(group=name, round=1, elapsed=0) for name in around)
    return tuple(groups), diagnostics


def _match_by_hand(
    progress: Progress, mission: Mission
) -> tuple[tuple[ByHand, ...], list[Diagnostic]]:
    actions = {t.name: t.action for t in mission.tasks if t.action is not Action.START}
    matched, diagnostics = [], []
    for done in progress.by_hand:
        if done.task not in actions:
            diagnostics.append(
                diagnostic_of(
                    "handover.by-hand-gone",
                    Message(
                        "task '{task}' was done by hand, but the mission plan does not have it",
                        task=done.task,
                    ),
                    "add it to the mission plan again if it has to count",
                )
            )
            continue
        matched.append(done)
        if done.value is not None and actions[done.task] is not Action.MEASURE:
            diagnostics.append(
                diagnostic_of(
                    "handover.by-hand-value",
                    Message(
                        "a value was given for task '{task}', which measures nothing",
                        task=done.task,
                    ),
                    "leave the value out, or give it for the task that measures it",
                )
            )
    return tuple(matched), diagnostics


def _match_reactions(
    progress: Progress, mission: Mission
) -> tuple[Progress, tuple[Diagnostic, ...]]:
    handled = {r.event for r in mission.reactions if r.response is not Response.REPORT}
    interrupting = handled - {r.event for r in mission.reactions if r.response is Response.ABORT}
    diagnostics = [
        diagnostic_of(
            "handover.reaction-gone",
            Message(
                "the mission plan does not react to {event} any more; that reaction was "
                "waiting to start",
                event=w.event,
            ),
            "add the reaction to the mission plan again if it has to be executed",
        )
        for w in progress.waiting
        if w.event not in handled
    ]
    update: dict[str, object] = {
        "waiting": tuple(w for w in progress.waiting if w.event in handled)
    }
    active = progress.reaction
    if active is not None and active.event not in interrupting:
        diagnostics.append(
            diagnostic_of(
                "handover.reaction-gone",
                Message(
                    "{event} interrupted the mission, but the mission plan has no such "
                    "reaction any more: the mission is paused",
                    event=active.event,
                ),
                "resume it when it is safe to continue",
            )
        )
        update |= {"reaction": None, "paused": True}
    return progress.model_copy(update=update), tuple(diagnostics)
