"""Sequences whose items are made when they are looked at."""

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from typing import Generic, TypeVar, overload

Kept = TypeVar("Kept")
Made = TypeVar("Made", covariant=True)


class View(Sequence[Made], Generic[Kept, Made]):
    """What a list holds now, as its owner only ever adds to it. Each item is made on access."""

    __slots__ = ("_kept", "_length", "_make")

    def __init__(self, kept: list[Kept], make: Callable[[Kept], Made]) -> None:
        self._kept = kept
        self._make = make
        self._length = len(kept)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, at: int) -> Made: ...
    @overload
    def __getitem__(self, at: slice) -> tuple[Made, ...]: ...
    def __getitem__(self, at: int | slice) -> Made | tuple[Made, ...]:
        picked = range(self._length)[at]
        if isinstance(picked, range):
            return tuple(self._make(self._kept[i]) for i in picked)
        return self._make(self._kept[picked])

    def __iter__(self) -> Iterator[Made]:
        return map(self._make, islice(self._kept, self._length))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, View | tuple | list):
            return NotImplemented
        return len(self) == len(other) and all(a == b for a, b in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(tuple(self))
