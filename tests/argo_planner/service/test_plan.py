"""Mission plans: edits by three people at once, undo and redo, and following by revisions."""

import json
import random
from collections import Counter
from datetime import UTC, datetime
from typing import Any

import pytest

from argo_compiler.base.errors import ArgoError, NotFound
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.editing import commands as edits
from argo_compiler.il import Group, Mission, Transition
from argo_planner.service.core.change import HEADER, apply_change, mission_change
from argo_planner.service.core.commands import (
    EditPlan,
    PlanCommand,
    RedoEdit,
    ReplacePlan,
    Revision,
    UndoEdit,
)
from argo_planner.service.core.plan import HISTORY, MissionPlan
from argo_planner.service.core.refusals import (
    ChangedSince,
    CommandIdTaken,
    EditRefused,
    NothingToUndo,
    PlanTooLarge,
    StaleRevision,
)
from tests.argo_compiler.editing.random_edits import random_edit
from tests.conftest import seeds
from tests.mission_writing import measure
from tests.yard import in_order

AT = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)


def mission(*names: str) -> Mission:
    """Return a mission of measurements, one after the other."""
    tasks = (measure(name, object_id=str(number)) for number, name in enumerate(names, 1))
    return Mission(tasks=in_order(*tasks))


class People:
    """People who send commands to a plan, each command with its own id."""

    def __init__(self, plan: MissionPlan) -> None:
        self.plan = plan
        self.sent = 0

    def edit(self, author: str, *made: edits.Edit) -> Revision:
        return self.send(author, EditPlan(id=self.id(), edits=made))

    def undo(self, author: str, revision: int | None = None) -> Revision:
        return self.send(author, UndoEdit(id=self.id(), revision=revision))

    def redo(self, author: str) -> Revision:
        return self.send(author, RedoEdit(id=self.id()))

    def send(self, author: str, command: PlanCommand, made_on: int | None = None) -> Revision:
        on = self.plan.revision if made_on is None else made_on
        self.plan = self.plan.execute(command, author, on, AT)
        return self.plan.history[-1]

    def id(self) -> str:
        self.sent += 1
        return f"c{self.sent}"

    @property
    def names(self) -> list[str]:
        return [task.name for task in self.plan.mission.tasks]


@pytest.fixture
def people() -> People:
    return People(MissionPlan(mission("a", "b", "c", "d")))


def test_an_edit_makes_a_revision_that_states_the_change(people: People) -> None:
    revision = people.edit("ann", edits.RemoveTask(name="b"))
    assert (revision.number, revision.author, revision.at) == (2, "ann", AT)
    assert people.names == ["a", "c", "d"]
    assert revision.change.tasks is not None
    assert revision.change.tasks.gone == ("b",)
    assert [task.name for task in revision.change.tasks.put] == ["a"]
    assert [c.message for c in revision.consequences] == ["task 'a' leads to 'c' now, not to 'b'"]


def test_several_edits_are_one_command_or_none(people: People) -> None:
    people.edit("ann", edits.MoveTask(name="d", first=True), edits.MoveTask(name="c", first=True))
    assert people.names == ["c", "d", "a", "b"]
    before = people.plan
    with pytest.raises(EditRefused) as refused:
        people.edit("ann", edits.RemoveTask(name="a"), edits.RemoveTask(name="nobody"))
    assert refused.value.place == 1
    assert refused.value.diagnostics[0].code == "edit.unknown-task"
    assert people.plan is before
    people.undo("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")


def test_a_command_on_an_old_revision_is_refused(people: People) -> None:
    people.edit("ann", edits.RemoveTask(name="b"))
    with pytest.raises(StaleRevision, match="revision 1, but the mission is at revision 2"):
        people.send("bob", EditPlan(id="x", edits=(edits.RemoveTask(name="c"),)), made_on=1)


