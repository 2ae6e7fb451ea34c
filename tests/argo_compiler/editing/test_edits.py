"""Single edits give the expected mission and consequences, or are refused for a stated reason."""

import inspect
from functools import partial

import pytest

from argo_compiler import editing
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.editing import EditConflict, EditInvalid, EditNotFound, commands
from argo_compiler.editing.commands import FUNCTIONS, apply, read_edit
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Task,
    TimeWindow,
)
from tests.mission_writing import drive, measure, wait, way

HIGH = Condition(type="MEASURED_VALUE_GREATER", object_id="1", param1=5)
DOCK = Pose(x=0, y=0, z=0)


task = partial(measure, object_id="1")


def group(name, start, end, **fields):
    return Group(name=name, start=start, end=end, **{"max_repeat_count": 2, **fields})


START = Task(name="START", action=Action.START, transitions=(way("A"),))
MISSION = Mission(
    tasks=(
        START,
        task("A", "B"),
        task("B", way("D", HIGH), "C", group="Alpha"),
        task("C", "D", group="Alpha/Beta"),
        task("D", way("A", HIGH), "E"),
        task("E"),
    ),
    groups=(group("Alpha", "B", "C"), group("Alpha/Beta", "C", "C")),
    reactions=(Reaction(event="low_battery", response="return"),),
    dock=DOCK,
    current="C",
)


def changes(edited):
    return [(c.subject, c.before, c.after) for c in edited.consequences]


def order(edited):
    return " ".join(t.name for t in edited.mission.tasks)


def test_a_task_is_added_between_its_neighbours():
    edited = editing.add_task(MISSION, task("new"), after="A")
    assert order(edited) == "START A new B C D E"
    assert changes(edited) == [("tasks['A'].transitions[0].target", "B", "new")]
    assert edited.mission.task("new").transitions == (way("B"),)
    assert order(editing.add_task(MISSION, task("new"))) == "START A B C D E new"
    assert order(editing.add_task(MISSION, task("new"), first=True)) == "START new A B C D E"


def test_at_the_border_of_a_group_a_task_is_outside_unless_into_is_given():
    outside = editing.add_task(MISSION, task("new"), after="C").mission
    assert [(g.start, g.end) for g in outside.groups] == [("B", "C"), ("C", "C")]
    assert outside.task("new").group == ""
    inside = editing.add_task(MISSION, task("new"), after="C", into="Alpha").mission
    assert [(g.start, g.end) for g in inside.groups] == [("B", "new"), ("C", "C")]
    assert inside.task("new").group == "Alpha"
    within = editing.add_task(MISSION, task("new"), before="C", into="Alpha/Beta").mission
    assert [(g.start, g.end) for g in within.groups] == [("B", "C"), ("new", "C")]


def test_the_neighbours_of_a_removed_task_take_over_its_roles():
    edited = editing.remove_task(MISSION, "C")
    assert order(edited) == "START A B D E"
    assert changes(edited) == [
        ("tasks['B'].transitions[1].target", "C", "D"),
        ("groups['Alpha'].end", "C", "B"),
        ("groups['Alpha/Beta']", "Alpha/Beta", None),
        ("current", "C", "D"),
    ]
    assert "no tasks any more" in edited.consequences[2].message
    assert changes(editing.remove_task(MISSION, "START")) == []


def test_a_task_is_renamed_wherever_it_is_named():
    edited = editing.rename_task(MISSION, "C", "gauge")
    assert changes(edited) == [
        ("tasks['B'].transitions[1].target", "C", "gauge"),
        ("groups['Alpha'].end", "C", "gauge"),
        ("groups['Alpha/Beta'].start", "C", "gauge"),
        ("groups['Alpha/Beta'].end", "C", "gauge"),
        ("current", "C", "gauge"),
    ]
    assert "'C'" not in edited.mission.model_dump_json().replace('"', "'")


def test_a_replacement_gets_the_transitions_and_position_of_the_task():
    edited = editing.replace_task(MISSION, "D", task("valve", retries=2))
    assert edited.mission.task("valve").transitions == MISSION.task("D").transitions
    assert edited.mission.task("C").transitions == (way("valve"),)
    assert edited.mission.task("B").transitions[0].target == "valve"


