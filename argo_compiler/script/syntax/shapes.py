"""The shape of a text: what stays of it when its plain numbers are others of as many digits."""

import re
from dataclasses import dataclass

_PLAIN = re.compile(
    r"(?<![\w.,'’:/½¼¾-])([2-9]|[1-9][0-9]{1,5}|[1-9][0-9]{0,4}\.[0-9]{1,2}"
    r"|0\.(?=[0-9]?[1-9])[0-9]{1,2})(?![\w½¼¾]|[.,'’:/-]\w)"
)
"""a number that can be read in one way only; 0 and 1 are often more than numbers"""
_HIDDEN = str.maketrans("0123456789", "\ue000" * 10)
_OTHERS = str.maketrans("0123456789", "4356789242")
"""by digit, another one, neither 0 nor 1"""


@dataclass(frozen=True, slots=True)
class Shape:
    """A text without its plain numbers, and these numbers."""

    key: str
    """equal for all texts of the shape"""
    figures: tuple[str, ...]

    @classmethod
    def of(cls, content: str) -> "Shape":
        parts = _PLAIN.split(content)
        figures = tuple(parts[1::2])
        # The first zero of `0.5` is part of the shape: such a number is less than one.
        parts[1::2] = [_changed(figure, _HIDDEN) for figure in figures]
        return cls("".join(parts), figures)


def figure_places(content: str) -> list[int]:
    """Where the plain numbers of a text begin."""
    return [found.start() for found in _PLAIN.finditer(content)]


def with_other_figures(content: str) -> str:
    """A text of the same shape in which every digit of the plain numbers is another one."""
    return _PLAIN.sub(lambda found: _changed(found[0], _OTHERS), content)


def _changed(figure: str, digits: dict[int, str] | dict[int, int]) -> str:
    return f"0{figure[1:].translate(digits)}" if figure[0] == "0" else figure.translate(digits)
