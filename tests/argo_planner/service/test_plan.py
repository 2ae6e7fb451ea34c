"""Plans under edit: three people at once, undo and redo, and what anybody can tell from the log."""

import json
import random
from collections import Counter
from datetime import UTC, datetime
from typing import Any

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.editing import commands as edits
from argo_compiler.il import Group, Mission, Transition
from argo_planner.service.core.change import HEADER, applied, difference
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
    """Measurements, one after the other."""
    tasks = (measure(name, object_id=str(number)) for number, name in enumerate(names, 1))
    return Mission(tasks=in_order(*tasks))


class People:
    """Sends commands to a plan, each with an id of its own."""

    def __init__(self, plan: MissionPlan) -> None:
        self.plan = plan
        self.sent = 0

    def does(self, author: str, *made: edits.Edit) -> Revision:
        return self.says(author, EditPlan(id=self.id(), edits=made))

    def undoes(self, author: str, revision: int | None = None) -> Revision:
        return self.says(author, UndoEdit(id=self.id(), revision=revision))

    def redoes(self, author: str) -> Revision:
        return self.says(author, RedoEdit(id=self.id()))

    def says(self, author: str, command: PlanCommand, made_on: int | None = None) -> Revision:
        on = self.plan.revision if made_on is None else made_on
        self.plan = self.plan.carried_out(command, author, on, AT)
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


def test_an_edit_makes_a_revision_that_tells_what_changed(people: People) -> None:
    revision = people.does("ann", edits.RemoveTask(name="b"))
    assert (revision.number, revision.author, revision.at) == (2, "ann", AT)
    assert people.names == ["a", "c", "d"]
    assert revision.change.tasks is not None
    assert revision.change.tasks.gone == ("b",)
    assert [task.name for task in revision.change.tasks.put] == ["a"]
    assert [c.message for c in revision.consequences] == ["task 'a' leads to 'c' now, not to 'b'"]


def test_several_edits_are_one_command_or_none(people: People) -> None:
    people.does("ann", edits.MoveTask(name="d", first=True), edits.MoveTask(name="c", first=True))
    assert people.names == ["c", "d", "a", "b"]
    before = people.plan
    with pytest.raises(EditRefused) as refused:
        people.does("ann", edits.RemoveTask(name="a"), edits.RemoveTask(name="nobody"))
    assert refused.value.place == 1
    assert refused.value.diagnostics[0].code == "edit.unknown-task"
    assert people.plan is before
    people.undoes("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")


def test_a_command_on_an_old_revision_is_refused(people: People) -> None:
    people.does("ann", edits.RemoveTask(name="b"))
    with pytest.raises(StaleRevision, match="revision 1, and the plan is at revision 2"):
        people.says("bob", EditPlan(id="x", edits=(edits.RemoveTask(name="c"),)), made_on=1)


def test_a_command_that_is_sent_again_does_nothing_twice(people: People) -> None:
    command = EditPlan(id="x", edits=(edits.RemoveTask(name="b"),))
    first = people.says("ann", command)
    people.does("bob", edits.RemoveTask(name="c"))
    plan = people.plan
    assert people.plan.carried_out(command, "ann", 1, AT) is plan
    assert plan.repeated(command, "ann") is first
    other = EditPlan(id="x", edits=(edits.RemoveTask(name="d"),))
    for again, author in ((other, "ann"), (command, "bob")):
        with pytest.raises(CommandIdTaken):
            plan.carried_out(again, author, plan.revision, AT)


def test_each_undoes_what_they_did_themselves(people: People) -> None:
    people.does("ann", edits.ChangeTask(name="a", velocity=0.2))
    people.does("bob", edits.ChangeTask(name="a", retries=2))
    people.does("bob", edits.RemoveTask(name="d"))
    people.undoes("ann")
    assert people.plan.mission.task("a").velocity is None  # type: ignore[union-attr]
    assert people.plan.mission.task("a").retries == 2  # type: ignore[union-attr]
    assert people.names == ["a", "b", "c"]
    people.redoes("ann")
    assert people.plan.mission.task("a").velocity == 0.2  # type: ignore[union-attr]
    people.undoes("bob")
    people.undoes("bob")
    people.undoes("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")
    for author in ("ann", "bob", "cid"):
        with pytest.raises(NothingToUndo):
            people.undoes(author)


def test_an_edit_ends_what_could_be_done_again(people: People) -> None:
    people.does("ann", edits.RemoveTask(name="d"))
    people.undoes("ann")
    people.does("ann", edits.RemoveTask(name="c"))
    with pytest.raises(NothingToUndo, match="undone nothing"):
        people.redoes("ann")


