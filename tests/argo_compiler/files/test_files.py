import pytest

from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, Span
from argo_compiler.files import mission_file as files
from argo_compiler.files.mission_file import decode_mission, read_mission, write_mission
from argo_compiler.il import Group, Mission, Stop
from tests.mission_writing import measure, start


@pytest.fixture
def mission():
    return Mission(
        designation="Öl #1",
        tasks=(start("S", "A"), measure("A", object_id="4")),
        groups=(Group(name="G", start="A", end="A", max_repeat_count=2, stop=Stop.SOFT),),
    )


def diagnostics_of(path):
    with pytest.raises(DiagnosticError) as caught:
        read_mission(path)
    assert str(path) in str(caught.value)
    return caught.value.diagnostics


def write(tmp_path, content):
    path = tmp_path / "plan.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_written_and_read_back(tmp_path, mission):
    path = tmp_path / "plan.json"
    write_mission(mission, path)
    assert read_mission(path) == mission
    text = path.read_text(encoding="utf-8")
    assert text.startswith('{\n  "version": 4,\n  "designation": "Öl #1",\n')
    assert text.endswith("}\n")
    assert "velocity" not in text


def test_byte_order_mark_is_accepted(tmp_path):
    assert read_mission(write(tmp_path, b'\xef\xbb\xbf{"version": 1}')) == Mission()


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ("[]", "file.not-a-mission"),
        ('{"version": 7}', "file.unsupported-version"),
        ('{"version": true}', "file.unsupported-version"),
        ("", "file.not-json"),
        ("{" + '"a": ' + "1" * 5000 + "}", "file.not-json"),
        ("[" * 100_000, "file.too-deep"),
        (b"\x89PNG\r\n", "file.not-text"),
        (b"{}\x00", "file.not-text"),
        ('{"designation": "\\ud800"}', "file.not-json"),
        ('{"max_duration": NaN}', "file.wrong-field"),
        ('{"max_duration": "20"}', "file.wrong-field"),
        ('{"x": ' + "[" * 500 + "]" * 500 + "}", "file.too-deep"),
    ],
)
def test_content_that_is_no_mission_is_refused(tmp_path, content, code):
    (diagnostic,) = diagnostics_of(write(tmp_path, content))
    assert diagnostic.code == code


def test_json_error_shows_the_line(tmp_path):
    (diagnostic,) = diagnostics_of(write(tmp_path, '{\r\n  "designation": oops\r\n}'))
    assert (diagnostic.span.line, diagnostic.span.column) == (2, 18)
    assert diagnostic.excerpt == '  "designation": oops'


def test_long_lines_are_not_shown(tmp_path):
    (diagnostic,) = diagnostics_of(write(tmp_path, '{"designation": "' + "x" * 1000 + '" oops}'))
    assert diagnostic.excerpt is None


def test_wrong_fields_are_named_by_their_path(tmp_path):
    content = """{"tasks": [
        {"name": "A", "action": "MEASURE"},
        {"name": "B", "action": "FLY", "transitions": [{"taget": "A", "target": "A"}]}
    ]}"""
    diagnostics = diagnostics_of(write(tmp_path, content))
    messages = [diagnostic.message for diagnostic in diagnostics]
    assert [message.split(":")[0] for message in messages] == [
        "tasks[1].action",
        "tasks[1].transitions[0].taget",
    ]
    assert "no such field" in diagnostics[1].message
    assert "`target`" in diagnostics[1].hint


def places(diagnostics):
    return [(diagnostic.span.line, diagnostic.span.column) for diagnostic in diagnostics]


