"""Text files of numbers, and errors that say where they are wrong."""

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.files.reading import read_text

MAX_BYTES = 100_000_000
MAX_NODES = 3000
"""Far above any problem that is solved in minutes, and below what would exhaust the memory."""

LARGEST = 10**10
"""the greatest number that is read: its sums stay far from where whole numbers overflow"""

_KIND = "TSPLIB, OPLib or TSPTW file"
_OF_NUMBERS = frozenset("0123456789+-.eE \t\r\f\v")


@dataclass(frozen=True)
class Source:
    """A text file, by its lines."""

    path: Path
    lines: tuple[str, ...]

    def wrong(self, line: int | None, what: str, way_out: str) -> ArgoError:
        """The error that says so. `line` counts from 0; None: the file as a whole."""
        place = f"{self.path}" if line is None else f"{self.path}:{line + 1}"
        return ArgoError(f"{place}: {what}; {way_out}")

    def nodes(self, line: int | None, count: float, least: int) -> int:
        """The number of nodes that the file states there. Raises ArgoError if it can't be one."""
        if count != int(count) or count < least:
            raise self.wrong(line, f"{count:g} nodes are no problem", f"it needs {least} or more")
        if count > MAX_NODES:
            raise self.wrong(
                line, f"it has {count:.0f} nodes", f"at most {MAX_NODES} are read: take a part"
            )
        return int(count)


def read_source(path: Path) -> Source:
    """The lines of a text file. Raises ArgoError if there are none to be read."""
    text = read_text(path, _KIND, MAX_BYTES)
    if not text.strip():
        raise ArgoError(f"{path}: is empty; name a {_KIND}")
    return Source(path, tuple(text.splitlines()))


class Numbers:
    """The numbers in some lines of a file, taken from the first to the last. Has state: how far it
    has come."""

    def __init__(self, source: Source, lines: Iterable[int]) -> None:
        """Raises ArgoError at the first thing that is no number."""
        self._source = source
        self._lines = list(lines)
        rows = [_numbers(source, line) for line in self._lines]
        self._ends = list(accumulate(len(row) for row in rows))
        self._values = np.array([value for row in rows for value in row], dtype=np.float64)
        self._next = 0

    @property
    def left(self) -> int:
        """How many have not been taken."""
        return len(self._values) - self._next

    def take(self, count: int, what: str) -> NDArray[np.float64]:
        """The next ones. Raises ArgoError, with what they would have been, if they are too few."""
        if self.left < count:
            line = self._lines[-1] if self._lines else None
            raise self._source.wrong(
                line,
                f"of {count} numbers for {what} there are {self.left}",
                "is the file complete?",
            )
        taken = self._values[self._next : self._next + count]
        self._next += count
        return taken

    def skip(self, value: float) -> None:
        """Leaves out the next one if it is this."""
        if self.left and self._values[self._next] == value:
            self._next += 1

    def refuse(self, wrong: NDArray[np.bool_], what: str, way_out: str) -> None:
        """Raises ArgoError at the line of the first of the numbers taken last that is wrong."""
        if wrong.any():
            first = self._next - wrong.size + int(np.flatnonzero(wrong)[0])
            value = self._values[first]
            raise self._source.wrong(self._line(first), f"{value:g} {what}", way_out)

    def finish(self, what: str) -> None:
        """Raises ArgoError if there are more numbers than those that were taken."""
        if self.left:
            raise self._source.wrong(
                self._line(self._next),
                f"there are {self.left} numbers more than {what} needs",
                "does the number of nodes agree with them?",
            )

    def _line(self, position: int) -> int:
        return self._lines[bisect_right(self._ends, position)]


def _numbers(source: Source, line: int) -> list[float]:
    text = source.lines[line]
    try:
        if not _OF_NUMBERS.issuperset(text):  # float() reads `nan`, `1_000` and other digits too
            raise ValueError
        values = [float(word) for word in text.split()]
        if any(abs(value) > LARGEST for value in values):
            raise ValueError
    except ValueError:
        word = next((word for word in text.split() if not _is_number(word)), text.strip())
        raise source.wrong(
            line, f"`{word[:40]}` is no number of up to {LARGEST}", "correct it there"
        ) from None
    return values


def _is_number(word: str) -> bool:
    try:
        return _OF_NUMBERS.issuperset(word) and abs(float(word)) <= LARGEST
    except ValueError:
        return False
