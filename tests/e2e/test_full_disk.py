"""Runs whose disk becomes full: they keep stored data, and go on or can be resumed."""

import re
from pathlib import Path

import pytest

from argo_compiler.il import Group, Mission
from tests.disks import small_disk
from tests.yard import measure, mission, waypoint, write_yard

pytestmark = pytest.mark.physics

_PAGE = 4096  # bytes


def mission_with_rounds(count: int) -> Mission:
    """Return a mission that measures checkpoint 2 in each of so many rounds."""
    group = Group(name="Round", start="A", end="MEASURE 2", max_repeat_count=count)
    return mission(measure(1), waypoint("A", 2.05, 2.05), measure(2), groups=(group,))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("full")
    write_yard(folder, plan=mission_with_rounds(6))
    return folder


RUN = ("run", "plan.json", "--site", "yard.yaml")


@pytest.fixture(scope="module")
def reference(argo, folder: Path) -> str:
    """Return the output of a run whose disk has enough room."""
    return printed_results(argo(*RUN, cwd=folder, status=0).stdout)


def printed_results(output: str) -> str:
    """Return the output of a command without its last lines, which name times and files."""
    return output[: output.index("Success: ")]


@pytest.mark.small_disk
def test_a_full_disk_ends_the_recording_but_not_the_run(argo, folder: Path, reference: str) -> None:
    with small_disk(20 * _PAGE) as disk:
        run = argo(*RUN, "--record", disk / "run.mcap", cwd=folder)
        shown = argo("replay", disk / "run.mcap", cwd=folder)
    assert run.returncode == 0, run.stderr
    assert printed_results(run.stdout) == reference
    ending = re.search(r"run\.mcap: the recording can't .* it ends at (\S+) s, and", run.stderr)
    assert ending
    assert f"run.mcap: it ends at {ending[1]} s: No space left on device" in run.stdout
    assert shown.returncode == 1
    assert f"breaks off after {ending[1]} s" in shown.stdout


@pytest.mark.small_disk
def test_a_run_is_resumed_once_its_journal_has_room_again(
    argo, folder: Path, reference: str
) -> None:
    with small_disk(60 * _PAGE) as disk:
        journal, other = disk / "run.journal", disk / "other"
        other.write_bytes(bytes(52 * _PAGE))
        broken = argo(*RUN, "--journal", journal, cwd=folder)
        other.unlink()
        resumed = argo("resume", journal, cwd=folder)
    assert broken.returncode == 2
    assert "the journal can't be written any further: No space left" in broken.stderr
    assert f"argo resume {journal}" in broken.stderr
    assert resumed.returncode == 0, resumed.stderr
    assert printed_readings(resumed.stdout) == printed_readings(reference)


def printed_readings(output: str) -> list[tuple[str, str]]:
    """Return names and values of readings, without times, which a restarted action may change."""
    return re.findall(r"(gauge \d).* (\S+ bar)", output)
