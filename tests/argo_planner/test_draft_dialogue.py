"""`argo import --interactive` in a pseudo terminal."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from argo_compiler.files.mission_file import read_mission
from tests.argo_planner.conftest import argo
from tests.terminals import Terminal

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo terminals")

MAIL = """\
Start in starting area 1.
I'd like to have pressure gauge 1, and then valve R25.
Photograph the pump.
Befriend valve R12.
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "mail.txt").write_text(MAIL, encoding="utf-8")
    return tmp_path


@pytest.fixture
def terminal(folder: Path) -> Iterator[Terminal]:
    with start(folder) as opened:
        yield opened


def start(folder: Path, script: str = "mail.txt") -> Terminal:
    command = (sys.executable, "-m", "argo_planner", "import", script, "-o", "m.json")
    return Terminal(*command, "--interactive", cwd=folder)


def measured(folder: Path) -> list[str]:
    return [task.object_id for task in read_mission(folder / "m.json").tasks if task.object_id]


def draft(folder: Path) -> str:
    return (folder / "mail.txt.draft").read_text(encoding="utf-8")


def test_one_key_a_line_leads_to_the_mission(terminal: Terminal, folder: Path) -> None:
    shown = terminal.expect(r"q quit, \? help: ")
    assert "mail.txt, line 2 (3 left)" in shown
    assert "      1 | Start in starting area 1." in shown
    assert ">     2 | I'd like to have pressure gauge 1, and then valve R25." in shown
    assert "      3 | Photograph the pump." in shown
    assert "=> Check checkpoint 1 and checkpoint 4." in shown
    assert "c confirm, a set aside" in shown
    terminal.type("c")
    shown = terminal.expect(r"q quit, \? help: ")
    assert "open: Argo does not understand `Photograph` here" in shown
    assert "c confirm" not in shown
    assert "u undo" in shown
    terminal.type("a")
    terminal.expect(r"line 4 \(1 left\)")
    assert "1: Check checkpoint 5." in terminal.expect("1-3 choose.*help: ")
    terminal.type("1")
    assert terminal.end() == 0
    assert measured(folder) == ["1", "4", "5"]
    assert "Befriend valve R12` counts as `Check checkpoint 5.`" in terminal.output


def test_lines_that_name_nothing_are_listed_and_set_aside_together(folder: Path) -> None:
    steps = "Photograph the pump\nBefriend valve R12.\nWave to the camera\nDo not hurry\n"
    (folder / "list.txt").write_text(f"Start in starting area 1.\n{steps}", "utf-8")
    with start(folder, "list.txt") as terminal:
        terminal.expect(r"a set aside, r set aside the rest that names nothing \(2\), s say")
        terminal.type("r")
        shown = terminal.expect("any other key no: ")
        assert "      2 | Photograph the pump" in shown
        assert "      4 | Wave to the camera" in shown
        assert "R12" not in shown
        assert "hurry" not in shown
        terminal.type("n")
        assert "r set aside the rest" in terminal.expect(r"\? help: ")
        terminal.type("ry")
        assert "line 3 (2 left)" in terminal.expect(r"\? help: ")
        terminal.type("u")
        assert "line 2 (4 left)" in terminal.expect(r"\? help: ")
        terminal.type("ry1a")
        assert terminal.end() == 0
    assert (folder / "list.txt.draft").read_text("utf-8").count("set aside by hand") == 3


def test_keys_typed_ahead_are_taken_in_their_order(terminal: Terminal, folder: Path) -> None:
    terminal.type("ca1")
    assert terminal.end() == 0
    assert measured(folder) == ["1", "4", "5"]


def test_a_kill_loses_no_decision(terminal: Terminal, folder: Path) -> None:
    terminal.type("ca")
    terminal.expect(r"line 4 \(1 left\)")
    terminal.kill()
    assert "confirmed: Check checkpoint 1 and checkpoint 4." in draft(folder)
    assert "set aside by hand" in draft(folder)
    with start(folder) as again:
        again.expect(r"line 4 \(1 left\)")
        again.type("1")
        assert again.end() == 0
    assert measured(folder) == ["1", "4", "5"]


def test_the_terminal_edits_what_is_said(terminal: Terminal, folder: Path) -> None:
    """Backspace and Ctrl-U are the terminal's own: the program gets the line that they leave."""
    terminal.type("cas")
    terminal.expect("line 4, in other words: ")
    assert terminal.echoes()
    terminal.type("Rubbish\x15Check valve R40\x7f\x7f12.\n")
    assert terminal.end() == 0
    assert measured(folder) == ["1", "4", "5"]
    assert "said: Check valve R12." in draft(folder)


