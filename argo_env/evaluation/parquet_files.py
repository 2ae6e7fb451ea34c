"""Parquet files of rows. They need pyarrow, which is not part of the base install."""

import os
import re
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.base.operating_system import sync_folder
from argo_env.evaluation.row import RunRow

if TYPE_CHECKING:
    import pyarrow

PARTS = "parts"
_PART_NAME = re.compile(r"part-(\d+)\.parquet")


def can_write_parts() -> bool:
    """Return True if pyarrow is installed."""
    return find_spec("pyarrow") is not None


def has_parts(folder: Path) -> bool:
    """Return True if the folder of an evaluation has Parquet files of rows."""
    return bool(_part_numbers(folder))


def write_part(folder: Path, rows: Sequence[RunRow]) -> Path:
    """Write rows to a new file atomically: the file is complete or does not exist.

    Raises Unavailable if it can't be written.
    """
    import pyarrow
    from pyarrow import parquet

    parts = folder / PARTS
    path = _part_path(folder, max(_part_numbers(folder), default=0) + 1)
    draft = parts / f".{path.name}"
    table = pyarrow.Table.from_pylist([_to_record(row) for row in rows], schema=_schema())
    try:
        parts.mkdir(exist_ok=True)
        parquet.write_table(table, draft)
        with open(draft, "rb") as file:
            os.fsync(file.fileno())
        os.replace(draft, path)
        sync_folder(parts)
    except OSError as error:
        raise Unavailable(f"{path} can't be written: {error}") from error
    return path


def read_parts(folder: Path) -> tuple[RunRow, ...]:
    """Read the rows of all Parquet files in the folder, in the order in which they were written.

    Raises Unavailable if there are files, and pyarrow is missing or one of them can't be read.
    """
    numbers = _part_numbers(folder)
    if not numbers:
        return ()
    if not can_write_parts():
        raise Unavailable(
            f"{folder / PARTS}: reading Parquet files needs pyarrow: {install_line('results')}"
        )
    from pyarrow import ArrowInvalid, parquet

    rows: list[RunRow] = []
    for number in numbers:
        path = _part_path(folder, number)
        try:
            # Reading it as a dataset would make a column of the folder's name.
            records = parquet.ParquetFile(path).read().to_pylist(maps_as_pydicts="strict")
        except (OSError, ArrowInvalid) as error:
            raise Unavailable(f"{path} can't be read: {error}") from error
        rows += [RunRow.model_validate(record) for record in records]
    return tuple(rows)


def remove_parts(folder: Path) -> None:
    """Remove all Parquet files from the folder. Raises Unavailable if that fails."""
    try:
        for number in _part_numbers(folder):
            os.unlink(_part_path(folder, number))
    except OSError as error:
        raise Unavailable(f"{folder / PARTS} can't be changed: {error.strerror}") from error


def _part_path(folder: Path, number: int) -> Path:
    return folder / PARTS / f"part-{number:05d}.parquet"


def _part_numbers(folder: Path) -> list[int]:
    try:
        names = os.listdir(folder / PARTS)
    except FileNotFoundError:
        return []
    except OSError as error:
        raise Unavailable(f"{folder / PARTS} can't be read: {error.strerror}") from error
    return sorted(int(match[1]) for name in names if (match := _PART_NAME.fullmatch(name)))


def _to_record(row: RunRow) -> dict[str, Any]:
    return row.model_dump(mode="json")


def _schema() -> "pyarrow.Schema":
    import pyarrow as pa

    text, number, count = pa.string(), pa.float64(), pa.int64()
    detection = pa.struct([("fault", text), ("began", number), ("delay", number)])
    kinds = {
        "docked": pa.bool_(),
        "failed": pa.list_(text),
        "detections": pa.list_(detection),
        "place": pa.list_(number),
        "world": pa.map_(text, number),
    }
    plain = {str: text, float: number, int: count}
    fields = []
    for name, field in RunRow.model_fields.items():
        kind = kinds.get(name)
        if kind is None:
            kind = next((plain[t] for t in plain if t.__name__ in str(field.annotation)), text)
        fields.append((name, kind))
    return pa.schema(fields)
