"""Parquet files of rows. What is imported for them is not part of the base install."""

import os
import re
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_env.evaluation.row import RunRow
from argo_env.files.checked_lines import sync_folder

if TYPE_CHECKING:
    import pyarrow

PARTS = "parts"
_NAME = re.compile(r"part-(\d+)\.parquet")


def can_write_parts() -> bool:
    """Whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def has_parts(folder: Path) -> bool:
    """Whether rows have been moved to Parquet files in the folder of an evaluation."""
    return bool(_numbers(folder))


def write_part(folder: Path, rows: Sequence[RunRow]) -> Path:
    """Writes rows to one more file, which is whole or not there. Raises Unavailable where that
    can't be done."""
    import pyarrow
    from pyarrow import parquet

    parts = folder / PARTS
    path = _part(folder, max(_numbers(folder), default=0) + 1)
    draft = parts / f".{path.name}"
    table = pyarrow.Table.from_pylist([_plain(row) for row in rows], schema=_schema())
    try:
        parts.mkdir(exist_ok=True)
        parquet.write_table(table, draft)
        with open(draft, "rb") as file:
            os.fsync(file.fileno())
        os.replace(draft, path)
        sync_folder(parts)
    except OSError as error:
        raise Unavailable(f"{path}: can't be written: {error}") from error
    return path


def read_parts(folder: Path) -> tuple[RunRow, ...]:
    """The rows in all files, in the order in which they were written.

    Raises Unavailable if there are any, and pyarrow is missing or one can't be read.
    """
    numbers = _numbers(folder)
    if not numbers:
        return ()
    if not can_write_parts():
        raise Unavailable(
            f"{folder / PARTS}: reading Parquet files needs pyarrow: {install_line('results')}"
        )
    from pyarrow import ArrowInvalid, parquet

    rows: list[RunRow] = []
    for number in numbers:
        path = _part(folder, number)
        try:
            # Not as a dataset, which would take the folder for a column.
            plain = parquet.ParquetFile(path).read().to_pylist(maps_as_pydicts="strict")
        except (OSError, ArrowInvalid) as error:
            raise Unavailable(f"{path}: can't be read: {error}") from error
        rows += [RunRow.model_validate(one) for one in plain]
    return tuple(rows)


def remove_parts(folder: Path) -> None:
    """Removes all files. Raises Unavailable where that can't be done."""
    try:
        for number in _numbers(folder):
            os.unlink(_part(folder, number))
    except OSError as error:
        raise Unavailable(f"{folder / PARTS}: can't be changed: {error.strerror}") from error


def _part(folder: Path, number: int) -> Path:
    return folder / PARTS / f"part-{number:05d}.parquet"


def _numbers(folder: Path) -> list[int]:
    try:
        names = os.listdir(folder / PARTS)
    except FileNotFoundError:
        return []
    except OSError as error:
        raise Unavailable(f"{folder / PARTS}: can't be read: {error.strerror}") from error
    return sorted(int(found[1]) for name in names if (found := _NAME.fullmatch(name)))


def _plain(row: RunRow) -> dict[str, Any]:
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
