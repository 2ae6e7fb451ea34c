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
_FROM_START = frozenset(["SINCE_START", "BACK_IN", "MAX_DURATION"])
_NAMED = frozenset(["KIND", "HASH", "NUMBER", "IDENT", "STRING", "IT", "THEM", "BOTH", "THIS"])


_AND_SO_ON = re.compile(r"(?:^|[\d,])\s*(\.{3}|…)(?=\s|$)")


@dataclass(frozen=True)
class Doubt:
    """What a word may change, and how to say what is meant."""

    message: str
    hint: str


_ONLY = Doubt(
    "may mean that the others are not so",
    "leave it out, or say of the others as well what they have to be",
)
_ONLY_THEN = Doubt(
    "may mean only in that case, or only after that",
    "write `if ..., then ...` for the first, and leave it out for the second",
)
_SUM = Doubt("may ask for their sum, or for each of them", "write `and` for the second")
_ALSO = Doubt(
    "may mean `if`, or `even if`",
    "write `if ...` for the first, and leave the condition out for the second",
)
_WITHIN = Doubt(
    "may be counted from the start of the mission, or from what is done before",
    "write `within 10 minutes of the start`; no time is counted from another step",
)
_THERE = Doubt(
    "may be the docking station, or the place that was named before",
    "name the place: `return to the docking station`",
)
_AND_BACK = Doubt(
    "may mean the way home, or the same checkpoints the other way round",
    "name what is done on the way back",
)


def ask_of_dots(text: ScriptText, diagnostics: Diagnostics) -> None:
    """Asks about `Check 1, 4, ...`."""
    dots = _AND_SO_ON.search(text.content)
    if dots is not None:
        message = f"`{dots[1]}` may mean that more is to be done"
        hint = "name all that is to be done, or leave the dots out"
        diagnostics.error("ambiguous-word", message, text.span(*dots.span(1)), hint)


def ask_of_words(
    text: ScriptText, lexicon: Lexicon, diagnostics: Diagnostics, ordered: bool
) -> None:
    """Asks about the words of a sentence that may change what is meant. `ordered`: something is
    to be done before it."""
    if _looks_doubtful().search(text.content) is None:
        return
    words = all_words(text.content, lexicon)
    for word, doubt in _doubts(words, text.content.lower(), ordered):
        said = text.content[word.start : word.end]
        span = text.span(word.start, word.end)
        diagnostics.error("ambiguous-word", f"`{said}` {doubt.message}", span, doubt.hint)


def _doubts(words: Sequence[Word], content: str, ordered: bool) -> Iterator[tuple[Word, Doubt]]:
    for i, word in enumerate(words):
        said = content[word.start : word.end]
        after = [w.type for w in words[i + 1 :] if w.type != "FILLER"]
        before = words[i - 1] if i > 0 else None
        match word.type:
            case "FILLER" if _is(said, "restricting"):
                if _names_subject(words, i) and after[:1] and after[0] in _NAMED:
                    yield word, _ONLY
                elif i == 0 and _is(_next(words, i, content), "following"):
                    yield word, _ONLY_THEN
            case "FILLER" if _is(said, "adding"):
                behind = [type_ for type_ in after if type_ != "JOINT"]
                bidden = any(w.type in VERBS for w in words[:i])
                if bidden and behind[:1] == ["IF"] and not {*VERBS} & {*behind}:
                    yield word, _ALSO
            case "FILLER" if _is(said, "thither") and after[:2] == ["JOINT", "BACK"]:
                yield word, _AND_BACK
            case "JOINT" if _is(said, "summing") and _names_subject(words, i):
                yield word, _SUM
            case "WITHIN" if ordered or _is_second(words, i):
                types = {w.type for w in words}
                if types.isdisjoint(_FROM_START) and not _is_first(said):
                    yield word, _WITHIN
            case "THERE" if before is not None and before.type == "HOME":
                yield word, _THERE


def _next(words: Sequence[Word], i: int, content: str) -> str:
    """The word behind one."""
    return content[words[i + 1].start : words[i + 1].end] if i + 1 < len(words) else ""


def _names_subject(words: Sequence[Word], i: int) -> bool:
    """Whether a word stands where a condition says of which checkpoints it is."""
    last = next((w.type for w in reversed(words[:i]) if w.type in _OPENS | _ENDS), "")
    return last in _OPENS


def _is_second(words: Sequence[Word], i: int) -> bool:
    """Whether the order that a word belongs to has others before it."""
    return sum(w.type in VERBS and w.type != "START" for w in words[:i]) > 1


def _is_first(said: str) -> bool:
    """`within the first`"""
    return re.search(rf"\b(?:{everywhere('of_start')})\b", said) is not None


def _is(said: str, name: str) -> bool:
    return re.fullmatch(everywhere(name), said) is not None


@cache
def _looks_doubtful() -> re.Pattern[str]:
    """A pattern of such words, so that few sentences are looked at once more."""
    names = ("restricting", "adding", "thither", "summing", "yonder", "windows")
    said = "|".join(map(everywhere, names))
    return re.compile(rf"(?<![\w-])(?:{said})(?![\w-])", re.IGNORECASE)
