"""Edits by functions and the same edits as lines of a script give the same mission."""

import random
from collections import Counter

import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.editing import (
    EditError,
    add_reaction,
    add_task,
    move_task,
    remove_task,
    replace_task,
    wrap_tasks,
)
from argo_compiler.il import Action, EventKind, Group, Mission, Reaction, Response, Task, Transition
from argo_compiler.script import format_script
from tests.argo_compiler.script.conftest import make_catalog
from tests.conftest import examples
from tests.mission_writing import unplaced
from tests.missions_sound import sound_missions
from tests.whole_scripts import import_whole

CATALOG = make_catalog()
EDITS = 50
edit_counts = Counter()
"""number of edits that were made, by kind"""


def with_own_names(mission: Mission) -> Mission:
    """Return the mission with an explicit name for each task and the default display group.

    Without explicit names, a script names a task by its position, so an edit would rename it.
    """
    new_names = {t.name: f"T{i}" for i, t in enumerate(mission.tasks)}

    def way(w):
        return w.model_copy(update={"target": new_names[w.target]})

    names = [t.name for t in mission.tasks]
    ranges = [(names.index(g.start), names.index(g.end), g.name) for g in mission.groups]
    tasks = tuple(
        t.model_copy(
            update={
                "name": new_names[t.name],
                "transitions": tuple(map(way, t.transitions)),
                "group": max((n for a, b, n in ranges if a <= i <= b), key=len, default=""),
            }
        )
        for i, t in enumerate(mission.tasks)
    )
    groups = tuple(
        g.model_copy(update={"start": new_names[g.start], "end": new_names[g.end]})
        for g in mission.groups
    )
    return mission.model_copy(update={"tasks": tasks, "groups": groups, "current": None})


def comparable(mission: Mission) -> Mission:
    """Return the mission without source positions, each unconditional transition last.

    The position of an unconditional transition has no meaning (T3), and a mission does not store
    it while the task is the last one and has no such transition.
    """
    bare = unplaced(mission)
    tasks = tuple(
        t.model_copy(
            update={"transitions": tuple(sorted(t.transitions, key=lambda w: not w.conditions))}
        )
        for t in bare.tasks
    )
    return bare.model_copy(update={"tasks": tasks})


def following_tasks(mission):
    """Return, for each task, the task that follows in a script that states no transition for it.

    START is skipped, unless the script states its target: the task before such a START leads to
    START's target.
    """
    after, name = {}, None
    for t in reversed(mission.tasks):
        after[t.name] = name
        usual = () if name is None else (Transition(target=name),)
        if t.action is not Action.START or t.transitions != usual:
            name = t.name
    return after


def unconditional_target(task):
    return next((w.target for w in task.transitions if not w.conditions), None)


def stated_targets(mission):
    """Return the targets that a script has to state, because they are not the following task."""
    after = following_tasks(mission)
    return {t.name: w for t in mission.tasks if (w := unconditional_target(t)) != after[t.name]}


