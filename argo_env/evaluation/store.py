"""Store of rows on disk that survives crashes without lost or duplicate rows.

A folder has `rows.log`, to which each row is appended as a line (see `checked_lines`), and
`parts/`, to which many rows at once are moved as a Parquet file that DuckDB and pandas can read. A
process that is killed leaves at most an incomplete last line, which is cut off. If it is killed
while it moves rows, the rows are in both; their keys identify the duplicates. Rows of damaged lines
are lost: their runs are repeated.
"""

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.operating_system import (
    OPEN_FLAGS,
    sync_folder,
    try_lock,
    write_draft_and_replace,
)
from argo_compiler.base.quantity_text import counted_text
from argo_env.closing import Closing
from argo_env.evaluation.parquet_files import (
    PARTS,
    can_write_parts,
    has_parts,
    read_parts,
    remove_parts,
    write_part,
)
from argo_env.evaluation.row import RunRow
from argo_env.files.checked_lines import (
    LineWriter,
    StoredLines,
    complete_lines,
    parse_lines,
)
from argo_env.files.folders import make_folder, require_folder_or_creatable

LOG = "rows.log"
_LOCK = ".lock"
_SYNC = 1.0  # s between two calls of fsync, which secure the rows against a loss of power


class RowStore(Closing):
    """Store of an evaluation's rows in a folder, which one process at a time can write.

    It holds all rows in memory and adds new ones to the folder.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """Open the folder, and create it if it does not exist.

        Raises Conflict if another process has it open, Unavailable if it can't be written.
        """
        make_folder(folder)
        require_folder_or_creatable(folder / PARTS)
        self.folder = folder
        self._clock = clock
        self._lock = _acquire_lock(folder)
        try:
            logged = read_log(folder)
            self._rows = {row.key: row for row in read_parts(folder)}
            self._moved = len(self._rows)
            for row in logged.rows:
                self._rows.setdefault(row.key, row)
            if logged.loss:
                self._replace_log(logged.rows)
            self._open_log()
        except OSError as error:
            os.close(self._lock)
            raise _not_writable(folder, error) from error
        except BaseException:
            os.close(self._lock)
            raise
        self.loss = logged.loss
        """which lines of the log were damaged; empty: none. Their runs are repeated"""
        self._synced = clock()

    @property
    def rows(self) -> dict[str, RunRow]:
        """All rows in the folder, by their keys."""
        return self._rows

    def add_if_new(self, row: RunRow) -> None:
        """Store a row, unless a row with its key is stored already.

        Raises Unavailable if it can't be written, for example to a full disk.
        """
        if row.key in self._rows:
            return
        with self._reporting_log_errors():
            self._lines.append(_fields(row))
        self._rows[row.key] = row
        if self._clock() - self._synced >= _SYNC:
            self.sync()

    def sync(self) -> None:
        """Write all rows through to the disk, so that they survive a loss of power.

        Raises Unavailable if that fails.
        """
        with self._reporting_log_errors():
            self._lines.sync()
        self._synced = self._clock()

    @property
    def uncompacted(self) -> int:
        """Number of rows that are in the log only."""
        return len(self._rows) - self._moved

    def compact(self) -> None:
        """Move the rows of the log to a Parquet file; without pyarrow they stay in the log.

        Raises Unavailable if a file can't be written.
        """
        if not self.uncompacted or not can_write_parts():
            return
        self.sync()
        write_part(self.folder, list(self._rows.values())[self._moved :])
        with self._reporting_log_errors():
            self._lines.clear()
        self._moved = len(self._rows)
        self.sync()

    def keep_only(self, fits: Callable[[RunRow], bool]) -> None:
        """Discard all rows for which `fits` returns False.

        A process that is killed meanwhile leaves all fitting rows in the folder, and maybe others.
        Raises Unavailable if the files can't be written.
        """
        fitting = [row for row in self._rows.values() if fits(row)]
        if len(fitting) == len(self._rows):
            return
        try:
            self._replace_log(fitting)
            replaced = self._file
            self._open_log()
            os.close(replaced)
        except OSError as error:
            raise _not_writable(self.folder, error) from error
        remove_parts(self.folder)
        self._rows = {row.key: row for row in fitting}
        self._moved = 0

    def _open_log(self) -> None:
        """Open the log, whose lines are all intact but for an incomplete last one."""
        file = os.open(self.folder / LOG, os.O_RDWR | os.O_CREAT | OPEN_FLAGS, 0o600)
        try:
            with open(file, "rb", closefd=False) as stream:
                lines = LineWriter(file, parse_lines(stream.read()))
            sync_folder(self.folder)
        except BaseException:
            os.close(file)
            raise
        self._file, self._lines = file, lines

    @contextmanager
    def _reporting_log_errors(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise Unavailable(
                Message("{path}: {reason}", path=self.folder / LOG, reason=reason_text(error))
            ) from error

    def _replace_log(self, rows: Sequence[RunRow]) -> None:
        """Replace the log by one with these rows; raises OSError if that fails."""
        content = b"".join(complete_lines([*map(_fields, rows)]))
        write_draft_and_replace(self.folder / f".{LOG}", self.folder / LOG, content)

    def close(self) -> None:
        """Write all rows through to the disk and release the folder's lock."""
        try:
            self.sync()
        finally:
            os.close(self._file)
            os.close(self._lock)


