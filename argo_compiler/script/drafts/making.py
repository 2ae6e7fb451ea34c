"""Script text to draft: the script is read, and what is left is proposed or asked about."""

from bisect import bisect_right
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

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
from argo_compiler.script.assistant.suggestion import LineSuggestion
from argo_compiler.script.documents.document import Document
from argo_compiler.script.documents.source import shortened
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
from argo_compiler.script.resolve.importing import resolve_script
from argo_compiler.script.sentences.understanding import IS_MEANT

if TYPE_CHECKING:
    from argo_compiler.script.proposals.composing import Proposal
    from argo_compiler.script.proposals.proposing import Made

_OF_OPTIONS = frozenset(["script.area-choice", "script.area-conflict", "script.area-not-offered"])
"""codes of errors that another option resolves, and no change of the line"""
_UNREAD = frozenset(
    [
        *("script.not-understood", "script.unfinished", "script.unknown-label", "script.row"),
        *("script.duration", "script.field", "script.ambiguous-duration", "script.question"),
    ]
)
"""codes of errors of a piece that the grammar does not take; others are questions"""
_WITHOUT_SENSE = frozenset(["script.not-understood", "script.unfinished"])
"""codes of errors whose hints are samples of the language"""
_OF_OFFERS = frozenset([Act.CONFIRMED, Act.CHOSEN])
"""acts that count only while what they accept is offered"""
_EMPTY = "script.empty-step"
"""code of the error that there is nothing to repeat, which lines with other errors may have"""
_HOW = {
    Act.CONFIRMED: "as confirmed",
    Act.CHOSEN: "as chosen",
    Act.SAID: "as a person has said",
}
BY_ASSISTANT = "suggested by an assistant"
"""reason of a line that an assistant has suggested sentences for"""

_LONGEST_CACHED = 100_000
"""characters of a script whose last readings are cached"""


@dataclass(frozen=True)
class _Reading:
    """A script that was read with some decisions."""

    script: Script
    mission: Mission | None
    diagnostics: tuple[Diagnostic, ...]


class _Context(NamedTuple):
    """Arguments of `propose` beside the script and the pieces."""

    catalog: Catalog
    start_area: int | None
    chosen: Mapping[int, tuple[str, ...]]
    sure: Collection[int]
    made: "Made"


@collector_held()
def import_script(
    text: str | Document,
    catalog: Catalog,
    *,
    source_name: str = "script",
    start_area: int | None = None,
    end_area: int | None = None,
    decisions: Iterable[LineDecision] = (),
    suggestions: Iterable[LineSuggestion] = (),
) -> Draft:
    """Return the draft of a script; its mission is None as long as something is left to decide.

    Args:
        text: the script, or the document in which it is; see `read_document`
        catalog: names and places of the site
        source_name: name of the script in messages
        start_area: starting area, for a script that names none
        end_area: area to end in, likewise
        decisions: what a person has decided on for lines of the script; decisions on lines that it
            does not have, or that have another proposal or other choices now, have no effect
        suggestions: what an assistant has suggested for lines that are open

    Raises:
        DiagnosticError: The text is no script: it is empty or too long.
    """
    areas = (start_area, end_area)
    given = tuple(decisions)

    def read(decided: Mapping[int, Sequence[str]]) -> _Reading:
        if isinstance(text, Document) or len(text) > _LONGEST_CACHED:
            return _read(text, catalog, source_name, areas, decided)
        sentences = tuple((at, tuple(said)) for at, said in sorted(decided.items()))
        return read_cached(text, catalog, source_name, areas, sentences)

    reading = read({})
    acts = _match(given, reading.script.pieces)
    said = {at: act.sentences for at, act in acts.items() if act.act not in _OF_OFFERS}
    chosen = {at: act.sentences for at, act in acts.items() if act.act is Act.CHOSEN}
    if said:
        reading = read(said)
    errors = _errors_by_piece(reading)
    unread = {at for at, error in errors.items() if error.code in _UNREAD and at not in said}
    unclear = {at for at in errors if at not in said}
    proposals: dict[int, Proposal] = {}
    script = reading.script
    context = _Context(catalog, start_area, {}, frozenset(), {})
    if unread or unclear:  # not of a script that is understood whole, which is to start fast
        proposals = _propose(script, unread, unclear - unread, context)
    if chosen:  # what is offered may hang on the other choices
        offered = {at: one.choices for at, one in proposals.items()}
        sure = frozenset(at for at, taken in chosen.items() if taken in offered.get(at, ()))
        context = context._replace(chosen=chosen, sure=sure)
    if chosen and proposals:
        proposals = _propose(script, unread, unclear - unread, context)
    proposed = {at: p.sentences for at, p in proposals.items() if not p.is_open}
    suggested = _match(tuple(suggestions), reading.script.pieces)
    assisted = _assisted(reading.script, unread - proposed.keys(), suggested, catalog)
    refused: dict[int, Diagnostic] = {}
    decided = {**said, **proposed}
    if proposed or assisted:
        sentences = {at: proposal.sentences for at, proposal in assisted.items()}
        reading = read(decided | sentences)
        refused = {at: e for at, e in _errors_by_piece(reading).items() if at in assisted}
        decided |= {at: one for at, one in sentences.items() if at not in refused}
        if refused:
            reading = read(decided)
        errors = _errors_by_piece(reading)
    lacking: set[int] = set()
    while more := {at for at in errors if not _has_choices(proposals.get(at))} - lacking:
        lacking |= more  # in error only with what was decided or proposed for this line or others
        others = _propose(script, unread - lacking, unclear | lacking, context)
        for at in more & others.keys():
            proposals[at] = replace(proposals.get(at, others[at]), choices=others[at].choices)
        late = {at: others[at] for at in more & others.keys() & chosen.keys()}
        late = {at: proposal for at, proposal in late.items() if proposal.sentences}
        proposals |= late
        decided |= {at: proposal.sentences for at, proposal in late.items()}
        if not late:
            break
        reading = read(decided)
        errors = _errors_by_piece(reading)
    proposals |= {at: one for at, one in assisted.items() if at not in refused}
    hinted = {at: _with_own_hint(error, proposals.get(at)) for at, error in errors.items()}
    known = _Known(errors, acts, proposals, suggested, assisted, refused)
    lines = tuple(_lines(reading, known))
    left = any(line.is_left for line in lines)
    notes = (*_asides(reading, proposals), *_decided(reading, given, acts, lines))
    notes = with_excerpts(notes, reading.script.source.lines)
    return Draft(
        source_name=source_name,
        lines=lines,
        mission=None if left else reading.mission,
        diagnostics=_all_diagnostics(
            reading, notes, {id(errors[at]): error for at, error in hinted.items()}
        ),
        text=reading.script.source_text,
    )


