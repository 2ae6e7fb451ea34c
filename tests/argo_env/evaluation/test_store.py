"""Tests of rows on disk: no row is lost, no row is duplicated."""

import errno
import os
import random
import re
import shutil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_env.evaluation import parquet_files, store
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.parquet_files import write_part
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.store import LOG, RowStore, read_log, read_rows
from argo_env.files import checked_lines
from argo_env.files.checked_lines import checked_line


def row(number: int, **others) -> RunRow:
    """Return a row with this seed, of a successful run unless `others` says otherwise."""
    fields = {
        "key": f"{number:024x}", "mission": "m", "policy": "as written", "site": "umad",
        "robot": "tracker", "drive": "route", "sensor": "ideal", "faults": "none", "seed": number,
        "outcome": RunOutcome.SUCCESS, "reason": "done",
    }  # fmt: skip
    return RunRow(**(fields | others))


def store_rows(folder, *rows, compact=False):
    """Store the rows in a folder, in the log or in a Parquet file."""
    with RowStore(folder) as store:
        for new_row in rows:
            store.add_if_new(new_row)
        if compact:
            store.compact()


FULL = row(
    99,
    duration=12.5,
    limit=100.0,
    docked=False,
    failed=("A", "B"),
    detections=(
        FaultDetection(fault="brick", began=1.0, delay=None),
        FaultDetection(fault="gas_leak", began=2.0, delay=3.5),
    ),
    place=(1.0, 2.0, 3.0),
    floor=2,
    world={"speed": 0.9, "start 3": 1.25},
)


def test_rows_come_back_as_they_were(tmp_path):
    with RowStore(tmp_path) as rows:
        for new_row in (row(1), FULL):
            rows.add_if_new(new_row)
        assert read_rows(tmp_path) == (row(1), FULL)
        rows.compact()
        assert rows.uncompacted == 0
        rows.add_if_new(row(2))
    assert re.fullmatch(r"part-00001-[0-9a-f]{8}\.parquet", part_of(tmp_path).name)
    assert read_rows(tmp_path) == (row(1), FULL, row(2))
    with RowStore(tmp_path) as rows:
        assert list(rows.rows.values()) == [row(1), FULL, row(2)]
        assert rows.uncompacted == 1
        rows.compact()
    assert read_rows(tmp_path) == (row(1), FULL, row(2))


def test_pandas_reads_the_parquet_files(tmp_path):
    import pandas

    store_rows(tmp_path, FULL, compact=True)
    frame = pandas.read_parquet(tmp_path / "parts")
    assert frame.loc[0, "duration"] == 12.5
    assert list(frame.loc[0, "failed"]) == ["A", "B"]


def test_a_row_is_stored_once(tmp_path):
    store_rows(tmp_path, row(1), row(1))
    assert (tmp_path / LOG).read_bytes().count(b'"key"') == 1


