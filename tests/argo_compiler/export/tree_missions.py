"""Random missions of version 3 that a behaviour tree can express, and their expected runs."""

from itertools import cycle

from hypothesis import strategies as st

from argo_compiler.hfsm import ActionFailed, ActionSucceeded, Outcome
from argo_compiler.il import Action, OnFailure, TimeWindow, Transition, WaitRule
from tests.argo_compiler.export.missions import structured_missions
from tests.argo_compiler.hfsm.play import run_mission
from tests.mission_parts import conditions_of_readings

OUTCOMES = [*(o for o in Outcome if o is not Outcome.COMPLETED_WITH_FAILURES)]
OUTCOMES += [Outcome.COMPLETED_WITH_FAILURES]
"""Outcomes in the order of their numbers in a tree, from 1."""


def executed(mission, outcomes, steps):
    """Return the executor's actions with their start times, and the mission's outcome or None.

    The outcome is None if the mission starts more than `steps` actions, of which the first `steps`
    are returned. As in the replacements for other tools, a value of 5 or more is abnormal, and a
    failure with an even value is unreadable, one with an odd value unreachable.
    """
    drawn = cycle(outcomes)

    def execute(command, now):
        duration, value, failed = next(drawn)
        task, id = command.task, command.id
        measured = value if task.action is Action.MEASURE else None
        has_value = measured is not None
        if failed:
            odd = has_value and measured % 2 == 1
            end = ActionFailed(task.name, "failed", has_value and not odd, id, unreachable=odd)
        else:
            end = ActionSucceeded(task.name, measured, abnormal=has_value and measured >= 5, id=id)
        return max(now, command.not_before or now) + duration, lambda: end

    executor, log, _ = run_mission(mission, execute, steps)
    return log, executor.outcome


@st.composite
def tree_missions(draw, timed=True, windows=True):
    """Draw a mission that a behaviour tree can express completely.

    Without `timed`, its tree has no node that depends on the clock. Without `windows`, no task has
    a time window.
    """
    mission = draw(structured_missions(timed))
    names = [task.name for task in mission.tasks if task.action is not Action.START]
    tasks = [
        task if task.action is Action.START else draw(_tasks(task, names, timed, timed and windows))
        for task in mission.tasks
    ]
    untils = st.lists(conditions_of_readings(), max_size=2).map(tuple)
    groups = [g.model_copy(update={"until": draw(untils)}) for g in mission.groups]
    return mission.model_copy(update={"tasks": tuple(tasks), "groups": tuple(groups)})


@st.composite
def _tasks(draw, task, names, timed, windows):
    """Draw a task of version 3 from a task that has only the fields of version 2."""
    condition_lists = st.lists(conditions_of_readings(), min_size=1, max_size=2).map(tuple)
    transitions = tuple(
        Transition(target=t.target, conditions=draw(condition_lists)) if t.conditions else t
        for t in task.transitions
    )
    if task.action is Action.WAYPOINT and draw(st.booleans()):
        wait = WaitRule(duration=draw(st.sampled_from([0, 1, 2, 5] if timed else [0])))
        return task.model_copy(
            update={
                "action": Action.WAIT,
                "pose": None,
                "wait": wait,
                "retries": 0,
                "on_failure": OnFailure.CONTINUE,
                "transitions": transitions,
            }
        )
    ahead = names[names.index(task.name) + 1 :]
    branches = task.on_failure is OnFailure.BRANCH and ahead
    window = st.builds(
        TimeWindow,
        earliest=st.integers(0, 12),
        latest=st.sampled_from([None, 13, 20]),
        hard=st.just(False),
    )
    limit = draw(st.sampled_from([None, None, 1, 2, 3] if timed else [None]))
    return task.model_copy(
        update={
            "on_failure": task.on_failure
            if branches or task.on_failure is not OnFailure.BRANCH
            else OnFailure.CONTINUE,
            "failure_target": draw(st.sampled_from(ahead)) if branches else None,
            "time_limit": limit,
            "optional": draw(st.booleans()),
            "window": draw(window) if windows and limit is None and draw(st.booleans()) else None,
            "transitions": transitions,
        }
    )
