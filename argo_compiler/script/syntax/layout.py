"""The lines of a script: which are steps, bullets, fields, titles and remarks, and what belongs
together.

A line that is not finished goes on in the next one. Whether it is finished is told by what it says:
a line that makes no sense by itself, or the next of which makes none, goes on.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from argo_compiler.script.syntax.source import ScriptText, join


class Mark(StrEnum):
    """What a line begins with."""

    NUMBER = "number"
    LETTER = "letter"
    BULLET = "bullet"
    NONE = "none"


@dataclass(slots=True)
class Line:
    """A line without its mark."""

    text: ScriptText
    indent: int
    mark: Mark = Mark.NONE
    number: int | None = None
    first: bool = False
    """whether it is the first line of a paragraph"""


@dataclass(slots=True)
class Item:
    """A step, a bullet or a paragraph: its text, and what lies within it."""

    text: ScriptText
    line: Line
    items: "list[Item]" = field(default_factory=list)


_NUMBER = re.compile(r"(?:step\s+)?([0-9]{1,6})\s*(?:[.)](?![0-9])|:(?![0-9]))\s*", re.IGNORECASE)
_STEP = re.compile(r"step\s+([0-9]{1,6})\b[.:)]?\s*", re.IGNORECASE)
_LETTER = re.compile(r"\(?([a-z]|[ivx]{1,4})[.)]\s+", re.IGNORECASE)
_BULLET = re.compile(r"[-*+•–‣◦]\s+|#+\s+")
_RUN_IN = re.compile(r"(?:^|[,;.!])\s+([0-9]{1,3})[.)]\s+(?=[^\W\d_])")


def lines_of(texts: Sequence[ScriptText]) -> Iterator[Line]:
    """The lines that say anything, with their marks."""
    first = True
    for text in texts:
        stripped = text.strip()
        if not stripped.content:
            first = True
            continue
        indent = len(text.content) - len(text.content.lstrip())
        for line in _split(_marked(stripped, indent)):
            line.first = first
            first = False
            yield line


def _marked(text: ScriptText, indent: int) -> Line:
    if bullet := _BULLET.match(text.content):
        inner = _marked(text[bullet.end() :].strip(), indent)
        return Line(inner.text, indent, inner.mark if inner.number else Mark.BULLET, inner.number)
    if number := _NUMBER.match(text.content) or _STEP.match(text.content):
        return Line(text[number.end() :].strip(), indent, Mark.NUMBER, int(number[1]))
    if letter := _LETTER.match(text.content):
        return Line(text[letter.end() :].strip(), indent, Mark.LETTER)
    return Line(text, indent)


def _split(line: Line) -> Iterator[Line]:
    """The steps of a line that has more than one: `1. ..., 2. ..., 3. ...`."""
    expected = (line.number or 0) + 1
    start = 0
    for found in _RUN_IN.finditer(line.text.content):
        if line.number is None or int(found[1]) != expected:
            continue
        yield Line(line.text[start : found.start()].strip(), line.indent, line.mark, expected - 1)
        start = found.end()
        expected += 1
    number = expected - 1 if line.number is not None else None
    yield Line(line.text[start:].strip(), line.indent, line.mark, number)


def items_of(
    lines: Sequence[Line],
    complete: Callable[[ScriptText], bool],
    alone: Callable[[ScriptText], bool],
) -> list[Item]:
    """The steps and paragraphs, those that lie within others inside of them. `complete` tells
    whether a text makes sense by itself, `alone` whether a line never goes on with another one."""
    top: list[Item] = []
    around: list[Item] = []
    for line in lines:
        follows = line.mark is Mark.NONE and around and not line.first and not alone(line.text)
        if follows and not alone(around[-1].text) and _goes_on(around[-1], line, complete):
            around[-1].text = join([around[-1].text, line.text])
            continue
        item = Item(line.text, line)
        while around and not _lies_in(line, around[-1].line):
            around.pop()
        (around[-1].items if around else top).append(item)
        around.append(item)
    return top


def _goes_on(item: Item, line: Line, complete: Callable[[ScriptText], bool]) -> bool:
    """Whether a line without a mark goes on with the text above it."""
    whole, rest = complete(item.text), complete(line.text)
    if whole and rest:
        return item.line.mark is Mark.NONE and item.text.content.endswith((".", "!", "?"))
    return not rest or complete(join([item.text, line.text]))


def _lies_in(line: Line, outer: Line) -> bool:
    """Whether a line lies within another one: a letter under a number, or what is indented."""
    if line.mark is Mark.NONE:
        return outer.mark is not Mark.NONE and line.indent > outer.indent
    if outer.mark is Mark.NONE:
        return False
    if outer.mark is Mark.NUMBER and line.mark is Mark.LETTER:
        return True
    return line.indent > outer.indent
