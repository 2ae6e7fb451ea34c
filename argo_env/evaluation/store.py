"""Rows on disk: what has come is never lost, and never there twice.

A folder has `rows.log`, to which each row is appended as a line with a checksum, and `parts/`, to
which many rows at once are moved as a Parquet file that DuckDB and pandas read. A process that is
killed leaves at most a torn last line, which is cut off; killed while rows are moved, it leaves
them in both places, which the keys of rows tell.
"""

import fcntl
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_env.closing import Closing
from argo_env.evaluation.parts import (
    PARTS,
    can_write_parts,
    has_parts,
    read_parts,
    remove_parts,
    write_part,
)
from argo_env.evaluation.row import RunRow
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    cut_off,
    sync_folder,
    write_all,
)
from argo_env.files.folders import check_folder, make_folder

LOG = "rows.log"
_LOCK = ".lock"
_SYNC = 1.0  # s between two times that rows are made to outlive the machine


class RowStore(Closing):
    """The rows of an evaluation in a folder. One process at a time has it open for writing."""

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """Opens the folder, which is made if it is not there.

        Raises Conflict if another process has it open, Unavailable if it can't be written.
        """
        make_folder(folder)
        check_folder(folder / PARTS)
        self.folder = folder
        self._clock = clock
        self._lock = _locked(folder)
        try:
            found = read_log(folder)
            self._file = os.open(folder / LOG, os.O_RDWR | os.O_CREAT, 0o644)
            os.ftruncate(self._file, found.size)
            self._size = os.lseek(self._file, found.size, os.SEEK_SET)
            sync_folder(folder)
        except OSError as error:
            os.close(self._lock)
            raise _unwritable(folder, error) from error
        self.damaged = found.damaged
        """lines of the log that could not be read: their runs are made again"""
        self._synced = clock()
        self._rows = {row.key: row for row in read_parts(folder)}
        self._moved = len(self._rows)
        for row in found.rows:
            self._rows.setdefault(row.key, row)

    @property
    def rows(self) -> dict[str, RunRow]:
        """All rows by their keys."""
        return self._rows

    def add(self, row: RunRow) -> None:
        """Keeps a row, unless it is there already. Raises Unavailable if the disk is full."""
        if row.key in self._rows:
            return
        line = _line(row)
        try:
            write_all(self._file, line)
        except OSError as error:
            cut_off(self._file, self._size)
            raise Unavailable(f"{self.folder / LOG}: {error.strerror}") from error
        self._size += len(line)
        self._rows[row.key] = row
        if self._clock() - self._synced >= _SYNC:
            self.sync()

    def sync(self) -> None:
        """From now on also a machine that loses power keeps all rows."""
        os.fsync(self._file)
        self._synced = self._clock()

    @property
    def loose(self) -> int:
        """How many rows are in the log alone."""
        return len(self._rows) - self._moved

    def compact(self) -> None:
        """Moves the rows of the log into a Parquet file; without pyarrow they stay there."""
        if not self.loose or not can_write_parts():
            return
        self.sync()
        write_part(self.folder, list(self._rows.values())[self._moved :])
        os.ftruncate(self._file, 0)
        self._size = os.lseek(self._file, 0, os.SEEK_SET)
        self._moved = len(self._rows)
        self.sync()

    def keep_only(self, fits: Callable[[RunRow], bool]) -> None:
        """Forgets all rows but those that fit. Raises Unavailable where that can't be done; killed
        meanwhile, the folder has all that fit, and maybe others."""
        kept = [row for row in self._rows.values() if fits(row)]
        if len(kept) == len(self._rows):
            return
        draft = self.folder / f".{LOG}"
        try:
            with open(draft, "wb") as file:
                file.writelines(map(_line, kept))
                file.flush()
                os.fsync(file.fileno())
            os.replace(draft, self.folder / LOG)
            sync_folder(self.folder)
            os.close(self._file)
            self._file = os.open(self.folder / LOG, os.O_RDWR)
            self._size = os.lseek(self._file, 0, os.SEEK_END)
        except OSError as error:
            raise _unwritable(self.folder, error) from error
        remove_parts(self.folder)
        self._rows = {row.key: row for row in kept}
        self._moved = 0

    def close(self) -> None:
        """Lets another process have the folder."""
        self.sync()
        os.close(self._file)
        os.close(self._lock)


def read_rows(folder: Path) -> tuple[RunRow, ...]:
    """All rows in a folder, as far as they are there now; also while another process adds some.

    Raises NotFound if it is no folder of an evaluation, Unavailable if pyarrow is missing.
    """
    if not (os.path.exists(folder / LOG) or has_parts(folder)):
        raise NotFound(f"{folder}: has no rows of an evaluation")
    # The log first: what is moved meanwhile is then in both places, and not in none.
    loose = read_log(folder).rows
    found = {row.key: row for row in read_parts(folder)}
    for row in loose:
        found.setdefault(row.key, row)
    return tuple(found.values())


@dataclass(frozen=True)
class LoggedRows:
    """The rows in a log."""

    rows: tuple[RunRow, ...]
    size: int
    """bytes up to the end of the last whole line"""
    damaged: int
    """lines whose checksum does not fit"""


def read_log(folder: Path) -> LoggedRows:
    """The rows of the log in a folder; what was torn by a kill is left out."""
    try:
        content = (folder / LOG).read_bytes()
    except FileNotFoundError:
        return LoggedRows((), 0, 0)
    size = content.rfind(b"\n") + 1
    rows, damaged = [], 0
    for line in content[:size].splitlines():
        data = checked_object(line)
        try:
            rows.append(RunRow.model_validate(data))
        except ValidationError:
            damaged += 1
    return LoggedRows(tuple(rows), size, damaged)


def _line(row: RunRow) -> bytes:
    return checked_line(row.model_dump(mode="json", exclude_defaults=True))


def _unwritable(folder: Path, error: OSError) -> Unavailable:
    return Unavailable(f"{error.filename or folder}: can't be written: {error.strerror}")


def _locked(folder: Path) -> int:
    try:
        file = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise _unwritable(folder, error) from error
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(file)
        raise Conflict(
            f"{folder}: another process evaluates into it: wait for its end, or choose another"
        ) from None
    return file
