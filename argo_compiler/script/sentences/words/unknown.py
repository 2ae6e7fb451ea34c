"""Numbers of which only a range is known: what follows for one of them follows for all of it.

A sentence is read with such numbers to see what hangs on its figures. Whatever asks more of one
than its range tells raises UnknownError; so what comes out holds for all numbers of the range. Of a
quoted name with figures in it nothing is known.
"""

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, NoReturn

from argo_compiler.base.records import dataclass
from argo_compiler.script.sentences.words.numbers import Figure

Fill = Callable[[Sequence[str]], Any]
"""the number or name, by the figures that a text has"""


class UnknownError(Exception):
    """Something hangs on a number that is not known."""


def _refuse(*_: object) -> NoReturn:
    raise UnknownError


class Unknown:
    """A number from `low` to `high`. It can be handed on, multiplied, and compared with what lies
    outside of its range."""

    __slots__ = ("fill", "high", "low")

    def __init__(self, low: float, high: float, fill: Fill) -> None:
        self.low = low
        self.high = high
        self.fill = fill

    def __mul__(self, factor: float) -> "Unknown":
        low, high = sorted((self.low * factor, self.high * factor))
        fill = self.fill
        return Unknown(low, high, lambda figures: fill(figures) * factor)

    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        if other is None:
            return False
        if type(other) not in (int, float, bool) or self.low <= other <= self.high:  # type: ignore[operator]
            raise UnknownError
        return False

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __lt__(self, other: float) -> bool:
        if self.low < other <= self.high:
            raise UnknownError
        return self.high < other

    def __le__(self, other: float) -> bool:
        if self.low <= other < self.high:
            raise UnknownError
        return self.high <= other

    def __gt__(self, other: float) -> bool:
        return not self <= other

    def __ge__(self, other: float) -> bool:
        return not self < other

    @property  # type: ignore[misc]
    def __class__(self) -> Any:
        """Not even its type is told: `isinstance` asks for this."""
        raise UnknownError

    __hash__: Any = _refuse
    __str__ = __repr__ = __format__ = __bool__ = __getattr__ = _refuse
    __int__ = __float__ = __index__ = __neg__ = __abs__ = __round__ = _refuse
    __add__ = __radd__ = __sub__ = __rsub__ = __truediv__ = __rtruediv__ = _refuse


@dataclass(frozen=True, slots=True)
class UnknownFigure(Figure):
    """A figure without a second reading of which only the range is known."""

    said: str = ""
    """one of the figures that it may be"""

    @property
    def whole(self) -> Any:
        if "." in self.said:
            raise UnknownError
        value: Any = self.value
        fill = value.fill
        return Unknown(value.low, value.high, lambda figures: int(fill(figures)))


def unknown_figure(said: str, place: int) -> UnknownFigure:
    """Any figure with as many digits before its point, if it has one, as `said` has."""
    digits = len(said.partition(".")[0])
    low, high = 10.0 ** (digits - 1), 10.0**digits
    if said[0] == "0":
        low, high = 0.001, 1.0
    value: Any = Unknown(low, high, lambda figures: float(figures[place]))
    return UnknownFigure(value, said=said)


class UnknownName(Unknown):
    """A name that consists of these parts with figures, which are not known, between each two."""

    __slots__ = ()

    def __init__(self, parts: Sequence[str], places: slice) -> None:
        def fill(figures: Sequence[str]) -> str:
            behind = [*figures[places], ""]
            return "".join([sign for pair in zip(parts, behind, strict=True) for sign in pair])

        super().__init__(-inf, inf, fill)

    def __bool__(self) -> bool:  # type: ignore[override]
        return True


UnknownValue = UnknownFigure | UnknownName
"""the value of a word that is not known"""
