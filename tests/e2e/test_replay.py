"""Recordings made and replayed by the command, also of processes that are killed."""

import re
import subprocess
from pathlib import Path

import pytest

from argo_env.recording.reader import read_recording
from tests.e2e.conftest import started
from tests.e2e.test_errors import refused
from tests.e2e.test_full_disk import results, rounds
from tests.yard import measure, mission, waypoint, write_yard

SHORT = mission(measure(1), waypoint("A", 2.05, 2.05))
LONG = rounds(400)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("replay")
    write_yard(folder, short=SHORT, long=LONG)
    return folder


def same_files(a: Path, b: Path) -> bool:
    """Whether the reports are the same; only a run has a journal."""
    names = sorted(p.name for p in a.iterdir() if p.suffix != ".journal")
    assert names == sorted(p.name for p in b.iterdir())
    return all((a / name).read_bytes() == (b / name).read_bytes() for name in names)


def test_replay_shows_and_makes_again_what_the_run_did(argo, folder: Path) -> None:
    run = ("run", "short.json", "--site", "yard.yaml", "--seed", 3)
    made_of_it = ("--report", "report", "--render", "film.gif")
    first = argo(*run, "--record", "run.mcap", *made_of_it, cwd=folder, status=0)
    assert "Recording: run.mcap" in first.stdout
    argo(*run, "--record", "2.mcap", cwd=folder, status=0)
    assert (folder / "2.mcap").read_bytes() == (folder / "run.mcap").read_bytes()
    # Without the files of the mission and the site: the recording has all of it.
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    (folder / "run.mcap").rename(elsewhere / "run.mcap")
    made = argo("replay", "run.mcap", *made_of_it, cwd=elsewhere, status=0)
    assert results(made.stdout) == results(first.stdout)
    assert same_files(folder / "report", elsewhere / "report")
    assert (folder / "film.gif").read_bytes() == (elsewhere / "film.gif").read_bytes()
    # A damaged end is said, and changes nothing of what is shown.
    content = (elsewhere / "run.mcap").read_bytes()
    (elsewhere / "run.mcap").write_bytes(content[:-40] + b"damaged" + content[-33:])
    noticed = argo("replay", "run.mcap", cwd=elsewhere)
    assert (noticed.returncode, results(noticed.stdout)) == (0, results(first.stdout))
    assert "Warning: run.mcap has a missing or damaged index; the record" in noticed.stderr
    (elsewhere / "run.mcap").write_bytes(content[: len(content) // 2] + b"?" + content)
    assert "run.mcap: is damaged after" in refused(argo("replay", "run.mcap", cwd=elsewhere))


def test_a_run_that_is_killed_can_be_replayed_up_to_there(argo, folder: Path) -> None:
    with started(
        "run", "long.json", "--site", "yard.yaml", "--record", "killed.mcap",
        "--journal", "killed.journal", cwd=folder, stdout=subprocess.DEVNULL,
    ) as process:  # fmt: skip
        told = 0
        while told < 5:
            line = process.stderr.readline()
            assert line, "it has ended before it was killed"
            told += "shows" in line
        process.kill()
    found = read_recording(folder / "killed.mcap")
    assert (found.flaw is None, found.record) == (False, None)
    # One reading takes about ten seconds of simulated time, after which all is on disk.
    assert len(found.readings) >= 3
    shown = argo("replay", "killed.mcap", cwd=folder)
    text = re.sub(r"\s+", " ", shown.stdout)
    assert (shown.returncode, shown.stderr) == (1, "")
    assert "gauge 1 (#1) shows" in text
    assert f"breaks off after {found.until:g} s" in text
    unreported = argo("replay", "killed.mcap", "--report", "none", cwd=folder)
    assert "has no record of the run" in refused(unreported)
    assert not (folder / "none").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("run", "short.json", "--record", "run.bag"), "name it so"),
        (("replay", "short.json"), "is no .mcap file"),
        (("replay", "short.json", "--render", "film.avi"), "a film is an .mp4 or a .gif"),
    ],
)
def test_what_is_refused(argo, folder: Path, arguments, says) -> None:
    assert says in refused(argo(*arguments, cwd=folder))