class Editor:
    """Maker of random edits, by functions and as lines of a script. Mutable."""

    def __init__(self, mission: Mission, rng: random.Random) -> None:
        self.mission, self.rng = mission, rng
        self.stated_targets = stated_targets(mission)
        self.lines: list[str] = []

    def step(self) -> None:
        kind = self.rng.choice(
            ["delete", "add", "add", "move", "move", "replace", "repeat", "react"]
        )
        try:
            proposed = getattr(self, kind)()
        except EditError:
            return
        if proposed is None:
            return
        line, mission = proposed
        # A transition that a script states stays, even if its target now follows anyway; one that
        # it does not state follows the order, even if an edit by a function keeps its target.
        if stated_targets(mission) != self.stated_targets:
            return
        edit_counts[kind] += 1
        self.mission = mission
        self.lines.append(line)

    def task(self):
        named = [t for t in self.mission.tasks if t.action is not Action.START]
        return self.rng.choice(named)

    def place(self):
        side = self.rng.choice(["before", "after"])
        return side, self.task().name

    def ends_a_group(self, name):
        return any(name in (g.start, g.end) for g in self.mission.groups)

    def delete(self):
        task = self.task()
        if sum(t.action is not Action.START for t in self.mission.tasks) == 1:
            return None
        led = [t.name for t in self.mission.tasks for w in t.transitions if w.target == task.name]
        by_order = [n for n, f in following_tasks(self.mission).items() if f == task.name]
        if (
            self.ends_a_group(task.name)
            or not set(led) <= set(by_order)
            or len(led) != len(set(led))
        ):
            return None
        if task.name in self.stated_targets or any(w.conditions for w in task.transitions):
            return None
        if any(
            w.target == task.name for t in self.mission.tasks for w in t.transitions if w.conditions
        ):
            return None
        return f'Delete step "{task.name}"', remove_task(self.mission, task.name).mission

    def add(self):
        number, (side, anchor) = self.rng.randint(1, 20), self.place()
        name = f"N{len(self.lines)}"
        task = Task(name=name, action=Action.MEASURE, object_id=str(number))
        line = f'"{name}": add checkpoint #{number} {side} step "{anchor}"'
        return line, add_task(self.mission, task, **{side: anchor}).mission

    def move(self):
        task, (side, anchor) = self.task(), self.place()
        if anchor == task.name or self.ends_a_group(task.name):
            return None
        line = f'Move step "{task.name}" {side} step "{anchor}"'
        return line, move_task(self.mission, task.name, **{side: anchor}).mission

    def replace(self):
        task, number = self.task(), str(self.rng.randint(1, 20))
        if task.action is not Action.MEASURE:
            return None
        new = task.model_copy(update={"object_id": number})
        line = f'Replace step "{task.name}" by checkpoint #{number}'
        return line, replace_task(self.mission, task.name, new).mission

    def repeat(self):
        names = [t.name for t in self.mission.tasks if t.action is not Action.START]
        first = self.rng.randrange(len(names))
        last = min(len(names) - 1, first + self.rng.randint(0, 3))
        name = f"R{len(self.lines)}"
        group = Group(name=name, start=names[first], end=names[last], max_repeat_count=2)
        inside = {*names[first : last + 1]}
        # A script derives the names of nested groups from their own names, not from their paths.
        if any("/" in g.name or {g.start, g.end} <= inside for g in self.mission.groups):
            return None
        # In a script `otherwise` leaves the round at once; in a mission the unconditional
        # transition ends it.
        end = self.mission.task(names[last])
        if end.name in self.stated_targets and any(w.conditions for w in end.transitions):
            return None
        wrapped = wrap_tasks(self.mission, group).mission
        return f'"{name}": repeat steps "{names[first]}" to "{names[last]}" twice', wrapped

    def react(self):
        event = self.rng.choice([EventKind.GAS_LEAK, EventKind.HOT_SPOT, EventKind.DYSFUNCTION])
        reaction = Reaction(event=event, response=Response.PAUSE)
        if any(r.event is event for r in self.mission.reactions):
            return None
        words = event.value.replace("_", " ")
        return f"On {words}: pause", add_reaction(self.mission, reaction).mission


@pytest.mark.long
@settings(max_examples=examples(120))
@given(sound_missions(CATALOG, most=5), st.integers(0, 2**32))
def test_the_same_edits_written_as_a_protocol_give_the_same_mission(mission, seed):
    edit_both(mission, seed)


@pytest.mark.long
@settings(max_examples=examples(200))
@given(sound_missions(CATALOG), st.integers(0, 2**32))
def test_two_hundred_sequences_of_edits_give_the_same_mission(mission, seed):
    edit_both(mission, seed)


def edit_both(mission, seed):
    try:
        script = format_script(with_own_names(mission), CATALOG)
    except DiagnosticError:  # a script can't express what has no effect
        reject()
    base = import_whole(script, CATALOG).mission
    assert comparable(base) == comparable(with_own_names(mission))
    editor = Editor(base, random.Random(seed))
    for _ in range(EDITS):
        editor.step()
    text = "\n".join([script.rstrip("\n"), *editor.lines])
    assert comparable(import_whole(text, CATALOG).mission) == comparable(editor.mission)


@pytest.mark.long
def test_all_kinds_of_edits_were_written():
    """The sequences above contain every kind of edit that a script can express."""
    if not edit_counts:
        test_the_same_edits_written_as_a_protocol_give_the_same_mission()
    assert set(edit_counts) == {"delete", "add", "move", "replace", "repeat", "react"}
    assert min(edit_counts.values()) > 5
