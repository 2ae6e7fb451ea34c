"""Proposals made of an assistant's suggestions, with the words of the script that they leave out.

An assistant may claim words that its sentences do not use, or leave words out. So each word outside
its claims is unused, and so is what means something to Argo and has no counterpart in the
sentences: a negation, a condition, a time, a checkpoint.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.listing import listed
from argo_compiler.script.assistant.suggestion import SuggestedSentence
from argo_compiler.script.documents.source import Diagnostics, RefusedError, ScriptText, Source
from argo_compiler.script.parsing.script import Script
from argo_compiler.script.proposals.composing import Proposal
from argo_compiler.script.proposals.known import Known
from argo_compiler.script.proposals.mentions import Mention, Mentions, mentions_in
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language

_WORD = re.compile(r"[#\w](?:\S*\w)?")
_NEGATION = "negation or condition"
_GROUPS = {
    kind: group
    for group, kinds in {
        _NEGATION: (
            *("forbidding", "leave_out", "NOT", "EXCEPT", "SPARE", "DELETE", "IF", "IF_ONLY"),
            *("UNLESS", "ELSE", "UNTIL"),
        ),
        "end": ("home", "HOME", "END", "DOCK", "place", "GO"),
        "number": ("QUANTITY", "NUMBER"),
        "verb": ("MEASURE", "SEE"),
    }.items()
    for kind in kinds
}
"""kinds of mentions that may stand for each other"""
_CHECKPOINTS = frozenset(["checkpoints", "pronoun", "everything", "IT", "ALL"])
"""kinds of mentions that are compared by the checkpoints that they mean"""


def suggested_proposals(
    script: Script,
    suggestions: Mapping[int, Sequence[SuggestedSentence]],
    texts: Mapping[int, str],
    catalog: Catalog,
) -> dict[int, Proposal]:
    """Return what suggestions propose for pieces of a script; by the offset at which one begins.

    `texts` are the texts of the pieces. A sentence whose words its piece does not have has no
    effect.
    """
    places = [place.name for place in catalog.places]
    language = Language.of(script.source_text, places)
    claims = _Claims(language, catalog)
    return {at: claims.proposal(texts[at], sentences) for at, sentences in suggestions.items()}


class _Claims:
    """Compares sentences with the words that they stand for."""

    def __init__(self, language: Language, catalog: Catalog) -> None:
        self.language = language
        self.catalog = catalog

    def proposal(self, text: str, sentences: Sequence[SuggestedSentence]) -> Proposal:
        """Return what sentences propose for a text, in the order of the words they stand for."""
        placed = [(span, part) for part in sentences if (span := find_words(text, part.words))]
        placed.sort(key=lambda one: one[0])
        said = tuple(dict.fromkeys(part.sentence for _, part in placed))
        if not said:
            return Proposal()
        outside = [
            word.span()
            for word in _WORD.finditer(text)
            if not any(start <= word.start() and word.end() <= end for (start, end), _ in placed)
        ]
        lost, invented = self._compared(text, said)
        doubt = f"it names {listed(invented)}, which the line does not name" if invented else ""
        unused = [text[start:end] for start, end in _merged([*outside, *lost], text)]
        return Proposal(said, tuple(unused), doubt=doubt)

    def _compared(
        self, text: str, sentences: Sequence[str]
    ) -> tuple[list[tuple[int, int]], list[str]]:
        """Return what of a text has no counterpart in the sentences, as spans, and the checkpoints
        that only the sentences name."""
        own, known = self._read(text)
        theirs = [(read, one) for read, one in map(self._read, sentences)]
        kinds = {_key(mention) for read, _ in theirs for mention in read.mentions}
        named = {id for read, one in theirs for m in read.mentions for id in _ids(m, one)}
        lost: list[tuple[int, int]] = []
        met: set[int] = set()
        for mention in own.mentions:
            ids = _ids(mention, known)
            met |= ids
            if ids - named or (mention.kind not in _CHECKPOINTS and _key(mention) not in kinds):
                lost.append((mention.start, mention.end))
        open_reference = own.has("pronoun", "everything")
        invented = () if open_reference else sorted(named - met)
        return lost, [f"checkpoint {id}" for id in invented]

    def _read(self, text: str) -> tuple[Mentions, Known]:
        source = Source(text)
        understanding = Understanding(self.language, frozenset(), Diagnostics(source))
        content = ScriptText(text, range(len(text)), source)
        return mentions_in(content, understanding), Known(understanding, self.catalog)


def find_words(text: str, words: str) -> tuple[int, int] | None:
    """Return where words stand in a text as whole words; None if it does not have them."""
    wanted = r"\s+".join(map(re.escape, words.split()))
    if not wanted:
        return None
    found = re.search(rf"(?<!\w){wanted}(?!\w)", text)
    return None if found is None else found.span()


def _key(mention: Mention) -> tuple[str, object]:
    """Return what two mentions share that stand for each other: a kind, and of amounts a value."""
    value = mention.value if mention.kind in ("DURATION", "QUANTITY", "NUMBER", "TIMES") else None
    return _GROUPS.get(mention.kind, mention.kind), repr(value) if value is not None else None


def _ids(mention: Mention, known: Known) -> set[int]:
    """Return the checkpoints that a mention names; none if that is not clear."""
    if mention.kind == "checkpoints":
        with suppress(RefusedError):
            return {checkpoint.id for checkpoint in known.checkpoints([mention])}
    return set()


def _merged(spans: Sequence[tuple[int, int]], text: str) -> Iterator[tuple[int, int]]:
    """Yield spans in their order, those as one that overlap or have only blanks between them."""
    current: tuple[int, int] | None = None
    for start, end in sorted(spans):
        if current is None:
            current = start, end
        elif start <= current[1] or not text[current[1] : start].strip():
            current = current[0], max(end, current[1])
        else:
            yield current
            current = start, end
    if current is not None:
        yield current
