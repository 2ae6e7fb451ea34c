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


def refusal(path):
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
    assert text.startswith('{\n  "version": 3,\n  "designation": "Öl #1",\n')
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
def test_what_is_no_mission(tmp_path, content, code):
    (finding,) = refusal(write(tmp_path, content))
    assert finding.code == code


def test_json_error_shows_the_line(tmp_path):
    (finding,) = refusal(write(tmp_path, '{\r\n  "designation": oops\r\n}'))
    assert (finding.span.line, finding.span.column) == (2, 18)
    assert finding.excerpt == '  "designation": oops'


def test_long_lines_are_not_shown(tmp_path):
    (finding,) = refusal(write(tmp_path, '{"designation": "' + "x" * 1000 + '" oops}'))
    assert finding.excerpt is None


def test_wrong_fields_are_named_by_their_path(tmp_path):
    content = """{"tasks": [
        {"name": "A", "action": "MEASURE"},
        {"name": "B", "action": "FLY", "transitions": [{"taget": "A", "target": "A"}]}
    ]}"""
    findings = refusal(write(tmp_path, content))
    messages = [finding.message for finding in findings]
    assert [message.split(":")[0] for message in messages] == [
        "tasks[1].action",
        "tasks[1].transitions[0].taget",
    ]
    assert "no such field" in findings[1].message
    assert "`target`" in findings[1].hint


def places(findings):
    return [(finding.span.line, finding.span.column) for finding in findings]


def test_wrong_fields_point_into_the_file(tmp_path):
    content = """{"tasks": [
  {"name": "A", "action": "MEASURE", "retries": -1},
  {"name": "Ö", "action": "FLY",
   "transitions": [{"taget": "A", "target": "A"}]}
], "groups": [{"name": "G", "start": "A"}]}"""
    findings = refusal(write(tmp_path, content))
    assert places(findings) == [(2, 38), (3, 17), (4, 21), (5, 16)]
    assert [f.subject for f in findings][-1] == "groups[0].end"
    assert findings[0].excerpt == content.split("\n")[1]
    assert {f.code for f in findings} == {"file.wrong-field"}


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
def test_an_unknown_field_is_met_with_the_nearest_name(tmp_path, content, hint):
    findings = refusal(write(tmp_path, content))
    assert any(hint in (f.hint or "") for f in findings)


def test_the_places_of_a_file_of_version_1_are_its_own(tmp_path):
    (finding,) = refusal(write(tmp_path, '{\n\n "version": 1, "color": 2}'))
    assert places([finding]) == [(3, 16)]


@pytest.mark.rule("M6")
def test_a_version_that_is_not_known_is_shown(tmp_path):
    (finding,) = refusal(write(tmp_path, '{"tasks": [],\n "version": 7}'))
    assert places([finding]) == [(2, 2)]


def test_keys_that_stand_twice_are_refused_with_both_places(tmp_path):
    content = """{"site": "umad",
 "tasks": [{"name": "A", "action": "FLY",
            "name": "B"}],
 "site": "other"}"""
    findings = refusal(write(tmp_path, content))
    assert [f.code for f in findings] == [
        "file.wrong-field",
        "file.duplicate-key",
        "file.duplicate-key",
    ]
    assert places(findings) == [(2, 26), (3, 13), (4, 2)]
    assert "line 2, column 13" in findings[1].message
    assert "line 1, column 2" in findings[2].message


def test_findings_about_a_mission_point_into_its_file(tmp_path):
    group = Group(name="G", start="A", end="Y", source=Span(line=700, column=1))
    mission = Mission(tasks=(measure("A", "Z", object_id="1"),), groups=(group,))
    path = tmp_path / "plan.json"
    write_mission(mission, path)
    file = decode_mission(path.read_bytes(), str(path))
    findings = file.placed(check(file.mission))
    assert [f.excerpt.strip() for f in findings] == ['"target": "Z"', '"end": "Y",']
    lines = path.read_text(encoding="utf-8").split("\n")
    assert all(lines[f.span.line - 1] == f.excerpt for f in findings)


def test_missing_file_and_directory(tmp_path):
    assert refusal(tmp_path / "plan.json")[0].code == "file.missing"
    assert refusal(tmp_path)[0].code == "file.directory"


def test_too_large_a_file_is_not_parsed(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MAX_BYTES", 1_000_000)
    (finding,) = refusal(write(tmp_path, b" " * 1_000_001))
    assert finding.message == "is larger than 1 MB"


def test_file_that_can_not_be_written(tmp_path, mission):
    with pytest.raises(DiagnosticError, match="can't be written"):
        write_mission(mission, tmp_path / "missing" / "plan.json")


@pytest.mark.rule("M6")
def test_a_file_of_version_1_is_read_as_what_it_meant(tmp_path):
    old = b'{"version": 1, "tasks": [{"name": "A", "action": "MEASURE", "object_id": "1"}]}'
    mission = read_mission(write(tmp_path, old))
    assert mission == Mission(tasks=(measure("A", object_id="1"),))