def test_one_revision_of_ones_own_can_be_undone(people: People) -> None:
    people.does("ann", edits.ChangeTask(name="a", velocity=0.2))
    people.does("ann", edits.ChangeTask(name="b", velocity=0.3))
    people.undoes("ann", 2)
    assert [task.velocity for task in people.plan.mission.tasks] == [None, 0.3, None, None]
    for author, number in (("ann", 2), ("bob", 3), ("ann", 99)):
        with pytest.raises(NothingToUndo):
            people.undoes(author, number)


@pytest.mark.parametrize(
    ("mine", "theirs", "reason"),
    [
        (
            edits.ChangeTask(name="a", velocity=0.2),
            edits.ChangeTask(name="a", velocity=0.3),
            "task 'a' is not as it left it: bob changed it in revision 3",
        ),
        (
            edits.ChangeTask(name="a", velocity=0.2),
            edits.RenameTask(name="a", new_name="A"),
            "task 'a' is not as it left it: bob changed it in revision 3",
        ),
        (
            edits.AddTask(task=mission("new").tasks[0], after="b"),
            edits.ChangeTask(name="new", retries=1),
            "task 'new' is not as it left it: bob changed it in revision 3",
        ),
        (
            edits.WrapTasks(group=Group(name="g", start="b", end="c", max_repeat_count=2)),
            edits.ChangeGroup(name="g", max_repeat_count=3),
            "group 'g' is not as it left it: bob changed it in revision 3",
        ),
        (
            edits.MoveTask(name="d", first=True),
            edits.MoveTask(name="d", after="b"),
            "is not as it left it: bob changed it in revision 3",
        ),
        (
            edits.SetHeader(max_duration=100.0),
            edits.SetHeader(max_duration=200.0),
            "`max_duration` is not as it left it: bob changed it in revision 3",
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
            "task 'b' is not as it left it: bob changed it in revision 3",
        ),
    ],
)
def test_what_somebody_has_changed_since_is_not_undone(
    people: People, mine: edits.Edit, theirs: edits.Edit, reason: str | None
) -> None:
    people.does("ann", mine)
    try:
        people.does("bob", theirs)
    except EditRefused:
        assert reason is None
    if reason is None:
        people.undoes("ann")
        return
    before = people.plan
    with pytest.raises(ChangedSince) as refused:
        people.undoes("ann")
    assert reason in str(refused.value)
    assert people.plan is before
    people.undoes("bob")
    people.undoes("ann")
    assert people.plan.mission == mission("a", "b", "c", "d")


def test_what_a_later_edit_needs_is_not_undone(people: People) -> None:
    people.does("ann", edits.AddTask(task=mission("e").tasks[0], after="d"))
    people.does("bob", edits.SetTransitions(task="a", transitions=(Transition(target="e"),)))
    with pytest.raises(ChangedSince, match="bob"):
        people.undoes("ann")


def test_a_whole_mission_is_replaced_and_put_back(people: People) -> None:
    people.does("ann", edits.SetHeader(designation="round"))
    people.says("bob", ReplacePlan(id="r", mission=mission("x", "b", "a"), about="script"))
    assert people.names == ["x", "b", "a"]
    people.undoes("bob")
    assert people.names == ["a", "b", "c", "d"]
    assert people.plan.mission.designation == "round"


def test_a_plan_may_not_grow_beyond_what_can_be_served(people: People) -> None:
    for edit in (
        edits.RenameTask(name="a", new_name="x" * 201),
        edits.SetHeader(designation="x" * 20_001),
        edits.RenameTask(name="a", new_name="a\0"),
        edits.RenameTask(name="a", new_name="a\u202egnp"),
    ):
        with pytest.raises(ArgoError, match=r"at most 200|may have 20000|can't be seen"):
            people.does("ann", edit)
    large = mission(*(f"t{k}" for k in range(10_001)))
    with pytest.raises(PlanTooLarge, match="10001 tasks"):
        people.says("ann", ReplacePlan(id="l", mission=large))
    people.does("ann", edits.RenameTask(name="a", new_name="<img src=x onerror=alert(1)>"))
    assert people.names[0].startswith("<img")


def test_old_history_is_forgotten(people: People) -> None:
    for k in range(HISTORY + 5):
        people.does("ann", edits.ChangeTask(name="a", velocity=0.1 + k / 1e4))
    assert len(people.plan.history) == HISTORY
    assert people.plan.since(1) is None
    assert people.plan.since(people.plan.revision + 1) is None
    assert people.plan.since(people.plan.revision) == ()
    assert people.plan.since(6) == people.plan.history
    with pytest.raises(NothingToUndo):
        people.undoes("ann", 6)
    with pytest.raises(ChangedSince):
        people.undoes("ann", 7)
    people.undoes("ann", HISTORY + 6)