def test_what_is_said_and_not_understood_is_asked_for_again(
    terminal: Terminal, folder: Path
) -> None:
    terminal.type("ca")
    terminal.expect(r"line 4 \(1 left\)")
    before = draft(folder)
    terminal.type("sBefriend valve R7.\n")
    terminal.expect("line 4 of mail.txt: `Befriend valve R7.` is not understood")
    terminal.expect("line 4, in other words: ")
    assert draft(folder) == before
    terminal.type("q or not\n")  # words, not keys
    terminal.expect("is not understood")
    terminal.expect("line 4, in other words: ")
    terminal.type("\x04")  # ends the sentence, and not the questions
    terminal.expect(r"\? help: ")
    terminal.type("1")
    assert terminal.end() == 0


def test_skip_undo_help_and_quit(terminal: Terminal, folder: Path) -> None:
    terminal.type("?")
    terminal.expect("lines that are left stay in the draft")
    terminal.type("x")
    terminal.expect("no such key here")
    terminal.type("c")
    terminal.expect(r"line 3 \(2 left\)")
    terminal.type("u")
    terminal.expect(r"line 2 \(3 left\)")
    assert "confirmed" not in draft(folder)
    terminal.type("n")
    terminal.expect(r"line 3 \(3 left\)")
    terminal.type(" q")
    assert terminal.end() == 3
    assert "1 line to confirm and 2 lines to answer" in terminal.output
    assert not (folder / "m.json").exists()


@pytest.mark.parametrize(("keys", "status"), [("\x04", 3), ("\x03", 130)])
def test_control_keys_end_it_and_leave_the_terminal_usable(
    keys: str, status: int, terminal: Terminal, folder: Path
) -> None:
    terminal.type("c")
    terminal.expect("line 3")
    terminal.expect("help: ")
    terminal.type(keys)
    assert terminal.end() == status
    assert terminal.echoes_at_end
    assert "confirmed: Check checkpoint 1" in draft(folder)


def test_a_new_size_of_the_window_and_function_keys_change_nothing(terminal: Terminal) -> None:
    terminal.expect(r"help: ")
    terminal.resize(5, 20)
    terminal.type("\x1b[A")
    terminal.expect("no such key here")
    terminal.resize(60, 300)
    terminal.type("ca1")
    assert terminal.end() == 0


def test_a_german_script(folder: Path) -> None:
    text = "Start im Startbereich 1.\nIch hätte gern das Manometer 1 abgelesen.\n"
    (folder / "rundgang.txt").write_text(f"{text}Ventil R25 begrüßen.\n", encoding="utf-8")
    with start(folder, "rundgang.txt") as terminal:
        assert "Ich hätte gern" in terminal.expect(r"\? help: ")
        terminal.type("1")
        terminal.expect(r"line 3 \(1 left\)")
        terminal.type("s")
        terminal.expect("in other words: ")
        terminal.type("Prüfe Ventil R12ü\x7f.\n")
        assert terminal.end() == 0
    assert "said: Prüfe Ventil R12." in (folder / "rundgang.txt.draft").read_text("utf-8")


def test_a_script_of_two_hundred_lines(folder: Path) -> None:
    lines = [f"Please befriend valve R{(7, 12, 25, 40)[i % 4]}, number {i}." for i in range(200)]
    (folder / "long.txt").write_text("\n".join(["Start in starting area 1.", *lines]), "utf-8")
    with start(folder, "long.txt") as terminal:
        terminal.type("n" * 180 + "a" * 20)
        assert terminal.end() == 3
    assert (folder / "long.txt.draft").read_text("utf-8").count("set aside by hand") == 20


def test_control_characters_of_a_script_do_not_reach_the_terminal(folder: Path) -> None:
    (folder / "mail.txt").write_text(f"{MAIL}Befriend \x1b]0;title\x07 valve R7.\n", "utf-8")
    with start(folder) as terminal:
        terminal.type("nnnq")
        assert terminal.end() == 3
        assert "\x1b" not in terminal.output
        assert "\x07" not in terminal.output


def test_without_a_terminal_one_message_says_so(folder: Path) -> None:
    said = argo("import", folder / "mail.txt", "-o", folder / "m.json", "--interactive", status=1)
    assert str(said.exception).startswith("--interactive needs a terminal")
    assert not (folder / "mail.txt.draft").exists()


def test_a_script_that_is_understood_is_not_asked_about(folder: Path) -> None:
    (folder / "mail.txt").write_text("Start in starting area 1. Check valve R12.\n", "utf-8")
    with start(folder) as terminal:
        assert terminal.end() == 0
        assert "help" not in terminal.output
    assert measured(folder) == ["5"]
