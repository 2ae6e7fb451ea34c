"""Recordings read back: the same report, and what is left of files that are cut or damaged."""

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from argo_compiler.base.errors import ArgoError
from argo_env.recording import files
from argo_env.recording.files import check_recording, recording_to
from argo_env.recording.reader import read_recording
from argo_env.report import write_report
from argo_env.run.journal import open_journal
from argo_env.run.session import resume, simulate
from argo_env.run.spec import RunSpec
from tests.argo_env.recording.conftest import PLAN, SPEC
from tests.conftest import examples
from tests.yard import Watching, cut, opened

EMPTY = b"\x89MCAP0\r\n"


def test_the_report_can_be_made_again(recorded, yard, tmp_path: Path) -> None:
    found = recorded.found
    assert found.record == recorded.record
    assert found.site == yard.site
    assert (found.flaw, found.facts["seed"]) == (None, "3")
    write_report(recorded.record, yard.site, tmp_path / "of the run")
    write_report(found.record, found.site, tmp_path / "again")
    for name in ("report.html", "report.json"):
        assert (tmp_path / "again" / name).read_bytes() == (
            tmp_path / "of the run" / name
        ).read_bytes()


def test_the_mission_is_in_it(recorded) -> None:
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


def test_a_recorded_run_is_the_run_without_a_recorder(recorded, yard) -> None:
    assert simulate(SPEC, opened(yard)) == recorded.record


def test_an_interrupted_run_is_recorded_with_its_record_as_it_stands(yard, tmp_path: Path) -> None:
    looks, file = iter([False] * 200 + [True]), tmp_path / "run.mcap"
    with recording_to(file) as recorder:
        record = simulate(SPEC, opened(yard), observers=[recorder], interrupted=lambda: next(looks))
    found = read_recording(file)
    assert found.record == record
    assert (found.flaw, record.result.ended) == (None, False)


def test_a_resumed_run_is_recorded_with_the_record_of_all_of_it(
    recorded, yard, tmp_path: Path
) -> None:
    place = tmp_path / "run.journal"
    whole = simulate(SPEC, opened(yard), journal=place)
    assert whole == recorded.record
    cut(place)
    file = tmp_path / "rest.mcap"
    with open_journal(place) as journal, recording_to(file) as recorder:
        gone_on_at = journal.entries[-1].t
        record = resume(journal, opened(yard), observers=[recorder])
    found = read_recording(file)
    assert found.record == record
    assert record.resumed == (gone_on_at,)
    assert 0 < found.messages["/pose"] < recorded.found.messages["/pose"]


@settings(deadline=None, max_examples=examples(40))
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_that_breaks_off_is_read_up_to_there(recorded, tmp_path_factory, share) -> None:
    cut = tmp_path_factory.mktemp("cut") / "cut.mcap"
    cut.write_bytes(recorded.content[: int(share * len(recorded.content))])
    found = _read_or_refused(cut)
    if found is None:
        assert share < 0.5, "the first part of the run has been read by then"
        return
    assert found.flaw
    assert found.record in (None, recorded.record)
    for name in ("readings", "tasks"):
        rest, all_ = getattr(found, name), getattr(recorded.record, name)
        assert rest == all_[: len(rest)]
    assert 0.0 <= found.until <= recorded.record.result.duration
    if found.record is None:
        with pytest.raises(ArgoError, match=rf"breaks off after {found.until:g} s"):
            found.require_record()


def test_little_is_lost_of_what_breaks_off(recorded) -> None:
    """What is not on disk yet is in the last chunk, and no chunk holds more than ten seconds."""
    with recorded.file.open("rb") as stream:
        chunks = make_reader(stream).get_summary().chunk_indexes
    assert len(chunks) >= recorded.record.result.duration / 10.1
    for chunk in chunks:
        assert chunk.message_end_time - chunk.message_start_time <= 10.1e9


@settings(deadline=None, max_examples=examples(40))
@given(st.data())
def test_a_damaged_file_is_refused_or_read_as_it_was(recorded, tmp_path_factory, data) -> None:
    content = bytearray(recorded.content)
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] ^= data.draw(st.integers(1, 255))
    damaged = tmp_path_factory.mktemp("damaged") / "damaged.mcap"
    damaged.write_bytes(content)
    found = _read_or_refused(damaged)
    assert found is None or (found.flaw and found.record in (None, recorded.record))


