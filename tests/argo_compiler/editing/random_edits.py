"""Random edits of a mission: of every kind, most of them possible, some of them invalid."""

import random

from argo_compiler.base.model import Pose
from argo_compiler.editing import commands
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)

POSE = Pose(x=1, y=2, z=0)


def random_edit(mission: Mission, rng: random.Random) -> commands.Edit:
    """Return an edit of a random kind; most of the names in it exist in the mission."""
    kind = rng.choice(sorted(_KINDS))
    return _KINDS[kind](mission, rng)


def any_task(mission: Mission, rng: random.Random) -> str:
    names = [t.name for t in mission.tasks]
    return rng.choice(names) if names and rng.random() < 0.97 else "nobody"


def new_task(mission: Mission, rng: random.Random) -> Task:
    number = str(rng.randint(1, 20))
    name = f"N{rng.randint(0, 99)}" if rng.random() < 0.9 else any_task(mission, rng)
    action = rng.choice(
        [Action.MEASURE] * 5 + [Action.WAYPOINT] * 4 + [Action.WAIT] * 3 + [Action.START]
    )
    return Task(
        name=name,
        action=action,
        object_id=number if action is Action.MEASURE and rng.random() < 0.97 else None,
        pose=POSE if action is Action.WAYPOINT else None,
        group=rng.choice(["", "", "", "shown"]),
        on_failure=rng.choice([*OnFailure, OnFailure.CONTINUE, OnFailure.CONTINUE]),
        failure_target=rng.choice([None, any_task(mission, rng)]),
        wait=wait(rng) if action is Action.WAIT else None,
        window=rng.choice([None, None, window(mission, rng)]),
        transitions=random_transitions(mission, rng) if rng.random() < 0.2 else (),
    )


def wait(rng: random.Random) -> WaitRule:
    return rng.choice(
        [
            WaitRule(duration=rng.choice([0, 0, 5])),
            WaitRule(event=EventKind.ALL_CLEAR, limit=rng.choice([None, 10])),
            WaitRule(conditions=(condition(rng),), limit=10),
            WaitRule(),
        ]
    )


def window(mission: Mission, rng: random.Random) -> TimeWindow:
    return TimeWindow(
        earliest=rng.choice([0, 10]),
        latest=rng.choice([None, 10, 20]),
        hard=rng.random() < 0.7,
        missed_target=rng.choice([None, any_task(mission, rng)]),
    )


def changed_task(mission: Mission, rng: random.Random) -> dict[str, object]:
    values = {
        "object_id": rng.choice([None, "1"]),
        "pose": rng.choice([None, POSE]),
        "wait": wait(rng),
        "velocity": rng.choice([None, 0.3, 0.0]),
        "retries": rng.randint(-1, 2),
        "on_failure": rng.choice(list(OnFailure)),
        "failure_target": rng.choice([None, any_task(mission, rng)]),
        "time_limit": rng.choice([None, 30.0]),
        "reading_limit": rng.choice([None, 5.0]),
        "optional": rng.random() < 0.5,
        "priority": rng.randint(0, 3),
        "window": rng.choice([None, window(mission, rng)]),
    }
    names = {*rng.sample(sorted(values), rng.randint(1, 2))}
    if values["on_failure"] is OnFailure.BRANCH and "on_failure" in names:
        names.add("failure_target")
    return {name: values[name] for name in sorted(names)}


def condition(rng: random.Random) -> Condition:
    kind, low = rng.choice([t for t in ConditionType if t.compares]), rng.randint(0, 5)
    return Condition(
        type=kind,
        object_id=str(rng.randint(1, 20)),
        param1=low,
        param2=low + rng.choice([-1, 1, 1, 1, 1]) if kind is ConditionType.WITHIN else None,
    )


def random_transitions(mission: Mission, rng: random.Random) -> tuple[Transition, ...]:
    return tuple(random_transition(mission, rng) for _ in range(rng.randint(0, 2)))


def random_transition(mission: Mission, rng: random.Random) -> Transition:
    conditions = tuple(condition(rng) for _ in range(rng.choice([0, 1, 1, 2])))
    return Transition(target=any_task(mission, rng), conditions=conditions)


def random_position(mission: Mission, rng: random.Random) -> dict[str, object]:
    anchor = any_task(mission, rng)
    position = rng.choice([{"before": anchor}, {"after": anchor}, {"first": True}, {}])
    if mission.groups and rng.random() < 0.3:
        position = {**position, "into": any_group(mission, rng)}
    return position


def any_group(mission: Mission, rng: random.Random) -> str:
    return rng.choice([g.name for g in mission.groups] or ["nobody"])


def group(mission: Mission, rng: random.Random) -> Group:
    names = [t.name for t in mission.tasks] or ["nobody"]
    start = rng.randrange(len(names))
    end = min(len(names) - 1, start + rng.choice([0, 0, 1, 1, 2, 4, -1]))
    own = rng.choice(["Alpha", "Beta", "G", "H", "I"]) + str(rng.randint(0, 9))
    return Group(
        name=f"{any_group(mission, rng)}/{own}" if rng.random() < 0.2 else own,
        start=names[start],
        end=names[max(end, 0)],
        max_repeat_count=rng.randint(0, 3),
        max_repeat_duration=rng.choice([0, 0, 60]),
        stop=rng.choice(list(Stop)),
    )