def test_a_moved_task_crosses_the_borders_of_groups():
    edited = editing.move_task(MISSION, "E", before="C", into="Alpha/Beta")
    assert order(edited) == "START A B E C D"
    assert edited.mission.task("E").group == "Alpha/Beta"
    assert edited.mission.task("D").transitions == (way("A", HIGH),)
    assert edited.mission.groups[1].start == "E"
    out = editing.move_task(edited.mission, "E", first=True)
    assert order(out) == "START E A B C D"
    assert out.mission.groups == MISSION.groups
    assert out.mission.tasks[0].transitions == (way("E"),)


def test_the_names_of_groups_follow_their_nesting():
    edited = editing.wrap_tasks(MISSION, group("Round", "A", "D"))
    assert [g.name for g in edited.mission.groups] == ["Round/Alpha", "Round/Alpha/Beta", "Round"]
    assert edited.mission.task("C").group == "Round/Alpha/Beta"
    inner = editing.wrap_tasks(MISSION, group("new", "B", "B")).mission
    assert inner.groups[-1].name == "Alpha/new"
    renamed = editing.rename_group(edited.mission, "Round/Alpha", "Gamma").mission
    assert [g.name for g in renamed.groups] == ["Round/Gamma", "Round/Gamma/Beta", "Round"]
    assert renamed.task("B").group == "Round/Gamma"
    dissolved = editing.dissolve_group(edited.mission, "Round").mission
    assert dissolved.groups == MISSION.groups
    wide = editing.change_group(MISSION, "Alpha", start="A", max_repeat_count=5).mission
    assert (wide.groups[0].start, wide.groups[0].max_repeat_count) == ("A", 5)
    assert wide.task("A").group == "Alpha"


def test_a_group_that_gets_the_name_of_its_outer_group_is_reported():
    wrapped = editing.wrap_tasks(MISSION, group("Round", "A", "D")).mission
    wrapped = editing.rename_group(wrapped, "Round", "Alpha").mission
    assert [g.name for g in wrapped.groups] == ["Alpha/Alpha", "Alpha/Alpha/Beta", "Alpha"]
    edited = editing.dissolve_group(wrapped, "Alpha")
    assert edited.mission.groups == MISSION.groups
    assert [c for c in changes(edited) if c[0].startswith("groups")] == [
        ("groups['Alpha'].name", "Alpha/Alpha", "Alpha"),
        ("groups['Alpha/Beta'].name", "Alpha/Alpha/Beta", "Alpha/Beta"),
    ]


def test_edits_of_transitions_conditions_reactions_and_header():
    mission = editing.remove_transition(MISSION, "D", 0).mission
    assert mission.task("D").transitions == (way("E"),)
    mission = editing.add_transition(mission, "D", way("A", HIGH), at=0).mission
    assert mission == MISSION
    mission = editing.add_condition(mission, "D", 0, HIGH).mission
    assert mission.task("D").transitions[0].conditions == (HIGH, HIGH)
    assert editing.remove_condition(mission, "D", 0, 1).mission == MISSION
    assert editing.set_target(MISSION, "D", 0, "B").mission.task("D").transitions[0].target == "B"
    pause = Reaction(event="low_battery", response="pause")
    assert editing.change_reaction(MISSION, "low_battery", pause).mission.reactions == (pause,)
    assert editing.remove_reaction(MISSION, "low_battery").mission.reactions == ()
    changed = editing.set_header(MISSION, designation="X", max_duration=60).mission
    assert (changed.designation, changed.max_duration, changed.dock) == ("X", 60.0, DOCK)
    assert editing.set_header(changed, max_duration=None).mission.max_duration is None


def call(name, *arguments, **fields):
    """Return a function without arguments that makes one edit of MISSION."""
    return partial(getattr(editing, name), MISSION, *arguments, **fields)


