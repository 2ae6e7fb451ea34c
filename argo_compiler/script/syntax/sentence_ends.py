"""Where the sentences of a text end: not behind `approx.`, in `Nr. R25` or in `2. Stock`."""

import re
from functools import cache

from argo_compiler.script.syntax.text.source import ScriptText, quotes
from argo_compiler.script.syntax.words.loading import everywhere

_LABEL = re.compile(r"\s*(?:[A-Za-z]?-?[0-9]|[A-Z](?!\w))")
_ORDINAL = re.compile(r"(?<![\w.,])[0-9]{1,2}\.$")
_NEXT_SIGN = re.compile(r"\s*(\S)")


def sentences(text: ScriptText) -> list[ScriptText]:
    """The sentences of a text, without their full stops."""
    found = (text[start:end].strip() for start, end in sentence_bounds(text.content))
    return [sentence for sentence in found if sentence.content]


def sentence_bounds(content: str) -> list[tuple[int, int]]:
    """Where the sentences of a text begin and end; at least one."""
    found: list[tuple[int, int]] = []
    start = k = 0
    quoted = quotes(content)
    for end in _sentence_end().finditer(content):
        while k < len(quoted) and quoted[k][1] <= end.start():
            k += 1
        if k < len(quoted) and quoted[k][0] < end.start():
            continue
        behind = _NEXT_SIGN.match(content, end.end())
        more = behind is not None and not behind[1].isupper()
        if more and _ended("abbreviation").search(
            content, max(0, end.start() - 8), end.start() + 1
        ):
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
    if _ended("number").search(content, max(0, stop - 5), stop) and _LABEL.match(content, stop):
        return True
    ordinal = _ORDINAL.search(content, max(0, stop - 4), stop)
    return ordinal is not None and _ordinal_of().match(content, stop) is not None


@cache
def _sentence_end() -> re.Pattern[str]:
    begins = everywhere("new_sentence")
    return re.compile(rf"(?:[.!?…]+|;(?=\s*(?:{begins})\b))(?=\s|$)", re.IGNORECASE)


@cache
def _ended(kind: str) -> re.Pattern[str]:
    """A word that has a full stop itself, at the end of a text."""
    return re.compile(rf"\b(?:{everywhere(kind)})\.$", re.IGNORECASE)


@cache
def _ordinal_of() -> re.Pattern[str]:
    """What stands behind an ordinal, where no line cuts it: `im 1. und 2. Stock`."""
    between, behind = everywhere("between_ordinals"), everywhere("behind_ordinals")
    more = rf"(?:\s*(?:,|{between})\s*[0-9]{{1,2}}\.)"
    cut = rf"\s*(?:,|{between})$"
    return re.compile(rf"{more}*(?:\s+(?:{behind})|{cut})|{more}+$", re.IGNORECASE)
