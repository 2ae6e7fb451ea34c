"""Where the values of a JSON text stand: line and column for the paths that someone asks for."""

import json
import re
from bisect import bisect_right
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from argo_compiler.diagnostics import Span

Step = str | int
JsonPath = tuple[Step, ...]
"""names of fields and positions in lists, from the outermost value inward"""

_TOKEN = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"|[{}\[\],:]|[^\s{}\[\],:"]+')


def format_path(path: JsonPath) -> str:
    """The path as it is written: `tasks[3].transitions[0]`."""
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    return "".join(steps).removeprefix(".")


class Value(NamedTuple):
    """Where a value stands, by offsets in the text. A container ends with its opening bracket."""

    depth: int
    """in how many containers it lies"""
    step: Step
    """its key or its position in the container"""
    key: tuple[int, int] | None
    """start and end of its key, quotes included"""
    start: int
    end: int


class JsonText:
    """A JSON text that `json.loads` has accepted. Knows where its lines begin."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._lines = [0, *(m.end() for m in re.finditer("\n", text))]

    def span(self, start: int, end: int) -> Span:
        """The stretch from `start` to `end`, or to the end of the line that it begins in."""
        line = bisect_right(self._lines, start)
        end = min(end, self._line_end(line))
        column = start - self._lines[line - 1] + 1
        return Span(line=line, column=column, length=max(1, end - start))

    def line(self, number: int) -> str:
        """The text of a line, without its end."""
        return self.text[self._lines[number - 1] : self._line_end(number)].rstrip("\r")

    def _line_end(self, number: int) -> int:
        return self._lines[number] - 1 if number < len(self._lines) else len(self.text)

    def values(self) -> Iterator[Value]:
        """All values in the order in which they begin. Depth of nesting costs nothing."""
        positions: list[int | None] = []  # for each open container: in lists, the next position
        key: tuple[int, int] | None = None
        for token in _TOKEN.finditer(self.text):
            start, end = token.span()
            character = self.text[start]
            if character in "}]":
                positions.pop()
                continue
            if character == ",":
                if (position := positions[-1]) is not None:
                    positions[-1] = position + 1
                continue
            if character == ":":
                continue
            position = positions[-1] if positions else 0
            if position is None and key is None:
                key = (start, end)
                continue
            step = self._name(key) if key else position or 0
            yield Value(len(positions), step, key, start, end)
            key = None
            if character in "{[":
                positions.append(None if character == "{" else 0)

    def _name(self, key: tuple[int, int]) -> str:
        start, end = key
        if "\\" in (written := self.text[start:end]):
            return str(json.loads(written))
        return written[1:-1]


@dataclass(slots=True)
class _Node:
    """A path that is looked for, with the paths that go on from it."""

    value: Value | None = None
    first: Value | None = None
    """the first member, if it is an object"""
    further: dict[Step, "_Node"] = field(default_factory=dict)


def find_places(text: JsonText, paths: Collection[JsonPath]) -> dict[JsonPath, Span]:
    """The place of each path's value, with its key where it has one.

    An object is shown by its first member, which tells more than a brace. If a path does not exist,
    the longest part of it that does stands for it. Linear time.
    """
    root = _Node()
    for path in paths:
        node = root
        for step in path:
            node = node.further.setdefault(step, _Node())
    _locate(text, root)
    return {path: _place(text, root, path) for path in paths}


def _locate(text: JsonText, root: _Node) -> None:
    around: list[_Node | None] = []  # for each open container, what is looked for in it
    for value in text.values():
        del around[value.depth :]
        if value.depth == 0:
            node: _Node | None = root
        else:
            outer = around[-1]
            node = outer.further.get(value.step) if outer else None
            if outer and outer.first is None and value.key:
                outer.first = value
        if node:
            node.value = value
        around.append(node)


def _place(text: JsonText, root: _Node, path: JsonPath) -> Span:
    node = root
    for step in path:
        further = node.further[step]
        if further.value is None:
            break
        node = further
    value = node.value
    if value is None:
        return Span(line=1, column=1)
    if value.key is None and node.first is not None:
        value = node.first
    return text.span(value.key[0] if value.key else value.start, value.end)


def find_duplicates(text: JsonText, limit: int) -> dict[JsonPath, Span]:
    """The keys that stand more than once in their object, with where each stands first.

    At most `limit` of them. `find_places` tells where a key stands last.
    """
    found: dict[JsonPath, Span] = {}
    path: list[Step] = []
    seen: list[dict[Step, tuple[int, int]]] = [{}]  # for each depth, the keys of the open object
    for value in text.values():
        del path[max(0, value.depth - 1) :], seen[value.depth + 1 :]
        if value.depth:
            path.append(value.step)
        if value.key:
            first = seen[value.depth].setdefault(value.step, value.key)
            if first != value.key:
                found.setdefault(tuple(path), text.span(*first))
                if len(found) == limit:
                    break
        seen.append({})
    return found
