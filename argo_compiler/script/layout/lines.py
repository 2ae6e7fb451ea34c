"""The lines of a script with the numbers, letters and bullets that they begin with, and where the
sentences in them end: not behind `approx.`, in `Nr. R25` or in `2. Stock`."""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.script.documents.signs import place_in_order
from argo_compiler.script.documents.source import ScriptText, Source, join, quotes
from argo_compiler.script.sentences.words.loading import pattern


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
    rank: int | None = None
    """which letter it begins with, from 1"""
    first: bool = False
    """whether it is the first line of a paragraph"""
    marked: ScriptText | None = None
    """the line with its mark, if that is a number"""
    heading: bool = False
    """whether it stands over others, if it says nothing by itself: marked so, or before a mark"""

    @property
    def unmarked(self) -> ScriptText:
        """The text, if what looks like a mark is none."""
        return self.marked or self.text


_NUMBER = (
    r"\(?(?:<step>\s+)?([0-9]{1,6})(?:(?:st|nd|rd|th)(?=:))?"
    r"\s*(?:\.?\)(?![0-9])|\.(?![0-9])|:(?![0-9])|\s-\s+(?=[^\W\d_]))\s*"
)
_STEP = r"<step>\s+([0-9]{1,6})\b[.:)]?(?!\s*(?:<about_step>)\b)\s*"
_SUB_NUMBER = re.compile(r"[0-9]{1,4}\.[0-9]{1,4}[.)]?\s+(?=[A-Z])")
_BRACKETED = re.compile(r"\[([0-9]{1,6})\]\s+")
_LETTER = re.compile(r"\(?([a-z]|[ivx]{1,4})[.)]\s+", re.IGNORECASE)
_BULLET = re.compile(
    r"(?:[-*+o]\s+|-(?=[^\W\d_])|[•–‣◦·▪▫●○■□☐☑✓✔→➔►▶]\s*)(?:\[[ xX]?\]\s+)?|#+\s+"
)
_RULE = re.compile(r"([-=_~*'])\1{2,}|\+[-=+]+\+")
_RULE_SIGNS = ("-", "=", "_", "~", "*", "'", "+")
_MAIL = re.compile(r"\s*(?:>\s?)+")
"""before the lines of a letter that is quoted in another one"""
_STAMP = re.compile(
    r"\s*(?:\[(?:[0-9./-]+,?\s*)?[0-9]{1,2}[:.][0-9]{2}(?::[0-9]{2})?(?:,?\s*[0-9./-]+)?\]"
    r"|[0-9]{1,2}:[0-9]{2}(?=\s))\s*[^\W\d_][\w .-]{0,30}:\s+"
)
_SPEAKER = re.compile(r"\s*([^\W\d_]\w{1,20}):\s+(?=\S)")
"""before a line of a chat: `[07:52, 14/03] Jonas: `"""
_RUN_IN = re.compile(r"(?:^|[,;.!])\s+([0-9]{1,3})[.)]\s+(?=[^\W\d_])")
_LABEL = re.compile(r"\s*(?:[A-Za-z]?-?[0-9]|[A-Z](?!\w))")
_ORDINAL = re.compile(r"(?<![\w.,])[0-9]{1,2}\.$")
_SENTENCE_END = r"(?:[.!?…]+|;(?=\s*<new_sentence>\b))(?=\s|$)"
_ABBREVIATED = r"\b<abbreviation>\.$"
_NUMBERED = r"\b<number>\.$"
_MORE_ORDINALS = r"(?:\s*(?:,|<between_ordinals>)\s*[0-9]{1,2}\.)"
_BEHIND_ORDINAL = (
    rf"{_MORE_ORDINALS}*(?:\s+<behind_ordinals>|\s*(?:,|<between_ordinals>)$)|{_MORE_ORDINALS}+$"
)
"""what stands behind an ordinal, where no line cuts it: `im 1. und 2. Stock`"""
_FLOOR_ONLY = r"(?:<behind_ordinals>)\W*"
_INITIAL = re.compile(r"(?:^|[:.(]\s*|\b(?:by|von)\s+|\b[^\W\d_a-z]\w+\s+)[^\W\d_a-z]\.$")
"""`Operator: H. Ruiz`, `prepared by K. Haugen`, `M. Dos Santos`, in all languages"""
_FAMILY_NAME = re.compile(r"\s+(?:[^\W\d_a-z]\.|[^\W\d_a-z][^\W\d_]+)")
_NEXT_SIGN = re.compile(r"\s*(\S)")


def lines_of(texts: Sequence[ScriptText]) -> Iterator[ScriptLine]:
    """The lines that say anything, with their marks."""
    first = True
    above: ScriptLine | None = None
    for text in _unquoted(texts):
        stripped = text.strip()
        rule = stripped.content[:1] in _RULE_SIGNS and _RULE.fullmatch(stripped.content)
        if rule and above is not None:
            above.heading = above.heading or (not first and above.mark is LineMark.NONE)
        if not stripped.content or rule:
            first = True
            continue
        indent = len(text.content) - len(text.content.lstrip(" \t"))
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


