"""Open lines in which nothing of a mission is mentioned, so that a person may set them aside
together."""

import re
from collections.abc import Sequence

from argo_compiler.base.catalog import Catalog
from argo_compiler.script.documents.source import Diagnostics, ScriptText, Source
from argo_compiler.script.drafts.draft import Draft, DraftLine, LineState
from argo_compiler.script.proposals.mentions import mentions_in
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.spelling import candidates

MOST_LINES = 1_000
"""open lines of a draft that are looked at"""
_LONGEST = 300
"""characters of a line; a longer one has to be read by itself"""
_OPEN_BOX = re.compile(r"\[\s*\]|[☐□]")
_SHORTEST_MISSPELT = 5
"""letters; a shorter word is near to too many others"""
_FIGURE = re.compile(r"\d")
_POINTING = frozenset(["THIS", "NEXT", "SHOULD", "CAN", "HE"])
"""types of words that join others, and may speak of the lines above, or ask for something"""
_IDLE_CUES = frozenset(["courtesy", "subject", "stating"])
"""cues of the prose that neither restrict a line nor put it in relation to others"""


def lines_naming_nothing(draft: Draft, catalog: Catalog) -> tuple[DraftLine, ...]:
    """Return the open lines that can only be set aside, and in which nothing of a mission is
    mentioned.

    That is no checkpoint, place, figure, time, order, negation, condition or word that points to
    other lines, nor a word that is nearly one of these. Such a line may still ask for something
    that Argo does not know, so a person has to see it before it is set aside.
    """
    asked = [line for line in draft.left if _offers_nothing(line)][:MOST_LINES]
    if not asked:
        return ()
    places = [place.name for place in catalog.places]
    own, languages = Language.of(draft.text, places), Language.all(places)
    names = frozenset(
        word.lower()
        for checkpoint in catalog.checkpoints
        for name in (checkpoint.name, *checkpoint.tags)
        for word in name.split()
    )
    return tuple(line for line in asked if _is_idle(line.text, own, languages, names))


def _offers_nothing(line: DraftLine) -> bool:
    """Return True for a whole line that is not understood, and has no meaning to choose."""
    alone = line.parts == 1 and len(line.text) <= _LONGEST
    unknown = line.state is LineState.OPEN and not line.is_question and line.act is None
    return alone and unknown and line.choices == ((),) and not line.suggested


def _is_idle(
    line: str, own: Language, languages: Sequence[Language], names: frozenset[str]
) -> bool:
    """Return True if a line mentions nothing in any language, as texts may mix them."""
    content = _OPEN_BOX.sub(" ", line).strip()
    if any(_unknown_words(content, language) is None for language in languages):
        return False
    unknown = _unknown_words(content, own) or ()
    if _FIGURE.search(content) or {word.lower() for word in unknown} & names:
        return False
    known = own.words
    misspelt = (w for w in unknown if len(w) >= _SHORTEST_MISSPELT and w.lower() not in known)
    meant = {other for word in misspelt for other in candidates(word, known)}
    return all(_unknown_words(word, own) is not None for word in meant)


def _unknown_words(content: str, language: Language) -> list[str] | None:
    """Return the words of a text that mean nothing to Argo; None if others mean something."""
    source = Source(content)
    text = ScriptText(content, range(len(content)), source)
    found = mentions_in(text, Understanding(language, frozenset(), Diagnostics(source)))
    if found.mentions or found.announces or found.joining & _POINTING:
        return None
    cues = ((name, said) for name, said in language.prose.cues.items() if name not in _IDLE_CUES)
    if any(phrase_pattern(said).search(content) is not None for name, said in cues):
        return None
    return [content[word.start : word.end] for word in found.unknown]
