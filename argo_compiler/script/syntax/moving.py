"""A node of a text that stands at another place as well, or says the same of other figures."""

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import cache
from typing import Any

from argo_compiler.diagnostics import Span, span_at
from argo_compiler.script.syntax.tree.manner import Joints, Manner
from argo_compiler.script.syntax.tree.node import Node
from argo_compiler.script.syntax.words.unknown import Fill, Unknown, UnknownText

Move = Callable[[int, int, Sequence[str]], Any]
"""the part so many lines and columns further on, with these figures for those that are unknown"""
_Fill = Callable[[object, object], None]


def mover(part: object) -> Move | None:
    """What makes the same part for another place; None if it says nothing of its place, nor of
    a figure that is not known."""
    if type(part) in (Unknown, UnknownText):
        fill: Fill = part.fill  # type: ignore[attr-defined]
        return lambda _lines, _columns, figures: fill(figures)
    match part:
        case Span(line=line, column=column, length=length):
            return lambda lines, columns, _: span_at(line + lines, column + columns, length)
        case tuple():
            moves = [mover(one) for one in part]
            if not any(moves):
                return None
            pairs = list(zip(part, moves, strict=True))
            return lambda lines, columns, figures: tuple(
                [one if move is None else move(lines, columns, figures) for one, move in pairs]
            )
        case Node() | Manner() | Joints():
            return _mover_of_node(part)
    return None


def _mover_of_node(part: Node | Manner | Joints) -> Move:
    type_: Any = type(part)
    same: list[tuple[_Fill, object]] = []
    moving: list[tuple[_Fill, Move]] = []
    for name, fill in _slots(type_):
        value = getattr(part, name)
        move = mover(value)
        if move is None:
            same.append((fill, value))
        else:
            moving.append((fill, move))

    def moved(lines: int, columns: int, figures: Sequence[str]) -> object:
        new = object.__new__(type_)
        for fill, value in same:
            fill(new, value)
        for fill, move in moving:
            fill(new, move(lines, columns, figures))
        return new

    return moved


@cache
def _slots(type_: type[Any]) -> list[tuple[str, _Fill]]:
    """The fields of a node, and how each is filled: through its slot, which is several times as
    fast as making a node."""
    return [(field.name, getattr(type_, field.name).__set__) for field in fields(type_)]
