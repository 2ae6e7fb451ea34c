"""What of a text the mission language has words for: checkpoints, places, times, verbs, signals."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.sentences.building.sentences import build
from argo_compiler.script.sentences.doubts import is_question
from argo_compiler.script.sentences.grammar.parser import StumbleError
from argo_compiler.script.sentences.tree.nouns import AllOf, Noun, Nouns, Pronoun
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.lexer import all_words
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.without_effect import (
    HARMLESS,
    MISPLACED,
    TOLD,
    WITHOUT_EFFECT,
)
from argo_compiler.script.sentences.words.word import Word

_NOUNS = frozenset(["KIND", "HASH", "IDENT", "ALL", "OF", "EVERYTHING", "IT", "THEM", "VALUE"])
"""types of words with which a noun phrase may begin"""
_PLACES = frozenset(["AREA", "DOCK", "PLACE", "FLOOR", "ORDINAL", "FLOOR_NAME"])
_WEAK = frozenset(
    [
        *("TO", "IN", "AT", "ON", "FOR", "BY", "IS", "HE", "SIGN", "SHOWN", "CAN", "SHOULD"),
        *("NEXT", "COLON", "AND_NOUN", "AND_DO", "AND_PLACE", "AND_ON", "AND_TEST", "JOINT"),
        *(
            "AND_NUMBER",
            "AND_AMOUNT",
            "EITHER",
            "STRAY",
            MISPLACED,
            "RPAR",
            "LPAR",
            "LPAR_HOW",
            "NAMELY",
        ),
        *("FROM", "DASH", "AND_EVENT", "THIS", "EQUAL"),
    ]
)
"""types of words that only join others"""
OF_FORMS = frozenset(
    [
        *(
            "MEASURE",
            "BE_MEASURED",
            "measuring",
            "NUMBER",
            "TIME_WORD",
            "OF",
            "pronoun",
            "question",
            "past",
        ),
        *("GREATER", "LESS", "STATE", "DONE", "QUANTITY", "REPORT", "MODE", "IN_BETWEEN", "PERSON"),
    ]
)
"""kinds that have no effect on a mission beside the name of nothing that it has"""
_TIMES = frozenset(["AT_LEAST", "BETWEEN", "FROM", "EARLIEST", "NUMBER", "DURATION"])
"""types of words with which a time between two limits may begin"""
_BETWEEN = ("AND_", "JOINT", "TO", "DASH", "BUT", "LATEST")
"""how types of words begin that stand between two limits"""
_WHOLE = (("limit", ("MOST_TIME",)), ("forbidding", ("EVENT", "STATE")))
"""cues that are none within words of these types"""
_FIGURE = re.compile(r"[0-9]+(?:[.,][0-9]+)?")
_LONGEST = 24
"""words of a noun phrase"""
_APART = frozenset(
    [
        *("subject", "stating", "asking", "clause", "answer", "wondering", "people", "of_others"),
        *("needless", "likewise", "retracting", "too_high", "too_low", "in_case"),
        *("by_then", "at_time", "latest", "failing", "trying", "retrying"),
    ]
)
"""cues that are no mentions, but part a text or tell statements"""
_IDLE = ("courtesy", "sequence", "referring")
"""cues that have no effect by themselves"""
_OPENING = frozenset(["question", "sequence"])
"""cues that mean something only where a text begins"""


@dataclass(frozen=True)
class Mention:
    """A part of a text that means something."""

    kind: str
    """`checkpoints`, `pronoun`, `everything`, `place`, a cue of the prose, or a type of word"""
    start: int
    end: int
    value: object = None
    limits_s: tuple[float, float] = (0.0, 0.0)
    """of a time between two limits"""

    @property
    def nouns(self) -> tuple[Noun, ...]:
        """The nouns of a noun phrase, without its exceptions; none of another part."""
        return self.value.nouns if isinstance(self.value, Nouns) else ()


@dataclass(frozen=True)
class Mentions:
    """The parts of a text that mean something, and the words that mean nothing to Argo."""

    mentions: tuple[Mention, ...]
    unknown: tuple[Word, ...]
    joining: frozenset[str] = frozenset()
    """types of words that were passed over, as they only join others"""
    announces: bool = False
    """whether the text ends with a colon"""
    idle: tuple[str, ...] = ()
    """phrases that were passed over as they ask for nothing: `noch`, `I think`"""
    occasion: int = 0
    """where the words end that say what the text is for: `For the acceptance`"""

    def of(self, *kinds: str) -> tuple[Mention, ...]:
        """Return the parts of these kinds."""
        return tuple(mention for mention in self.mentions if mention.kind in kinds)

    def has(self, *kinds: str) -> bool:
        return any(mention.kind in kinds for mention in self.mentions)

    def only(self, *kinds: str) -> bool:
        """Whether there is nothing but parts of these kinds."""
        return all(mention.kind in kinds for mention in self.mentions)

    def without(self, *kinds: str) -> "Mentions":
        """Return these mentions without those of some kinds."""
        kept = tuple(mention for mention in self.mentions if mention.kind not in kinds)
        return replace(self, mentions=kept)


def mentions_in(text: ScriptText, understanding: Understanding) -> Mentions:
    """Return what a text has that means something, in the order of the text."""
    offsets = text.offsets if isinstance(text.offsets, range) else tuple(text.offsets)
    return _mentions_in(ScriptText(text.content, offsets, text.source), understanding)


@lru_cache(maxsize=1024)  # a text is looked at for many reasons
def _mentions_in(text: ScriptText, understanding: Understanding) -> Mentions:
    words = understanding.words(text)
    phrases = dict(_phrases(words, text, understanding))
    named = [m for m in phrases.values() if m.kind != "pronoun"]
    named += [Mention(w.type, w.start, w.end) for w in words if w.type == "IF_TIME"]
    cues = [cue for cue in _cues(text.content, understanding) if not _overlaps(cue, named)]
    for kind, types in _WHOLE:  # `max 30 min`, `no radio`, `not readable`
        whole = [Mention(w.type, w.start, w.end) for w in words if w.type in types]
        cues = [cue for cue in cues if cue.kind != kind or not _overlaps(cue, whole)]
    found = [cue for cue in cues if cue.kind not in _IDLE]
    if is_question(text, understanding.language.lexicon):
        end = len(text.content)
        found.append(Mention("question", end, end))
    occasion = phrase_pattern(understanding.language.prose.occasion).match(text.content)
    named_first = min((m.start for m in (*cues, *named)), default=0)
    joints = understanding.joints("or")
    found += [Mention("OR", w.start, w.start) for w in words if w.before.lower() in joints]
    unknown: list[Word] = []
    joining = {cue.kind for cue in cues if cue.kind == "courtesy"}
    i = 0
    while i < len(words):
        word = words[i]
        phrase = phrases.get(i)
        if phrase is not None and not _overlaps(phrase, cues):
            found.append(phrase)
            while i < len(words) and words[i].start < phrase.end:
                i += 1
            continue
        i += 1
        misplaced = word.type == MISPLACED and word.value not in (*HARMLESS, "ADDITION")
        if not misplaced and any(cue.start < word.end and word.start < cue.end for cue in cues):
            continue
        if word.type == "WORD":
            unknown.append(word)
        elif word.type in _WEAK and not misplaced and word.value != "or":
            joining.add(word.type)
        else:
            found.append(Mention(word.type, word.start, word.end, word.value))
    in_order = tuple(sorted(found, key=lambda m: m.start))
    behind = named_first if occasion is not None else 0
    announces = text.content.rstrip().endswith(":")
    idle = tuple(_idle(text.content, cues, understanding))
    return Mentions(in_order, tuple(unknown), frozenset(joining), announces, idle, behind)


def _idle(content: str, cues: Sequence[Mention], understanding: Understanding) -> Iterator[str]:
    """Yield the passed-over phrases that the lexicon does not list as without effect."""
    for cue in cues:
        phrase = content[cue.start : cue.end]
        types = {word.type for word in all_words(phrase, understanding.language.lexicon)}
        if cue.kind == "courtesy" and (types & TOLD or not types <= WITHOUT_EFFECT):
            yield phrase


def _overlaps(mention: Mention, others: Sequence[Mention]) -> bool:
    return any(other.start < mention.end and mention.start < other.end for other in others)


def _phrases(
    words: Sequence[Word], text: ScriptText, understanding: Understanding
) -> Iterator[tuple[int, Mention]]:
    """Yield the noun phrases and places, each with the index of its first word."""
    i = 0
    while i < len(words):
        type_ = words[i].type
        begun = type_ in _NOUNS or type_ in _PLACES or type_ in _TIMES
        phrase = _phrase(words, i, text, understanding) if begun else None
        if phrase is None:
            i += 1
            continue
        yield i, phrase[0]
        i = phrase[1]


def _phrase(
    words: Sequence[Word], i: int, text: ScriptText, understanding: Understanding
) -> tuple[Mention, int] | None:
    """Return the longest noun phrase or place that begins at a word, and the index behind it."""
    if (span := _span(words, i, text)) is not None:
        return span
    first = words[i].type
    starts = [name for name, types in (("nouns", _NOUNS), ("location", _PLACES)) if first in types]
    for start in starts:
        behind = min(len(words), i + _LONGEST)
        while behind > i:
            types = tuple(word.type for word in words[i:behind])
            try:
                branch = understanding.grammar.tree(types, start)
            except StumbleError as stumble:
                behind = min(behind - 1, i + stumble.at)  # a longer one stumbles there as well
                continue
            node = build(branch, list(words[i:behind]), text, understanding.diagnostics)
            kind = "place"
            if start == "nouns":
                kind = _kind_of(node)
                if kind == "checkpoints" and isinstance((*node.nouns, *node.but)[-1], Pronoun):
                    behind -= 1  # `all valves except R7, that one is locked out`
                    continue
            return Mention(kind, words[i].start, words[behind - 1].end, node), behind
    return None


def _span(words: Sequence[Word], i: int, text: ScriptText) -> tuple[Mention, int] | None:
    """Return a time between two limits after something, in seconds, and the index behind it: `at
    least 5 but at most 8 minutes after`."""
    first = i + (words[i].type in ("AT_LEAST", "BETWEEN", "FROM", "EARLIEST"))
    second = first + 1
    while second < len(words) and words[second].type.startswith(_BETWEEN):
        second += 1
    types = [word.type for word in words[first : second + 2]]
    if len(types) < 3 or types[-1] != "AFTER" or types[0] not in ("NUMBER", "DURATION"):
        return None
    most = words[second]
    said = _FIGURE.search(text.content[most.start : most.end])
    if (
        most.type not in ("DURATION", "MOST_TIME")
        or said is None
        or not isinstance(most.value, Length)
    ):
        return None
    most_s = most.value.seconds
    least = words[first].value
    unit_s = most_s / float(said[0].replace(",", "."))
    least_s = least.seconds if isinstance(least, Length) else least.value * unit_s
    if not 0 < least_s < most_s:
        return None
    end = words[second + 1].end
    return Mention("SPAN", words[i].start, end, limits_s=(least_s, most_s)), second + 2


def _kind_of(nouns: Nouns) -> str:
    """Return what a noun phrase is: `pronoun` if it means what was named before, `everything` if it
    is the whole mission or site, else `checkpoints`."""
    if all(isinstance(noun, Pronoun) for noun in nouns.nouns):
        return "pronoun"
    (first, *others) = nouns.nouns
    whole = not others and isinstance(first, AllOf) and first.whole and not first.floors
    return "everything" if whole and not nouns.but else "checkpoints"


def _cues(content: str, understanding: Understanding) -> Iterator[Mention]:
    """Yield the cues of a text; of two that overlap, the first and longest."""
    found: list[Mention] = []
    begins = len(content) - len(content.lstrip(' "(-'))
    for name, phrases in understanding.language.prose.cues.items():
        if name in _APART:
            continue
        for match in phrase_pattern(phrases).finditer(content):
            opening = match.start() <= begins or match[0] == "?"
            if name not in _OPENING or opening:
                found.append(Mention(name, *match.span()))
    behind = 0
    for cue in sorted(found, key=lambda m: (m.start, -m.end, m.kind == "forbidding")):
        if cue.start >= behind:
            behind = cue.end
            yield cue


def checkpoint_words(checkpoints: Sequence[CheckpointInfo]) -> str:
    """Return checkpoints by their numbers: `checkpoint 1, checkpoint 3 and checkpoint 4`."""
    said = [f"checkpoint {checkpoint.id}" for checkpoint in checkpoints]
    return said[0] if len(said) == 1 else f"{', '.join(said[:-1])} and {said[-1]}"
