"""Heals the words that text recognition cut or misread.

A mission sheet is a table of two columns, and text recognition leaves tabs where the column
boundary cuts through a word. The letters beside the cut may stand twice or be lost. What a run of
tabs meant is decided by a vocabulary, in this order; the first rule under which the text makes
sense is taken:

1. Nothing is wrong with the letters: `R2⇥5` is `R25`, `whe⇥n` is `when`, and in `duration:⇥20'`
   or `Anomaly⇥specified` the tab separates.
2. Letters stand twice: `tota⇥al` is `total`, `ga⇥⇥auge` is `gauge`.
3. One letter is lost: `a⇥⇥d` is `and`. Never so for words with figures, such as `R25`.

If one rule allows several readings it is an error that lists them, and so is a cut between two
figures, for no vocabulary knows numbers. If no rule allows one, the tab separates, with a warning.

Besides that, typographic signs are read as their plain ones, emphasis, list marks and trailing
blanks are dropped.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

from argo_compiler.base.listing import listed
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.script.documents.source import (
    MAX_LINE,
    Diagnostics,
    ScriptText,
    Source,
    quotes,
)

_PLAIN = {
    **dict.fromkeys("\u2018\u2019\u201b\u2032\u00b4`", "'"),
    **dict.fromkeys("\u201c\u201d\u201e\u201f\u2033\u00ab\u00bb", '"'),
    **dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2015\u2212", "-"),
    **dict.fromkeys("\x0c\u200b\u200c\u200d\u2060\u00ad\ufeff", ""),
    "\ufb01": "fi",
    "\ufb02": "fl",
}
_NOISE = re.compile(r"[^ -)+-^a-~]|^\s*[-#+]|\s$")
"""only where this is found there may be anything to heal; most lines need no closer look"""
_EMPHASIS = re.compile(r"(?<!\w)(_{1,2}|`)(?=[^\s_`])([^_`]*\w[^_`]*)(?<!\s)\1(?!\w)")
_STEP = re.compile(r"\s*[0-9]+[.)]")
_TABS = re.compile(r"\t+")
_WORD = re.compile(r"[\w'-]*")
_MOST_CUTS = 8
"""runs of tabs in a row of the sheet; a line with more is no such row, and they separate"""
MOST_ERRORS = 1_000
"""errors of a script; the rest is not read, as it is none"""
_LONGEST_OVERLAP = 3
"""letters that may stand twice beside a cut"""


@dataclass(frozen=True)
class Healed:
    """The script's lines without noise, each character mapped to where it stood."""

    lines: tuple[ScriptText, ...]
    unreadable: frozenset[int]
    """the numbers of lines with an error; their text is not to be used"""
    diagnostics: tuple[Diagnostic, ...]

    @property
    def text(self) -> str:
        return "\n".join(line.content for line in self.lines)


def heal(
    text: str | Source,
    vocabulary: Collection[str],
    read: Mapping[int, ScriptText] = MappingProxyType({}),
) -> Healed:
    """The script with its noise healed by `vocabulary`, words in lower case.

    Every healed word is a warning that shows both forms. Lines stay lines; the tabs before a text
    in the second column become one. `read` has lines that need no healing, by their numbers.
    """
    source = Source(text) if isinstance(text, str) else text
    diagnostics = Diagnostics(source)
    lines = []
    unreadable = set()
    for number in range(1, len(source.lines) + 1):
        if number in read:
            lines.append(_plain(read[number]))
            continue
        line = source.line_text(number)
        if not _NOISE.search(line.content) and len(line.content) <= MAX_LINE:
            lines.append(line)
            continue
        if len(line.content) > MAX_LINE:
            message = f"the line has {len(line.content)} characters; at most {MAX_LINE} are read"
            diagnostics.error("long-line", message, line.span(0, 1), "break it into lines")
            lines.append(line[:0])
            unreadable.add(number)
            continue
        healed, clear = _join_cuts(_plain(line), vocabulary, diagnostics)
        if not clear:
            # The number stays, so that the steps are still one after the other.
            mark = _STEP.match(healed.content)
            healed = healed[: mark.end() if mark else 0]
            unreadable.add(number)
        lines.append(healed)
    return Healed(tuple(lines), frozenset(unreadable), tuple(diagnostics.entries))