REFUSED = {
    EditNotFound: [
        ("edit.unknown-task", call("remove_task", "Q")),
        ("edit.unknown-task", call("set_target", "D", 0, "Q")),
        ("edit.unknown-task", call("set_header", current="Q")),
        ("edit.unknown-group", call("dissolve_group", "Beta")),
        ("edit.unknown-transition", call("remove_transition", "E", 0)),
        ("edit.unknown-condition", call("remove_condition", "D", 1, 0)),
        ("edit.unknown-reaction", call("remove_reaction", "gas_leak")),
    ],
    EditConflict: [
        ("edit.name-taken", call("rename_task", "A", "B")),
        ("edit.name-taken", call("wrap_tasks", group("Alpha", "E", "E"))),
        ("edit.name-taken", call("wrap_tasks", group("Alpha", "B", "C"))),
        ("edit.group-overlap", call("wrap_tasks", group("X", "A", "B"))),
        ("edit.group-overlap", call("change_group", "Alpha/Beta", end="D")),
        ("edit.start-in-group", call("wrap_tasks", group("X", "START", "A"))),
        ("edit.second-default", call("add_transition", "A", way("C"))),
        ("edit.second-default", call("set_conditions", "D", 0, ())),
        (
            "edit.second-reaction",
            call("add_reaction", Reaction(event="low_battery", response="abort")),
        ),
        ("edit.not-beside-group", call("add_task", task("new"), after="D", into="Alpha")),
        ("edit.last-task", lambda: editing.remove_task(Mission(tasks=(START,)), "START")),
        (
            "edit.ambiguous-task",
            lambda: editing.remove_task(Mission(tasks=(task("A"), task("A"))), "A"),
        ),
        ("il.no-dock", call("set_header", dock=None)),
        ("il.endless-group", call("change_group", "Alpha/Beta", max_repeat_count=0)),
        ("il.start-as-target", call("set_target", "D", 0, "START")),
    ],
    EditInvalid: [
        ("edit.place", call("move_task", "A", after="A")),
        ("edit.place", call("move_task", "A", after="B", first=True)),
        ("edit.value", call("rename_task", "A", "")),
        ("edit.value", call("set_header", max_duration=-1)),
        ("edit.value", lambda: read_edit('{"kind": "remove_task", "name": 3}')),
        ("edit.value", call("rename_task", "A", "\ud800")),
        ("edit.value", call("rename_task", "A", 5)),
        ("edit.value", call("rename_group", "Alpha", None)),
        ("edit.value", call("set_header", tasks=())),
        ("edit.value", call("change_group", "Alpha", source=None)),
        ("edit.value", call("add_task", {"name": "new"})),
        ("edit.value", call("replace_task", "A", None)),
        ("edit.value", call("wrap_tasks", "Alpha")),
        ("edit.value", call("add_reaction", "low_battery")),
        ("edit.value", call("change_reaction", "low_battery", "pause")),
        ("edit.value", call("add_transition", "D", way("A"), at="0")),
        ("edit.value", call("set_target", "D", "0", "A")),
        ("edit.value", call("set_transitions", "D", ("A",))),
        ("edit.value", call("set_conditions", "D", 0, ("x",))),
        ("edit.value", call("remove_condition", "D", 0, "0")),
        ("edit.value", lambda: apply(None, commands.RemoveTask(name="A"))),
        ("edit.value", lambda: apply(MISSION, {"kind": "remove_task", "name": "A"})),
        ("edit.value", lambda: read_edit("")),
        ("edit.value", lambda: read_edit(5)),
        ("edit.value", lambda: read_edit('{"kind": "remove_task", "name": "A", "name": "B"}')),
        ("edit.group-order", call("wrap_tasks", group("X", "E", "D"))),
        ("edit.group-name", call("rename_group", "Alpha", "a/b")),
        ("il.waypoint-without-pose", call("add_task", Task(name="new", action=Action.WAYPOINT))),
    ],
}
REFUSALS = [(kind, *case) for kind, cases in REFUSED.items() for case in cases]
TESTED_ELSEWHERE = {
    "edit.beginning",
    "edit.ends-by-condition",
    "edit.ends-round",
    "edit.leaves-group",
    "edit.starts-round",
}
"""codes that the removals in `test_runs` cover"""


@pytest.mark.parametrize(("kind", "code", "edit"), REFUSALS)
def test_an_impossible_edit_raises_the_right_error_and_code(kind, code, edit):
    with pytest.raises(kind, match=code) as caught:
        edit()
    assert [d.code for d in caught.value.diagnostics] == [code]
    assert all(d.hint for d in caught.value.diagnostics)


def test_every_code_of_a_refused_edit_is_tested():
    tried = {code for _, code, _ in REFUSALS if code.startswith("edit.")}
    assert tried | TESTED_ELSEWHERE == {code for code in CODES if code.startswith("edit.")}


