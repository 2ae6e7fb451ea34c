"""What of a text the mission language has words for: checkpoints, places, times, verbs, signals."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.sentences.building.sentences import build
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.tree.nouns import Nouns, Pronoun
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.prose import cue_pattern
from argo_compiler.script.sentences.words.word import Word

_NOUNS = frozenset(["KIND", "HASH", "IDENT", "ALL", "OF", "EVERYTHING", "IT", "THEM", "VALUE"])
"""types of words with which a noun phrase may begin"""
_PLACES = frozenset(["AREA", "DOCK", "PLACE", "FLOOR", "ORDINAL", "FLOOR_NAME"])
_WEAK = frozenset(
    [
        *("TO", "IN", "AT", "ON", "FOR", "BY", "IS", "HE", "SIGN", "SHOWN", "CAN", "SHOULD"),
        *("NEXT", "COLON", "AND_NOUN", "AND_DO", "AND_PLACE", "AND_ON", "AND_TEST", "JOINT"),
        *("AND_NUMBER", "AND_AMOUNT", "EITHER", "STRAY", "RPAR", "LPAR", "LPAR_HOW", "NAMELY"),
        *("FROM", "DASH", "AND_EVENT", "THIS", "EQUAL"),
    ]
)
"""types of words that only join others"""
_OF_STATEMENTS = frozenset(["subject", "stating", "asking"])
"""cues of which only statements consist"""
_LONGEST = 24
"""words of a noun phrase"""


@dataclass(frozen=True)
class Mention:
    """A part of a text that means something."""

    kind: str
    """`checkpoints`, `place`, a cue of the prose, or a type of word"""
    start: int
    end: int
    value: object = None


@dataclass(frozen=True)
class Mentions:
    """The parts of a text that mean something, and the words that mean nothing to Argo."""

    mentions: tuple[Mention, ...]
    unknown: tuple[Word, ...]

    def of(self, *kinds: str) -> tuple[Mention, ...]:
        """Return the parts of these kinds."""
        return tuple(mention for mention in self.mentions if mention.kind in kinds)

    def has(self, *kinds: str) -> bool:
        return any(mention.kind in kinds for mention in self.mentions)

    def only(self, *kinds: str) -> bool:
        """Whether there is nothing but parts of these kinds."""
        return all(mention.kind in kinds for mention in self.mentions)


def mentions_in(text: ScriptText, understanding: Understanding) -> Mentions:
    """Return what a text has that means something, in the order of the text."""
    content = text.content
    cues = list(_cues(content, understanding))
    words = [
        w
        for w in understanding.words(text)
        if not any(a < w.end and w.start < b for _, a, b in cues)
    ]
    found = [Mention(name, start, end) for name, start, end in cues if name != "courtesy"]
    unknown: list[Word] = []
    i = 0
    while i < len(words):
        word = words[i]
        phrase = _phrase(words, i, text, understanding)
        if phrase is not None:
            mention, i = phrase
            found.append(mention)
            continue
        if word.type == "WORD":
            unknown.append(word)
        elif word.type not in _WEAK:
            found.append(Mention(word.type, word.start, word.end, word.value))
        i += 1
    return Mentions(tuple(sorted(found, key=lambda s: s.start)), tuple(unknown))


def _phrase(
    words: Sequence[Word], i: int, text: ScriptText, understanding: Understanding
) -> tuple[Mention, int] | None:
    """Return the longest noun phrase or place that begins at a word, and the word behind it."""
    first = words[i].type
    starts = [name for name, types in (("nouns", _NOUNS), ("location", _PLACES)) if first in types]
    for start in starts:
        for behind in range(min(len(words), i + _LONGEST), i, -1):
            types = tuple(word.type for word in words[i:behind])
            try:
                branch = understanding.grammar.tree(types, start)
            except StumbleError:
                continue
            node = build(branch, list(words[i:behind]), text, understanding.diagnostics)
            kind = "place" if start == "location" else _kind_of(node)
            return Mention(kind, words[i].start, words[behind - 1].end, node), behind
    return None


def _kind_of(nouns: Nouns) -> str:
    return "checkpoints" if nouns.nouns else "nouns"


def _cues(content: str, understanding: Understanding) -> Iterator[tuple[str, int, int]]:
    """Yield the cues of a text with their places; of two that overlap, the first and longest."""
    found: list[tuple[int, int, str]] = []
    for name, phrases in understanding.language.prose.cues.items():
        if name in _OF_STATEMENTS:
            continue
        pattern = cue_pattern(name, phrases)
        found += [(m.start(), -m.end(), name) for m in pattern.finditer(content)]
    behind = 0
    for start, negative_end, name in sorted(found):
        if start >= behind:
            behind = -negative_end
            yield name, start, behind


def checkpoint_words(checkpoints: Sequence[CheckpointInfo]) -> str:
    """Return checkpoints by their numbers: `checkpoint 1, checkpoint 3 and checkpoint 4`."""
    said = [f"checkpoint {checkpoint.id}" for checkpoint in checkpoints]
    return said[0] if len(said) == 1 else f"{', '.join(said[:-1])} and {said[-1]}"


def is_pronoun(mention: Mention) -> bool:
    """Whether a noun phrase names no checkpoint, but means one that was named before."""
    nouns = mention.value
    return isinstance(nouns, Nouns) and all(isinstance(noun, Pronoun) for noun in nouns.nouns)
