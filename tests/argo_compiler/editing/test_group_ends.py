"""Edits at the ends of groups that do not lead to the next task of the list keep the rounds.

Tasks are moved to, away from and behind such an end; the runs of the edited mission must equal
those of a mission that a model builds from scratch.
"""

import random
from collections import Counter
from dataclasses import dataclass, field
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.editing import EditConflict, add_task, change_group, move_task, set_target
from argo_compiler.il import Group, Mission
from tests.argo_compiler.editing.test_runs import run, try_edit
from tests.conftest import examples
from tests.mission_writing import measure

task = partial(measure, object_id="1")


def rounds(name, start, end, count):
    return Group(name=name, start=start, end=end, max_repeat_count=count)


def order(edited):
    return "".join(run(edited.mission)[0])


LEADS_ON = Mission(
    tasks=(task("a", "b"), task("b", "c"), task("c", "e"), task("d", "e"), task("e")),
    groups=(rounds("G", "a", "c", 3),),
)
ENDS = Mission(
    tasks=(task("a", "b"), task("b"), task("x", "y"), task("y")),
    groups=(rounds("G", "a", "b", 2),),
)
NESTED = Mission(
    tasks=(task("a", "b"), task("b", "c"), task("c", "f"), task("d", "f"), task("f")),
    groups=(rounds("G", "a", "c", 2), rounds("G/H", "b", "c", 2)),
)


@pytest.mark.parametrize(
    ("mission", "name", "place", "expected"),
    [
        (LEADS_ON, "b", {"after": "c", "into": "G"}, "acbacbacbe"),
        (LEADS_ON, "c", {"after": "a"}, "acbacbacbe"),
        (LEADS_ON, "c", {"before": "a", "into": "G"}, "cabcabcabe"),
        (LEADS_ON, "c", {"first": True}, "cabababe"),
        (LEADS_ON, "c", {}, "abababec"),
        (LEADS_ON, "c", {"before": "d"}, "abababce"),
        (LEADS_ON, "c", {"after": "b", "into": "G"}, "abcabcabce"),
        (LEADS_ON, "e", {"after": "c", "into": "G"}, "abceabceabced"),
        (ENDS, "b", {"before": "a", "into": "G"}, "baba"),
        (ENDS, "a", {"after": "b", "into": "G"}, "baba"),
        (NESTED, "c", {"before": "b"}, "acbbacbbf"),
        (NESTED, "c", {"before": "b", "into": "G/H"}, "acbcbacbcbf"),
        (NESTED, "c", {"before": "d", "into": "G"}, "abbcabbcf"),
    ],
)
def test_a_moved_task_leaves_the_rounds_of_its_group(mission, name, place, expected):
    assert order(move_task(mission, name, **place)) == expected


def test_a_round_can_not_end_with_a_task_that_leads_elsewhere():
    jumps = LEADS_ON.model_copy(
        update={"tasks": (task("a", "b"), task("b", "e"), *LEADS_ON.tasks[2:])}
    )
    with pytest.raises(EditConflict, match="'b' in its place, which leads to 'e'"):
        move_task(jumps, "c", after="d")


def test_a_groups_only_task_can_not_be_moved_into_it():
    alone = LEADS_ON.model_copy(update={"groups": (rounds("G", "c", "c", 3),)})
    with pytest.raises(EditConflict, match="'c' is the only task of group 'G'"):
        move_task(alone, "c", after="a", into="G")


def test_a_new_end_that_leads_elsewhere_ends_the_rounds():
    made = add_task(LEADS_ON, task("n", "d"), after="c", into="G")
    assert order(made) == "abcnabcnabcnde"
    assert [c.message for c in made.consequences] == [
        "task 'c' leads to 'n' now, not to 'e'",
        "group 'G' ends with task 'n' now, not 'c'",
    ]


def test_a_group_ends_with_a_task_that_a_round_reaches():
    with pytest.raises(
        EditConflict, match="ends with 'c', which leads to 'e': a round would never"
    ):
        change_group(LEADS_ON, "G", end="d")
    with pytest.raises(EditConflict, match="lead 'b' to 'x' first"):
        change_group(ENDS, "G", end="x")
    assert order(change_group(LEADS_ON, "G", end="e")) == "abceabceabce"
    assert order(change_group(LEADS_ON, "G", end="b")) == "abababce"
    way_on = set_target(LEADS_ON, "c", 0, "d").mission
    assert order(change_group(way_on, "G", end="d")) == "abcdabcdabcde"


# ---- random missions