def _plain(line: ScriptText) -> ScriptText:
    """The line in plain signs, without emphasis, list mark and trailing blanks."""
    if '"' not in line.content:
        for found in reversed(list(_EMPHASIS.finditer(line.content))):
            line = line.without(found.end(2), found.end()).without(*found.span(1))
    content = line.content
    if "*" in content or "`" in content:
        mark = len(content) - len(content.lstrip())
        quoted = quotes("".join((_PLAIN.get(c, c) or " ")[0] for c in content))
        said = [
            c
            if c in "*`" and any(a < i < b for a, b in quoted)
            else _sign(c, i == mark and content[i + 1 : i + 2] == " ")
            for i, c in enumerate(content)
        ]
    elif not content.isascii():
        said = [_sign(c) for c in content]
    else:
        return line[: len(content.rstrip())]
    offsets = [at for sign, at in zip(said, line.offsets, strict=True) for _ in sign]
    line = ScriptText("".join(said), offsets, line.source)
    return line[: len(line.content.rstrip())]


def plain_signs(text: str) -> str:
    """Return a text of one line with plain signs in place of typographic ones: `20′` as `20'`."""
    return "".join(map(_sign, text))


@lru_cache(maxsize=1024)
def _sign(character: str, is_mark: bool = False) -> str:
    if character == "*":
        return "-" if is_mark else ""
    if character in _PLAIN:
        return _PLAIN[character]
    return " " if character.isspace() and character != "\t" else character


def _join_cuts(
    line: ScriptText, vocabulary: Collection[str], diagnostics: Diagnostics
) -> tuple[ScriptText, bool]:
    """The line with every run of tabs read, and whether all of them could be."""
    clear = True
    done = 0
    if len(_TABS.findall(line.content)) > _MOST_CUTS:
        return ScriptText(line.content.replace("\t", " "), line.offsets, line.source), clear
    while run := _TABS.search(line.content, done):
        start, end = run.span()
        if start == 0:
            line = line.replace(0, end, "\t")
            done = 1
            continue
        left = _word_at_start(line.content[start - 1 :: -1])[::-1]
        right = _word_at_start(line.content[end:])
        readings = _readings(left, right, vocabulary)
        span = line.span(start - len(left), end + len(right))
        if len(readings) > 1:
            clear = False
            diagnostics.error(
                "ambiguous-cut",
                f"`{left} {right}` can be read as {listed((f'`{r}`' for r in readings), 'or')}",
                span,
                "write it with the intended spacing, without the tab",
            )
        elif not readings:
            diagnostics.warning(
                "unclear-cut", f"`{left} {right}` can be one word; it is read as two", span
            )
        if len(readings) == 1 and " " not in readings[0]:
            diagnostics.warning("healed", f"read `{left} {right}` as `{readings[0]}`", span)
            line = line.replace(start - len(left), end + len(right), readings[0])
            done = start - len(left) + len(readings[0])
        else:
            line = line.replace(start, end, " ")
            done = start + 1
    return line, clear


def _readings(left: str, right: str, vocabulary: Collection[str]) -> list[str]:
    """What `left`, a cut and `right` may mean by the first rule that allows anything."""
    if _is_sign(left) or _is_sign(right):
        return [f"{left} {right}"]
    if left.isdecimal() and right[0].isdecimal():
        return [left + right, f"{left} {right}"]

    def is_word(text: str) -> bool:
        # A single letter is what a cut leaves of a word, except for the article.
        return text == "a" or (len(text) > 1 and text in vocabulary)

    a, b = left.lower(), right.lower()
    intact = [left + right] if is_word(a + b) else []
    if (is_word(a) or a.isdecimal()) and (is_word(b) or b.isdecimal()):
        intact.append(f"{left} {right}")
    if intact:
        return intact

    overlaps = range(1, min(len(a), len(b), _LONGEST_OVERLAP) + 1)
    doubled = [left + right[k:] for k in overlaps if a[-k:] == b[:k] and is_word(a + b[k:])]
    if doubled:
        return doubled

    if any(c.isdecimal() for c in a + b):
        return []
    return sorted(
        left + word[len(a)] + right
        for word in vocabulary
        if len(word) == len(a) + len(b) + 1 and word.startswith(a) and word.endswith(b)
    )


def _word_at_start(text: str) -> str:
    match = _WORD.match(text)
    return match.group() if match else ""


def _is_sign(text: str) -> bool:
    return not any(c.isalnum() for c in text)
