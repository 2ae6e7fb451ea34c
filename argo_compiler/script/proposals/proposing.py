"""Proposals for the pieces of a script that the grammar does not take."""

import re
from bisect import bisect_right
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from argo_compiler.base.catalog import Catalog
from argo_compiler.script.documents.source import Diagnostics, RefusedError, Source
from argo_compiler.script.parsing.script import Piece, Script
from argo_compiler.script.proposals.composing import Composer, Proposal
from argo_compiler.script.proposals.mentions import Mention
from argo_compiler.script.proposals.rows import propose_row
from argo_compiler.script.sentences.tree.orders import Measure, Sentence
from argo_compiler.script.sentences.tree.script import ScriptStep
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.prose import cue_pattern

MAX_PROPOSED = 2000
"""pieces of a script; no more are looked at"""
_FIRST = 4
"""pieces of a letter in which a name alone is a greeting"""
_NAME = re.compile(r"[^\W\d_a-zäöü][^\W\d_A-ZÄÖÜ]+,")
_CLOCK = re.compile(r"\s*[0-9]{1,2}[:.][0-9]{2}\b")


def propose(script: Script, unread: Collection[int], catalog: Catalog) -> dict[int, Proposal]:
    """Return what is proposed for the unread pieces; by the offset at which a piece begins."""
    if not unread:
        return {}
    source = Source(script.source_text, script.source_name)
    places = [place.name for place in catalog.places]
    language = Language.of(script.source_text, places)
    understanding = Understanding(language, frozenset(), Diagnostics(source))
    composer = Composer(understanding, catalog)
    measured = _measured(script.steps, script.pieces)
    found: dict[int, Proposal] = {}
    in_log = False
    for i, piece in enumerate(script.pieces):
        start = piece.text.first
        content = piece.text.content
        if content.isupper() and start not in script.rows:
            logs = understanding.language.prose.form["logs"]
            in_log = cue_pattern("logs", logs).fullmatch(content.strip(" :")) is not None
        if start in unread and len(found) < MAX_PROPOSED:
            row = script.rows.get(start)
            if in_log and _CLOCK.match(content if row is None else row.place.content):
                found[start] = Proposal(aside="an entry of a log")
            elif row is not None:
                found[start] = propose_row(row, composer, first=i == 0)
            elif i < _FIRST and _NAME.fullmatch(content):
                found[start] = Proposal(aside="a greeting")
            else:
                found[start] = composer.propose(piece.text)
        for mention in measured.get(start, ()):
            with suppress(RefusedError):
                composer.measured(composer.checkpoints([mention]))
    return found


def _measured(steps: Sequence[ScriptStep], pieces: Sequence[Piece]) -> dict[int, list[Mention]]:
    """Return the noun phrases that are measured, by the pieces that they stand in."""
    starts = [piece.text.first for piece in pieces]
    found: dict[int, list[Mention]] = {}
    for order in _measures(steps):
        source = pieces[0].text.source
        offset = source.offset_at(order.span.line, order.span.column)
        at = max(bisect_right(starts, offset) - 1, 0)
        found.setdefault(starts[at], []).append(Mention("checkpoints", 0, 0, order.what))
    return found


def _measures(steps: Sequence[ScriptStep]) -> Iterator[Measure]:
    for step in steps:
        for sentence in step.sentences:
            if isinstance(sentence, Sentence):
                yield from (order for order in sentence.orders if isinstance(order, Measure))
        yield from _measures(step.steps)