@dataclass
class RoundsModel:
    """Model of a mission whose groups may lead elsewhere than to the next task. Mutable."""

    names: list[str]
    members: dict[str, set[str]] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    exits: dict[str, str | None] = field(default_factory=dict)
    """target of a group that does not lead to the next task of the list"""
    jumps: dict[str, str | None] = field(default_factory=dict)
    """target of a task that does not lead to the next task of the list"""

    def last_task(self, group):
        return max(self.members[group], key=self.names.index)

    def groups_around(self, name):
        """Return the groups that contain a task, outermost first."""
        return sorted(g for g, inside in self.members.items() if name in inside)

    def target_of(self, name):
        if name in self.jumps:
            return self.jumps[name]
        for group in self.groups_around(name):
            if group in self.exits and self.last_task(group) == name:
                return self.exits[group]
        return next(iter(self.names[self.names.index(name) + 1 :]), None)

    def mission(self):
        targets = ((name, self.target_of(name)) for name in self.names)
        tasks = tuple(task(name, *([] if to is None else [to])) for name, to in targets)
        groups = tuple(
            rounds(g, min(self.members[g], key=self.names.index), self.last_task(g), self.counts[g])
            for g in sorted(self.members)
        )
        return Mission(tasks=tasks, groups=groups)

    def move_next_to(self, name, anchor, after):
        """Insert or move a task next to the anchor, into the anchor's groups."""
        former, ended = (
            self.names.index(name) if name in self.names else None,
            self.groups_around(name),
        )
        ended = [g for g in ended if self.last_task(g) == name and len(self.members[g]) > 1]
        exits = self.target_of(name) if ended and any(g in self.exits for g in ended) else ()
        for group in self.groups_around(name):
            self.members[group].remove(name)
            if not self.members[group]:
                del self.members[group]
        if former is not None:
            self.names.remove(name)
        place = self.names.index(anchor) + after
        self.names.insert(place, name)
        for group in self.groups_around(anchor):
            self.members[group].add(name)
        for group in list(self.exits):
            if group not in self.members:
                self.jumps[name] = self.exits.pop(group)
            elif self.last_task(group) == name and (
                name in self.jumps or self.exits[group] == name
            ):
                del self.exits[group]
        if former == place and exits != () and not {*ended} & {*self.groups_around(name)}:
            self.jumps[name] = exits
            for group in ended:
                self.exits.pop(group, None)


def random_model(rng):
    """Return a model of three to ten tasks and one to three groups, one possibly in another."""
    names = list("abcdefghij"[: rng.randint(3, 10)])
    model = RoundsModel(names)
    cut = rng.randint(1, len(names))
    ranges = {"G": sorted(rng.choices(range(cut), k=2))}
    if cut < len(names) and rng.random() < 0.4:
        ranges["K"] = sorted(rng.choices(range(cut, len(names)), k=2))
    first, last = ranges["G"]
    if rng.random() < 0.5:
        ranges["G/H"] = sorted(rng.choices(range(first, last + 1), k=2))
    for group, (first, last) in ranges.items():
        model.members[group] = {*names[first : last + 1]}
        model.counts[group] = rng.randint(2, 3)
    for group, (_, last) in ranges.items():
        shared = group == "G/H" and last == ranges["G"][1]
        beyond = [*names[last + 2 :], *([None] if last + 1 < len(names) else [])]
        if beyond and not shared and rng.random() < 0.7:
            model.exits[group] = rng.choice(beyond)
    for i, name in enumerate(names[:-2]):
        if not model.groups_around(name) and rng.random() < 0.15:
            model.jumps[name] = rng.choice(names[i + 2 :])
    return model


def test_moves_and_additions_keep_the_rounds_of_groups_that_lead_elsewhere():
    outcomes = Counter()

    @settings(max_examples=examples(600))
    @given(st.integers(0, 2**32))
    def move_or_add(seed):
        rng = random.Random(seed)
        model = random_model(rng)
        mission = model.mission()
        assert not has_errors(check(mission))
        anchor, after = rng.choice(model.names), rng.random() < 0.5
        place = {"after" if after else "before": anchor}
        into = model.groups_around(anchor)
        place |= {"into": into[-1]} if into else {}
        if rng.random() < 0.3:
            new = task("n", *rng.choice([(), (), (rng.choice(model.names),)]))
            if new.transitions:
                model.jumps["n"] = new.transitions[0].target
            name, edit = "n", lambda: add_task(mission, new, **place)
        else:
            name = rng.choice(model.names)
            if name == anchor:
                return
            edit = lambda: move_task(mission, name, **place)  # noqa: E731
        made, codes = try_edit(edit)
        outcomes.update(codes or {"made"})
        if made is None:
            # A task that ends an inner group and leads elsewhere would end the outer one.
            assert codes == {"edit.ends-round"}
            return
        model.move_next_to(name, anchor, after)
        assert run(made) == run(model.mission()), (mission, name, place)

    move_or_add()
    assert outcomes["made"] > 20 * outcomes["edit.ends-round"]
