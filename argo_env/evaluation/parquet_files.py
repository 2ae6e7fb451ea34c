"""Parquet files of rows. They need pyarrow, which is not part of the base install.

The name of a file ends with its checksum. Parquet's own checksums, which are written as well, cover
the pages of data, but neither their headers nor the footer.
"""

import io
import os
import re
import zlib
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable, reason_text
from argo_compiler.base.extras import install_line
from argo_compiler.base.message import Message
from argo_compiler.base.operating_system import write_draft_and_replace
from argo_compiler.files.json_places import format_path
from argo_env.evaluation.row import RunRow
from argo_env.files.checked_files import damaged
from argo_env.files.folders import make_private_folder

if TYPE_CHECKING:
    import pyarrow

PARTS = "parts"
_PART_NAME = re.compile(r"part-(\d+)(?:-([0-9a-f]{8}))?\.parquet")
"""number and checksum; older versions of Argo wrote none"""
_REMEDY = Message("restore it from a copy, or delete it and evaluate again, which repeats its runs")


def can_write_parts() -> bool:
    """Return True if pyarrow is installed."""
    return find_spec("pyarrow") is not None


def has_parts(folder: Path) -> bool:
    """Return True if the folder of an evaluation has Parquet files of rows."""
    return bool(_numbered_parts(folder))


def write_part(folder: Path, rows: Sequence[RunRow]) -> Path:
    """Write rows to a new file atomically: the file is complete or does not exist.

    Raises Unavailable if it can't be written.
    """
    import pyarrow
    from pyarrow import parquet

    parts = folder / PARTS
    number = max(_numbered_parts(folder), default=0) + 1
    sink = io.BytesIO()
    table = pyarrow.Table.from_pylist([_to_record(row) for row in rows], schema=_schema())
    parquet.write_table(table, sink, write_page_checksum=True)
    content = sink.getvalue()
    path = parts / f"part-{number:05d}-{zlib.crc32(content):08x}.parquet"
    draft = parts / f".part-{number:05d}.parquet"
    try:
        make_private_folder(parts)
        write_draft_and_replace(draft, path, content)
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be written: {error}", path=path, error=reason_text(error))
        ) from error
    return path


def read_parts(folder: Path) -> tuple[RunRow, ...]:
    """Read the rows of all Parquet files in the folder, in the order in which they were written.

    Raises Unavailable if there are files, and pyarrow is missing or one of them can't be read or is
    damaged.
    """
    parts = _numbered_parts(folder)
    if not parts:
        return ()
    if not can_write_parts():
        raise Unavailable(
            Message(
                "{folder}: reading Parquet files needs pyarrow: {install_line}",
                folder=folder / PARTS,
                install_line=install_line("results"),
            )
        )
    rows: list[RunRow] = []
    for _, path in sorted(parts.items()):
        rows += _read_part(path)
    return tuple(rows)


def _read_part(path: Path) -> list[RunRow]:
    from pyarrow import ArrowException, BufferReader, parquet

    try:
        content = path.read_bytes()
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be read: {reason}", path=path, reason=reason_text(error))
        ) from error
    match = _PART_NAME.fullmatch(path.name)
    stated = match and match[2]
    if stated and int(stated, 16) != zlib.crc32(content):
        raise damaged(path, "its content does not fit the checksum in its name", _REMEDY)
    try:
        # Reading it as a dataset would make a column of the folder's name.
        file = parquet.ParquetFile(BufferReader(content), page_checksum_verification=True)
        records = file.read().to_pylist(maps_as_pydicts="strict")
        return [RunRow.model_validate(record) for record in records]
    except (OSError, ArrowException, ValueError, KeyError, MemoryError, OverflowError) as error:
        raise damaged(path, _reason(error), _REMEDY) from error


def _reason(error: Exception) -> str:
    """Return what is wrong with the content of a Parquet file, in one line."""
    if isinstance(error, ValidationError):
        fault = error.errors(include_url=False)[0]
        return Message(
            "column {format_path}: {fault}",
            format_path=format_path(fault["loc"]),
            fault=fault["msg"],
        )
    return str(error).partition("\n")[0] or type(error).__name__


def remove_parts(folder: Path) -> None:
    """Remove all Parquet files from the folder. Raises Unavailable if that fails."""
    try:
        for path in _numbered_parts(folder).values():
            os.unlink(path)
    except OSError as error:
        raise Unavailable(
            Message(
                "{folder} can't be changed: {reason}",
                folder=folder / PARTS,
                reason=reason_text(error),
            )
        ) from error


def _numbered_parts(folder: Path) -> dict[int, Path]:
    """Return the paths of the Parquet files in a folder by their numbers.

    Raises Unavailable for two files with one number.
    """
    try:
        names = os.listdir(folder / PARTS)
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise Unavailable(
            Message(
                "{folder} can't be read: {reason}", folder=folder / PARTS, reason=reason_text(error)
            )
        ) from error
    parts: dict[int, Path] = {}
    for name in names:
        if match := _PART_NAME.fullmatch(name):
            path = folder / PARTS / name
            if parts.setdefault(int(match[1]), path) != path:
                raise Unavailable(
                    Message(
                        "{path} and {part}: delete one of the two",
                        path=path,
                        part=parts[int(match[1])].name,
                    )
                )
    return parts


def _to_record(row: RunRow) -> dict[str, Any]:
    return row.model_dump(mode="json")


def _schema() -> "pyarrow.Schema":
    import pyarrow as pa

    text, number, count = pa.string(), pa.float64(), pa.int64()
    detection = pa.struct([("fault", text), ("began", number), ("delay", number)])
    part = pa.struct(
        [
            ("code", text),
            ("names", pa.list_(text)),
            ("times", pa.list_(number)),
            ("numbers", pa.list_(count)),
            ("event", text),
            ("text", text),
        ]
    )
    kinds = {
        "verdict": pa.list_(part),
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