def test_a_command_that_is_sent_again_is_executed_once(people: People) -> None:
    command = EditPlan(id="x", edits=(edits.RemoveTask(name="b"),))
    first = people.send("ann", command)
    people.edit("bob", edits.RemoveTask(name="c"))
    plan = people.plan
    assert people.plan.execute(command, "ann", 1, AT) is plan
    assert plan.find_revision_made_by(command, "ann") is first
    other = EditPlan(id="x", edits=(edits.RemoveTask(name="d"),))
    for again, author in ((other, "ann"), (command, "bob")):
        with pytest.raises(CommandIdTaken):
            plan.execute(again, author, plan.revision, AT)


def test_each_author_undoes_their_own_changes(people: People) -> None:
    people.edit("ann", edits.ChangeTask(name="a", velocity=0.2))
    people.edit("bob", edits.ChangeTask(name="a", retries=2))
    people.edit("bob", edits.RemoveTask(name="d"))
    people.undo("ann")
    assert people.plan.mission.task("a").velocity is None  # type: ignore[union-attr]
    assert people.plan.mission.task("a").retries == 2  # type: ignore[union-attr]
    assert people.names == ["a", "b", "c"]
    people.redo("ann")
    assert people.plan.mission.task("a").velocity == 0.2  # type: ignore[union-attr]
    people.undo("bob")
    people.undo("bob")
    people.undo("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")
    for author in ("ann", "bob", "cid"):
        with pytest.raises(NothingToUndo):
            people.undo(author)


def test_an_edit_clears_the_changes_that_could_be_redone(people: People) -> None:
    people.edit("ann", edits.RemoveTask(name="d"))
    people.undo("ann")
    people.edit("ann", edits.RemoveTask(name="c"))
    with pytest.raises(NothingToUndo, match="nothing to redo"):
        people.redo("ann")


def test_an_author_can_undo_a_chosen_revision_of_their_own(people: People) -> None:
    people.edit("ann", edits.ChangeTask(name="a", velocity=0.2))
    people.edit("ann", edits.ChangeTask(name="b", velocity=0.3))
    people.undo("ann", 2)
    assert [task.velocity for task in people.plan.mission.tasks] == [None, 0.3, None, None]
    for author, number in (("ann", 2), ("bob", 3), ("ann", 99)):
        with pytest.raises(NothingToUndo):
            people.undo(author, number)


@pytest.mark.parametrize(
    ("mine", "theirs", "reason"),
    [
        (
            edits.ChangeTask(name="a", velocity=0.2),
            edits.ChangeTask(name="a", velocity=0.3),
            "task 'a' was changed later, by bob in revision 3",
        ),
        (
            edits.ChangeTask(name="a", velocity=0.2),
            edits.RenameTask(name="a", new_name="A"),
            "task 'a' was changed later, by bob in revision 3",
        ),
        (
            edits.AddTask(task=mission("new").tasks[0], after="b"),
            edits.ChangeTask(name="new", retries=1),
            "task 'new' was changed later, by bob in revision 3",
        ),
        (
            edits.WrapTasks(group=Group(name="g", start="b", end="c", max_repeat_count=2)),
            edits.ChangeGroup(name="g", max_repeat_count=3),
            "group 'g' was changed later, by bob in revision 3",
        ),
        (
            edits.MoveTask(name="d", first=True),
            edits.MoveTask(name="d", after="b"),
            "was changed later, by bob in revision 3",
        ),
        (
            edits.SetHeader(max_duration=100.0),
            edits.SetHeader(max_duration=200.0),
            "`max_duration` was changed later, by bob in revision 3",
        ),
        (
            edits.RenameTask(name="b", new_name="B"),
            edits.SetTransitions(
                task="c", transitions=(Transition(target="d"),), kind="set_transitions"
            ),
            None,
        ),
        (
            edits.RemoveTask(name="b"),
            edits.AddTask(task=mission("b").tasks[0], after="d"),
            "task 'b' was changed later, by bob in revision 3",
        ),
    ],
)
def test_a_change_that_was_changed_later_is_not_undone(
    people: People, mine: edits.Edit, theirs: edits.Edit, reason: str | None
) -> None:
    people.edit("ann", mine)
    try:
        people.edit("bob", theirs)
    except EditRefused:
        assert reason is None
    if reason is None:
        people.undo("ann")
        return
    before = people.plan
    with pytest.raises(ChangedSince) as refused:
        people.undo("ann")
    assert reason in str(refused.value)
    assert people.plan is before
    people.undo("bob")
    people.undo("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")