def stamped(source: Source, known: Collection[str]) -> dict[int, ScriptText]:
    """Return the lines of a chat without the time and the name before each, by their numbers.
    `known` are words that are no names."""
    found: dict[int, ScriptText] = {}
    names = Counter(name[1] for line in source.lines if (name := _SPEAKER.match(line)))
    names = Counter({name: n for name, n in names.items() if name.lower() not in known})
    talk = len(names) > 1 and max(names.values()) > 1
    for number, line in enumerate(source.lines, start=1):
        stamp = _STAMP.match(line)
        if stamp is None and talk and (name := _SPEAKER.match(line)) and name[1] in names:
            stamp = name
        if stamp is not None:
            text = source.line_text(number)[stamp.end() :]
            mark = ScriptText("- ", [text.first] * 2, source) if text.content else text
            found[number] = join([mark, text], "")  # no line of a chat goes on in the next one
    return found if len(found) > 1 else {}


def unmarked(text: ScriptText) -> ScriptText:
    """Return a line without its number, letter or bullet."""
    return _marked(text.strip(), 0).text


def _unquoted(texts: Sequence[ScriptText]) -> Iterator[ScriptText]:
    """The lines of a letter without its marks. A single line with one is taken as it is: in it the
    sign may say that a value is greater."""
    if not any(">" in text.content for text in texts):
        yield from texts
        return
    marks = [_MAIL.match(text.content) for text in texts]
    for i, (text, mark) in enumerate(zip(texts, marks, strict=True)):
        beside = any(marks[k : k + 1] != [None] for k in (i - 1, i + 1) if 0 <= k < len(marks))
        yield text[mark.end() :] if mark is not None and beside else text


def _marked(text: ScriptText, indent: int) -> ScriptLine:
    if not text.content[:1].isdigit() and (bullet := _BULLET.match(text.content)):
        inner = _marked(text[bullet.end() :].strip(), indent)
        mark = inner.mark if inner.number else LineMark.BULLET
        return ScriptLine(
            inner.text, indent, mark, inner.number, heading=text.content.startswith("#")
        )
    number = pattern(_NUMBER).match(text.content) or pattern(_STEP).match(text.content)
    if number := number or _BRACKETED.match(text.content):
        rest = text[number.end() :].strip()
        if pattern(_FLOOR_ONLY).fullmatch(rest.content):
            return ScriptLine(text, indent)  # `1. Obergeschoss`
        return ScriptLine(rest, indent, LineMark.NUMBER, int(number[1]), marked=text)
    if letter := _LETTER.match(text.content):
        rest, rank = text[letter.end() :].strip(), place_in_order(letter[1])
        return ScriptLine(rest, indent, LineMark.LETTER, rank=rank)
    if number := _SUB_NUMBER.match(text.content):
        return ScriptLine(text[number.end() :].strip(), indent, LineMark.LETTER)
    return ScriptLine(text, indent)


def _split(line: ScriptLine) -> Iterator[ScriptLine]:
    """The steps of a line that has more than one: `1. ..., 2. ..., 3. ...`."""
    if line.number is None or _RUN_IN.search(line.text.content) is None:
        yield line
        return
    expected = line.number + 1
    start = 0
    quoted = quotes(line.text.content)
    for found in _RUN_IN.finditer(line.text.content):
        if any(a < found.start() < b for a, b in quoted):
            continue
        if int(found[1]) != expected:
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


# ---- sentences


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found = (text[start:end].strip() for start, end in sentence_bounds(text.content))
    return [sentence for sentence in found if sentence.content]


def sentence_bounds(content: str) -> list[tuple[int, int]]:
    """Where the sentences of a text begin and end; at least one."""
    found: list[tuple[int, int]] = []
    start = k = 0
    quoted = quotes(content)
    for end in pattern(_SENTENCE_END).finditer(content):
        while k < len(quoted) and quoted[k][1] <= end.start():
            k += 1
        if k < len(quoted) and quoted[k][0] < end.start():
            continue
        behind = _NEXT_SIGN.match(content, end.end())
        more = behind is not None and not behind[1].isupper()
        if more and pattern(_ABBREVIATED).search(content, max(0, end.start() - 8), end.start() + 1):
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
    if pattern(_NUMBERED).search(content, max(0, stop - 5), stop) and _LABEL.match(content, stop):
        return True
    if _INITIAL.search(content, max(0, stop - 30), stop) and _FAMILY_NAME.match(content, stop):
        return True
    ordinal = _ORDINAL.search(content, max(0, stop - 4), stop)
    return ordinal is not None and pattern(_BEHIND_ORDINAL).match(content, stop) is not None