def changed_group(mission: Mission, rng: random.Random) -> dict[str, object]:
    values = {
        "start": any_task(mission, rng),
        "end": any_task(mission, rng),
        "max_repeat_count": rng.randint(-1, 3),
        "max_repeat_duration": rng.choice([0, 60.0, 1e-9]),
        "count_interruptions": rng.random() < 0.5,
        "stop": rng.choice(list(Stop)),
        "every": rng.choice([0, 30.0, -1.0]),
        "until": rng.choice([(), (condition(rng),)]),
    }
    return {name: values[name] for name in rng.sample(sorted(values), rng.randint(1, 2))}


def reaction(rng: random.Random) -> Reaction:
    event, response = rng.choice(list(EventKind)), rng.choice(list(Response))
    pose = POSE if response is Response.SAFE_AREA and rng.random() < 0.9 else None
    returns = response is Response.RETURN and rng.random() < 0.3
    return Reaction(
        event=event,
        response=response,
        pose=POSE if returns else pose,
        area=2 if returns else None,
        hold_limit=rng.choice([None, 60.0]),
        priority=rng.choice([None, 3]),
    )


def any_event(mission: Mission, rng: random.Random) -> EventKind:
    return rng.choice([r.event for r in mission.reactions] * 5 + list(EventKind))


def header(mission: Mission, rng: random.Random) -> dict[str, object]:
    values = {
        "designation": f"Mission #{rng.randint(1, 9)}",
        "site": mission.site,
        "mode": rng.choice(list(Mode)),
        "max_duration": rng.choice([None, 60.0, -1.0]),
        "start_area": rng.choice([None, 1, 2]),
        "end_area": rng.choice([None, 1, 2]),
        "dock": rng.choice([None, POSE]),
        "order": rng.choice(list(Order)),
        "anomaly_specification": rng.choice(["", "all"]),
        "current": rng.choice([None, any_task(mission, rng)]),
    }
    return {name: values[name] for name in rng.sample(sorted(values), rng.randint(1, 3))}


_KINDS = {
    "add_task": lambda m, r: commands.AddTask(task=new_task(m, r), **random_position(m, r)),
    "remove_task": lambda m, r: commands.RemoveTask(name=any_task(m, r)),
    "replace_task": lambda m, r: commands.ReplaceTask(name=any_task(m, r), task=new_task(m, r)),
    "change_task": lambda m, r: commands.ChangeTask(name=any_task(m, r), **changed_task(m, r)),
    "move_task": lambda m, r: commands.MoveTask(name=any_task(m, r), **random_position(m, r)),
    "rename_task": lambda m, r: commands.RenameTask(
        name=any_task(m, r), new_name=r.choice([f"R{r.randint(0, 99)}", any_task(m, r), ""])
    ),
    "wrap_tasks": lambda m, r: commands.WrapTasks(group=group(m, r)),
    "dissolve_group": lambda m, r: commands.DissolveGroup(name=any_group(m, r)),
    "rename_group": lambda m, r: commands.RenameGroup(
        name=any_group(m, r), own_name=r.choice([f"Q{r.randint(0, 9)}", "a/b", any_group(m, r)])
    ),
    "change_group": lambda m, r: commands.ChangeGroup(name=any_group(m, r), **changed_group(m, r)),
    "set_transitions": lambda m, r: commands.SetTransitions(
        task=any_task(m, r), transitions=random_transitions(m, r)
    ),
    "add_transition": lambda m, r: commands.AddTransition(
        task=any_task(m, r), transition=random_transition(m, r), at=r.choice([None, 0, 1])
    ),
    "remove_transition": lambda m, r: commands.RemoveTransition(
        task=any_task(m, r), at=r.randint(0, 1)
    ),
    "set_target": lambda m, r: commands.SetTarget(
        task=any_task(m, r), at=r.randint(0, 1), target=any_task(m, r)
    ),
    "set_conditions": lambda m, r: commands.SetConditions(
        task=any_task(m, r), at=r.randint(0, 1), conditions=random_transition(m, r).conditions
    ),
    "add_condition": lambda m, r: commands.AddCondition(
        task=any_task(m, r), at=r.randint(0, 1), condition=condition(r)
    ),
    "remove_condition": lambda m, r: commands.RemoveCondition(
        task=any_task(m, r), at=r.randint(0, 1), condition=r.randint(0, 1)
    ),
    "add_reaction": lambda _, r: commands.AddReaction(reaction=reaction(r)),
    "change_reaction": lambda m, r: commands.ChangeReaction(
        event=any_event(m, r), reaction=reaction(r)
    ),
    "remove_reaction": lambda m, r: commands.RemoveReaction(event=any_event(m, r)),
    "set_header": lambda m, r: commands.SetHeader(**header(m, r)),
}
