"""Choices of a text by its parts: what those of them mean that mean something."""

import re
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise

from argo_compiler.script.documents.source import RefusedError, ScriptText
from argo_compiler.script.proposals.composing import Composer
from argo_compiler.script.proposals.frames import Sentences, sentences_of
from argo_compiler.script.proposals.mentions import checkpoint_words, mentions_in
from argo_compiler.script.proposals.open_text import OpenText
from argo_compiler.script.proposals.paraphrasing import ORDERS, reads, rephrased, sentence
from argo_compiler.script.sentences.tree.nouns import Labelled, Nouns
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.spelling import candidates
from argo_compiler.script.sentences.words.without_effect import MISPLACED

_MOST_PARTS = 24
_LONGEST_PART = 8
"""parts that are read as one"""
MOST_TAKEN_APART = 20_000
"""characters of all texts of a script that are taken apart: of some hundreds of open lines"""
_PASSED_OVER = ("WORD", "SIGN", "STRAY", "DONE", MISPLACED)
"""types of words that a text is read without"""
_CUT = re.compile(r"[,;:]\s+|\s+[-–/|]\s+|\s*(?:->|→|>)\s*|\s+(?=\()|[()]\s*|[.!?]\s+")
_CUT_WORDS = ("AND_", "JOINT", "NEXT", "COLON")
"""how types of words begin that part a text"""


def by_parts(of: OpenText) -> Iterator[Sentences]:
    """Yield what the parts of a text mean that mean something: the longest that make sense."""
    of.composer.taken_apart += len(of.text.content)
    if of.composer.taken_apart > MOST_TAKEN_APART:
        return
    starts = [0, *_cuts(of.text, of.composer), len(of.text.content)]
    pieces = [of.text[start:end] for start, end in pairwise(starts)]
    known = [bool(_bare(piece, of.composer).content) for piece in pieces]
    telling = [i for i, piece in enumerate(pieces) if known[i] or not _is_unknown(piece, of)]
    senseless: set[tuple[int, ...]] = set()
    made: list[str] = []
    i = 0
    while i < len(starts) - 1:
        for k in range(min(len(starts) - 1, i + _LONGEST_PART), i, -1):
            inner = telling[bisect_left(telling, i) : bisect_left(telling, k)]
            ends = (*inner[:1], *inner[-1:])  # the words around these mean nothing
            if not any(known[i:k]) or ends in senseless:
                continue
            part = _part(of.text[starts[ends[0]] : starts[ends[-1] + 1]], of.composer)
            if part is not None:
                made += part
                break
            senseless.add(ends)
        i = k
    yield tuple(made)


def _is_unknown(text: ScriptText, of: OpenText) -> bool:
    """Return True for a part that consists of words that nobody knows."""
    types = of.composer.understanding.types(text)
    return bool(types) and {*types} <= {*_PASSED_OVER}


def _cuts(text: ScriptText, composer: Composer) -> list[int]:
    """Return where the parts of a text begin, but for the first."""
    words = composer.understanding.words(text)
    cuts = {m.end() for m in _CUT.finditer(text.content)}
    cuts |= {m.start() for m in _CUT.finditer(text.content)}
    cuts |= {word.start for word in words if word.type.startswith((*_CUT_WORDS, "WORD"))}
    cuts |= {word.end for word in words if word.type == "WORD"}
    cues = composer.understanding.language.prose.cues
    cuts |= {m.start() for m in phrase_pattern(cues["clause"]).finditer(text.content)}
    return sorted(cuts - {0, len(text.content)})[: _MOST_PARTS - 1]


def _part(text: ScriptText, composer: Composer) -> Sentences | None:
    """Return what a part means without the words that nobody knows; None if it makes no sense."""
    bare = _bare(text, composer)
    mentions = mentions_in(bare, composer.understanding)
    rewritten = rephrased(bare, composer.understanding).text if bare.content else bare
    for found, meant in ((mentions.without(*_PASSED_OVER), bare), (mentions, rewritten)):
        made = sentences_of(found, composer.known) if found.mentions else None
        if made:
            return made
        if found.has(*ORDERS) and reads(meant, composer.understanding):
            return (sentence(_numbered(meant, composer)),)
    return None


def _numbered(text: ScriptText, composer: Composer) -> ScriptText:
    """Return a text with its checkpoints by number, but for `all valves` and the like."""
    for mention in reversed(mentions_in(text, composer.understanding).of("checkpoints")):
        nouns = mention.value
        assert isinstance(nouns, Nouns)
        if not nouns.but and all(isinstance(noun, Labelled) for noun in nouns.nouns):
            with suppress(RefusedError):
                words = checkpoint_words(composer.known.checkpoints([mention]))
                text = text.replace(mention.start, mention.end, words)
    return text


def _bare(text: ScriptText, composer: Composer) -> ScriptText:
    """Return a text without words that mean nothing, and without what joins it to others; words
    that are misspelt are put right."""
    understanding = composer.understanding
    for word in reversed(understanding.words(text)):
        if word.type == "WORD":
            meant = candidates(text.content[word.start : word.end], understanding.known)
            if meant:
                text = text.replace(word.start, word.end, min(meant))
    words = understanding.words(text)
    while words and words[0].type.startswith((*_CUT_WORDS, *_PASSED_OVER)):
        words = words[1:]
    start = words[0].start if words else len(text.content)
    for word in reversed([word for word in words if word.type in _PASSED_OVER]):
        text = text.without(word.start, word.end)
    return _tidied(text[start:])


def _tidied(text: ScriptText) -> ScriptText:
    for blanks in reversed(list(re.finditer(r"(?<=\s)\s+|\s+(?=[,;.])", text.content))):
        text = text.without(*blanks.span())
    content = text.content
    first = len(content) - len(content.lstrip(" ,;:.-–/>|()"))
    return text[first : max(first, len(content.rstrip(" ,;:.-–/>|(")))]