def test_a_change_that_a_later_edit_depends_on_is_not_undone(people: People) -> None:
    people.edit("ann", edits.AddTask(task=mission("e").tasks[0], after="d"))
    people.edit("bob", edits.SetTransitions(task="a", transitions=(Transition(target="e"),)))
    with pytest.raises(ChangedSince, match="bob"):
        people.undo("ann")


def test_a_mission_is_replaced_and_restored(people: People) -> None:
    people.edit("ann", edits.SetHeader(designation="round"))
    people.send("bob", ReplacePlan(id="r", mission=mission("x", "b", "a"), about="script"))
    assert people.names == ["x", "b", "a"]
    people.undo("bob")
    assert people.names == ["a", "b", "c", "d"]
    assert people.plan.mission.designation == "round"


def test_a_plan_may_not_exceed_the_limits(people: People) -> None:
    for edit in (
        edits.RenameTask(name="a", new_name="x" * 201),
        edits.SetHeader(designation="x" * 20_001),
        edits.RenameTask(name="a", new_name="a\0"),
        edits.RenameTask(name="a", new_name="a\u202egnp"),
    ):
        with pytest.raises(ArgoError, match=r"at most 200|at most 20000 are|invisible character"):
            people.edit("ann", edit)
    large = mission(*(f"t{k}" for k in range(10_001)))
    with pytest.raises(PlanTooLarge, match="10001 tasks"):
        people.send("ann", ReplacePlan(id="l", mission=large))
    people.edit("ann", edits.RenameTask(name="a", new_name="<img src=x onerror=alert(1)>"))
    assert people.names[0].startswith("<img")


def test_old_revisions_leave_the_history(people: People) -> None:
    for k in range(HISTORY + 5):
        people.edit("ann", edits.ChangeTask(name="a", velocity=0.1 + k / 1e4))
    assert len(people.plan.history) == HISTORY
    assert people.plan.revisions_after(1) is None
    assert people.plan.revisions_after(people.plan.revision + 1) is None
    assert people.plan.revisions_after(people.plan.revision) == ()
    assert people.plan.revisions_after(6) == people.plan.history
    with pytest.raises(NothingToUndo):
        people.undo("ann", 6)
    with pytest.raises(ChangedSince):
        people.undo("ann", 7)
    people.undo("ann", HISTORY + 6)


# ---- many people at once


class Follower:
    """Copy of a mission in JSON that is updated by the changes of revisions alone."""

    def __init__(self, mission: Mission) -> None:
        self.state = json.loads(mission.model_dump_json())

    def apply(self, revision: Revision) -> None:
        change = json.loads(revision.model_dump_json())["change"]
        for field, value in (change["header"] or {}).items():
            if field != "kind":
                self.state[field] = value
        for kind in ("tasks", "groups", "reactions"):
            if change[kind] is not None:
                self._apply_to(kind, change[kind], "event" if kind == "reactions" else "name")

    def _apply_to(self, kind: str, change: dict[str, Any], key: str) -> None:
        items = {item[key]: item for item in self.state[kind]}
        items.update((item[key], item) for item in change["put"])
        removed = {*change["gone"], *(name for name, _ in change["placed"])}
        order = [item[key] for item in self.state[kind] if item[key] not in removed]
        for name, behind in change["placed"]:
            order.insert(0 if behind is None else order.index(behind) + 1, name)
        self.state[kind] = [items[name] for name in order]


def test_the_plan_before_a_revision_is_that_of_the_history_or_there_is_none(people: People) -> None:
    first = people.plan
    for number in range(3):
        people.edit("ann", edits.ChangeTask(name="a", velocity=0.1 + number / 10))
    assert people.plan.plan_before(2) == first
    for revision in (-1, 0, 1, 5, 99):
        with pytest.raises(NotFound, match=f"revision {revision} is not in the history"):
            people.plan.plan_before(revision)