def read_rows(folder: Path) -> tuple[RunRow, ...]:
    """Read all rows that are in a folder now; another process may add rows meanwhile.

    Lines that a loss of power may have damaged are left out: their runs have no rows. Raises
    NotFound if the folder has no files of rows, Unavailable if a file is damaged otherwise, or if
    there are Parquet files and pyarrow is missing.
    """
    if not (os.path.exists(folder / LOG) or has_parts(folder)):
        raise NotFound(Message("{folder} has no rows of an evaluation", folder=folder))
    # The log comes first: rows that are moved meanwhile are then read twice, and not missed.
    logged = read_log(folder)
    if logged.was_synced:
        raise Unavailable(
            Message(
                "{loss}: evaluate again into this folder, which repeats the runs of the "
                "damaged lines, or restore the file from a copy",
                loss=logged.loss,
            )
        )
    by_key = {row.key: row for row in read_parts(folder)}
    for row in logged.rows:
        by_key.setdefault(row.key, row)
    return tuple(by_key.values())


@dataclass(frozen=True)
class LoggedRows:
    """Rows of a log file."""

    rows: tuple[RunRow, ...]
    loss: str
    """which lines are damaged; empty if that is at most an incomplete last line"""
    was_synced: bool
    """whether one of them was on disk, so that it was not damaged by a loss of power"""


def read_log(folder: Path) -> LoggedRows:
    """Read the rows of the log in a folder; leave out damaged lines."""
    path = folder / LOG
    try:
        stored = parse_lines(path.read_bytes())
    except FileNotFoundError:
        return LoggedRows((), "", False)
    rows = []
    wrong = 0
    for line in (*stored.lines, *stored.later):
        try:
            if line.data:
                rows.append(RunRow.model_validate(line.data))
        except ValidationError:
            wrong += 1  # written by another version
    return LoggedRows(tuple(rows), _loss(path, stored, wrong), stored.was_synced or wrong > 0)


def _loss(path: Path, stored: StoredLines, wrong: int) -> str:
    """Return which lines of a log are damaged; `wrong` intact lines have no valid row."""
    if not stored.damaged:
        lines = counted_text(wrong, "line")
        return (
            Message("{path}: {lines} without a row of this version", path=path, lines=lines)
            if wrong
            else ""
        )
    why = "" if stored.was_synced else Message(", as by a loss of power")
    return Message(
        "{path}: damaged in line {count}{why}", path=path, count=len(stored.lines) + 1, why=why
    )


def _fields(row: RunRow) -> dict[str, Any]:
    return row.model_dump(mode="json", exclude_defaults=True)


def _not_writable(folder: Path, error: OSError) -> Unavailable:
    return Unavailable(
        Message(
            "{value} can't be written: {reason}",
            value=error.filename or folder,
            reason=reason_text(error),
        )
    )


def _acquire_lock(folder: Path) -> int:
    try:
        file = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | OPEN_FLAGS, 0o600)
    except OSError as error:
        raise _not_writable(folder, error) from error
    try:
        locked = try_lock(file)
    except OSError as error:
        os.close(file)
        raise _not_writable(folder, error) from error
    if not locked:
        os.close(file)
        raise Conflict(
            Message(
                "{folder}: another process evaluates into it: wait until it ends, or "
                "choose another folder",
                folder=folder,
            )
        )
    return file