def test_a_misspelt_name_is_answered_with_the_right_one():
    with pytest.raises(EditNotFound, match="is 'START' meant"):
        editing.remove_task(MISSION, "STRT")


def test_unchanged_parts_are_shared():
    edited = editing.remove_task(MISSION, "E").mission
    kept = [t for t in edited.tasks if any(t is old for old in MISSION.tasks)]
    assert [t.name for t in kept] == ["START", "A", "B", "C"]
    assert edited.groups[0] is MISSION.groups[0]


@pytest.mark.parametrize("kind", FUNCTIONS)
def test_an_edit_as_data_is_the_call_of_its_function(kind):
    """The fields of a model and their defaults equal the parameters of its function."""
    model = next(
        m
        for m in vars(commands).values()
        if isinstance(m, type)
        and issubclass(m, commands.EditCommand)
        and m.model_fields["kind"].default == kind
    )
    mission, *rest = inspect.signature(FUNCTIONS[kind]).parameters.values()
    fields = {name: f for name, f in model.model_fields.items() if name != "kind"}
    assert mission.name == "mission"
    named = {p.name: p for p in rest if p.kind is not inspect.Parameter.VAR_KEYWORD}
    if len(named) == len(rest):
        assert set(named) == set(fields)
    else:
        (values,) = (p for p in rest if p.kind is inspect.Parameter.VAR_KEYWORD)
        given = set(values.annotation.__args__[0].__annotations__)
        assert set(named) | given == set(fields)
    for name, parameter in named.items():
        required = parameter.default is inspect.Parameter.empty
        assert fields[name].is_required() == required
        assert required or fields[name].default == parameter.default


def test_an_edit_is_written_with_the_fields_that_were_set_only():
    edit = commands.SetHeader(max_duration=None)
    assert edit.model_dump_json() == '{"kind":"set_header","max_duration":null}'
    long = MISSION.model_copy(update={"max_duration": 60.0, "designation": "X"})
    changed = apply(long, read_edit(edit.model_dump_json())).mission
    assert (changed.max_duration, changed.designation) == (None, "X")


def test_edits_that_set_other_fields_differ():
    """A field that is set to its default is not the same as a field that is not set."""
    assert commands.SetHeader() != commands.SetHeader(max_duration=None)
    assert commands.ChangeGroup(name="G") != commands.ChangeGroup(name="G", max_repeat_count=0)
    assert len({commands.SetHeader(), commands.SetHeader(max_duration=None)}) == 2
    written = read_edit('{"kind": "remove_task", "name": "A"}')
    assert {written: 1}[commands.RemoveTask(name="A")] == 1
    assert commands.RemoveTask(name="A") != commands.DissolveGroup(name="A")


def test_a_start_that_is_moved_does_not_end_the_mission():
    mission = Mission(tasks=(START, task("A", "B"), task("B")))
    (consequence,) = editing.move_task(mission, "START", after="B").consequences
    assert consequence.message == "task 'START' leads nowhere now; the mission begins with 'A'"


def test_the_end_of_an_endless_task_is_reported_when_it_is_removed():
    mission = Mission(tasks=(task("A", "B"), task("B", "B"), task("C")))
    edited = editing.remove_task(mission, "B")
    assert edited.mission.task("A").transitions == (way("C"),)
    assert edited.consequences[-1].message == (
        "a run that reached 'B' stayed there, because it led to itself; it continues with 'C' now"
    )


# ---- fields of version 3


def chain():
    """Return a mission of the tasks a, b, c; b also follows if a failed or missed its window."""
    window = TimeWindow(latest=60, missed_target="b")
    first = drive("a", "b", on_failure=OnFailure.BRANCH, failure_target="b", window=window)
    return Mission(tasks=(first, drive("b", "c"), drive("c")))


@pytest.mark.rule("T8", "W5")
def test_a_failure_target_follows_a_new_name():
    made = editing.rename_task(chain(), "b", "new").mission.task("a")
    assert (made.failure_target, made.window.missed_target) == ("new", "new")


@pytest.mark.rule("T8", "W5")
def test_a_failure_target_that_is_removed_becomes_its_successor():
    result = editing.remove_task(chain(), "b")
    made = result.mission.task("a")
    assert (made.failure_target, made.window.missed_target) == ("c", "c")
    assert [c.subject for c in result.consequences] == [
        "tasks['a'].transitions[0].target",
        "tasks['a'].failure_target",
        "tasks['a'].window.missed_target",
    ]
    with pytest.raises(EditConflict, match="no branch can end a mission"):
        editing.remove_task(result.mission, "c")


