"""All commands that take a script, with drafts of all kinds: each behaves alike."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import IncompleteDraft, import_script, read_document
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.draft_display import incomplete_text
from tests.argo_planner.conftest import argo
from tests.processes import ROOT

WHOLE = "Start in starting area 1.\nOrder: precise\nCheck valve R12.\n"
OPEN = f"{WHOLE}Befriend valve R25.\n"
DECIDED = "# draft, version 1: a.txt\n\n4 | Befriend valve R25\nset aside by hand\n"
CHANGED = DECIDED.replace("R25", "R31")

COMMANDS: dict[str, Callable[[Path, Path], tuple[object, ...]]] = {
    "import": lambda script, folder: ("import", script, "-o", folder / "m.json"),
    "check": lambda script, _: ("check", script),
    "explain": lambda script, _: ("explain", script),
    "compile": lambda script, folder: ("compile", script, "-o", folder / "machine.json"),
    "format": lambda script, folder: ("format", script, "-o", folder / "formatted.txt"),
    "export": lambda script, folder: ("export", script, "--to", "mermaid", "-o", folder / "m.mmd"),
    "route": lambda script, _: ("route", script, "--time-limit", "1s"),
    "run": lambda script, _: ("run", script, "--drive", "route"),
    "evaluate": lambda script, folder: (
        *("evaluate", script, "--seeds", "0..0", "--out", folder / "evaluation"),
    ),
}


@pytest.fixture
def script(tmp_path: Path) -> Path:
    return tmp_path / "a.txt"


def write(script: Path, text: str, draft: str | bytes | None = None) -> None:
    script.write_text(text, encoding="utf-8")
    if draft is not None:
        beside = script.with_name("a.txt.draft")
        beside.write_bytes(draft if isinstance(draft, bytes) else draft.encode())


def outcome(command: str, script: Path) -> tuple[int, str]:
    """Return the exit status of `argo` with a command, and all that it shows."""
    result = argo(*COMMANDS[command](script, script.parent))
    status = result.exit_code
    code = getattr(result.exception, "code", None)
    if code == "incomplete":
        status = 3
    elif isinstance(code, str):
        status = 2
    return status, f"{result.output}{result.exception or ''}"


def written(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {"a.txt", "a.txt.draft"}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_complete_script_needs_no_draft(command: str, script: Path) -> None:
    write(script, WHOLE)
    assert outcome(command, script)[0] == 0
    assert not (script.parent / "a.txt.draft").exists()


@pytest.mark.parametrize("command", COMMANDS)
def test_an_incomplete_draft_ends_with_status_3_and_writes_no_result(
    command: str, script: Path
) -> None:
    write(script, OPEN)
    status, shown = outcome(command, script)
    assert status == 3
    assert "1 line to answer" in shown
    assert not written(script.parent)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_decided_draft_counts(command: str, script: Path) -> None:
    write(script, OPEN, DECIDED)
    assert outcome(command, script)[0] == 0


@pytest.mark.parametrize("command", COMMANDS)
def test_a_decision_that_no_longer_fits_has_no_effect_and_is_reported(
    command: str, script: Path
) -> None:
    write(script, OPEN, CHANGED)
    status, shown = outcome(command, script)
    assert status == 3
    if command == "check":
        assert "what was decided on `Befriend valve R31` has no effect" in shown


DAMAGED = {
    "foreign": (b"Dear draft,\n", "is no draft of this version"),
    "empty": (b"", "is no draft of this version"),
    "other version": (b"# draft, version 9: a.txt\n", "is no draft of this version"),
    "not UTF-8": (b"# draft, version 1: a.txt\n\xe4\n", "is not UTF-8"),
    "binary": (b"\x00\x01\x02" * 100, "is a binary file"),
}


@pytest.mark.parametrize("kind", DAMAGED)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_damaged_draft_is_refused_in_one_message(command: str, kind: str, script: Path) -> None:
    content, message = DAMAGED[kind]
    write(script, OPEN, content)
    status, shown = outcome(command, script)
    assert (status, message in shown) == (2, True), shown
    assert "a.txt.draft" in shown
    assert (script.parent / "a.txt.draft").read_bytes() == content
    assert not written(script.parent)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_folder_in_place_of_the_draft_is_refused(command: str, script: Path) -> None:
    write(script, OPEN)
    (script.parent / "a.txt.draft").mkdir()
    status, shown = outcome(command, script)
    assert status == 2
    assert "a.txt.draft is a directory, not the draft of" in shown


@pytest.mark.parametrize("command", COMMANDS)
def test_a_draft_that_is_too_large_is_not_read(command: str, script: Path) -> None:
    write(script, OPEN)
    with (script.parent / "a.txt.draft").open("wb") as file:
        file.truncate(10**12)  # takes no space on the disk
    status, shown = outcome(command, script)
    assert (status, "a.txt.draft is larger than" in shown) == (2, True), shown


def test_where_no_draft_can_be_written_the_command_says_what_is_left(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(script, OPEN)

    def refuse(*_: object) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr("argo_planner.terminal.draft_files.write_atomically", refuse)
    status, shown = outcome("import", script)
    assert status == 3
    assert "a.txt.draft can't be written: Read-only file system" in shown
    assert "1 line to answer" in shown
    mission = script.parent / "m.json"
    decided = argo("import", script, "-o", mission, "--set-aside", "4", status=0)
    assert "what was decided counts for this command only" in decided.output
    assert mission.exists()


@pytest.mark.skipif(not os.path.exists("/dev/stdin"), reason="there is no /dev/stdin")
def test_standard_input_is_decided_on_in_one_command(tmp_path: Path) -> None:
    def run(*words: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "argo_planner", *map(str, words)],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            input=f"{OPEN}Befriend valve R7.\n",
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    first = run("import", "/dev/stdin", "-o", "m.json")
    assert first.returncode == 3
    assert "decide in one command, as no draft of standard input is kept" in first.stderr
    assert "--choose 4=1 --choose 5=1" in first.stderr
    assert not list(tmp_path.iterdir())
    second = run("import", "/dev/stdin", "-o", "m.json", "--choose", "4=1", "--choose", "5=1")
    assert second.returncode == 0, second.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["m.json"]
    assert run("check", "/dev/stdin").returncode == 3


def test_python_gets_the_same(umad: OpenedSite) -> None:
    draft = import_script(OPEN, umad.catalog)
    assert draft.mission is None
    decided = import_script(OPEN, umad.catalog, decisions=draft.set_aside(["4"]))
    assert decided.mission is not None
    assert "script.set-aside-by-hand" in {d.code for d in decided.diagnostics}


ASIDE = f"{WHOLE}The crane is at the gate.\n"


@pytest.mark.parametrize("command", ["import", "check", "explain"])
def test_strict_counts_what_argo_has_set_aside_and_not_what_a_person_has(
    command: str, script: Path
) -> None:
    write(script, ASIDE)
    words = COMMANDS[command](script, script.parent)
    assert argo(*words, status=0).exit_code == 0
    (script.parent / "m.json").unlink(missing_ok=True)
    assert argo(*words, "--strict").exit_code == 1
    assert not written(script.parent)
    argo("import", script, "-o", script.parent / "n.json", "--set-aside", "4", status=0)
    assert argo(*words, "--strict").exit_code == 0


@pytest.mark.usefixtures("quick_picture")
def test_the_explanation_and_the_record_name_what_was_decided(script: Path) -> None:
    write(script, f"{OPEN}Befriend valve R7.\n")
    folder = script.parent
    words = ("--set-aside", "4", "--say", "5", "Check valve R7.")
    argo("import", script, "-o", folder / "m.json", *words, status=0)
    shown = argo("explain", script, status=0).output
    assert "Note: no effect: line 4: `Befriend valve R25` is set aside by hand" in shown
    assert "`Befriend valve R7` counts as `Check valve R7.`, as a person has said" in shown
    argo("run", script, "--drive", "route", "--report", folder / "report", status=0)
    record = json.loads((folder / "report" / "report.json").read_text(encoding="utf-8"))
    codes = {d["code"] for d in record["diagnostics"]}
    assert {"script.set-aside-by-hand", "script.decided"} <= codes
    page = (folder / "report" / "report.html").read_text(encoding="utf-8")
    assert "is set aside by hand" in page


# ---- several decisions in one command


def test_the_decisions_of_one_command_are_about_the_lines_as_they_were_shown(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They need one import before, one after, and one that looks at what is said alone."""
    count = 0

    def counted(*given: object, **named: object) -> object:
        nonlocal count
        count += 1
        return import_script(*given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr("argo_compiler.script.import_script", counted)
    write(script, f"{OPEN}Befriend valve R7.\nI'd like to have valve R31.\nHug valve R7.\n")
    acts = ("--choose", "4=1", "--say", "5", "Check valve R7.", "--confirm", "6")
    mission = script.parent / "m.json"
    argo("import", script, "-o", mission, *acts, "--set-aside", "7", status=0)
    assert count == 2


def test_an_import_shows_the_choices_and_where_the_draft_is(script: Path) -> None:
    write(script, OPEN)
    result = argo("import", script, "-o", script.parent / "m.json")
    assert isinstance(result.exception, IncompleteDraft)
    shown = incomplete_text(result.exception)
    assert "choice 1: Check checkpoint 4." in shown
    assert "choice 3: (set it aside)" in shown
    assert f"all lines and choices are in {script}.draft" in shown


def test_all_and_ranges_leave_out_lines_that_another_option_names(script: Path) -> None:
    text = f"{WHOLE}I'd like to have valve R25.\nI'd like to have valve R7.\n"
    write(script, text)
    mission = script.parent / "m.json"
    argo("import", script, "-o", mission, "--confirm", "all", "--set-aside", "4", status=0)
    draft = (script.parent / "a.txt.draft").read_text(encoding="utf-8")
    assert draft.count("confirmed: ") == draft.count("set aside by hand") == 1
    argo("import", script, "-o", mission, "--undo", "4-5", "--force")
    acts = ("--confirm", "4-5", "--set-aside", "5", "--force")
    argo("import", script, "-o", mission, *acts, status=0)
    assert (script.parent / "a.txt.draft").read_text("utf-8").count("confirmed: ") == 1
    argo("import", script, "-o", mission, "--undo", "all", "--force")
    draft = (script.parent / "a.txt.draft").read_text(encoding="utf-8")
    assert not any(decided in draft for decided in ("confirmed: ", "set aside by hand"))


def test_one_choice_of_several_lines(script: Path) -> None:
    write(script, f"{OPEN}Befriend valve R7.\n")
    mission = script.parent / "m.json"
    result = argo("import", script, "-o", mission, "--choose", "4,5=1", "--confirm", "all")
    assert "line 5 of a.txt" not in f"{result.output}{result.exception}"
    assert mission.exists()


@pytest.mark.parametrize(
    ("acts", "message"),
    [
        (["--say", "4", "Befriend valve R7."], "line 4 of .*: `Befriend valve R7.` is not under"),
        (["--say", "4", "Check valve R99."], "there is no valve R99 on umad"),
        (["--say", "4", "Check it again, sir"], "is not understood"),
        (
            ["--say", "4", "If #1 is above 9 psia, go home."],
            "and `If #1 is above 9 psia, go home` is",
        ),
        (["--say", "4", "Check \x07valve R7."], "characters that can't be printed"),
        (["--say", "4", "Check \udcff."], "characters that can't be printed"),
        (["--say", "44", "Check valve R7."], "has no line 44 with text"),
        (["--choose", "4=9"], "has 3 choices, and no choice 9"),
        (["--choose", f"4={'9' * 5000}"], "write a line and the number"),
        (["--choose", "5=1"], "offers no choice"),
        (["--confirm", "4"], "is open, and has nothing to confirm"),
        (["--confirm", "1" * 5000], "has no line"),
        (["--confirm", f"1-{'9' * 5000}"], "names no lines"),
        (["--undo", "x"], "has no line x"),
        (["--set-aside", "4", "--choose", "4=1"], "line 4 of .* is decided on twice"),
    ],
    ids=range(15),
)
def test_an_act_that_is_impossible_changes_nothing(
    acts: list[str], message: str, script: Path
) -> None:
    import re

    write(script, f"{OPEN}I'd like to have valve R7.\n")
    outcome("import", script)
    before = (script.parent / "a.txt.draft").read_text(encoding="utf-8")
    good = [] if "5=1" in acts else ["--confirm", "5"] if acts[0] != "--confirm" else []
    result = argo("import", script, "-o", script.parent / "m.json", *acts, *good)
    shown = f"{result.output}{result.exception}"
    assert re.search(message, shown), shown
    assert (script.parent / "a.txt.draft").read_text(encoding="utf-8") == before
    assert not written(script.parent)


def test_a_said_sentence_that_fits_only_with_other_lines_is_checked_at_once(script: Path) -> None:
    """Another line that is open does not hide that `it` refers to nothing."""
    write(script, "Start in starting area 1.\nBefriend all.\nBefriend valve R7.\n")
    words = ("import", script, "-o", script.parent / "m.json", "--say", "2", "Check it.")
    assert "is not understood" in str(argo(*words).exception)


def test_the_place_of_a_line_is_told_once(tmp_path: Path, catalog: Catalog) -> None:
    """In separated values it is the number of the line."""
    table = tmp_path / "round.csv"
    table.write_text("Seq.,Point,Normal\n2,R25,\n1,R12,\n", encoding="utf-8")
    draft = import_script(read_document(table), catalog, start_area=1)
    with pytest.raises(IncompleteDraft) as raised:
        draft.require_mission()
    shown = incomplete_text(raised.value)
    assert "line 1: | Seq. | Point | Normal |" in shown
    assert "(line 1)" not in shown
