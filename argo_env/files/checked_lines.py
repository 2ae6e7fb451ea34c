"""Files of lines with checksums, which tell what a loss of power may have damaged.

Each line is a checksum and an object as JSON, with its number `n` from 0. A file is synced from
time to time; each line states how many lines were known to be on disk when it was written:
`synced`, or else all lines before it. After each sync a line without other fields, a mark, states
this at once. A line that is damaged, although a later one states that it was on disk, has not been
damaged by a loss of power.
"""

import json
import os
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from typing import Any

from argo_compiler.base.operating_system import sync_content


def checked_line(data: Mapping[str, Any]) -> bytes:
    """Return the line that stores an object: a checksum, the object as JSON, and a line end."""
    payload = json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(payload), payload)


def checked_object(line: bytes) -> dict[str, Any] | None:
    """Return the object that `checked_line` stored in a line, given without its line end.

    Returns None if the checksum does not match or the line holds no JSON object.
    """
    checksum, _, payload = line.partition(b" ")
    if checksum != b"%08x" % zlib.crc32(payload):
        return None
    try:
        data = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return data if isinstance(data, dict) else None


@dataclass(frozen=True)
class StoredLine:
    """Intact line of a file."""

    number: int
    data: dict[str, Any]
    """the stored object, without `n` and `synced`; empty for a mark"""
    end: int
    """number of bytes up to the end of the line"""


@dataclass(frozen=True)
class StoredLines:
    """Lines of a file: those before the first damaged one, and intact ones after it."""

    lines: tuple[StoredLine, ...]
    """lines before the first damaged one"""
    later: tuple[StoredLine, ...]
    """intact lines after it"""
    synced: int
    """number of lines that were on disk once, as intact lines state"""
    damaged: bool
    """whether more is wrong than a last line that a killed process has not written to its end"""
    bad: int
    """number of damaged lines, that one not included; a damaged part without line ends counts 1"""

    @property
    def size(self) -> int:
        """Number of bytes of the lines before the first damaged one."""
        return self.lines[-1].end if self.lines else 0

    @property
    def was_synced(self) -> bool:
        """True if a line is damaged that was on disk: this is no loss of power."""
        return self.damaged and len(self.lines) < self.synced

    @property
    def count_after(self) -> int:
        """Number of lines from the first damaged one on."""
        return self.bad + len(self.later)

    @property
    def objects(self) -> tuple[StoredLine, ...]:
        """Lines before the first damaged one that are no marks."""
        return tuple(line for line in self.lines if line.data)


def parse_lines(content: bytes) -> StoredLines:
    """Return the lines of a file."""
    parts = content.split(b"\n")
    lines: list[StoredLine] = []
    later: list[StoredLine] = []
    synced = end = bad = 0
    for part in parts[:-1]:
        end += len(part) + 1
        data = checked_object(part)
        number = None if data is None else data.pop("n", len(lines))
        if data is None or not isinstance(number, int):
            bad += 1
            continue
        stated = data.pop("synced", number)
        synced = max(synced, stated if isinstance(stated, int) else 0)
        is_next = number == len(lines) and not bad and not later
        (lines if is_next else later).append(StoredLine(number, data, end))
    rest = parts[-1]
    is_torn = b"\0" not in rest and checked_object(rest[:-1]) is None
    bad += not is_torn
    return StoredLines(tuple(lines), tuple(later), synced, bool(bad or later), bad)


class LineWriter:
    """Writer of lines to an open file, which it does not own."""

    def __init__(self, file: int, stored: StoredLines) -> None:
        """Continue a file after its lines before the first damaged one; the rest is cut off.

        Raises OSError if the file can't be written.
        """
        self._file = file
        self.size = stored.size
        self.count = len(stored.lines)
        """number of lines, with marks"""
        self._synced = min(stored.synced, self.count)
        self._must_cut = False
        """whether a line that could not be written may follow the others"""
        os.lseek(file, self.size, os.SEEK_SET)
        if os.fstat(file).st_size != self.size:
            os.ftruncate(file, self.size)
            sync_content(file)
            self._synced = self.count

    def line(self, data: Mapping[str, Any]) -> bytes:
        """Return the next line, which stores an object."""
        return checked_line(_numbered(data, self.count, self._synced))

    def append(self, data: Mapping[str, Any]) -> None:
        """Write the next line; raises OSError, and cuts off what was written, if that fails.

        Raises OSError too if what an earlier error has left can't be cut off.
        """
        if self._must_cut:
            self._cut()
        line = self.line(data)
        try:
            write_all(self._file, line)
        except OSError:
            self._cut_if_possible()
            raise
        self.size += len(line)
        self.count += 1

    def append_and_sync(self, data: Mapping[str, Any]) -> None:
        """Write the next line and sync the file.

        Raises OSError, and cuts off what was written, if that fails.
        """
        size, count = self.size, self.count
        self.append(data)
        try:
            self.sync()
        except OSError:
            self.size, self.count = size, count
            self._cut_if_possible()
            raise

    def sync(self) -> None:
        """Sync the file, and write a mark; raises OSError if it can't be synced."""
        sync_content(self._file)
        if self._synced < self.count:
            self._synced = self.count
            with suppress(OSError):  # the next line states the same
                self.append({})

    def clear(self) -> None:
        """Remove all lines."""
        os.ftruncate(self._file, 0)
        self.size = os.lseek(self._file, 0, os.SEEK_SET)
        self.count = self._synced = 0

    def _cut(self) -> None:
        """Cut off what follows the lines."""
        os.ftruncate(self._file, self.size)
        os.lseek(self._file, self.size, os.SEEK_SET)
        self._must_cut = False

    def _cut_if_possible(self) -> None:
        """Cut off what follows the lines; if that fails, the next line is to do it."""
        self._must_cut = True
        with suppress(OSError):
            self._cut()


def complete_lines(objects: Sequence[Mapping[str, Any]]) -> list[bytes]:
    """Return all lines of a file that is synced before anybody can read it; the last is a mark."""
    return [
        checked_line(_numbered(data, number, number))
        for number, data in enumerate(chain(objects, ({},)))
    ]


def _numbered(data: Mapping[str, Any], number: int, synced: int) -> dict[str, Any]:
    return {"n": number} | ({} if synced == number else {"synced": synced}) | dict(data)


def write_all(file: int, data: bytes) -> None:
    """Write all data to an open file; an OSError may leave a part of the data written."""
    while data:
        data = data[os.write(file, data) :]


def truncate_if_possible(file: int, size: int) -> None:
    """Truncate an open file to `size` bytes, to remove a line that was written in part.

    If that fails, no error is raised: the damaged line stays, and its checksum does not match.
    """
    with suppress(OSError):
        os.ftruncate(file, size)
