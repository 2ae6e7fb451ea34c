"""Tests of rows on disk: no row is lost, no row is duplicated."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_env.evaluation import parquet_files, store
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.parquet_files import write_part
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.store import LOG, RowStore, read_log, read_rows


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
    assert (tmp_path / "parts" / "part-00001.parquet").exists()
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
    assert len((tmp_path / LOG).read_bytes().splitlines()) == 1


@given(st.data())
def test_a_log_that_is_cut_anywhere_keeps_all_complete_rows(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("rows")
    store_rows(folder, *map(row, range(4)))
    content = (folder / LOG).read_bytes()
    cut = data.draw(st.integers(0, len(content)))
    (folder / LOG).write_bytes(content[:cut])
    complete = content[:cut].count(b"\n")
    with RowStore(folder) as rows:
        assert [row.seed for row in rows.rows.values()] == list(range(complete))
        for number in range(4):
            rows.add_if_new(row(number))
    assert [row.seed for row in read_rows(folder)] == [0, 1, 2, 3]


def test_a_damaged_line_is_left_out_and_counted(tmp_path):
    store_rows(tmp_path, *map(row, range(3)))
    lines = (tmp_path / LOG).read_bytes().splitlines(keepends=True)
    lines[1] = lines[1].replace(b"umad", b"amud")
    (tmp_path / LOG).write_bytes(b"".join(lines))
    with RowStore(tmp_path) as rows:
        assert rows.damaged == 1
        assert [row.seed for row in rows.rows.values()] == [0, 2]
        rows.add_if_new(row(1))
    assert {row.seed for row in read_rows(tmp_path)} == {0, 1, 2}


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


def test_a_damaged_part_is_named(tmp_path):
    store_rows(tmp_path, row(1), compact=True)
    path = tmp_path / "parts" / "part-00001.parquet"
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(Unavailable, match=r"part-00001\.parquet can't be read"):
        read_rows(tmp_path)


def test_a_folder_without_rows_is_refused(tmp_path):
    with pytest.raises(NotFound, match="has no rows"):
        read_rows(tmp_path)


def test_a_folder_that_can_not_be_written_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(Unavailable, match="can't be made a folder"):
        RowStore(tmp_path / "file" / "rows")
