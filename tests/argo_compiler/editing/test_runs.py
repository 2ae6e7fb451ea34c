"""Edits keep the rest of a run: missions before and after an edit are executed and compared.

Each task's value or failure depends only on its name and the number of its visits, so two runs can
be compared task by task.
"""

import random
import zlib
from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.editing import (
    EditError,
    add_task,
    dissolve_group,
    move_task,
    remove_task,
    rename_task,
    wrap_tasks,
)
from argo_compiler.hfsm import ActionFailed, ActionSucceeded, Executor, lower
from argo_compiler.il import (
    Action,
    Condition,
    Group,
    Mission,
    OnFailure,
    Task,
    Transition,
    WaitRule,
)
from tests.conftest import examples
from tests.mission_parts import nested
from tests.mission_writing import drive

STEPS = 120


def run(mission, original_names=None, steps=STEPS):
    """Return the tasks in the order of execution, and whether the mission has ended."""
    executor = Executor(lower(mission))
    executor.start(0.0)
    visits, order = Counter(), []
    while executor.running is not None and len(order) < steps:
        task = executor.running
        name = task.name
        order.append(name)
        visits[name] += 1
        read = zlib.crc32(f"{(original_names or {}).get(name, name)} {visits[name]}".encode()) % 7
        value = float(read) if task.action is Action.MEASURE else None
        if task.on_failure is OnFailure.BRANCH and read < 3:
            executor.handle(ActionFailed(name, "stuck"), 0.0)
        else:
            executor.handle(ActionSucceeded(name, value), 0.0)
    return order, executor.finished


seeds = st.integers(0, 2**32)


def condition(rng):
    kind = rng.choice(["MEASURED_VALUE_LESS", "MEASURED_VALUE_GREATER"])
    return Condition(type=kind, object_id=rng.choice("123"), param1=rng.randint(0, 6))


def random_mission(rng, plain=False):
    """Return a mission whose runs depend only on values; a `plain` one is a chain with rounds."""
    while True:
        kinds = "MW" if plain else "MMWWP"
        names = [f"{rng.choice(kinds)}{i}" for i in range(rng.randint(2, 7))]
        tasks = tuple(random_task(names, i, rng, plain) for i in range(len(names)))
        if not plain and rng.random() < 0.5:
            ways = (Transition(target=rng.choice(names)),) if rng.random() < 0.7 else ()
            tasks = (Task(name="S", action=Action.START, transitions=ways), *tasks)
        edited = Mission(tasks=tasks, groups=random_groups(names, rng))
        if not has_errors(check(edited)):
            return edited


def random_task(names, i, rng, plain):
    ways = []
    if not plain and rng.random() < 0.35:
        held = tuple(condition(rng) for _ in range(rng.choice([1, 1, 2])))
        ways = [Transition(target=rng.choice(names), conditions=held)]
        if rng.random() < 0.3:
            ways.append(Transition(target=rng.choice(names), conditions=(condition(rng),)))
    onward = names if not plain and rng.random() < 0.2 else names[i + 1 : i + 2]
    if onward and (plain or rng.random() < 0.95):
        ways.insert(rng.randint(0, len(ways)), Transition(target=rng.choice(onward)))
    action = {"M": Action.MEASURE, "W": Action.WAYPOINT, "P": Action.WAIT}[names[i][0]]
    branches = not plain and action is not Action.WAIT and rng.random() < 0.2
    return Task(
        name=names[i],
        action=action,
        object_id=rng.choice("123") if action is Action.MEASURE else None,
        pose=Pose(x=0, y=0, z=0) if action is Action.WAYPOINT else None,
        wait=WaitRule(duration=0) if action is Action.WAIT else None,
        on_failure=OnFailure.BRANCH if branches else OnFailure.CONTINUE,
        failure_target=rng.choice(names) if branches else None,
        transitions=tuple(ways),
    )


def random_groups(names, rng):
    ranges = ([rng.randrange(len(names)) for _ in range(2)] for _ in range(rng.randint(0, 3)))
    return tuple(
        Group(name=n, start=names[a], end=names[b], max_repeat_count=rng.randint(1, 3))
        for n, a, b in nested(ranges, lambda i, *_: f"G{i}")
    )


def has_no_influence(mission, name):
    """Return True if no condition depends on the task's value and it has at most one target."""
    task = mission.task(name)
    compared = {c.object_id for t in mission.tasks for w in t.transitions for c in w.conditions}
    one = all(not w.conditions for w in task.transitions) and task.failure_target is None
    return one and task.object_id not in compared


def try_edit(edit):
    """Return the edited mission, or None with the codes of the refusal."""
    try:
        return edit().mission, set()
    except EditError as refusal:
        return None, {d.code for d in refusal.diagnostics}