@given(st.data())
def test_a_log_that_is_cut_anywhere_keeps_all_complete_rows(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("rows")
    store_rows(folder, *map(row, range(4)))
    content = (folder / LOG).read_bytes()
    cut = data.draw(st.integers(0, len(content)))
    (folder / LOG).write_bytes(content[:cut])
    complete = sum(b'"key"' in line for line in content[:cut].split(b"\n")[:-1])
    with RowStore(folder) as rows:
        assert [row.seed for row in rows.rows.values()] == list(range(complete))
        for number in range(4):
            rows.add_if_new(row(number))
    assert [row.seed for row in read_rows(folder)] == [0, 1, 2, 3]


def damage_line(folder, number):
    lines = (folder / LOG).read_bytes().splitlines(keepends=True)
    lines[number] = lines[number].replace(b"umad", b"amud")
    (folder / LOG).write_bytes(b"".join(lines))


def test_a_damaged_line_is_named_and_its_run_is_repeated(tmp_path):
    store_rows(tmp_path, *map(row, range(3)))
    damage_line(tmp_path, 1)
    with pytest.raises(
        Unavailable, match=r"rows\.log: damaged in line 2: evaluate again into this"
    ):
        read_rows(tmp_path)
    with RowStore(tmp_path) as rows:
        assert rows.loss == f"{tmp_path / LOG}: damaged in line 2"
        assert [row.seed for row in rows.rows.values()] == [0, 2]
        rows.add_if_new(row(1))
    assert {row.seed for row in read_rows(tmp_path)} == {0, 1, 2}
    with RowStore(tmp_path) as rows:
        assert not rows.loss


def test_a_page_that_was_not_synced_is_no_damage(tmp_path):
    """A loss of power leaves any of the pages that were not synced as zeros."""
    with RowStore(tmp_path, clock=lambda: 0.0) as rows:
        for number in range(3):
            rows.add_if_new(row(number))
        rows.sync()
        synced = (tmp_path / LOG).stat().st_size
        for number in range(3, 9):
            rows.add_if_new(row(number))
        content = (tmp_path / LOG).read_bytes()
    (tmp_path / LOG).write_bytes(content[:synced] + bytes(500) + content[synced + 500 :])
    seeds = [row.seed for row in read_rows(tmp_path)]
    assert seeds[:3] == [0, 1, 2]
    assert 3 < len(seeds) < 9
    with RowStore(tmp_path) as rows:
        assert "damaged in line 5, as by a loss of power" in rows.loss
        assert [row.seed for row in rows.rows.values()] == seeds
    lost = bytearray(content)
    lost[200:300] = bytes(100)
    (tmp_path / LOG).write_bytes(lost)
    with pytest.raises(Unavailable, match="damaged in line 1:"):
        read_rows(tmp_path)


def test_a_log_without_marks_is_read(tmp_path):
    """The lines of logs had no numbers."""
    old = [checked_line(row(k).model_dump(mode="json", exclude_defaults=True)) for k in range(3)]
    (tmp_path / LOG).write_bytes(b"".join(old))
    assert read_rows(tmp_path) == (row(0), row(1), row(2))
    store_rows(tmp_path, row(3))
    assert read_rows(tmp_path) == (row(0), row(1), row(2), row(3))
    (tmp_path / LOG).write_bytes(old[0] + b"x" + old[1] + old[2])
    with RowStore(tmp_path) as rows:
        assert "damaged in line 2" in rows.loss
        assert [*rows.rows.values()] == [row(0), row(2)]


def test_a_row_follows_one_that_found_no_room(tmp_path, monkeypatch):
    with RowStore(tmp_path) as rows:
        rows.add_if_new(row(0))
        write, room = os.write, [100]

        def write_until_full(file, data):
            if not room:
                raise OSError(errno.ENOSPC, "No space left on device")
            return write(file, data[: room.pop()])

        monkeypatch.setattr(os, "write", write_until_full)
        with pytest.raises(Unavailable, match="No space left"):
            rows.add_if_new(row(1))
        monkeypatch.undo()
        rows.add_if_new(row(2))
    assert read_rows(tmp_path) == (row(0), row(2))


def fail(*_: object) -> None:
    raise OSError(errno.EIO, "Input/output error")


def test_a_row_follows_one_that_could_not_be_removed(tmp_path, monkeypatch):
    with RowStore(tmp_path, clock=lambda: 0.0) as rows:
        rows.add_if_new(row(0))
        write = os.write
        with monkeypatch.context() as broken:
            broken.setattr(os, "ftruncate", fail)
            broken.setattr(
                os,
                "write",
                lambda file, data: write(file, data[:100]) if len(data) > 100 else fail(),
            )
            with pytest.raises(Unavailable, match="Input/output error"):
                rows.add_if_new(row(1))
        with monkeypatch.context() as broken:
            broken.setattr(os, "ftruncate", fail)
            with pytest.raises(Unavailable, match="Input/output error"):
                rows.add_if_new(row(1))
        rows.add_if_new(row(2))
    assert read_rows(tmp_path) == (row(0), row(2))


def test_rows_that_can_not_be_synced_are_an_error_and_leave_the_folder_unlocked(
    tmp_path, monkeypatch
):
    rows = RowStore(tmp_path)
    rows.add_if_new(row(0))
    monkeypatch.setattr(checked_lines, "sync_content", fail)
    with pytest.raises(Unavailable, match="Input/output error"):
        rows.close()
    monkeypatch.undo()
    with RowStore(tmp_path) as again:
        assert [*again.rows.values()] == [row(0)]


def free_descriptors() -> list[int]:
    """Return the lowest free descriptors of files."""
    files = [os.open(os.devnull, os.O_RDONLY) for _ in range(3)]
    for file in files:
        os.close(file)
    return files


def test_a_log_that_can_not_be_opened_leaves_no_file_open(tmp_path, monkeypatch):
    store_rows(tmp_path, row(0))
    free = free_descriptors()
    monkeypatch.setattr(store, "LineWriter", fail)
    with pytest.raises(Unavailable, match="Input/output error"):
        RowStore(tmp_path)
    assert free_descriptors() == free


def test_a_log_that_can_not_be_opened_again_leaves_the_folder_unlocked(tmp_path, monkeypatch):
    with RowStore(tmp_path) as rows:
        rows.add_if_new(row(0))
        rows.add_if_new(row(1))
        open_file = os.open
        monkeypatch.setattr(
            os,
            "open",
            lambda path, *others: (fail if path == tmp_path / LOG else open_file)(path, *others),
        )
        with pytest.raises(Unavailable, match="Input/output error"):
            rows.keep_only(lambda row: row.seed == 1)
        monkeypatch.undo()
    with RowStore(tmp_path) as again:
        assert [*again.rows.values()] == [row(1)]


def test_a_log_that_can_not_be_emptied_is_an_error_and_duplicates_no_row(tmp_path, monkeypatch):
    with RowStore(tmp_path) as rows:
        rows.add_if_new(row(0))
        monkeypatch.setattr(os, "ftruncate", fail)
        with pytest.raises(Unavailable, match=r"rows\.log: Input/output error"):
            rows.compact()
        monkeypatch.undo()
    assert read_rows(tmp_path) == (row(0),)


def test_a_kill_between_the_part_and_the_log_duplicates_no_row(tmp_path):
    store_rows(tmp_path, row(1), row(2))
    write_part(tmp_path, read_log(tmp_path).rows)  # the process is killed here
    assert [row.seed for row in read_rows(tmp_path)] == [1, 2]
    with RowStore(tmp_path) as rows:
        assert len(rows.rows) == 2
        rows.add_if_new(row(3))
        rows.compact()
    assert [row.seed for row in read_rows(tmp_path)] == [1, 2, 3]
    import pandas

    assert sorted(pandas.read_parquet(tmp_path / "parts")["seed"]) == [1, 2, 3]


def test_a_kill_while_a_part_is_written_leaves_the_rows_in_the_log(tmp_path):
    store_rows(tmp_path, row(1))
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / ".part-00001.parquet").write_bytes(b"PAR1 half of it")
    assert [row.seed for row in read_rows(tmp_path)] == [1]
    store_rows(tmp_path, compact=True)
    assert [row.seed for row in read_rows(tmp_path)] == [1]