def _has_choices(proposal: "Proposal | None") -> bool:
    return proposal is not None and bool(proposal.choices)


def _propose(
    script: Script,
    unread: Collection[int],
    unclear: Collection[int],
    context: _Context,
) -> "dict[int, Proposal]":
    """Return the proposals for pieces of a script; see `propose`, which is imported only here."""
    from argo_compiler.script.proposals.proposing import propose

    return propose(script, unread, unclear, *context)


def _with_own_hint(error: Diagnostic, proposal: "Proposal | None") -> Diagnostic:
    """Return the error of a text that makes no sense with what may be said of its own checkpoints,
    if that is known."""
    choice = _first_choice(error, proposal)
    hints = filter(None, (_spelling(error), f"say, `{choice}`"))
    return error.model_copy(update={"hint": "; ".join(hints)}) if choice else error


def _first_choice(error: Diagnostic, proposal: "Proposal | None") -> str:
    """Return the first choice for a text that makes no sense; empty if it has none."""
    if error.code not in _WITHOUT_SENSE or proposal is None or not proposal.choices:
        return ""
    return " ".join(proposal.choices[0])


def _spelling(error: Diagnostic) -> str:
    """Return the part of a hint that asks for the right spelling, if it has one."""
    meant, asks, _ = (error.hint or "").partition(IS_MEANT)
    return f"{meant}{asks}" if asks else ""


def _all_diagnostics(
    reading: _Reading, notes: Sequence[Diagnostic], hinted: Mapping[int, Diagnostic]
) -> tuple[Diagnostic, ...]:
    """Return all diagnostics of a script, by their place. `hinted`: those with other hints, by the
    identity of what they replace."""
    source = reading.script.source
    found = by_position((*(hinted.get(id(d), d) for d in reading.diagnostics), *notes))
    document = source.document
    return (*source.placed(found), *(() if document is None else document.note_diagnostics()))


def _assisted(
    script: Script,
    open_pieces: Collection[int],
    suggested: Mapping[int, LineSuggestion],
    catalog: Catalog,
) -> "dict[int, Proposal]":
    """Return what an assistant's suggestions propose for pieces that nothing is proposed for."""
    if not suggested:
        return {}
    from argo_compiler.script.assistant.claims import suggested_proposals

    texts = {piece.text.first: text_of(piece) for piece in script.pieces}
    sentences = {at: one.sentences for at, one in suggested.items() if at in open_pieces}
    found = suggested_proposals(script, sentences, texts, catalog)
    return {at: proposal for at, proposal in found.items() if proposal.sentences}


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


