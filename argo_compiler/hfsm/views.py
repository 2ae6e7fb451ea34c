"""Read-only sequences whose items are created on access."""

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from typing import Generic, TypeVar, overload

Stored = TypeVar("Stored")
Item = TypeVar("Item", covariant=True)


class View(Sequence[Item], Generic[Stored, Item]):
    """View of a list's present items, each created on access.

    The list's owner only ever appends to it.
    """

    __slots__ = ("_length", "_make", "_stored")

    def __init__(self, stored: list[Stored], make: Callable[[Stored], Item]) -> None:
        self._stored = stored
        self._make = make
        self._length = len(stored)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> Item: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Item, ...]: ...
    def __getitem__(self, index: int | slice) -> Item | tuple[Item, ...]:
        picked = range(self._length)[index]
        if isinstance(picked, range):
            return tuple(self._make(self._stored[i]) for i in picked)
        return self._make(self._stored[picked])

    def __iter__(self) -> Iterator[Item]:
        return map(self._make, islice(self._stored, self._length))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, View | tuple | list):
            return NotImplemented
        return len(self) == len(other) and all(a == b for a, b in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(tuple(self))
