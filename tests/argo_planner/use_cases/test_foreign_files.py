"""Files of other programs are named for what they are, in one line, and scripts are not."""

import gzip
import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.foreign import find_foreign_file, find_foreign_json
from argo_compiler.files.mission_file import decode_mission, mission_text
from argo_env.evaluation.file import decode_evaluation
from argo_env.files.resources import scenarios_folder
from argo_planner.use_cases.importing import Upload, load_unchecked_mission
from tests.argo_planner.use_cases.foreign_files import FOREIGN
from tests.yard import measure, mission

MISSION = mission(measure(1), measure(2))
NAMES = [file.name for file in FOREIGN]


def refusal(name, content, catalog):
    with pytest.raises((Invalid, DiagnosticError)) as refused:
        load_unchecked_mission(Upload(name, content), catalog)
    return str(refused.value)


@pytest.mark.parametrize("file", FOREIGN, ids=NAMES)
def test_each_is_named_in_one_line_with_the_way_out(file, site):
    said = refusal(file.name, file.content, site.catalog)
    assert file.named in said
    assert "\n" not in said
    assert said.startswith(file.name)
    assert any(way in said for way in ("choose", "write", "save", "unpack", "begins with"))
    assert "newer Argo" not in said


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be", "utf-32"])
@pytest.mark.parametrize("name", ["order.json", "tree3.xml", "survey.txt", "waypoints.yaml"])
def test_the_encoding_does_not_matter(name, encoding, site):
    file = next(file for file in FOREIGN if file.name == name)
    content = file.content.decode().encode(encoding)
    assert file.named in refusal(name, content, site.catalog)


def test_a_yaml_file_of_another_program_has_no_evaluations():
    waypoints = next(file for file in FOREIGN if file.name == "waypoints.yaml")
    with pytest.raises(DiagnosticError) as refused:
        decode_evaluation(waypoints.content, waypoints.name)
    assert str(refused.value) == (
        "waypoints.yaml: error: the file has no evaluations, but a list of waypoints, as Nav2 "
        "follows them: choose another file [evaluation.wrong-field]"
    )


@pytest.mark.parametrize(
    ("version", "hint"),
    [
        (99, "use a newer Argo, or save the mission again"),
        ("3", "write one of them"),
        (0, "write one of them"),
        (True, "write one of them"),
    ],
)
def test_only_a_later_mission_of_argo_needs_a_newer_argo(version, hint):
    data = json.loads(mission_text(MISSION)) | {"version": version}
    with pytest.raises(DiagnosticError) as refused:
        decode_mission(json.dumps(data).encode(), "mission.json")
    (diagnostic,) = refused.value.diagnostics
    assert diagnostic.code == "file.unsupported-version"
    assert diagnostic.hint.endswith(hint)


def test_tasks_of_another_program_are_no_tasks_with_mistakes():
    text = b'{"version": "4.1", "tasks": [{"id": 1, "title": "buy milk", "done": false}]}'
    with pytest.raises(DiagnosticError) as refused:
        decode_mission(text, "todo.json")
    assert str(refused.value).startswith(
        "todo.json: error: the file is not a mission: its tasks have 'done', but no 'action'; "
    )


def test_what_argo_reads_and_writes_is_not_foreign():
    texts = [*scenarios_folder().rglob("*.txt"), *scenarios_folder().rglob("*.json")]
    assert texts
    for path in texts:
        assert find_foreign_file(path.name, path.read_bytes()) is None, path
    assert find_foreign_json(json.loads(mission_text(MISSION))) is None


def test_scripts_of_people_are_not_foreign():
    folder = os.environ.get("ARGO_CORPUS")
    if not folder:
        pytest.skip("ARGO_CORPUS names no folder: no other people's scripts are tried")
    paths = sorted(path for path in Path(folder).rglob("*.txt") if path.name != "README.txt")
    assert paths
    for path in paths:
        assert find_foreign_file(path.name, path.read_bytes()) is None, path


@pytest.mark.parametrize(
    "text",
    [
        "[Mission sheet]\nStart: area 1\n1. Check checkpoint 4.\n",
        "(check checkpoint 4)\n",
        "# Mission\nCheck 4.\n",
        "from area 1, go to checkpoint 4\n",
        "solid waste round: check checkpoint 4\n",
        "graph of pressures: check checkpoint 4\n",
        "Section 2\nCheck 4.\n",
    ],
)
def test_what_begins_like_another_format_is_still_a_script(text):
    assert find_foreign_file("mission.txt", text.encode()) is None


@given(st.binary(max_size=60), st.sampled_from(FOREIGN), st.integers(0, 2000))
def test_no_content_ends_in_a_traceback(noise, file, cut):
    for content in (noise, file.content[:cut] + noise, noise + file.content[:cut]):
        find_foreign_file(file.name, content)


@pytest.mark.parametrize(
    "content",
    [
        b"<!---->" * 2000,
        b"<?a?>" * 2000 + b"<",
        b"\n" * 4000 + b"[",
        b"; x\n" * 1000 + b"(",
        b"(a" + b" a" * 2000,
        b"a=\n" * 1300 + b"[a",
        b"def f(" + b":" * 4000,
        b"<!x [" * 800,
    ],
)
def test_no_content_takes_long(content):
    """With a pattern that tries all ways to divide such a content, this would never end."""
    find_foreign_file("mission.txt", content)


def test_an_archive_of_much_is_not_unpacked(site):
    packed = gzip.compress(bytes(10_000_000))
    assert "a compressed file (gzip)" in refusal("mission.txt", packed, site.catalog)


def test_errors_of_a_table_with_steps_are_those_of_a_script(site):
    table = b"step,what\n1,Check checkpoint 4\n2,Check checkpoint 999\n"
    with pytest.raises(ArgoError) as refused:
        load_unchecked_mission(Upload("mission.csv", table), site.catalog)
    assert "a table" not in str(refused.value)
