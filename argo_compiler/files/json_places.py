"""Places of values in a JSON text: line and column for given paths."""

import json
import re
from bisect import bisect_right
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Span

LONG_NUMBER = Message("it has a number with thousands of digits")
"""meaning of a ValueError of `json.loads` that is no JSONDecodeError"""

Step = str | int
JsonPath = tuple[Step, ...]
"""Names of fields and positions in lists, from the outermost value inward."""

_TOKEN = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"|[{}\[\],:]|[^\s{}\[\],:"]+')


def format_path(path: JsonPath) -> str:
    """Return the path as text, such as `tasks[3].transitions[0]`."""
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    return "".join(steps).removeprefix(".")


class JsonValue(NamedTuple):
    """Place of a value as offsets in the text; that of a container is only its opening bracket."""

    depth: int
    """number of containers around the value"""
    step: Step
    """key of the value, or its position in a list"""
    key: tuple[int, int] | None
    """start and end of its key with the quotes; None in a list and for the outermost value"""
    start: int
    end: int


class JsonText:
    """JSON text that `json.loads` has accepted, with the offsets at which its lines begin."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._lines = [0, *(m.end() for m in re.finditer("\n", text))]

    def span(self, start: int, end: int) -> Span:
        """Return the span from `start` to `end`, cut off at the end of the line of `start`."""
        line = bisect_right(self._lines, start)
        end = min(end, self._line_end(line))
        column = start - self._lines[line - 1] + 1
        return Span(line=line, column=column, length=max(1, end - start))

    def line_text(self, line_number: int) -> str:
        """Return the text of a line (from 1) without its line end."""
        return self.text[self._lines[line_number - 1] : self._line_end(line_number)].rstrip("\r")

    def _line_end(self, number: int) -> int:
        return self._lines[number] - 1 if number < len(self._lines) else len(self.text)

    def iter_all_values(self) -> Iterator[JsonValue]:
        """Yield all values, containers too, in the order of their first characters in the text.

        This is not recursive, so any depth of nesting is possible.
        """
        positions: list[
            int | None
        ] = []  # for each open container: the next position in a list, None in an object
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
            yield JsonValue(len(positions), step, key, start, end)
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
    """Node of the tree of paths to find; holds its value and the next steps of the paths."""

    value: JsonValue | None = None
    first: JsonValue | None = None
    """first member of the value if that is an object"""
    children: dict[Step, "_Node"] = field(default_factory=dict)


def find_places_or_parents(text: JsonText, paths: Collection[JsonPath]) -> dict[JsonPath, Span]:
    """Return, by path, the place in the text of the value there, including its key if it has one.

    The place of an object without a key is that of its first member, which shows more than a brace.
    If a path does not exist, the place is that of its longest existing part. Takes linear time.
    """
    root = _Node()
    for path in paths:
        node = root
        for step in path:
            node = node.children.setdefault(step, _Node())
    _locate(text, root)
    return {path: _place(text, root, path) for path in paths}


def _locate(text: JsonText, root: _Node) -> None:
    enclosing: list[_Node | None] = []  # node of each open container; None if no path leads there
    for value in text.iter_all_values():
        del enclosing[value.depth :]
        if value.depth == 0:
            node: _Node | None = root
        else:
            outer = enclosing[-1]
            node = outer.children.get(value.step) if outer else None
            if outer and outer.first is None and value.key:
                outer.first = value
        if node:
            node.value = value
        enclosing.append(node)


def _place(text: JsonText, root: _Node, path: JsonPath) -> Span:
    node = root
    for step in path:
        child = node.children[step]
        if child.value is None:
            break
        node = child
    value = node.value
    if value is None:
        return Span(line=1, column=1)
    if value.key is None and node.first is not None:
        value = node.first
    return text.span(value.key[0] if value.key else value.start, value.end)


def find_duplicate_keys(text: JsonText, limit: int) -> dict[JsonPath, Span]:
    """Return the paths of keys that occur repeatedly in their object, with the first key's place.

    At most `limit` paths are returned. `find_places_or_parents` returns the last place of a key.
    """
    duplicates: dict[JsonPath, Span] = {}
    path: list[Step] = []
    seen: list[dict[Step, tuple[int, int]]] = [{}]  # for each depth, the keys of the open object
    for value in text.iter_all_values():
        del path[max(0, value.depth - 1) :], seen[value.depth + 1 :]
        if value.depth:
            path.append(value.step)
        if value.key:
            first = seen[value.depth].setdefault(value.step, value.key)
            if first != value.key:
                duplicates.setdefault(tuple(path), text.span(*first))
                if len(duplicates) == limit:
                    break
        seen.append({})
    return duplicates
