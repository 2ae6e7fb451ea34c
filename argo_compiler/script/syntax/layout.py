"""The lines of a script: which are steps, bullets, fields, titles and remarks, and what belongs
together.

A line that is not finished goes on in the next one. Whether it is finished is told by what it says:
a line that makes no sense by itself, or the next of which makes none, goes on.
"""

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from argo_compiler.script.syntax.source import ScriptText, join
from argo_compiler.script.syntax.understanding import quotes


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
    heading: bool = False
    """whether it stands over others, if it says nothing by itself: marked so, or before a mark"""


@dataclass(slots=True)
class Item:
    """A step, a bullet or a paragraph: its text, and what lies within it."""

    text: ScriptText
    line: Line
    items: "list[Item]" = field(default_factory=list)


_NUMBER = re.compile(
    r"\(?(?:(?:step|schritt)\s+)?([0-9]{1,6})\s*(?:[.)](?![0-9])|:(?![0-9])|\s-\s+(?=[^\W\d_]))\s*",
    re.IGNORECASE,
)
_SUB_NUMBER = re.compile(r"[0-9]{1,4}\.[0-9]{1,4}[.)]?\s+(?=[A-Z])")
_STEP = re.compile(r"(?:step|schritt)\s+([0-9]{1,6})\b[.:)]?\s*", re.IGNORECASE)
_LETTER = re.compile(r"\(?([a-z]|[ivx]{1,4})[.)]\s+", re.IGNORECASE)
_BULLET = re.compile(r"[-*+•–‣◦]\s+(?:\[[ xX]?\]\s+)?|#+\s+")
_RULE = re.compile(r"([-=_~*])\1{2,}")
QUOTED = re.compile(r'"(?:[^"\\]|\\.)*"')
_RUN_IN = re.compile(r"(?:^|[,;.!])\s+([0-9]{1,3})[.)]\s+(?=[^\W\d_])")


_SENTENCE_END = re.compile(
    r"(?:[.!?…]+|;(?=\s*(?:if|otherwise|else|when|wenn|falls|sonst)\b))(?=\s|$)", re.I
)
_ABBREVIATION = re.compile(r"\b(?:no|nr|approx|ca|max|min|e\.g|i\.e|z\.b)\.$", re.IGNORECASE)
_LABELLED = re.compile(r"\b(?:no|nr)\.$", re.IGNORECASE)
_LABEL = re.compile(r"\s*[A-Za-z]?-?[0-9]")
_ORDINAL = re.compile(r"(?<![\w.,])[0-9]{1,2}\.$")
_ORDINAL_OF = re.compile(
    r"(?:\s*(?:,|und|oder|bis)\s*[0-9]{1,2}\.)*\s+(?:stock|etage|geschoss|ebene|deck)", re.I
)
"""`im 1. und 2. Stock`"""
_LAST_HALF = re.compile(r"([^\W\d_]+)-$")
_FIRST_HALF = re.compile(r"[^\W\d_]+")


def lines_of(texts: Sequence[ScriptText]) -> Iterator[Line]:
    """The lines that say anything, with their marks."""
    first = True
    above: Line | None = None
    for text in texts:
        stripped = text.strip()
        rule = stripped.content[:3] and _RULE.fullmatch(stripped.content)
        if rule and above is not None:
            above.heading = above.heading or (not first and above.mark is Mark.NONE)
        if not stripped.content or rule:
            first = True
            continue
        indent = len(text.content) - len(text.content.lstrip())
        for line in _split(_marked(stripped, indent)):
            line.first = first
            first = False
            if above is not None:
                if line.mark is not Mark.NONE and above.mark is Mark.NONE:
                    above.heading = True
                yield above
            above = line
    if above is not None:
        yield above


def _marked(text: ScriptText, indent: int) -> Line:
    if bullet := _BULLET.match(text.content):
        inner = _marked(text[bullet.end() :].strip(), indent)
        mark = inner.mark if inner.number else Mark.BULLET
        return Line(inner.text, indent, mark, inner.number, heading=text.content.startswith("#"))
    if number := _NUMBER.match(text.content) or _STEP.match(text.content):
        return Line(text[number.end() :].strip(), indent, Mark.NUMBER, int(number[1]))
    if letter := _LETTER.match(text.content) or _SUB_NUMBER.match(text.content):
        return Line(text[letter.end() :].strip(), indent, Mark.LETTER)
    return Line(text, indent)


