"""Random missions of version 3 that go forward, and what the executor does with one."""

from itertools import cycle

from hypothesis import strategies as st

from argo_compiler.hfsm import ActionFailed, ActionSucceeded, Outcome
from argo_compiler.il import Action, OnFailure, TimeWindow, Transition, WaitRule
from tests.argo_compiler.export.missions import structured_missions
from tests.argo_compiler.hfsm.play import carry_out
from tests.mission_parts import conditions_of_readings

OUTCOMES = [*(o for o in Outcome if o is not Outcome.COMPLETED_WITH_FAILURES)]
OUTCOMES += [Outcome.COMPLETED_WITH_FAILURES]
"""in the order of their numbers in a tree, from 1"""


def executed(mission, outcomes, steps):
    """The actions with the times of their starts, and how the mission ended; None: not yet.

    As in the stand-ins for other tools, a value of 5 or more is abnormal, and a failure that has a
    value is one of reading.
    """
    drawn = cycle(outcomes)

    def doing(command, now):
        duration, value, failed = next(drawn)
        task, id = command.task, command.id
        measured = value if task.action is Action.MEASURE else None
        known = measured is not None
        if failed:
            end = ActionFailed(task.name, "failed", unreadable=known, id=id)
        else:
            end = ActionSucceeded(task.name, measured, abnormal=known and measured >= 5, id=id)
        return max(now, command.not_before or now) + duration, lambda: end

    executor, log, _ = carry_out(mission, doing, steps)
    return log, executor.outcome


@st.composite
def carried_missions(draw, timed=True, windows=True):
    """Missions of which a behaviour tree can carry all; those that are not `timed` have no node
    that goes by the clock; without `windows`, no task has one."""
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
    """A task of version 3 made of one that has only what version 2 had."""
    held = st.lists(conditions_of_readings(), min_size=1, max_size=2).map(tuple)
    ways = tuple(
        Transition(target=way.target, conditions=draw(held)) if way.conditions else way
        for way in task.transitions
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
                "transitions": ways,
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
            "transitions": ways,
        }
    )