def test_no_damage_to_the_end_goes_unnoticed(recorded, tmp_path: Path) -> None:
    """In the index, the footer and the mark after it: changed, lost and blank."""
    file, whole = tmp_path / "damaged.mcap", recorded.content
    contents = []
    for k in (1, 8, 9, 12, 13, 20, 29, 37, 38, 60, 290):
        contents += [whole[:-k], whole[:-k] + bytes(k)]
        contents.append(whole[:-k] + bytes([whole[-k] ^ 1]) + whole[len(whole) - k + 1 :])
    for content in contents:
        file.write_bytes(content)
        found = read_recording(file)
        assert found.flaw == "has a missing or damaged index"
        assert found.record == recorded.record


def test_what_follows_after_the_end_is_told_as_that(recorded, tmp_path: Path) -> None:
    file, whole = tmp_path / "longer.mcap", recorded.content
    for more, said in ((b"\0", "1 byte"), (b"\r\n", "2 bytes"), (whole, f"{len(whole)} bytes")):
        file.write_bytes(whole + more)
        found = read_recording(file)
        assert found.flaw == f"goes on for {said} after its end"
        assert found.record == recorded.record


def test_a_part_cut_out_of_the_middle_is_told_with_a_reason(recorded, tmp_path: Path) -> None:
    file, whole = tmp_path / "spliced.mcap", recorded.content
    for share in (0.3, 0.5, 0.7):
        file.write_bytes(whole[: int(share * len(whole))] + whole[-8:])
        with pytest.raises(ArgoError, match=r"is damaged after [\d.]+ s \(\w.*\): take it"):
            read_recording(file)


def test_a_damaged_record_is_none(recorded, tmp_path: Path) -> None:
    """Also where the file has no end, by the checksum of which that would be seen."""
    file, whole = tmp_path / "damaged.mcap", recorded.content
    place = whole.rindex(b'"verdict"')
    damaged = whole[:place] + b'"verDict"' + whole[place + 9 :]
    file.write_bytes(damaged)
    with pytest.raises(ArgoError, match=r"is damaged after .* \(the checksum of record.json"):
        read_recording(file)
    file.write_bytes(damaged[:-9])
    found = read_recording(file)
    assert found.record is None
    assert "record.json is wrong" in found.loss


def _read_or_refused(path: Path):
    """What has been read, or None if that was refused, with the name of the file."""
    try:
        return read_recording(path)
    except ArgoError as refusal:
        said = str(refusal)
    assert str(path) in said
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
    with pytest.raises(ArgoError, match="is no recording of Argo's"):
        read_recording(path)
    with pytest.raises(ArgoError, match="there is no such recording"):
        read_recording(tmp_path / "none.mcap")
    with pytest.raises(ArgoError, match="is a folder"):
        read_recording(tmp_path)


def test_where_no_recording_can_be_written(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "folder.mcap").mkdir()
    for name, says in (
        ("run.bag", "name it so"), ("folder.mcap", "is a folder"),
        ("no/run.mcap", "folder .* does not exist"),
    ):  # fmt: skip
        with pytest.raises(ArgoError, match=says):
            check_recording(tmp_path / name)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder.mcap"], "nothing is made yet"
    monkeypatch.setattr(files, "find_spec", lambda name: None if name == "mcap" else object())
    with pytest.raises(ArgoError, match=r"need mcap: pip install .*\[recording\]"):
        check_recording(tmp_path / "run.mcap")


def test_a_run_that_fails_leaves_what_was_recorded(yard, tmp_path: Path) -> None:
    def fail(now, _):
        if now > 30.0:
            raise RuntimeError("the plug was pulled")

    file = tmp_path / "failed.mcap"
    with pytest.raises(RuntimeError, match="plug"), recording_to(file) as recorder:
        simulate(SPEC, opened(yard), observers=[recorder, Watching(fail)])
    found = read_recording(file)
    assert (found.flaw, found.record) == (None, None)
    assert found.until == pytest.approx(30.1)
    with pytest.raises(ArgoError, match=r"the run broke off after 30\.1 s"):
        found.require_record()
