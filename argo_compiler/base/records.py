"""Dataclasses that are made faster than Python's own, for modules that short commands import.

Python compiles each method of a dataclass anew when its module is imported. For the 100 dataclasses
that `argo check` imports this takes 8 % of its time.
"""

import dataclasses
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(part=None, /, *, frozen=False, eq=True, repr=True, unsafe_hash=False, **options):
        """Make a dataclass that compares, hashes and prints as one of Python's.

        A frozen one is so for type checkers only: nothing refuses a change when the program runs.
        """

        def make(part):
            own = vars(part)
            made = dataclasses.dataclass(eq=False, repr=False, **options)(part)
            every = dataclasses.fields(made)
            if repr and "__repr__" not in own:
                made.__repr__ = _repr_of([one.name for one in every if one.repr])
            if not eq:
                return made
            values = _values_of([one.name for one in every if one.compare])
            if "__eq__" not in own:
                made.__eq__ = _eq_of(values)
            if own.get("__hash__") is None:
                hashed = [
                    one.name for one in every if (one.compare if one.hash is None else one.hash)
                ]
                made.__hash__ = _hash_of(_values_of(hashed)) if frozen or unsafe_hash else None
            return made

        return make if part is None else make(part)


def _values_of(names: list[str]) -> Callable[[Any], tuple[object, ...]]:
    """Return a function that returns the values of these fields."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda record: tuple([getattr(record, name) for name in names])


def _repr_of(names: list[str]) -> Callable[[Any], str]:
    def represent(self: Any) -> str:
        shown = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{type(self).__qualname__}({shown})"

    return represent


def _eq_of(values: Callable[[Any], tuple[object, ...]]) -> Callable[[Any, object], Any]:
    def equal(self: Any, other: object) -> Any:
        if other.__class__ is not self.__class__:
            return NotImplemented
        return values(self) == values(other)

    return equal


def _hash_of(values: Callable[[Any], tuple[object, ...]]) -> Callable[[Any], int]:
    def hashed(self: Any) -> int:
        return hash(values(self))

    return hashed