@lru_cache(maxsize=4)
def read_cached(
    text: str,
    catalog: Catalog,
    source_name: str,
    areas: tuple[int | None, int | None],
    decided: tuple[tuple[int, tuple[str, ...]], ...],
) -> _Reading:
    """Return the reading of a script, which is the same once its proposals are confirmed."""
    return _read(text, catalog, source_name, areas, dict(decided))


class _OfLine(Protocol):
    """Something about a line that is found again by its text."""

    @property
    def text(self) -> str: ...
    @property
    def occurrence(self) -> int: ...
    @property
    def occurrences(self) -> int: ...


_Found = TypeVar("_Found", bound=_OfLine)


def _match(stored: Sequence[_Found], pieces: Sequence[Piece]) -> dict[int, _Found]:
    """Return what is stored for lines by the offsets at which their pieces begin.

    Of several lines with one text each needs its own: if their number has changed, what is stored
    for them has no effect.
    """
    if not stored:
        return {}
    by_line = {(one.text, one.occurrence, one.occurrences): one for one in stored}
    texts = [text_of(piece) for piece in pieces]
    found: dict[int, _Found] = {}
    for text, piece, place in zip(texts, pieces, occurrences(texts), strict=True):
        if (one := by_line.get((text, *place))) is not None:
            found[piece.text.first] = one
    return found


def text_of(piece: Piece) -> str:
    """Return the part of the source that a piece was read from, with single blanks."""
    text = piece.text
    return " ".join(text.source.text[text.first : text.last + 1].split())


@dataclass(frozen=True)
class _Known:
    """Errors, decisions and proposals of pieces, by the offsets at which the pieces begin."""

    errors: Mapping[int, Diagnostic]
    acts: Mapping[int, LineDecision]
    proposals: "Mapping[int, Proposal]"
    suggested: Mapping[int, LineSuggestion]
    assisted: "Mapping[int, Proposal]"
    """proposals that follow from suggestions"""
    refused: Mapping[int, Diagnostic]
    """errors in the sentences that are suggested"""

    def of(self, at: int) -> dict[str, object]:
        """Return what is known of a piece, as fields of its line."""
        found: dict[str, object] = {}
        confirmed = False
        decision, proposal = self.acts.get(at), self.proposals.get(at)
        if proposal is not None:
            state = LineState.PROPOSED if proposal.sentences else LineState.SET_ASIDE
            found = {"state": state, "sentences": proposal.sentences, "unused": proposal.unused}
            found |= {"reason": proposal.aside, "choices": proposal.choices}
            if at in self.assisted and at not in self.refused:
                found["reason"] = "; ".join(filter(None, (BY_ASSISTANT, proposal.doubt)))
            if proposal.certain:
                found["state"] = LineState.UNDERSTOOD
            confirmed = decision is not None and decision.sentences == proposal.sentences != ()
        if decision is not None and (confirmed or decision.act not in _OF_OFFERS):
            aside = decision.act is Act.SET_ASIDE
            found = {"state": LineState.SET_ASIDE if aside else LineState.UNDERSTOOD}
            found |= {"act": decision.act, "sentences": decision.sentences}
        elif proposal is not None and proposal.doubt and at not in self.assisted:
            found["state"], found["reason"] = LineState.OPEN, proposal.doubt
        if (error := self.errors.get(at)) is not None:
            doubt = "" if proposal is None else proposal.doubt
            found |= {"state": LineState.OPEN, "reason": doubt or error.message}
            hint = _spelling(error) if _first_choice(error, proposal) else error.hint or ""
            found |= {"hint": hint, "is_question": error.code not in _UNREAD}
            refused = decision.sentences if decision is not None and "act" in found else None
            choices = () if proposal is None else proposal.choices
            found |= {"choices": tuple(choice for choice in choices if choice != refused)}
        if (refusal := self.refused.get(at)) is not None and "act" not in found:
            sentences = " ".join(self.assisted[at].sentences)
            found["hint"] = f"an assistant suggests `{sentences}`, but {refusal.message}"
        if at in self.suggested:
            found["suggested"] = self.suggested[at].sentences
        return found


