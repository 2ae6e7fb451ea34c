"""Texts in words that the grammar takes: phrases are replaced by others that mean the same.

`valve R25 is not open` becomes `valve R25 is below 80 degrees`. Only a text that makes sense as a
whole then counts.
"""

import re
from functools import cache

from argo_compiler.base.records import dataclass
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.lexicon import expand

_LONGEST = 300
"""characters of a text that is paraphrased"""
_ALONE = (("AREA", "NUMBER"),)
"""what can be where a mission starts, or where it ends"""
ORDERS = (
    *("MEASURE", "KEEP_MEASURING", "GO", "HOME", "START", "PATROL", "WAIT", "RECHARGE", "REPEAT"),
    *("ADD", "DELETE", "REPLACE", "MOVE", "IF", "UNLESS", "ELSE", "UNTIL", "EVERY"),
)
"""types of words of which a text has one that the grammar may read alone"""
_BLANKS = re.compile(r"(?<=\s)\s+|\s+(?=[,;])")
"""blanks that are left where words were removed"""
_PART = {"n": r"[-\d.,]*\d(?:\s?(?:%|°|[a-z]{1,8}))?", "k": r"[\w-]+", "x": r".+?", "y": r".+"}
"""what stands for a slot: an amount, a word, or any words"""


@dataclass(frozen=True)
class Rephrased:
    """A text in other words, and the words of it that have no others."""

    text: ScriptText
    dropped: tuple[str, ...] = ()


def rephrased(text: ScriptText, understanding: Understanding) -> Rephrased:
    """Return a text with all phrases replaced that have others."""
    if len(text.content) > _LONGEST:
        return Rephrased(text)
    dropped: list[str] = []
    content = text.content.lower()
    for parts, phrase, meant in _paraphrases(understanding.language.prose.paraphrases):
        if parts[0] not in content or not all(part in content for part in parts):
            continue  # hundreds of patterns take long to make, and few are needed
        for found in reversed(list(_pattern(phrase).finditer(text.content))):
            if meant:
                text = text.replace(*found.span(), found.expand(meant))
            else:
                dropped.append(found[0])
                text = text.without(*found.span())
            content = text.content.lower()
    for blanks in reversed(list(_BLANKS.finditer(text.content))):
        text = text.without(*blanks.span())
    return Rephrased(text.strip(), tuple(dropped))


def reads(text: ScriptText, understanding: Understanding) -> bool:
    """Return True if the grammar takes a text as a whole."""
    text = text[: len(text.content.rstrip(" .!"))]
    if not text.content or understanding.unfinished(text) is not None:
        return False
    if understanding.types(text) in _ALONE:
        return False
    reading = understanding.read(text)
    return not isinstance(reading, StumbleError) and "WORD" not in understanding.types(text)


def sentence(text: ScriptText) -> str:
    """Return a text as a sentence."""
    content = text.content.strip(" .!").replace(",,", ",")
    return f"{content[0].upper()}{content[1:]}."


@cache
def _paraphrases(phrases: str) -> list[tuple[list[str], str, str]]:
    """Return the phrases, each with its parts between blanks and slots, and what it is replaced by;
    long ones first."""
    pairs = [pair.split("=>") for pair in phrases.split("|")]
    said = [(phrase, meant.strip()) for text, meant in pairs for phrase in expand(text)]
    said.sort(key=lambda one: len(one[0]), reverse=True)
    return [(_parts(text), text, re.sub(r"<([a-z])>", r"\\g<\1>", meant)) for text, meant in said]


def _parts(phrase: str) -> list[str]:
    """Return the parts of a phrase that a text has to have, the longest first."""
    return sorted(re.sub(r"<[a-z]>", " ", phrase).lower().split(), key=len, reverse=True)


@cache
def _pattern(phrase: str) -> re.Pattern[str]:
    escaped = re.escape(phrase).replace(r"\ ,", r"\s*,").replace(r"\ ", r"\s+")
    slotted = re.sub(r"<([a-z])>", lambda found: f"(?P<{found[1]}>{_PART[found[1]]})", escaped)
    return re.compile(rf"(?<![\w-]){slotted}(?![\w-])", re.IGNORECASE)