def test_a_run_without_a_removed_task_is_otherwise_the_same():
    """Without a task on whose value nothing depends, a run is the same but for its visits.

    Each reason to refuse a removal occurs.
    """
    refused = Counter()

    @settings(max_examples=examples(800))
    @given(seeds)
    def remove_each(seed):
        mission = random_mission(random.Random(seed))
        before, ended = run(mission)
        for name in (t.name for t in mission.tasks):
            if not has_no_influence(mission, name):
                continue
            edited, codes = try_edit(lambda name=name: remove_task(mission, name))
            refused.update(codes or {"no"})
            if edited is None:
                continue
            left = [task for task in before if task != name]
            after, ends = run(edited, steps=STEPS if ended else len(left))
            assert after == left
            assert ends or not ended

    remove_each()
    assert set(refused) == {
        "no",
        "edit.beginning",
        "edit.ends-by-condition",
        "edit.ends-round",
        "edit.leaves-group",
        "edit.starts-round",
        *({"il.endless-group", "il.instant-loop"} & set(refused)),
    }
    assert refused["no"] > 0.7 * refused.total()


@settings(max_examples=examples(200))
@given(seeds)
def test_any_task_of_a_chain_with_rounds_can_be_removed(seed):
    """Tasks can be removed until one remains, with any groups."""
    rng = random.Random(seed)
    mission = random_mission(rng, plain=True)
    while len(mission.tasks) > 1:
        mission = remove_task(mission, random_task_name(mission, rng)).mission
    assert all(g.start == g.end == mission.tasks[0].name for g in mission.groups)


@settings(max_examples=examples(300))
@given(seeds, st.booleans())
def test_an_added_task_is_executed_between_the_others(seed, plain):
    rng = random.Random(seed)
    mission = random_mission(rng, plain)
    where = rng.choice(["before", "after", "first", "last"])
    place = {where: random_task_name(mission, rng)} if where in ("before", "after") else {}
    place |= {"first": True} if where == "first" else {}
    if mission.groups and rng.random() < 0.5:
        place["into"] = rng.choice([g.name for g in mission.groups])
    edited, codes = try_edit(lambda: add_task(mission, drive("new"), **place))
    assert codes <= {"edit.not-beside-group", "il.start-in-group"}
    if edited is None:
        return
    before, ended = run(mission)
    after, ends = run(edited, steps=3 * STEPS if ended else STEPS)
    left = [task for task in after if task != "new"]
    assert left == before[: len(left)]
    assert ends == ended or not ends
    assert left == before or not ended


@settings(max_examples=examples(200))
@given(seeds)
def test_a_new_name_changes_no_run(seed):
    rng = random.Random(seed)
    mission = random_mission(rng)
    name = random_task_name(mission, rng)
    edited = rename_task(mission, name, "new").mission
    before, ended = run(mission)
    after, ends = run(edited, original_names={"new": name})
    assert [name if task == "new" else task for task in after] == before
    assert ends == ended


@settings(max_examples=examples(200))
@given(seeds)
def test_a_chain_is_executed_in_the_order_of_its_list_after_any_move(seed):
    rng = random.Random(seed)
    mission = random_mission(rng, plain=True).model_copy(update={"groups": ()})
    names = [t.name for t in mission.tasks]
    for _ in range(5):
        name, anchor = rng.choice(names), rng.choice(names)
        if name == anchor:
            continue
        after = rng.random() < 0.5
        mission = move_task(mission, name, **{"after" if after else "before": anchor}).mission
        names.remove(name)
        names.insert(names.index(anchor) + after, name)
        assert [t.name for t in mission.tasks] == names
    assert run(mission) == (names, True)


@settings(max_examples=examples(200))
@given(seeds)
def test_a_group_around_tasks_repeats_them_and_dissolving_it_undoes_that(seed):
    rng = random.Random(seed)
    mission = random_mission(rng, plain=True)
    names = [t.name for t in mission.tasks]
    first, last = sorted(rng.randrange(len(names)) for _ in range(2))
    group = Group(name="new", start=names[first], end=names[last], max_repeat_count=2)
    edited, codes = try_edit(lambda: wrap_tasks(mission, group))
    assert codes <= {"edit.group-overlap"}
    if edited is None:
        return
    (name,) = {g.name for g in edited.groups if g.name.split("/")[-1] == "new"}
    assert dissolve_group(edited, name).mission == mission
    if not mission.groups:
        twice = [*names[: last + 1], *names[first : last + 1], *names[last + 1 :]]
        assert run(edited) == (twice, True)


def random_task_name(mission, rng):
    return rng.choice([t.name for t in mission.tasks])
