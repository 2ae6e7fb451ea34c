"""Script text to draft: the script is read, and what is left is proposed or asked about."""

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    Severity,
    by_position,
    diagnostic_of,
    with_excerpts,
)
from argo_compiler.il import Mission
from argo_compiler.script.documents.document import Document
from argo_compiler.script.documents.source import Source
from argo_compiler.script.drafts.draft import (
    Act,
    Draft,
    DraftLine,
    LineDecision,
    LineState,
    occurrences,
)
from argo_compiler.script.parsing.parser import parse
from argo_compiler.script.parsing.script import Piece, Script
from argo_compiler.script.proposals.composing import Proposal
from argo_compiler.script.proposals.proposing import propose
from argo_compiler.script.resolve.importing import resolve_script

_OF_OPTIONS = frozenset(["script.area-choice", "script.area-conflict", "script.area-not-offered"])
"""codes of errors that another option resolves, and no change of the line"""
_UNREAD = frozenset(
    [
        *("script.not-understood", "script.unfinished", "script.unknown-label", "script.row"),
        *("script.duration", "script.field", "script.ambiguous-duration", "script.question"),
    ]
)
"""codes of errors of a piece that the grammar does not take; others are questions"""

_UNCLEAR = "script.ambiguous-"
"""how codes of errors of a piece begin that has more than one meaning"""

_LONGEST_SHOWN = 60
"""characters of a text that a message shows"""


@dataclass(frozen=True)
class _Reading:
    """A script that was read with some decisions."""

    script: Script
    mission: Mission | None
    diagnostics: tuple[Diagnostic, ...]


@collector_held()
def import_script(
    text: str | Document,
    catalog: Catalog,
    *,
    source_name: str = "script",
    start_area: int | None = None,
    end_area: int | None = None,
    decisions: Iterable[LineDecision] = (),
) -> Draft:
    """Return the draft of a script; its mission is None as long as something is left to decide.

    Args:
        text: the script, or the document in which it is; see `read_document`
        catalog: names and places of the site
        source_name: name of the script in messages
        start_area: starting area, for a script that names none
        end_area: area to end in, likewise
        decisions: what a person has decided on for lines of the script; decisions on lines that it
            does not have, or that have another proposal now, have no effect

    Raises:
        DiagnosticError: The text is no script: it is empty or too long.
    """
    areas = (start_area, end_area)
    reading = _read(text, catalog, source_name, areas, {})
    acts = _match(tuple(decisions), reading.script.pieces)
    said = {at: act.sentences for at, act in acts.items() if act.act is not Act.CONFIRMED}
    if said:
        reading = _read(text, catalog, source_name, areas, said)
    errors = _errors_by_piece(reading)
    unread = {at for at, error in errors.items() if error.code in _UNREAD and at not in said}
    unclear = {at for at, e in errors.items() if e.code.startswith(_UNCLEAR) and at not in said}
    proposals = propose(reading.script, unread, unclear - unread, catalog, start_area)
    proposed = {at: p.sentences for at, p in proposals.items() if _reads(p)}
    if proposed:
        reading = _read(text, catalog, source_name, areas, {**said, **proposed})
        errors = _errors_by_piece(reading)
    lines = tuple(_lines(reading, errors, acts, proposals))
    left = any(line.is_left for line in lines)
    return Draft(
        source_name=source_name,
        lines=lines,
        mission=None if left else reading.mission,
        diagnostics=_all_diagnostics(reading, proposals),
    )


def _all_diagnostics(
    reading: _Reading, proposals: Mapping[int, Proposal]
) -> tuple[Diagnostic, ...]:
    """Return all diagnostics of a script, by their place."""
    source = reading.script.source
    found = by_position((*reading.diagnostics, *_asides(reading, proposals)))
    notes = () if source.document is None else source.document.note_diagnostics()
    return (*source.placed(found), *notes)


def _reads(proposal: Proposal) -> bool:
    """Return True if a proposal states what replaces its piece, or that nothing does."""
    return bool(proposal.sentences or proposal.aside or proposal.certain)


def _read(
    text: str | Document,
    catalog: Catalog,
    source_name: str,
    areas: tuple[int | None, int | None],
    decided: Mapping[int, Sequence[str]],
) -> _Reading:
    places = [place.name for place in catalog.places]
    names = [checkpoint.name for checkpoint in catalog.checkpoints]
    tags = {tag: (c.id, c.name) for c in catalog.checkpoints for tag in c.tags}
    script = parse(text, places, source_name, names, decided, tags)
    try:
        resolved = resolve_script(script, catalog, *areas)
    except DiagnosticError as error:
        return _Reading(script, None, error.diagnostics)
    return _Reading(script, resolved.mission, resolved.diagnostics)


