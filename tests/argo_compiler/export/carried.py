"""Random missions of version 3 that go forward, and what the executor does with one."""

from itertools import cycle

from hypothesis import strategies as st

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Executor,
    Outcome,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import Action, OnFailure, TimeWindow, Transition, WaitRule
from tests.argo_compiler.export.missions import structured_missions
from tests.mission_parts import conditions_of_readings

OUTCOMES = [*(o for o in Outcome if o is not Outcome.COMPLETED_WITH_FAILURES)]
OUTCOMES += [Outcome.COMPLETED_WITH_FAILURES]
"""in the order of their numbers in a tree, from 1"""


def executed(mission, outcomes, steps):
    """The actions with the times of their starts, and how the mission ended; None: not yet.

    As in the stand-ins for other tools, a value of 5 or more is abnormal, and a failure that has a
    value is one of reading.
    """
    executor, drawn = Executor(lower(mission)), cycle(outcomes)
    now, log, running, ends = 0, [], None, None
    commands = executor.start(now)
    while True:
        for command in commands:
            if isinstance(command, StartAction):
                if len(log) == steps:
                    return log, None
                log.append((now, command.task.name))
                running, ends = command, None
            else:
                running = None
                commands = executor.handle(ActionStopped(command.task, id=command.id), now)
                break
        else:
            if executor.outcome is not None:
                return log, executor.outcome
            due = executor.next_deadline
            if running is not None and ends is None:
                duration, value, failed = next(drawn)
                ends = max(now, running.not_before or now) + duration
            if running is None or (due is not None and due < ends):
                assert due is not None
                now, commands = due, executor.handle(Tick(), due)
                continue
            now, task, id = ends, running.task.name, running.id
            measured = value if running.task.action is Action.MEASURE else None
            running = None
            if failed:
                end = ActionFailed(task, "failed", unreadable=measured is not None, id=id)
            else:
                abnormal = measured is not None and measured >= 5
                end = ActionSucceeded(task, measured, abnormal=abnormal, id=id)
            commands = executor.handle(end, now)


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
