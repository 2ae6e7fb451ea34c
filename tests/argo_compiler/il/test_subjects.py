"""Subjects of diagnostics use names, whatever the names are, and lead back to their places."""

import json

from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.checks import check
from argo_compiler.diagnostics.subject import NamedItem, split_subject, subject_of
from argo_compiler.files.mission_file import decode_mission, mission_text
from argo_compiler.il import Action, Group, Mission, Task, Transition
from argo_compiler.il.subjects import Subjects
from tests.missions_all import missions

ODD = st.text(st.sampled_from("ab'\"\\]['.\n\t\0\x1f\u2028ü😀"), min_size=1, max_size=8)
names = st.one_of(ODD, st.text(min_size=1))


def test_names_are_written_as_in_normalised_paths():
    assert subject_of("tasks", "it's \\ a\nb\x01", ".pose") == r"tasks['it\'s \\ a\nb\u0001'].pose"


@given(names, st.sampled_from(["", ".name", ".transitions[3].conditions[0].object_id"]))
def test_any_name_is_read_back(name, rest):
    path = split_subject(subject_of("groups", name, rest))
    assert path == ("groups", NamedItem(name), *split_subject(rest))


@given(missions())
def test_each_part_of_any_mission_has_a_subject_of_its_own_that_leads_to_it(mission):
    subjects = Subjects(mission)
    ways = {
        "tasks": subjects.task_subject,
        "groups": subjects.group_subject,
        "reactions": subjects.reaction_subject,
    }
    seen = []
    for field, name in ways.items():
        for i in range(len(getattr(mission, field))):
            seen.append(name(i, ".name"))
            assert subjects.subject_path(seen[-1]) == (field, i, "name")
    assert len(set(seen)) == len(seen)


def test_what_is_not_there_leads_to_the_list():
    assert Subjects(Mission()).subject_path("tasks['A'].pose") == ("tasks",)


def test_diagnostics_about_odd_and_repeated_names_point_into_the_file(tmp_path):
    odd = 'a\'].b["0"]\n\\'
    tasks = (
        Task(name="same", action=Action.MEASURE, object_id="1"),
        Task(name=odd, action=Action.MEASURE, transitions=(Transition(target="no"),)),
        Task(name="same", action=Action.MEASURE),
    )
    groups = (Group(name="G", start=odd, end="gone", max_repeat_count=1),)
    path = tmp_path / "plan.json"
    path.write_text(mission_text(Mission(tasks=tasks, groups=groups)), encoding="utf-8")
    read = decode_mission(path.read_bytes(), str(path))
    lines = read.text.split("\n")
    found = {
        (f.code, lines[f.span.line - 1].strip())
        for f in read.diagnostics_with_positions(check(read.mission))
    }
    assert found == {
        ("il.duplicate-task", '"name": "same",'),
        ("il.measure-without-object", f'"name": {json.dumps(odd)},'),
        ("il.measure-without-object", '"name": "same",'),
        ("il.unknown-target", '"target": "no"'),
        ("il.unknown-group-task", '"end": "gone",'),
    }
    places = {f.subject: f.span.line for f in read.diagnostics_with_positions(check(read.mission))}
    assert places["tasks[2]"] == places["tasks[2].name"]


def test_a_subject_is_still_meant_when_something_was_added_before_it():
    lost = Task(name="lost", action=Action.MEASURE)
    more = Task(name="more", action=Action.MEASURE, object_id="1")
    (before,), (after,) = check(Mission(tasks=(lost,))), check(Mission(tasks=(more, lost)))
    assert before.subject == after.subject == "tasks['lost']"
