"""Recordings read back: the same report, and the rest of files that are cut or damaged."""

import json
import os
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.limited_process import CallLimits, process_kept
from argo_env.recording import files, reader
from argo_env.recording.files import check_recording_path, recording_to
from argo_env.recording.reader import read_recording
from argo_env.report import write_report
from argo_env.run.journal import open_journal
from argo_env.run.session import resume, simulate
from argo_env.run.spec import RunSpec
from tests.argo_env.recording.conftest import PLAN, SPEC, as_stored
from tests.conftest import examples
from tests.yard import Watching, cut, opened

pytestmark = pytest.mark.physics

EMPTY = b"\x89MCAP0\r\n"


@pytest.fixture(autouse=True, scope="module")
def one_process():
    """Let one process read all recordings, as each start takes a second."""
    with process_kept():
        yield


def test_the_report_can_be_made_again(recorded, yard, tmp_path: Path) -> None:
    recording = recorded.decoded
    assert recording.record == recorded.stored
    assert recording.site == yard.site
    assert (recording.flaw, recording.facts["seed"]) == (None, "3")
    write_report(recorded.record, yard.site, tmp_path / "of the run")
    write_report(recording.record, recording.site, tmp_path / "again")
    for name in ("report.html", "report.json"):
        assert (tmp_path / "again" / name).read_bytes() == (
            tmp_path / "of the run" / name
        ).read_bytes()


def test_the_mission_is_attached(recorded) -> None:
    with recorded.file.open("rb") as stream:
        attached = {a.name: a.data for a in make_reader(stream).iter_attachments()}
    assert attached["source/plan.txt"] == b"the plan as a person wrote it"
    assert type(PLAN).model_validate_json(attached["mission.json"]) == PLAN
    settings = json.loads(attached["settings.json"])
    assert RunSpec.model_validate({"mission": PLAN, "site": "yard"} | settings) == SPEC
    assert b"<robot" in attached["tracker.urdf"]


def test_equal_runs_give_equal_files(recorded, record_run, tmp_path: Path) -> None:
    source = recorded.file.parent / "plan.txt"
    record_run(tmp_path / "again.mcap", source=source)
    assert (tmp_path / "again.mcap").read_bytes() == recorded.content
    record_run(tmp_path / "other.mcap", SPEC.model_copy(update={"seed": 4}), source=source)
    assert (tmp_path / "other.mcap").read_bytes() != recorded.content


def test_recording_does_not_change_a_run(recorded, yard) -> None:
    assert simulate(SPEC, opened(yard)) == recorded.record


def test_an_interrupted_run_is_recorded_with_its_record_so_far(yard, tmp_path: Path) -> None:
    checks, file = iter([False] * 200 + [True]), tmp_path / "run.mcap"
    with recording_to(file) as recorder:
        record = simulate(
            SPEC, opened(yard), observers=[recorder], interrupted=lambda: next(checks)
        )
    recording = read_recording(file)
    assert recording.record == as_stored(record)
    assert (recording.flaw, record.result.ended) == (None, False)


def test_a_resumed_run_is_recorded_with_the_record_of_all_of_it(
    recorded, yard, tmp_path: Path
) -> None:
    journal_file = tmp_path / "run.journal"
    whole = simulate(SPEC, opened(yard), journal=journal_file)
    assert whole == recorded.record
    cut(journal_file)
    file = tmp_path / "rest.mcap"
    with open_journal(journal_file) as journal, recording_to(file) as recorder:
        resumed_at = journal.entries[-1].t
        record = resume(journal, opened(yard), observers=[recorder])
    recording = read_recording(file)
    assert recording.record == as_stored(record)
    assert record.resumed == (resumed_at,)
    assert 0 < recording.messages["/pose"] < recorded.decoded.messages["/pose"]


