"""The lines of a script: which are steps, bullets, fields, titles and remarks, and what belongs
together.

A line that is not finished goes on in the next one. Whether it is finished is told by what it says:
a line that makes no sense by itself, or the next of which makes none, goes on.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from argo_compiler.script.syntax.text.source import ScriptText, join
from argo_compiler.script.syntax.understanding import quotes


class LineMark(StrEnum):
    """What a line begins with."""

    NUMBER = "number"
    LETTER = "letter"
    BULLET = "bullet"
    NONE = "none"


@dataclass(slots=True)
class ScriptLine:
    """A line without its mark."""

    text: ScriptText
    indent: int
    mark: LineMark = LineMark.NONE
    number: int | None = None
    first: bool = False
    """whether it is the first line of a paragraph"""
    heading: bool = False
    """whether it stands over others, if it says nothing by itself: marked so, or before a mark"""


@dataclass(slots=True)
class LineItem:
    """A step, a bullet or a paragraph: its text, and what lies within it."""

    text: ScriptText
    line: ScriptLine
    items: "list[LineItem]" = field(default_factory=list)
    parts: list[ScriptText] = field(default_factory=list)
    """the lines of the text, while they are gathered"""
    tail: ScriptText | None = None
    """the last sentence of the parts"""

    def finish(self) -> "LineItem":
        """The item with its lines in one text."""
        if self.parts:
            self.text = join([self.text, *self.parts])
            self.parts = []
        for item in self.items:
            item.finish()
        return self


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
_NEXT_SIGN = re.compile(r"\s*(\S)")
_LONGEST_SENTENCE = 2000
"""characters; no line goes on with a longer one"""
_LONGEST_STRANGE = 300
"""characters; lines that make no sense are put together up to here"""
_DEEPEST = 20
"""items that lie in one another; what lies deeper is taken to lie there"""
_LAST_HALF = re.compile(r"([^\W\d_]+)-$")
_FIRST_HALF = re.compile(r"[^\W\d_]+")


def lines_of(texts: Sequence[ScriptText]) -> Iterator[ScriptLine]:
    """The lines that say anything, with their marks."""
    first = True
    above: ScriptLine | None = None
    for text in texts:
        stripped = text.strip()
        rule = stripped.content[:3] and _RULE.fullmatch(stripped.content)
        if rule and above is not None:
            above.heading = above.heading or (not first and above.mark is LineMark.NONE)
        if not stripped.content or rule:
            first = True
            continue
        indent = len(text.content) - len(text.content.lstrip())
        for line in _split(_marked(stripped, indent)):
            line.first = first
            first = False
            if above is not None:
                if line.mark is not LineMark.NONE and above.mark is LineMark.NONE:
                    above.heading = True
                yield above
            above = line
    if above is not None:
        yield above


def _marked(text: ScriptText, indent: int) -> ScriptLine:
    if bullet := _BULLET.match(text.content):
        inner = _marked(text[bullet.end() :].strip(), indent)
        mark = inner.mark if inner.number else LineMark.BULLET
        return ScriptLine(
            inner.text, indent, mark, inner.number, heading=text.content.startswith("#")
        )
    if number := _NUMBER.match(text.content) or _STEP.match(text.content):
        return ScriptLine(text[number.end() :].strip(), indent, LineMark.NUMBER, int(number[1]))
    if letter := _LETTER.match(text.content) or _SUB_NUMBER.match(text.content):
        return ScriptLine(text[letter.end() :].strip(), indent, LineMark.LETTER)
    return ScriptLine(text, indent)


def _split(line: ScriptLine) -> Iterator[ScriptLine]:
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
        yield ScriptLine(
            line.text[start : found.start()].strip(), line.indent, line.mark, expected - 1
        )
        start = found.end()
        expected += 1
    if start == 0:
        yield line
    else:
        yield ScriptLine(line.text[start:].strip(), line.indent, line.mark, expected - 1)


def items_of(
    lines: Iterable[ScriptLine],
    complete: Callable[[ScriptText], bool],
    alone: Callable[[ScriptText], bool],
    words: Collection[str],
) -> Iterator[LineItem]:
    """The steps and paragraphs, those that lie within others inside of them. `complete` tells
    whether a text makes sense by itself, `alone` whether a line never goes on with another one, and
    `words` whether a hyphen at the end of a line divides a word."""
    around: list[LineItem] = []
    for line in lines:
        if line.mark is LineMark.NONE and around and not line.first and not alone(line.text):
            above = around[-1]
            last = above.tail or above.text
            goes_on = _is_unfinished(last, line.text)
            if goes_on or (not alone(above.text) and _goes_on(above, last, line, complete)):
                _append(above, last, line.text, words)
                continue
        item = LineItem(line.text, line)
        while around and not _lies_in(line, around[-1].line):
            outer = around.pop()
            if not around:
                yield outer.finish()
        if around:
            around[-1].items.append(item)
        if len(around) < _DEEPEST:
            around.append(item)
    if around:
        yield around[0].finish()


def _append(item: LineItem, last: ScriptText, below: ScriptText, words: Collection[str]) -> None:
    """Lets an item go on with a line; a word that a hyphen divides becomes whole."""
    left, right = _LAST_HALF.search(last.content), _FIRST_HALF.match(below.content)
    if left is not None and right is not None and (left[1] + right[0]).lower() in words:
        whole = last[: len(last.content) - 1]
        offsets = [*whole.offsets, *below.offsets]
        joined = ScriptText(whole.content + below.content, offsets, last.source)
        in_text = not item.parts
        cut = item.text if in_text else item.parts.pop()
        offsets = [*cut.offsets[:-1], *below.offsets]
        merged = ScriptText(cut.content[:-1] + below.content, offsets, cut.source)
        if in_text:
            item.text = merged
        else:
            item.parts.append(merged)
    else:
        joined = join([last, below])
        item.parts.append(below)
    item.tail = joined[_bounds(joined.content)[-1][0] :]


def _is_unfinished(text: ScriptText, following: ScriptText) -> bool:
    """Whether a text plainly goes on: after a comma or `and`, and between quoted pieces."""
    content = text.content
    quoted = content.endswith('"') and following.content.startswith('"')
    return quoted or content.endswith((",", " and", " or", '":'))


def _goes_on(
    item: LineItem, last: ScriptText, line: ScriptLine, complete: Callable[[ScriptText], bool]
) -> bool:
    """Whether a line without a mark goes on with the last sentence above it."""
    if len(last.content) > _LONGEST_SENTENCE:
        return False
    whole, rest = complete(last), complete(line.text)
    ended = last.content.endswith((".", "!", "?"))
    if whole and rest:
        return item.line.mark is LineMark.NONE and ended
    if ended or (whole and line.heading):
        return False
    if not whole and not rest and len(last.content) <= _LONGEST_STRANGE:
        return True
    return complete(join([last, line.text]))


def _lies_in(line: ScriptLine, outer: ScriptLine) -> bool:
    """Whether a line lies within another one: a letter under a number, or what is indented."""
    if line.mark is LineMark.NONE:
        return outer.mark is not LineMark.NONE and line.indent > outer.indent
    if outer.mark is LineMark.NONE:
        return False
    if outer.mark is LineMark.NUMBER and line.mark is LineMark.LETTER:
        return True
    return line.indent > outer.indent


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found = (text[start:end].strip() for start, end in _bounds(text.content))
    return [sentence for sentence in found if sentence.content]


def _bounds(content: str) -> list[tuple[int, int]]:
    """Where the sentences of a text begin and end; at least one."""
    found: list[tuple[int, int]] = []
    start = k = 0
    quoted = quotes(content)
    for end in _SENTENCE_END.finditer(content):
        while k < len(quoted) and quoted[k][1] <= end.start():
            k += 1
        if k < len(quoted) and quoted[k][0] < end.start():
            continue
        behind = _NEXT_SIGN.match(content, end.end())
        more = behind is not None and not behind[1].isupper()
        if more and _ABBREVIATION.search(content, max(0, end.start() - 8), end.start() + 1):
            continue
        if _goes_on_behind(content, end.start() + 1):
            continue
        found.append((start, end.start()))
        start = end.end()
    if content[start:].strip() or not found:
        found.append((start, len(content)))
    return found


def _goes_on_behind(content: str, stop: int) -> bool:
    """Whether a full stop belongs to `Nr. R25` or `2. Stock`."""
    if _LABELLED.search(content, max(0, stop - 5), stop) and _LABEL.match(content, stop):
        return True
    ordinal = _ORDINAL.search(content, max(0, stop - 4), stop)
    return ordinal is not None and _ORDINAL_OF.match(content, stop) is not None