def errors(mission: Mission) -> Counter[str]:
    return Counter(d.code for d in check(mission) if d.severity is Severity.ERROR)


def field_values(mission: Mission) -> dict[tuple[str, ...], Any]:
    """Return each value of a mission by its kind of item, the item's name and the field."""
    values: dict[tuple[str, ...], Any] = {("", f): getattr(mission, f) for f in HEADER}
    for kind, items in (("task", mission.tasks), ("group", mission.groups)):
        for item in items:
            values |= {(kind, item.name, f): getattr(item, f) for f in type(item).model_fields}
    for reaction in mission.reactions:
        values |= {
            ("on", reaction.event, f): getattr(reaction, f) for f in type(reaction).model_fields
        }
    return values


GONE = object()


def test_three_people_edit_undo_and_redo_at_once() -> None:
    """In random interleavings, each author works on a known revision, and no follower diverges."""
    done: Counter[str] = Counter()
    for seed in seeds(100):
        rng = random.Random(seed)
        first = mission("a", "b", "c", "d", "e")
        plan = MissionPlan(first)
        seen = dict.fromkeys(("ann", "bob", "cid"), 1)
        followers = {author: Follower(first) for author in seen}
        for step in range(50):
            author = rng.choice(sorted(seen))
            command = random_command(plan, rng, f"{seed}-{step}")
            before = plan
            try:
                plan = plan.execute(command, author, seen[author], AT)
            except StaleRevision:
                done["stale"] += 1
            except ArgoError as refused:
                done[refused.code] += 1
                assert plan is before
            else:
                done[command.kind] += 1
                check_invariants(before, plan)
            if rng.random() < 0.9:
                for revision in plan.revisions_after(seen[author]) or ():
                    followers[author].apply(revision)
                seen[author] = plan.revision
        for author, follower in followers.items():
            for revision in plan.revisions_after(seen[author]) or ():
                follower.apply(revision)
            assert follower.state == json.loads(plan.mission.model_dump_json())
        replayed = MissionPlan(first)
        for revision in plan.history:
            replayed = replayed.with_next_revision(
                Revision.model_validate_json(revision.model_dump_json())
            )
        assert replayed == plan
    assert min(done[kind] for kind in ("edit", "undo", "redo", "stale", "changed-since")) > 10, done


def random_command(plan: MissionPlan, rng: random.Random, id: str) -> PlanCommand:
    kind = rng.choice(["edit"] * 4 + ["undo"] * 3 + ["redo"])
    if kind == "undo":
        return UndoEdit(id=id)
    if kind == "redo":
        return RedoEdit(id=id)
    count = rng.choice([1, 1, 1, 2, 3])
    return EditPlan(id=id, edits=tuple(random_edit(plan.mission, rng) for _ in range(count)))


def check_invariants(before: MissionPlan, after: MissionPlan) -> None:
    """Check the properties that each single revision must have."""
    revision = after.history[-1]
    assert after.revision == before.revision + 1 == revision.number
    assert not errors(after.mission) - errors(before.mission)
    assert (
        apply_change(before.mission, mission_change(before.mission, after.mission)) == after.mission
    )
    if revision.reverts is None:
        return
    missions = (*before.missions, before.mission)
    at = revision.reverts - before.revision - 2 + len(missions)
    was, became, now, result = map(
        field_values, (*missions[at : at + 2], before.mission, after.mission)
    )
    for field in was.keys() | became.keys() | now.keys() | result.keys():
        old, new, present, actual = (m.get(field, GONE) for m in (was, became, now, result))
        assert actual == (present if old == new else old), field
    changed = {
        name
        for name in {*names(missions[at]), *names(missions[at + 1])}
        if name in moved_names(missions[at], missions[at + 1])
    }
    unmoved = [n for n in names(before.mission) if n not in changed]
    assert [n for n in names(after.mission) if n not in changed] == unmoved


def names(mission: Mission) -> list[str]:
    return [task.name for task in mission.tasks]


def moved_names(before: Mission, after: Mission) -> set[str]:
    tasks = mission_change(before, after).tasks
    return {*tasks.gone, *(name for name, _ in tasks.placed)} if tasks else set()