@settings(deadline=None, max_examples=examples(40))
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_that_breaks_off_is_read_up_to_there(recorded, tmp_path_factory, share) -> None:
    cut = tmp_path_factory.mktemp("cut") / "cut.mcap"
    cut.write_bytes(recorded.content[: int(share * len(recorded.content))])
    recording = _read_or_none(cut)
    if recording is None:
        assert share < 0.5, "half of the file has the start of the run"
        return
    assert recording.flaw
    assert recording.record in (None, recorded.stored)
    for name in ("readings", "tasks"):
        rest, all_ = getattr(recording, name), getattr(recorded.stored, name)
        assert rest == all_[: len(rest)]
    assert 0.0 <= recording.until <= recorded.record.result.duration
    if recording.record is None:
        with pytest.raises(ArgoError, match=rf"breaks off after {recording.until:g} s"):
            recording.require_record()


def test_a_file_that_breaks_off_lacks_at_most_ten_seconds(recorded) -> None:
    """Messages that are not on disk yet are in the last chunk; none is longer than ten seconds."""
    with recorded.file.open("rb") as stream:
        chunks = make_reader(stream).get_summary().chunk_indexes
    assert len(chunks) >= recorded.record.result.duration / 10.1
    for chunk in chunks:
        assert chunk.message_end_time - chunk.message_start_time <= 10.1e9


@settings(deadline=None, max_examples=examples(40))
@given(st.data())
def test_a_damaged_file_is_refused_or_read_correctly(recorded, tmp_path_factory, data) -> None:
    content = bytearray(recorded.content)
    position = data.draw(st.integers(0, len(content) - 1))
    content[position] ^= data.draw(st.integers(1, 255))
    damaged = tmp_path_factory.mktemp("damaged") / "damaged.mcap"
    damaged.write_bytes(content)
    recording = _read_or_none(damaged)
    assert recording is None or (recording.flaw and recording.record in (None, recorded.stored))


def test_all_damage_to_the_end_is_noticed(recorded, tmp_path: Path) -> None:
    """Bytes of the index, the footer and the magic after it are changed, lost or blank."""
    file, whole = tmp_path / "damaged.mcap", recorded.content
    contents = []
    for k in (1, 8, 9, 12, 13, 20, 29, 37, 38, 60, 290):
        contents += [whole[:-k], whole[:-k] + bytes(k)]
        contents.append(whole[:-k] + bytes([whole[-k] ^ 1]) + whole[len(whole) - k + 1 :])
    for content in contents:
        file.write_bytes(content)
        recording = read_recording(file)
        assert recording.flaw == "has a missing or damaged index"
        assert recording.record == recorded.stored


def test_bytes_after_the_end_are_counted(recorded, tmp_path: Path) -> None:
    file, whole = tmp_path / "longer.mcap", recorded.content
    for more, number in (
        (b"\0", "1 more byte"), (b"\r\n", "2 more bytes"), (whole, f"{len(whole)} more bytes"),
    ):  # fmt: skip
        file.write_bytes(whole + more)
        recording = read_recording(file)
        assert recording.flaw == f"has {number} after its end"
        assert recording.record == recorded.stored


def test_a_file_without_its_middle_is_refused_with_a_reason(recorded, tmp_path: Path) -> None:
    file, whole = tmp_path / "spliced.mcap", recorded.content
    for share in (0.3, 0.5, 0.7):
        file.write_bytes(whole[: int(share * len(whole))] + whole[-8:])
        with pytest.raises(ArgoError, match=r"is damaged after [\d.]+ s \(\w.*\): restore it"):
            read_recording(file)


def test_a_damaged_record_is_not_read(recorded, tmp_path: Path) -> None:
    """Without its end, the file has no checksum of all data, but the record has one of its own."""
    file, whole = tmp_path / "damaged.mcap", recorded.content
    position = whole.rindex(b'"verdict"')
    damaged = whole[:position] + b'"verDict"' + whole[position + 9 :]
    file.write_bytes(damaged)
    with pytest.raises(ArgoError, match=r"is damaged after .* \(the checksum of record.json"):
        read_recording(file)
    file.write_bytes(damaged[:-9])
    recording = read_recording(file)
    assert recording.record is None
    assert "record.json is wrong" in recording.reason_if_record_missing