def _split(line: Line) -> Iterator[Line]:
    """The steps of a line that has more than one: `1. ..., 2. ..., 3. ...`."""
    expected = (line.number or 0) + 1
    start = 0
    quoted = [m.span() for m in QUOTED.finditer(line.text.content)]
    for found in _RUN_IN.finditer(line.text.content):
        if any(a < found.start() < b for a, b in quoted):
            continue
        if line.number is None or int(found[1]) != expected:
            continue
        before = line.text.content[: found.start()]
        if before.count("(") > before.count(")"):
            continue  # `(1, 2, 5) heading 90 degrees` in step 4
        yield Line(line.text[start : found.start()].strip(), line.indent, line.mark, expected - 1)
        start = found.end()
        expected += 1
    number = expected - 1 if line.number is not None else None
    yield Line(line.text[start:].strip(), line.indent, line.mark, number)


def items_of(
    lines: Sequence[Line],
    complete: Callable[[ScriptText], bool],
    alone: Callable[[ScriptText], bool],
    words: Collection[str],
) -> list[Item]:
    """The steps and paragraphs, those that lie within others inside of them. `complete` tells
    whether a text makes sense by itself, `alone` whether a line never goes on with another one, and
    `words` whether a hyphen at the end of a line divides a word."""
    top: list[Item] = []
    around: list[Item] = []
    for line in lines:
        follows = line.mark is Mark.NONE and around and not line.first and not alone(line.text)
        if follows and (
            _is_unfinished(around[-1].text, line.text)
            or (not alone(around[-1].text) and _goes_on(around[-1], line, complete))
        ):
            around[-1].text = _joined(around[-1].text, line.text, words)
            continue
        item = Item(line.text, line)
        while around and not _lies_in(line, around[-1].line):
            around.pop()
        (around[-1].items if around else top).append(item)
        around.append(item)
    return top


def _is_unfinished(text: ScriptText, following: ScriptText) -> bool:
    """Whether a text plainly goes on: after a comma or `and`, and between quoted pieces."""
    content = text.content
    quoted = content.endswith('"') and following.content.startswith('"')
    return quoted or content.endswith((",", " and", " or", '":'))


def _goes_on(item: Item, line: Line, complete: Callable[[ScriptText], bool]) -> bool:
    """Whether a line without a mark goes on with the text above it."""
    last = sentences(item.text)[-1] if item.text.content else item.text
    whole, rest = complete(last), complete(line.text)
    ended = item.text.content.endswith((".", "!", "?"))
    if whole and rest:
        return item.line.mark is Mark.NONE and ended
    if ended or (whole and line.heading):
        return False
    return not (whole or rest) or complete(join([last, line.text]))


def _joined(above: ScriptText, below: ScriptText, words: Collection[str]) -> ScriptText:
    """Two lines in one; a word that a hyphen divides becomes whole."""
    left, right = _LAST_HALF.search(above.content), _FIRST_HALF.match(below.content)
    if left is None or right is None or (left[1] + right[0]).lower() not in words:
        return join([above, below])
    whole = above[: len(above.content) - 1]
    return ScriptText(whole.content + below.content, [*whole.offsets, *below.offsets], above.source)


def _lies_in(line: Line, outer: Line) -> bool:
    """Whether a line lies within another one: a letter under a number, or what is indented."""
    if line.mark is Mark.NONE:
        return outer.mark is not Mark.NONE and line.indent > outer.indent
    if outer.mark is Mark.NONE:
        return False
    if outer.mark is Mark.NUMBER and line.mark is Mark.LETTER:
        return True
    return line.indent > outer.indent


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found: list[ScriptText] = []
    start = 0
    quoted = quotes(text.content)
    for end in _SENTENCE_END.finditer(text.content):
        if any(a < end.start() < b for a, b in quoted):
            continue
        goes_on = not text.content[end.end() :].lstrip()[:1].isupper()
        more = goes_on and end.end() < len(text.content)
        if more and _ABBREVIATION.search(text.content[: end.start() + 1]):
            continue
        if _goes_on_behind(text.content, end.start() + 1):
            continue
        found.append(text[start : end.start()].strip())
        start = end.end()
    found.append(text[start:].strip())
    return [sentence for sentence in found if sentence.content]


def _goes_on_behind(content: str, stop: int) -> bool:
    """Whether a full stop belongs to `Nr. R25` or `2. Stock`."""
    if _LABELLED.search(content, max(0, stop - 5), stop) and _LABEL.match(content, stop):
        return True
    ordinal = _ORDINAL.search(content, max(0, stop - 4), stop)
    return ordinal is not None and _ORDINAL_OF.match(content, stop) is not None