def test_wrong_fields_point_into_the_file(tmp_path):
    content = """{"tasks": [
  {"name": "A", "action": "MEASURE", "retries": -1},
  {"name": "Ö", "action": "FLY",
   "transitions": [{"taget": "A", "target": "A"}]}
], "groups": [{"name": "G", "start": "A"}]}"""
    diagnostics = diagnostics_of(write(tmp_path, content))
    assert places(diagnostics) == [(2, 38), (3, 17), (4, 21), (5, 16)]
    assert [f.subject for f in diagnostics][-1] == "groups[0].end"
    assert diagnostics[0].excerpt == content.split("\n")[1]
    assert {f.code for f in diagnostics} == {"file.wrong-field"}


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ('{"taks": []}', "`tasks`"),
        ('{"tasks": [{"name": "A", "action": "START", "retry": 1}]}', "`retries`"),
        ('{"dock": {"x": 0, "y": 0, "z": 0, "jaw": 1}}', "`yaw`"),
        ('{"reactions": [{"event": "gas_leak", "responce": "abort"}]}', "`response`"),
        ('{"zzz": 1}', "spelling"),
    ],
)
def test_the_hint_for_an_unknown_field_is_the_nearest_name(tmp_path, content, hint):
    diagnostics = diagnostics_of(write(tmp_path, content))
    assert any(hint in (f.hint or "") for f in diagnostics)


def test_places_in_a_file_of_version_1_are_those_before_migration(tmp_path):
    (diagnostic,) = diagnostics_of(write(tmp_path, '{\n\n "version": 1, "color": 2}'))
    assert places([diagnostic]) == [(3, 16)]


@pytest.mark.rule("M6")
def test_an_unknown_version_is_refused_at_its_place(tmp_path):
    (diagnostic,) = diagnostics_of(write(tmp_path, '{"tasks": [],\n "version": 7}'))
    assert places([diagnostic]) == [(2, 2)]


def test_repeated_keys_are_refused_with_both_places(tmp_path):
    content = """{"site": "umad",
 "tasks": [{"name": "A", "action": "FLY",
            "name": "B"}],
 "site": "other"}"""
    diagnostics = diagnostics_of(write(tmp_path, content))
    assert [f.code for f in diagnostics] == [
        "file.wrong-field",
        "file.duplicate-key",
        "file.duplicate-key",
    ]
    assert places(diagnostics) == [(2, 26), (3, 13), (4, 2)]
    assert "line 2, column 13" in diagnostics[1].message
    assert "line 1, column 2" in diagnostics[2].message


def test_diagnostics_of_a_mission_point_into_its_file(tmp_path):
    group = Group(name="G", start="A", end="Y", source=Span(line=700, column=1))
    mission = Mission(tasks=(measure("A", "Z", object_id="1"),), groups=(group,))
    path = tmp_path / "plan.json"
    write_mission(mission, path)
    file = decode_mission(path.read_bytes(), str(path))
    diagnostics = file.diagnostics_with_positions(check(file.mission))
    assert [f.excerpt.strip() for f in diagnostics] == ['"target": "Z"', '"end": "Y",']
    lines = path.read_text(encoding="utf-8").split("\n")
    assert all(lines[f.span.line - 1] == f.excerpt for f in diagnostics)


def test_missing_file_and_directory(tmp_path):
    assert diagnostics_of(tmp_path / "plan.json")[0].code == "file.missing"
    assert diagnostics_of(tmp_path)[0].code == "file.directory"


def test_a_file_that_is_too_large_is_not_parsed(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MAX_BYTES", 1_000_000)
    (diagnostic,) = diagnostics_of(write(tmp_path, b" " * 1_000_001))
    assert diagnostic.message == "the file is larger than 1 MB"


def test_a_file_that_cannot_be_written_is_an_error(tmp_path, mission):
    with pytest.raises(DiagnosticError, match="can't be written"):
        write_mission(mission, tmp_path / "missing" / "plan.json")


@pytest.mark.rule("M6")
def test_a_file_of_version_1_keeps_its_meaning(tmp_path):
    content = b'{"version": 1, "tasks": [{"name": "A", "action": "MEASURE", "object_id": "1"}]}'
    mission = read_mission(write(tmp_path, content))
    assert mission == Mission(tasks=(measure("A", object_id="1"),))