def _read_or_none(path: Path):
    """Return the recording; None if it is refused with a message that names the file."""
    try:
        return read_recording(path)
    except ArgoError as error:
        message = str(error)
    assert str(path) in message
    return None


@settings(deadline=None, max_examples=examples(40))
@given(st.binary(max_size=200), st.booleans())
def test_foreign_bytes_are_refused(tmp_path_factory, noise, marked) -> None:
    foreign = tmp_path_factory.mktemp("foreign") / "foreign.mcap"
    foreign.write_bytes(EMPTY + noise if marked else noise)
    with pytest.raises(ArgoError, match=r"a run was recorded in|is damaged"):
        read_recording(foreign)


def test_another_tools_recording_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/readings", "json", 0)
        writer.add_message(channel, 0, b"{}", 0)
        writer.finish()
    with pytest.raises(ArgoError, match="is not a recording of Argo's"):
        read_recording(path)
    with pytest.raises(ArgoError, match="there is no such recording"):
        read_recording(tmp_path / "none.mcap")
    with pytest.raises(ArgoError, match="is a folder"):
        read_recording(tmp_path)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory")
def test_a_small_recording_that_unpacks_to_much_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=40_000_000)
        writer.start()
        channel = writer.register_channel("/readings", "json", 0)
        for number in range(12):
            writer.add_message(channel, number, bytes(45_000_000), 0)
        writer.finish()
    assert path.stat().st_size < 1_000_000
    with pytest.raises(
        ArgoError, match=r"bomb\.mcap takes more than 40. MB of memory to read: name"
    ):
        read_recording(path)


def test_a_chunk_larger_than_any_is_damage(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "chunk.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/readings", "json", 0)
        writer.add_message(channel, 0, bytes(2_000), 0)
        writer.finish()
    monkeypatch.setattr(reader, "MAX_CHUNK_BYTES", 1_000)
    with pytest.raises(ArgoError, match=r"is damaged after 0 s \(a chunk has 20\d\d bytes\)"):
        reader.read_recording_here(path, str(path))


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such files")
def test_a_recording_that_is_open_already_is_read(recorded) -> None:
    with recorded.file.open("rb") as file:
        assert read_recording(Path(f"/dev/fd/{file.fileno()}")).record == recorded.stored


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such files")
def test_a_recording_that_takes_too_long_is_refused(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "endless.mcap"
    os.mkfifo(path)
    monkeypatch.setattr(reader, "limits_for_size", lambda _, **__: CallLimits(0.1, 400_000_000))
    with pytest.raises(
        ArgoError, match=r"endless\.mcap takes longer than 1 s to read: name a file"
    ):
        read_recording(path)


def test_a_file_that_can_not_be_written_is_an_error(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "folder.mcap").mkdir()
    for name, message in (
        ("run.bag", "name it so"), ("folder.mcap", "is a folder"),
        ("no/run.mcap", "folder .* does not exist"),
    ):  # fmt: skip
        with pytest.raises(ArgoError, match=message):
            check_recording_path(tmp_path / name)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder.mcap"], "nothing is made yet"
    monkeypatch.setattr(files, "find_spec", lambda name: None if name == "mcap" else object())
    with pytest.raises(ArgoError, match=r"need mcap: pip install .*\[recording\]"):
        check_recording_path(tmp_path / "run.mcap")


def test_the_recording_of_a_failed_run_can_be_read(yard, tmp_path: Path) -> None:
    def fail(now, _):
        if now > 30.0:
            raise RuntimeError("the plug was pulled")

    file = tmp_path / "failed.mcap"
    with pytest.raises(RuntimeError, match="plug"), recording_to(file) as recorder:
        simulate(SPEC, opened(yard), observers=[recorder, Watching(fail)])
    recording = read_recording(file)
    assert (recording.flaw, recording.record) == (None, None)
    assert recording.until == pytest.approx(30.1)
    with pytest.raises(ArgoError, match=r"the run broke off after 30\.1 s"):
        recording.require_record()
