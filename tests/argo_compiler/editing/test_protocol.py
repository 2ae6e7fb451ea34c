"""Scripts and functions edit alike: the same edits, written as lines of a protocol, give the same
mission."""

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
from argo_compiler.script import format_script, import_script
from tests.argo_compiler.script.conftest import make_catalog
from tests.conftest import examples
from tests.mission_writing import unplaced
from tests.missions_sound import sound_missions

CATALOG = make_catalog()
EDITS = 50
made = Counter()
"""how often each kind of edit was made"""


def own_names(mission: Mission) -> Mission:
    """The mission with a name of its own for each task and what is meant if nothing is said of
    where it is shown: in a script what goes by its place is called anew when that changes."""
    called = {t.name: f"T{i}" for i, t in enumerate(mission.tasks)}

    def way(w):
        return w.model_copy(update={"target": called[w.target]})

    names = [t.name for t in mission.tasks]
    ranges = [(names.index(g.start), names.index(g.end), g.name) for g in mission.groups]
    tasks = tuple(
        t.model_copy(
            update={
                "name": called[t.name],
                "transitions": tuple(map(way, t.transitions)),
                "group": max((n for a, b, n in ranges if a <= i <= b), key=len, default=""),
            }
        )
        for i, t in enumerate(mission.tasks)
    )
    groups = tuple(
        g.model_copy(update={"start": called[g.start], "end": called[g.end]})
        for g in mission.groups
    )
    return mission.model_copy(update={"tasks": tasks, "groups": groups, "current": None})


def plain(mission: Mission) -> Mission:
    """The mission without the places in the script that it is from. The unconditional transition
    of a task stands last: where it stands has no meaning (T3), and a mission does not keep where it
    stood while the task was the last one."""
    bare = unplaced(mission)
    tasks = tuple(
        t.model_copy(
            update={"transitions": tuple(sorted(t.transitions, key=lambda w: not w.conditions))}
        )
        for t in bare.tasks
    )
    return bare.model_copy(update={"tasks": tasks})


def following(mission):
    """Return what a script that says no more comes to after each task. It passes over a START,
    unless that leads elsewhere: what stands before such a START comes to where that leads."""
    after, name = {}, None
    for t in reversed(mission.tasks):
        after[t.name] = name
        usual = () if name is None else (Transition(target=name),)
        if t.action is not Action.START or t.transitions != usual:
            name = t.name
    return after


def default(task):
    return next((w.target for w in task.transitions if not w.conditions), None)


def stated(mission):
    """Return where the tasks lead of which a script says it, as that is not to what follows."""
    after = following(mission)
    return {t.name: w for t in mission.tasks if (w := default(t)) != after[t.name]}


class Editor:
    """Makes the same edits by functions and in words. Mutable."""

    def __init__(self, mission: Mission, rng: random.Random) -> None:
        self.mission, self.rng = mission, rng
        self.stated = stated(mission)
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
        # A way that a script gives in words stays, even where it now leads to what follows, and
        # one that it leaves unsaid follows the order, even where an edit keeps it by its target.
        if stated(mission) != self.stated:
            return
        made[kind] += 1
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
        by_order = [n for n, f in following(self.mission).items() if f == task.name]
        if (
            self.ends_a_group(task.name)
            or not set(led) <= set(by_order)
            or len(led) != len(set(led))
        ):
            return None
        if task.name in self.stated or any(w.conditions for w in task.transitions):
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
        # A script names the groups in a group anew from their own names, not from their paths.
        if any("/" in g.name or {g.start, g.end} <= inside for g in self.mission.groups):
            return None
        # There `otherwise` leaves the round at once, and here what is unconditional ends it.
        end = self.mission.task(names[last])
        if end.name in self.stated and any(w.conditions for w in end.transitions):
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
        script = format_script(own_names(mission), CATALOG)
    except DiagnosticError:  # what has no effect is not said
        reject()
    base = import_script(script, CATALOG).mission
    assert plain(base) == plain(own_names(mission))
    editor = Editor(base, random.Random(seed))
    for _ in range(EDITS):
        editor.step()
    text = "\n".join([script.rstrip("\n"), *editor.lines])
    assert plain(import_script(text, CATALOG).mission) == plain(editor.mission)


@pytest.mark.long
def test_all_kinds_of_edits_were_written():
    """The sequences above are long and have all that a protocol can say."""
    if not made:
        test_the_same_edits_written_as_a_protocol_give_the_same_mission()
    assert set(made) == {"delete", "add", "move", "replace", "repeat", "react"}
    assert min(made.values()) > 5
