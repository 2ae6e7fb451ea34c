"""Handing a mission over to a person and back: what they did, and a plan that they edited."""

from collections.abc import Iterator, Sequence
from typing import TypeVar

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.hfsm.progress import ByHand, GroupProgress, Progress
from argo_compiler.il import Action, Mission, OnFailure, Response
from argo_compiler.il.grouping import group_ranges
from argo_compiler.il.reserved import RETURN_TASK

AnyModel = TypeVar("AnyModel", bound=Model)


def hand_over(progress: Progress, by_hand: Sequence[ByHand], away: float = 0.0) -> Progress:
    """The progress, `away` seconds later, with what a person did or skipped meanwhile, in the order
    in which they did it.

    Then the robot is given back, and what was done ages from there on: what is restored from this
    later is told of the time since then only.
    """
    aged = later(progress, away)
    given = (one.model_copy(update={"age": one.age or 0.0}) for one in by_hand)
    return aged.model_copy(update={"by_hand": (*aged.by_hand, *given)})


def later(progress: Progress, away: float) -> Progress:
    """The progress after time away (s), in which nothing happened (rule H2)."""
    if not away >= 0:
        raise ValueError(f"{away} is no time in seconds")
    return progress.model_copy(
        update={
            "since": progress.since + away,
            "elapsed": progress.elapsed + away,
            "groups": tuple(
                _plus(group, "elapsed", away) if group.counts_interruptions else group
                for group in progress.groups
            ),
            "readings": tuple(_plus(reading, "age", away) for reading in progress.readings),
            "reaction": progress.reaction and _plus(progress.reaction, "held", away),
            "by_hand": tuple(_plus(done, "age", away) for done in progress.by_hand),
        }
    )


def _plus(model: AnyModel, field: str, seconds: float) -> AnyModel:
    return model.model_copy(update={field: (getattr(model, field) or 0.0) + seconds})


def match(progress: Progress, mission: Mission) -> tuple[Progress | None, tuple[Diagnostic, ...]]:
    """The progress as that of a mission that was edited since, by the names of tasks and groups.

    The mission is one that `check` finds no error in. None where it can't go on without a decision:
    then a diagnostic is an error.
    """
    if progress.outcome is not None:
        return progress, ()
    errors = tuple(_active(progress, mission))
    if errors:
        return None, errors
    groups, of_groups = _groups(progress, mission)
    done, of_done = _by_hand(progress, mission)
    planned = {g.name for g in mission.groups if g.every} & {g.group for g in groups}
    update = {
        "groups": groups,
        "round_of": progress.round_of if progress.round_of in planned else None,
        "by_hand": done,
    }
    matched = progress.model_copy(update=update)
    matched, of_reactions = _reactions(matched, mission)
    return matched, (*of_groups, *of_done, *of_reactions)


def _active(progress: Progress, mission: Mission) -> Iterator[Diagnostic]:
    name = progress.active
    if name is None:
        return
    if name == RETURN_TASK:
        if all(task.on_failure is not OnFailure.RETURN for task in mission.tasks):
            yield diagnostic_of(
                "handover.no-return",
                "the robot is on its way back to the dock after a failure, but no task of the plan "
                "returns when it has failed",
                "give a task `on_failure` return, or cancel the mission",
            )
        return
    task = mission.task(name)
    if task is None or task.action is Action.START:
        yield diagnostic_of(
            "handover.task-gone",
            f"the mission stands at task '{name}', which the plan does not have any more",
            "put a task of that name back, or set `active` in the progress to the task that the "
            "mission is to go on with",
        )


def _groups(
    progress: Progress, mission: Mission
) -> tuple[tuple[GroupProgress, ...], list[Diagnostic]]:
    """The groups around the active task, those that were active with their rounds and clocks."""
    position = next((i for i, t in enumerate(mission.tasks) if t.name == progress.active), None)
    around = [
        r.group.name for r in group_ranges(mission) if position is not None and r.contains(position)
    ]
    known = {p.group: p for p in progress.groups}
    diagnostics = [
        diagnostic_of(
            "handover.new-group",
            f"group '{name}' is new around task '{progress.active}': it begins in round 1, with "
            "its clock at 0",
            "set its round in the progress if it is to be another one",
        )
        for name in around
        if name not in known
    ]
    diagnostics += [
        diagnostic_of(
            "handover.group-gone",
            f"group '{name}' is not around task '{progress.active}' any more: its round "
            f"{p.round} and its clock are dropped",
            "keep the group if its rounds are to be completed",
        )
        for name, p in known.items()
        if name not in around
    ]
    groups = (known.get(name) or GroupProgress(group=name, round=1, elapsed=0) for name in around)
    return tuple(groups), diagnostics


def _by_hand(progress: Progress, mission: Mission) -> tuple[tuple[ByHand, ...], list[Diagnostic]]:
    actions = {t.name: t.action for t in mission.tasks if t.action is not Action.START}
    kept, diagnostics = [], []
    for done in progress.by_hand:
        if done.task not in actions:
            diagnostics.append(
                diagnostic_of(
                    "handover.by-hand-gone",
                    f"task '{done.task}' was done by hand, but the plan does not have it",
                    "put it back into the plan if it is to count",
                )
            )
            continue
        kept.append(done)
        if done.value is not None and actions[done.task] is not Action.MEASURE:
            diagnostics.append(
                diagnostic_of(
                    "handover.by-hand-value",
                    f"a value was given for task '{done.task}', which measures nothing",
                    "leave the value out, or give it for the task that measures it",
                )
            )
    return tuple(kept), diagnostics


def _reactions(progress: Progress, mission: Mission) -> tuple[Progress, tuple[Diagnostic, ...]]:
    answered = {r.event for r in mission.reactions if r.response is not Response.REPORT}
    begun = answered - {r.event for r in mission.reactions if r.response is Response.ABORT}
    diagnostics = [
        diagnostic_of(
            "handover.reaction-gone",
            f"the plan does not react to {w.event} any more, which waited for its turn",
            "put the reaction back into the plan if it is to be carried out",
        )
        for w in progress.waiting
        if w.event not in answered
    ]
    update: dict[str, object] = {
        "waiting": tuple(w for w in progress.waiting if w.event in answered)
    }
    active = progress.reaction
    if active is not None and active.event not in begun:
        diagnostics.append(
            diagnostic_of(
                "handover.reaction-gone",
                f"the mission was interrupted by {active.event}, for which the plan has no such "
                "reaction any more: it is paused",
                "resume it when it is safe to go on",
            )
        )
        update |= {"reaction": None, "paused": True}
    return progress.model_copy(update=update), tuple(diagnostics)
