"""Paths that can't be read or written: one message names the wrong path in all commands.

Python's `Path.exists` and its siblings raise if a folder can't be read or a name is too long.
"""

import os
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from argo_compiler.base.errors import ArgoError
from tests.argo_planner.conftest import argo

NOBODY = 65534

SCRIPT = "Mission Protocol #1\n1. Start in starting area 1.\n2. Check checkpoint #1.\n"

READS = {
    "import {} -o new.json --site darmstadt": ".txt",
    "check {} --site darmstadt ": ".bag",
    "check {} --site darmstadt": ".json",
    "compile {} -o new.json --site darmstadt": ".json",
    "format {} --site darmstadt": ".txt",
    "export {} --to dot -o new.dot --site darmstadt": ".json",
    "route {} --site darmstadt": ".json",
    "run {} --site darmstadt": ".json",
    "check s.txt --site {}": ".yaml",
    "sites {}": ".yaml",
    "run s.txt --drive route --faults {} --site darmstadt": ".yaml",
    "route s.txt --requirements {} --site darmstadt": ".yaml",
    "resume {}": ".journal",
    "replay {}": ".mcap",
}
"""commands that read a file, with the suffix of the file"""

WRITES = {
    "import s.txt -o {} --site darmstadt": ".json",
    "check s.txt -o {} --site darmstadt": ".txt",
    "compile s.txt -o {} --site darmstadt": ".json",
    "compile s.txt -o new.json --mermaid {} --site darmstadt": ".mmd",
    "format s.txt -o {} --site darmstadt": ".txt",
    "export s.txt --to dot -o {} --site darmstadt": ".dot",
    "export s.txt --to flexbe -o {} --site darmstadt": "",
    "sites darmstadt -o {}": ".yaml",
    "route s.txt -o {} --site darmstadt": ".json",
    "route s.txt --pictures {} --site darmstadt": "",
    "run s.txt --drive route --journal {} --site darmstadt": ".journal",
    "run s.txt --drive route --record {} --site darmstadt": ".mcap",
    "run s.txt --drive route --render {} --site darmstadt": ".gif",
    "run s.txt --drive route --report {} --site darmstadt": "",
}
"""commands that write a file or a folder, with its suffix"""


@contextmanager
def without_privileges() -> Iterator[None]:
    """Run as a user whom permissions stop, unlike root."""
    before = os.geteuid()
    if before == 0:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(before)


@pytest.fixture(autouse=True)
def folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a working folder that every user can read, unlike that of pytest."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o777)
        monkeypatch.chdir(name)
        _fill()
        yield Path(name)
        monkeypatch.undo()


def _fill() -> None:
    Path("s.txt").write_text(SCRIPT, encoding="utf-8")
    for suffix in set(READS.values()):
        Path(f"loop{suffix}").symlink_to(f"loop{suffix}")
    Path("locked").mkdir(0o700)
    Path("locked").chmod(0)


def refusal(command: str, path: str) -> str:
    """Return the message about the path."""
    words = [word.format(path) for word in command.split()]
    result = argo(*words)
    if not isinstance(result.exception, ArgoError | SystemExit) or not result.exit_code:
        raise AssertionError(f"{command}: {result.output}") from result.exception
    said = f"{result.exception}" if isinstance(result.exception, ArgoError) else result.output
    assert path in said
    return said


@pytest.mark.parametrize("command", READS)
def test_unreadable_paths_are_named_with_the_reason(command: str):
    suffix = READS[command]
    too_long = "n" * 250 + "e" * 20 + suffix
    assert "File name too long" in refusal(command, too_long)
    assert "Too many levels of symbolic links" in refusal(command, f"loop{suffix}")
    assert "Not a directory" in refusal(command, f"s.txt/x{suffix}")
    with without_privileges():
        assert "Permission denied" in refusal(command, f"locked/x{suffix}")


@pytest.mark.parametrize("command", WRITES)
def test_unwritable_paths_are_named_and_no_file_remains(folder: Path, command: str):
    suffix = WRITES[command]
    before = set(folder.iterdir())
    refusal(command, "n" * 250 + "e" * 20 + suffix)
    refusal(command, f"s.txt/x{suffix}")
    with without_privileges():
        refusal(command, f"locked/x{suffix}")
    assert {path.name for path in folder.iterdir()} - {path.name for path in before} <= {"new.json"}


@pytest.mark.parametrize("name", ["pipe", "pipe.txt"])
def test_a_script_comes_whole_through_a_pipe(name: str):
    os.mkfifo(name)
    writing = threading.Thread(target=lambda: Path(name).write_text(SCRIPT, encoding="utf-8"))
    writing.start()
    result = argo("format", name, "--site", "darmstadt", status=0)
    writing.join()
    assert "2. Check checkpoint #1." in result.output


def test_an_endless_file_that_is_no_recording_is_refused():
    assert "is not an .mcap file" in refusal("replay {}", "/dev/zero")
