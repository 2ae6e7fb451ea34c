"""Texts in words that the grammar takes: phrases are replaced by others that mean the same.

`valve R25 is not open` becomes `valve R25 is below 80 degrees`. Only a text that makes sense as a
whole then counts.
"""

import re
from collections.abc import Iterator
from functools import cache

from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.lexicon import expand

_LONGEST = 300
"""characters of a text that is paraphrased"""
_PART = {"n": r"[-\d.,]*\d(?:\s?(?:%|°|[a-z]{1,8}))?", "k": r"[\w-]+", "x": r".+?", "y": r".+"}
"""what stands for a slot: an amount, a word, or any words"""


def paraphrases(
    text: ScriptText, understanding: Understanding, changed: bool = False
) -> Iterator[str]:
    """Yield what a text becomes, if it makes sense then. `changed`: it already has other words than
    the script."""
    content = text.content.strip(" .!")
    if len(content) > _LONGEST:
        return
    for meant, pattern in _patterns(understanding.language.prose.paraphrases):
        content = pattern.sub(meant, content)
    content = " ".join(content.split())
    changed = changed or content != text.content.strip(" .!")
    if content and changed and makes_sense(content, text, understanding):
        yield f"{content[0].upper()}{content[1:]}."


def makes_sense(content: str, place: ScriptText, understanding: Understanding) -> bool:
    """Return True if the grammar takes a text as a whole."""
    text = place.replaced(content)
    if understanding.unfinished(text) is not None:
        return False
    reading = understanding.read(text)
    return not isinstance(reading, StumbleError) and "WORD" not in understanding.types(text)


@cache
def _patterns(phrases: str) -> list[tuple[str, re.Pattern[str]]]:
    """Return the patterns of phrases, with what each is replaced by; long ones first."""
    pairs = [pair.split("=>") for pair in phrases.split("|")]
    said = [(phrase, meant.strip()) for text, meant in pairs for phrase in expand(text)]
    said.sort(key=lambda one: len(one[0]), reverse=True)
    return [(re.sub(r"<([a-z])>", r"\\g<\1>", meant), _pattern(text)) for text, meant in said]


def _pattern(phrase: str) -> re.Pattern[str]:
    escaped = re.escape(phrase).replace(r"\ ", r"\s+")
    slotted = re.sub(r"<([a-z])>", lambda found: f"(?P<{found[1]}>{_PART[found[1]]})", escaped)
    return re.compile(rf"(?<![\w-]){slotted}(?![\w-])", re.IGNORECASE)