def test_one_process_at_a_time(tmp_path):
    with (
        RowStore(tmp_path),
        pytest.raises(Conflict, match="another process evaluates into it"),
    ):
        RowStore(tmp_path)
    RowStore(tmp_path).close()


def test_without_pyarrow_rows_stay_in_the_log(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "can_write_parts", lambda: False)
    store_rows(tmp_path, row(1), compact=True)
    assert not (tmp_path / "parts").exists()
    assert read_rows(tmp_path) == (row(1),)
    monkeypatch.undo()
    store_rows(tmp_path, compact=True)
    monkeypatch.setattr(parquet_files, "can_write_parts", lambda: False)
    with pytest.raises(Unavailable, match=r"pip install .*\[results\]"):
        read_rows(tmp_path)


def part_of(folder):
    (part,) = (folder / "parts").iterdir()
    return part


def test_every_flipped_bit_of_a_part_is_damage(tmp_path):
    """Some bits change a row without any other trace; the headers of pages have no checksum."""
    store_rows(tmp_path, row(1), FULL, compact=True)
    path = part_of(tmp_path)
    content = path.read_bytes()
    rng = random.Random(14)
    for _ in range(100):
        damaged = bytearray(content)
        damaged[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged)
        with pytest.raises(
            Unavailable, match=r"parts/part-00001-.*\.parquet is damaged: its content"
        ):
            read_rows(tmp_path)
        with pytest.raises(
            Unavailable, match="restore it from a copy, or delete it and evaluate ag"
        ):
            RowStore(tmp_path)
    path.write_bytes(content)
    store_rows(tmp_path)  # the folder is not locked any more


def test_a_part_without_a_checksum_is_read(tmp_path):
    """Names of parts had no checksums."""
    store_rows(tmp_path, row(1), compact=True)
    path = part_of(tmp_path)
    old = path.rename(path.with_name("part-00001.parquet"))
    assert read_rows(tmp_path) == (row(1),)
    store_rows(tmp_path, row(2), compact=True)
    assert read_rows(tmp_path) == (row(1), row(2))
    content = old.read_bytes()
    for damaged in (content[:-8], content[:100], b"", bytes(len(content))):
        old.write_bytes(damaged)
        with pytest.raises(Unavailable, match=r"part-00001\.parquet is damaged: .*; restore it"):
            read_rows(tmp_path)
    old.write_bytes(content)
    again = old.with_name("part-00002.parquet")
    again.write_bytes(content)
    with pytest.raises(Unavailable, match="delete one of the two"):
        read_rows(tmp_path)


def test_a_part_whose_rows_make_no_sense_is_damaged(fault_inputs, tmp_path):
    (tmp_path / "parts").mkdir()
    shutil.copy(
        fault_inputs / "part-one-bit-flipped.parquet", tmp_path / "parts/part-00001.parquet"
    )
    with pytest.raises(Unavailable, match=r"part-00001\.parquet is damaged: column outcome: Input"):
        read_rows(tmp_path)


def test_the_files_are_private(tmp_path):
    store_rows(tmp_path, row(1), compact=True)
    store_rows(tmp_path, row(2))
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.stat().st_mode & 0o777 for path in files} == {0o600}


def test_a_folder_without_rows_is_refused(tmp_path):
    with pytest.raises(NotFound, match="has no rows"):
        read_rows(tmp_path)


def test_a_folder_that_can_not_be_written_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(Unavailable, match="can't be made a folder"):
        RowStore(tmp_path / "file" / "rows")
