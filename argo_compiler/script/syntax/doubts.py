"""Small words that change nothing where they mostly stand, and what is meant where they stand here:
`if only one of them is above 4`, `check 8 also if ...`, `go back there`. They are asked about.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.lexer import all_words
from argo_compiler.script.syntax.words.lexicon import Lexicon
from argo_compiler.script.syntax.words.loading import everywhere
from argo_compiler.script.syntax.words.word import Word

_OPENS = frozenset(["IF", "IF_ONLY", "UNLESS", "UNTIL"])
_ENDS = frozenset(
    [*VERBS, "GREATER", "LESS", "AT_LEAST", "AT_MOST", "BETWEEN", "STATE", "FAILS", "IS"]
)
"""words behind which a condition says no more of which checkpoints it is"""
_NAMED = frozenset(["KIND", "HASH", "NUMBER", "IDENT", "STRING", "IT", "THEM", "BOTH", "THIS"])


@dataclass(frozen=True)
class Doubt:
    """What a word may change, and how to say what is meant."""

    message: str
    hint: str


_ONLY = Doubt(
    "may mean that the others are not so",
    "leave it out, or say of the others as well what they have to be",
)
_SUM = Doubt("may ask for their sum, or for each of them", "write `and` for the second")
_ALSO = Doubt(
    "may mean `if`, or `even if`",
    "write `if ...` for the first, and leave the condition out for the second",
)
_THERE = Doubt(
    "may be the docking station, or the place that was named before",
    "name the place: `return to the docking station`",
)
_AND_BACK = Doubt(
    "may mean the way home, or the same checkpoints the other way round",
    "name what is done on the way back",
)


def ask_of_words(text: ScriptText, lexicon: Lexicon, diagnostics: Diagnostics) -> None:
    """Asks about the words of a sentence that may change what is meant."""
    if _looks_doubtful().search(text.content) is None:
        return
    words = all_words(text.content, lexicon)
    for word, doubt in _doubts(words, text.content.lower()):
        said = text.content[word.start : word.end]
        span = text.span(word.start, word.end)
        diagnostics.error("ambiguous-word", f"`{said}` {doubt.message}", span, doubt.hint)


def _doubts(words: Sequence[Word], content: str) -> Iterator[tuple[Word, Doubt]]:
    for i, word in enumerate(words):
        said = content[word.start : word.end]
        after = [w.type for w in words[i + 1 :] if w.type != "FILLER"]
        before = words[i - 1] if i > 0 else None
        match word.type:
            case "FILLER" if _is(said, "restricting"):
                if _names_subject(words, i) and after[:1] and after[0] in _NAMED:
                    yield word, _ONLY
            case "FILLER" if _is(said, "adding"):
                behind = [type_ for type_ in after if type_ != "JOINT"]
                ordered = any(w.type in VERBS for w in words[:i])
                if ordered and behind[:1] == ["IF"] and not {*VERBS} & {*behind}:
                    yield word, _ALSO
            case "FILLER" if _is(said, "thither") and after[:2] == ["JOINT", "BACK"]:
                yield word, _AND_BACK
            case "JOINT" if _is(said, "summing") and _names_subject(words, i):
                yield word, _SUM
            case "THERE" if before is not None and before.type == "HOME":
                yield word, _THERE


def _names_subject(words: Sequence[Word], i: int) -> bool:
    """Whether a word stands where a condition says of which checkpoints it is."""
    last = next((w.type for w in reversed(words[:i]) if w.type in _OPENS | _ENDS), "")
    return last in _OPENS


def _is(said: str, name: str) -> bool:
    return re.fullmatch(everywhere(name), said) is not None


@cache
def _looks_doubtful() -> re.Pattern[str]:
    """A pattern of such words, so that few sentences are looked at once more."""
    names = ("restricting", "adding", "thither", "summing", "yonder")
    said = "|".join(map(everywhere, names))
    return re.compile(rf"(?<![\w-])(?:{said})(?![\w-])", re.IGNORECASE)
