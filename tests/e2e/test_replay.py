"""Recordings that the command makes and replays, also those of killed processes."""

import re
import subprocess
from pathlib import Path

import pytest

from argo_env.recording.reader import read_recording
from tests.e2e.conftest import start_argo
from tests.e2e.test_errors import require_refusal
from tests.e2e.test_full_disk import mission_with_rounds, printed_results
from tests.yard import measure, mission, waypoint, write_yard

SHORT = mission(measure(1), waypoint("A", 2.05, 2.05))
LONG = mission_with_rounds(400)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("replay")
    write_yard(folder, short=SHORT, long=LONG)
    return folder


def reports_equal(a: Path, b: Path) -> bool:
    """Return True if two folders have the same reports, apart from the journal of a run in `a`."""
    names = sorted(p.name for p in a.iterdir() if p.suffix != ".journal")
    assert names == sorted(p.name for p in b.iterdir())
    return all((a / name).read_bytes() == (b / name).read_bytes() for name in names)


@pytest.mark.long
@pytest.mark.physics
def test_replay_makes_the_output_report_and_film_of_the_run_again(argo, folder: Path) -> None:
    run = ("run", "short.json", "--site", "yard.yaml", "--seed", 3)
    made_of_it = ("--report", "report", "--render", "film.gif")
    first = argo(*run, "--record", "run.mcap", *made_of_it, cwd=folder, status=0)
    assert "Recording: run.mcap" in first.stdout
    argo(*run, "--record", "2.mcap", cwd=folder, status=0)
    assert (folder / "2.mcap").read_bytes() == (folder / "run.mcap").read_bytes()
    # The recording replaces the files of the mission and the site.
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    (folder / "run.mcap").rename(elsewhere / "run.mcap")
    made = argo("replay", "run.mcap", *made_of_it, cwd=elsewhere, status=0)
    assert printed_results(made.stdout) == printed_results(first.stdout)
    assert reports_equal(folder / "report", elsewhere / "report")
    assert (folder / "film.gif").read_bytes() == (elsewhere / "film.gif").read_bytes()
    # A damaged end is reported, but does not change the results.
    content = (elsewhere / "run.mcap").read_bytes()
    (elsewhere / "run.mcap").write_bytes(content[:-40] + b"damaged" + content[-33:])
    noticed = argo("replay", "run.mcap", cwd=elsewhere)
    assert (noticed.returncode, printed_results(noticed.stdout)) == (
        0,
        printed_results(first.stdout),
    )
    assert "Warning: run.mcap has a missing or damaged index; the record" in noticed.stderr
    (elsewhere / "run.mcap").write_bytes(content[: len(content) // 2] + b"?" + content)
    assert "run.mcap is damaged after" in require_refusal(argo("replay", "run.mcap", cwd=elsewhere))


@pytest.mark.long
@pytest.mark.physics
def test_a_killed_run_can_be_replayed_up_to_the_kill(argo, folder: Path) -> None:
    with start_argo(
        "run", "long.json", "--site", "yard.yaml", "--record", "killed.mcap",
        "--journal", "killed.journal", cwd=folder, stdout=subprocess.DEVNULL,
    ) as process:  # fmt: skip
        readings = 0
        while readings < 5:
            line = process.stderr.readline()
            assert line, "the run has ended before it was killed"
            readings += "shows" in line
        process.kill()
    recording = read_recording(folder / "killed.mcap")
    assert (recording.flaw is None, recording.record) == (False, None)
    # A reading takes about ten seconds of simulated time, after which the recording is on disk.
    assert len(recording.readings) >= 3
    shown = argo("replay", "killed.mcap", cwd=folder)
    text = re.sub(r"\s+", " ", shown.stdout)
    assert (shown.returncode, shown.stderr) == (1, "")
    assert "gauge 1 (#1) shows" in text
    assert f"breaks off after {recording.until:g} s" in text
    unreported = argo("replay", "killed.mcap", "--report", "none", cwd=folder)
    assert "has no record of the run" in require_refusal(unreported)
    assert not (folder / "none").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "short.json", "--record", "run.bag"), "name it so"),
        (("replay", "short.json"), "is not an .mcap file"),
        (("replay", "short.json", "--render", "film.avi"), "a film is an .mp4 or a .gif"),
    ],
)
def test_wrong_kinds_of_files_are_refused(argo, folder: Path, arguments, message) -> None:
    assert message in require_refusal(argo(*arguments, cwd=folder))
