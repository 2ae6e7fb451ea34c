"""Runs whose disk becomes full lose nothing that was there, and nothing that can be made again."""

import re
from pathlib import Path

import pytest

from argo_compiler.il import Group, Mission
from tests.disks import small_disk
from tests.yard import measure, mission, waypoint, write_yard

_PAGE = 4096  # bytes


def rounds(count: int) -> Mission:
    """A mission that measures a checkpoint so often."""
    group = Group(name="Round", start="A", end="MEASURE 2", max_repeat_count=count)
    return mission(measure(1), waypoint("A", 2.05, 2.05), measure(2), groups=(group,))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("full")
    write_yard(folder, plan=rounds(6))
    return folder


RUN = ("run", "plan.json", "--site", "yard.yaml")


@pytest.fixture(scope="module")
def reference(argo, folder: Path) -> str:
    """What is said of the run with room for all."""
    return results(argo(*RUN, cwd=folder, status=0).stdout)


def results(output: str) -> str:
    """Return what a command printed of the run, without the lines on its own time and files."""
    return output[: output.index("Success: ")]


def test_a_recording_is_dropped_and_the_run_goes_on(argo, folder: Path, reference: str) -> None:
    with small_disk(20 * _PAGE) as disk:
        run = argo(*RUN, "--record", disk / "run.mcap", cwd=folder)
        shown = argo("replay", disk / "run.mcap", cwd=folder)
    assert run.returncode == 0, run.stderr
    assert results(run.stdout) == reference
    said = re.search(r"run\.mcap: the recording can't .* it ends at (\S+) s, and", run.stderr)
    assert said
    assert f"run.mcap: it ends at {said[1]} s: No space left on device" in run.stdout
    assert shown.returncode == 1
    assert f"breaks off after {said[1]} s" in shown.stdout


def test_a_journal_goes_on_where_there_is_room_again(argo, folder: Path, reference: str) -> None:
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
    assert readings(resumed.stdout) == readings(reference)


def readings(output: str) -> list[tuple[str, str]]:
    """Without their times, which an action that began anew may change."""
    return re.findall(r"(gauge \d).* (\S+ bar)", output)