def _match(decisions: Sequence[LineDecision], pieces: Sequence[Piece]) -> dict[int, LineDecision]:
    """Return the decisions by the offsets at which their pieces begin.

    Of several lines with one text each needs its own decision: if their number has changed, these
    decisions have no effect.
    """
    if not decisions:
        return {}
    by_line = {(decision.text, decision.occurrence): decision for decision in decisions}
    texts = [text_of(piece) for piece in pieces]
    found: dict[int, LineDecision] = {}
    for text, piece, (nth, count) in zip(texts, pieces, occurrences(texts), strict=True):
        decision = by_line.get((text, nth))
        if decision is not None and decision.occurrences == count:
            found[piece.text.first] = decision
    return found


def text_of(piece: Piece) -> str:
    """Return the part of the source that a piece was read from, with single blanks."""
    text = piece.text
    return " ".join(text.source.text[text.first : text.last + 1].split())


def _lines(
    reading: _Reading,
    errors: Mapping[int, Diagnostic],
    acts: Mapping[int, LineDecision],
    proposals: Mapping[int, Proposal],
) -> Iterator[DraftLine]:
    pieces, source = reading.script.pieces, reading.script.source
    spans = [_lines_of(piece) for piece in pieces]
    parts = occurrences([first for first, _ in spans])
    for piece, (first, last), (part, count) in zip(pieces, spans, parts, strict=True):
        at = piece.text.first
        line = DraftLine(
            line=first,
            last_line=last,
            part=part,
            parts=count,
            place="" if source.document is None else source.document.place_at(first),
            text=text_of(piece),
            state=LineState.SET_ASIDE if piece.aside else LineState.UNDERSTOOD,
            reason=piece.aside,
        )
        yield line.model_copy(update=_known(acts.get(at), proposals.get(at), errors.get(at)))


def _known(
    decision: LineDecision | None, proposal: Proposal | None, error: Diagnostic | None
) -> dict[str, object]:
    """Return what is known of a line besides its text."""
    found: dict[str, object] = {}
    confirmed = False
    if proposal is not None:
        state = LineState.PROPOSED if proposal.sentences else LineState.SET_ASIDE
        found = {"state": state, "sentences": proposal.sentences, "unused": proposal.unused}
        found |= {"reason": proposal.aside, "choices": proposal.choices}
        if proposal.certain:
            found["state"] = LineState.UNDERSTOOD
        confirmed = decision is not None and decision.sentences == proposal.sentences != ()
    if decision is not None and (confirmed or decision.act is not Act.CONFIRMED):
        aside = decision.act is Act.SET_ASIDE
        found = {"state": LineState.SET_ASIDE if aside else LineState.UNDERSTOOD}
        found |= {"act": decision.act, "sentences": decision.sentences}
    elif decision is None and proposal is not None and proposal.doubt:
        found["state"], found["reason"] = LineState.OPEN, proposal.doubt
    if error is not None:
        doubt = "" if proposal is None else proposal.doubt
        found |= {"state": LineState.OPEN, "reason": doubt or error.message}
        found["hint"] = error.hint or ""
    return found


def _asides(reading: _Reading, proposals: Mapping[int, Proposal]) -> tuple[Diagnostic, ...]:
    """Return the warnings for pieces that are set aside, or that differ from the site."""
    found: list[Diagnostic] = []
    for piece in reading.script.pieces:
        proposal = proposals.get(piece.text.first)
        if proposal is None:
            continue
        span = piece.text.span()
        if proposal.aside:
            message = f"`{_shown(text_of(piece))}` is set aside: it is {proposal.aside}"
            hint = "write it as a step if the robot has to do something"
            found.append(diagnostic_of("script.set-aside", message, hint, span=span))
        for message in proposal.differences:
            hint = "correct one of the two; the mission uses that of the site"
            found.append(diagnostic_of("script.other-range", message, hint, span=span))
    return with_excerpts(found, Source(reading.script.source_text).lines)


def _shown(text: str) -> str:
    return text if len(text) <= _LONGEST_SHOWN else f"{text[: _LONGEST_SHOWN - 3]}..."


def _lines_of(piece: Piece) -> tuple[int, int]:
    """Return the numbers of a piece's first and last line."""
    text, source = piece.text, piece.text.source
    return source.line_at(text.first), source.line_at(text.last)


def _errors_by_piece(reading: _Reading) -> dict[int, Diagnostic]:
    """Return the first error in each piece that has one, by the offset at which it begins."""
    pieces = reading.script.pieces
    starts = [piece.text.first for piece in pieces]
    found: dict[int, Diagnostic] = {}
    for diagnostic in reading.diagnostics:
        span = diagnostic.span
        if diagnostic.severity is not Severity.ERROR or span is None or not pieces:
            continue
        if diagnostic.code in _OF_OPTIONS:
            continue
        offset = pieces[0].text.source.offset_at(span.line, span.column)
        at = bisect_right(starts, offset) - 1
        inside = (i for i in range(at, max(-1, at - 20), -1) if pieces[i].text.last >= offset)
        found.setdefault(starts[next(inside, max(at, 0))], diagnostic)
    return found
