"""A run does not depend on its recording: the recorded part stays, and a loss is reported."""

import os
import re

import pytest

from argo_compiler.base.errors import ArgoError
from argo_env.recording.files import BestEffortRecorder, recording_to
from argo_env.recording.reader import read_recording
from argo_env.run.observer import Observer
from argo_env.run.session import simulate
from tests.argo_env.recording.conftest import SPEC, as_stored
from tests.disks import fill, small_disk
from tests.yard import Watching, measure, mission, opened

SHORT = SPEC.model_copy(update={"mission": mission(measure(1)), "events": ()})
_PAGE = 4096  # bytes


def record_on(disk, navigator, *observers, spec=SPEC):
    """Record a run on the disk; return its record, the warnings and the loss."""
    warnings = []
    with recording_to(disk / "run.mcap", warn=warnings.append) as recorder:
        record = simulate(spec, opened(navigator), observers=[recorder, *observers])
    return record, warnings, recorder.loss


@pytest.mark.small_disk
@pytest.mark.physics
@pytest.mark.parametrize("share", [0.4, 0.8, 1.0])
def test_a_recording_ends_where_the_disk_is_full(recorded, yard, share) -> None:
    pages = int(share * (len(recorded.content) - 1) / _PAGE)
    with small_disk(pages * _PAGE) as disk:
        record, warnings, loss = record_on(disk, yard)
        recording = read_recording(disk / "run.mcap")
    assert record == recorded.record
    (warning,) = warnings
    assert "run.mcap: the recording can't be written any further: No space left" in warning
    assert f"it ends at {recording.until:g} s, and the run continues" in warning
    assert loss == f"it ends at {recording.until:g} s: No space left on device"
    assert recording.flaw
    assert recording.record in (None, as_stored(record))
    assert recording.readings == record.readings[: len(recording.readings)]


@pytest.mark.small_disk
@pytest.mark.physics
def test_a_run_succeeds_on_a_disk_that_is_full_from_the_first_step_on(yard) -> None:
    with small_disk(_PAGE) as disk:
        record, warnings, loss = record_on(disk, yard, spec=SHORT)
    assert record.result.success
    assert len(warnings) == 1
    assert loss == "it has nothing of the run: No space left on device"


@pytest.mark.small_disk
def test_a_disk_that_is_full_before_the_run_is_an_error(yard) -> None:
    with small_disk(_PAGE) as disk:
        fill(disk)
        with pytest.raises(ArgoError, match=r"run\.mcap: the recording can't be written.*No space"):
            record_on(disk, yard, spec=SHORT)


def test_a_best_effort_recorder_has_all_methods_of_observers() -> None:
    assert {n for n in vars(Observer) if n.startswith("on_")} <= vars(BestEffortRecorder).keys()


@pytest.mark.small_disk
@pytest.mark.physics
def test_a_recording_has_no_gap_if_space_becomes_free_again(recorded, yard) -> None:
    with small_disk(int(0.9 * len(recorded.content))) as disk:
        (disk / "other").write_bytes(bytes(len(recorded.content) // 3))

        def make_room(now, _):
            if now > 80.0:
                (disk / "other").unlink(missing_ok=True)

        record, _, loss = record_on(disk, yard, Watching(make_room))
        recording = read_recording(disk / "run.mcap")
    assert record == recorded.record
    assert loss.startswith(f"it ends at {recording.until:g} s")


@pytest.mark.physics
@pytest.mark.parametrize("kind", ["missing", "pipe"])
def test_a_run_is_recorded_without_a_source_that_can_not_be_read(yard, tmp_path, kind) -> None:
    source, warnings = tmp_path / "plan.txt", []
    if kind == "pipe":
        os.mkfifo(source)
    with recording_to(tmp_path / "run.mcap", source, warnings.append) as recorder:
        record = simulate(SHORT, opened(yard), observers=[recorder])
    assert read_recording(tmp_path / "run.mcap").record == as_stored(record)
    (warning,) = warnings
    assert re.match(r".*plan\.txt is not recorded with the run: ", warning)


@pytest.mark.physics
def test_all_files_of_a_folder_are_recorded_as_the_source(yard, tmp_path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text("what is in it")
    with recording_to(tmp_path / "run.mcap", bag) as recorder:
        simulate(SHORT, opened(yard), observers=[recorder])
    assert b"source/bag/metadata.yaml" in (tmp_path / "run.mcap").read_bytes()