def _lines(reading: _Reading, known: _Known) -> Iterator[DraftLine]:
    pieces, source = reading.script.pieces, reading.script.source
    spans = [_lines_of(piece) for piece in pieces]
    parts = occurrences([first for first, _ in spans])
    for piece, (first, last), (part, count) in zip(pieces, spans, parts, strict=True):
        line = DraftLine(
            line=first,
            last_line=last,
            column=piece.text.span().column,
            part=part,
            parts=count,
            place="" if source.document is None else source.document.place_at(first),
            text=text_of(piece),
            state=LineState.SET_ASIDE if piece.aside else LineState.UNDERSTOOD,
            reason=piece.aside,
        )
        found = known.of(piece.text.first)
        yield line.model_copy(update=found) if found else line


def _asides(reading: _Reading, proposals: "Mapping[int, Proposal]") -> tuple[Diagnostic, ...]:
    """Return the warnings for pieces that are set aside, or that differ from the site."""
    found: list[Diagnostic] = []
    for piece in reading.script.pieces:
        proposal = proposals.get(piece.text.first)
        if proposal is None:
            continue
        span = piece.text.span()
        if proposal.aside:
            message = f"`{shortened(text_of(piece))}` is set aside: it is {proposal.aside}"
            hint = "write it as a step if the robot has to do something"
            found.append(diagnostic_of("script.set-aside", message, hint, span=span))
        for word in proposal.ignored if proposal.certain else ():
            found.append(diagnostic_of("script.no-effect", f"`{word}` has no effect", span=span))
        for message in proposal.differences:
            hint = "correct one of the two; the mission uses that of the site"
            found.append(diagnostic_of("script.other-range", message, hint, span=span))
    return tuple(found)


def _decided(
    reading: _Reading,
    decisions: Sequence[LineDecision],
    acts: Mapping[int, LineDecision],
    lines: Sequence[DraftLine],
) -> Iterator[Diagnostic]:
    """Yield notes of what was decided on, and warnings of decisions that have no effect."""
    effective: set[int] = set()
    matched: dict[int, DraftLine] = {}
    for piece, line in zip(reading.script.pieces, lines, strict=True):
        act = acts.get(piece.text.first)
        if act is None:
            continue
        matched[id(act)] = line
        if line.act is None:
            continue
        effective.add(id(act))
        span, shown = piece.text.span(), f"`{shortened(line.text)}`"
        if line.act is Act.SET_ASIDE:
            message = f"{shown} is set aside by hand"
            yield diagnostic_of("script.set-aside-by-hand", message, span=span)
        else:
            message = f"{shown} counts as `{shortened(' '.join(line.sentences))}`, {_HOW[line.act]}"
            yield diagnostic_of("script.decided", message, span=span)
    for decision in decisions:
        if id(decision) not in effective:
            why = _why_not(decision, matched.get(id(decision)))
            count = sum(line.text == decision.text for line in lines)
            now = f"{count} lines have this text now" if count > 1 else "one line has this text now"
            why = why or (now if count else "no line has this text")
            message = f"what was decided on `{shortened(decision.text)}` has no effect: {why}"
            hint = "import the script again to forget the decision, or decide anew"
            yield diagnostic_of("script.decision-unused", message, hint)


def _why_not(decision: LineDecision, line: DraftLine | None) -> str:
    """Return why a decision on a line that the script still has does not count; empty if it has no
    such line."""
    if line is None:
        return ""
    if not line.is_left:
        return "the line is understood without it"
    number = f"line {line.label}"
    if decision.act is Act.CHOSEN:
        return f"{number} does not offer `{shortened(' '.join(decision.sentences))}` now"
    return (
        f"{number} has another proposal now"
        if line.sentences
        else f"nothing is proposed for {number}"
    )


def _lines_of(piece: Piece) -> tuple[int, int]:
    """Return the numbers of a piece's first and last line."""
    text, source = piece.text, piece.text.source
    return source.line_at(text.first), source.line_at(text.last)


def _errors_by_piece(reading: _Reading) -> dict[int, Diagnostic]:
    """Return the first error in each piece that has one, by the offset at which it begins."""
    pieces = reading.script.pieces
    errors = [d for d in reading.diagnostics if d.severity is Severity.ERROR]
    starts = [piece.text.first for piece in pieces] if errors else []
    found: dict[int, Diagnostic] = {}
    for diagnostic in errors:
        span = diagnostic.span
        if span is None or not pieces or diagnostic.code in _OF_OPTIONS:
            continue
        offset = pieces[0].text.source.offset_at(span.line, span.column)
        at = bisect_right(starts, offset) - 1
        inside = (i for i in range(at, max(-1, at - 20), -1) if pieces[i].text.last >= offset)
        found.setdefault(starts[next(inside, max(at, 0))], diagnostic)
    others = {at: error for at, error in found.items() if error.code != _EMPTY}
    return others or found