@pytest.mark.rule("G14")
def test_a_failure_cannot_end_a_round_in_place_of_its_last_task():
    around = editing.wrap_tasks(chain(), group("G", "a", "b")).mission
    with pytest.raises(EditConflict, match="ends the rounds of group 'G'"):
        editing.remove_task(around, "b")


def test_fields_of_a_task_are_set_and_cleared():
    fields = {
        "velocity": 0.3,
        "time_limit": 60.0,
        "optional": True,
        "priority": 3,
        "retries": 2,
        "on_failure": OnFailure.BRANCH,
        "failure_target": "c",
        "window": TimeWindow(earliest=10, latest=70, missed_target="c"),
    }
    made = editing.change_task(chain(), "b", **fields)
    assert made.consequences == ()
    assert made.mission.task("b") == chain().task("b").model_copy(update=fields)
    usual = {name: Task.model_fields[name].default for name in fields}
    assert editing.change_task(made.mission, "b", **usual).mission == chain()


@pytest.mark.parametrize(
    ("fields", "error", "message"),
    [
        ({"failure_target": "nobody"}, EditNotFound, "'nobody'"),
        ({"window": TimeWindow(latest=5, missed_target="x")}, EditNotFound, "'x'"),
        ({"velocity": 0.0}, EditInvalid, "velocity"),
        ({"on_failure": OnFailure.BRANCH}, EditInvalid, "has no target for that"),
        ({"window": TimeWindow(earliest=9, latest=5)}, EditInvalid, "no time"),
        ({"on_failure": OnFailure.RETURN}, EditConflict, "dock"),
        ({"group": "z"}, EditInvalid, "`group` is not a field"),
    ],
)
def test_fields_that_a_task_cannot_have_are_refused(fields, error, message):
    with pytest.raises(error, match=message):
        editing.change_task(chain(), "b", **fields)


def test_a_wait_is_added_at_the_end_of_a_round_and_rounds_get_a_period():
    around = editing.wrap_tasks(chain(), group("G", "a", "b")).mission
    place = wait("end of 'G'", duration=0)
    made = editing.add_task(around, place, after="b", into="G").mission
    assert made.groups[0].end == "end of 'G'"
    held = Condition(type=ConditionType.UNREADABLE, object_id="1")
    planned = editing.change_group(made, "G", every=60.0, until=(held,)).mission.groups[0]
    assert (planned.every, planned.until) == (60.0, (held,))
    with pytest.raises(EditInvalid, match="does not say how long"):
        editing.add_task(around, place.model_copy(update={"wait": None}))


def test_a_reaction_gets_a_dock_of_its_own_and_a_limit():
    held = Reaction(event=EventKind.LOW_BATTERY, response=Response.PAUSE)
    mission = editing.add_reaction(chain(), held).mission
    away = held.model_copy(
        update={"response": Response.RETURN, "pose": DOCK, "area": 2, "hold_limit": 60.0}
    )
    made = editing.change_reaction(mission, EventKind.LOW_BATTERY, away).mission
    assert made.reactions == (away,)


@pytest.mark.rule("M10")
def test_precedences_follow_new_names_and_are_removed_with_their_tasks():
    mission = Mission(
        tasks=(task("A", "B"), task("B", "C"), task("C")),
        before=(("A", "B"), ("B", "C"), ("A", "C")),
    )
    renamed = editing.rename_task(mission, "B", "X").mission
    assert renamed.before == (("A", "X"), ("X", "C"), ("A", "C"))
    removed = editing.remove_task(mission, "B")
    assert removed.mission.before == (("A", "C"),)
    gone = [c.before for c in removed.consequences if c.subject == "before"]
    assert gone == ["'A' before 'B'", "'B' before 'C'"]
    turned = Mission(tasks=(task("C", "B"), task("B", "A"), task("A")))
    with pytest.raises(EditConflict):
        editing.set_header(turned, before=(("A", "C"),))
    assert editing.set_header(mission, before=()).mission.before == ()


def test_a_mission_without_tasks_can_be_given_its_duration() -> None:
    edited = editing.set_header(Mission(tasks=()), max_duration=1200.0)
    assert edited.mission.max_duration == 1200