# ---- many people at once


class Follower:
    """Follows a plan by what is said of its revisions, and knows nothing but JSON."""

    def __init__(self, mission: Mission) -> None:
        self.state = json.loads(mission.model_dump_json())

    def hears(self, revision: Revision) -> None:
        change = json.loads(revision.model_dump_json())["change"]
        for field, value in (change["header"] or {}).items():
            if field != "kind":
                self.state[field] = value
        for kind in ("tasks", "groups", "reactions"):
            if change[kind] is not None:
                self._list(kind, change[kind], "event" if kind == "reactions" else "name")

    def _list(self, kind: str, change: dict[str, Any], key: str) -> None:
        items = {item[key]: item for item in self.state[kind]}
        items.update((item[key], item) for item in change["put"])
        out = {*change["gone"], *(name for name, _ in change["placed"])}
        order = [item[key] for item in self.state[kind] if item[key] not in out]
        for name, behind in change["placed"]:
            order.insert(0 if behind is None else order.index(behind) + 1, name)
        self.state[kind] = [items[name] for name in order]


def errors(mission: Mission) -> Counter[str]:
    return Counter(d.code for d in check(mission) if d.severity is Severity.ERROR)


def flat(mission: Mission) -> dict[tuple[str, ...], Any]:
    """Each value of a mission by where it stands."""
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
    """Random interleavings: each works on what they saw last, and nobody is ever told wrong."""
    done: Counter[str] = Counter()
    for seed in seeds(100):
        rng = random.Random(seed)
        first = mission("a", "b", "c", "d", "e")
        plan = MissionPlan(first)
        seen = dict.fromkeys(("ann", "bob", "cid"), 1)
        followers = {author: Follower(first) for author in seen}
        for step in range(50):
            author = rng.choice(sorted(seen))
            command = a_command(plan, rng, f"{seed}-{step}")
            before = plan
            try:
                plan = plan.carried_out(command, author, seen[author], AT)
            except StaleRevision:
                done["stale"] += 1
            except ArgoError as refused:
                done[refused.code] += 1
                assert plan is before
            else:
                done[command.kind] += 1
                invariants(before, plan)
            if rng.random() < 0.9:
                for revision in plan.since(seen[author]) or ():
                    followers[author].hears(revision)
                seen[author] = plan.revision
        for author, follower in followers.items():
            for revision in plan.since(seen[author]) or ():
                follower.hears(revision)
            assert follower.state == json.loads(plan.mission.model_dump_json())
        replayed = MissionPlan(first)
        for revision in plan.history:
            replayed = replayed.repeat(Revision.model_validate_json(revision.model_dump_json()))
        assert replayed == plan
    assert min(done[kind] for kind in ("edit", "undo", "redo", "stale", "changed-since")) > 10, done


def a_command(plan: MissionPlan, rng: random.Random, id: str) -> PlanCommand:
    kind = rng.choice(["edit"] * 4 + ["undo"] * 3 + ["redo"])
    if kind == "undo":
        return UndoEdit(id=id)
    if kind == "redo":
        return RedoEdit(id=id)
    count = rng.choice([1, 1, 1, 2, 3])
    return EditPlan(id=id, edits=tuple(random_edit(plan.mission, rng) for _ in range(count)))


def invariants(before: MissionPlan, after: MissionPlan) -> None:
    """What holds of each revision, looked at by itself."""
    revision = after.history[-1]
    assert after.revision == before.revision + 1 == revision.number
    assert not errors(after.mission) - errors(before.mission)
    assert applied(before.mission, difference(before.mission, after.mission)) == after.mission
    if revision.reverts is None:
        return
    missions = (*before.missions, before.mission)
    at = revision.reverts - before.revision - 2 + len(missions)
    was, became, now, result = map(flat, (*missions[at : at + 2], before.mission, after.mission))
    for place in was.keys() | became.keys() | now.keys() | result.keys():
        old, new, present, found = (m.get(place, GONE) for m in (was, became, now, result))
        assert found == (present if old == new else old), place
    changed = {
        name
        for name in {*names(missions[at]), *names(missions[at + 1])}
        if name in moved(missions[at], missions[at + 1])
    }
    unmoved = [n for n in names(before.mission) if n not in changed]
    assert [n for n in names(after.mission) if n not in changed] == unmoved


def names(mission: Mission) -> list[str]:
    return [task.name for task in mission.tasks]


def moved(before: Mission, after: Mission) -> set[str]:
    tasks = difference(before, after).tasks
    return {*tasks.gone, *(name for name, _ in tasks.placed)} if tasks else set()
