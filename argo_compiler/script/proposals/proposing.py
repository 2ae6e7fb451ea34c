"""Proposals for the pieces of a script that the grammar does not take."""

import re
from bisect import bisect_right
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain, takewhile
from typing import Any, TypeGuard, TypeVar

from argo_compiler.base.catalog import Catalog
from argo_compiler.script.documents.signs import place_in_order
from argo_compiler.script.documents.source import Diagnostics, RefusedError, ScriptText
from argo_compiler.script.layout.forms import CellRole, FormRow
from argo_compiler.script.parsing.script import Piece, Script
from argo_compiler.script.proposals.choices import choices_of
from argo_compiler.script.proposals.clock import (
    NO_DATES,
    find_plan,
    has_date,
    timed,
    wait_until,
    waits,
    windowed,
)
from argo_compiler.script.proposals.composing import Composer, Proposal
from argo_compiler.script.proposals.frames import Sentences, floor_names, has_no_floor
from argo_compiler.script.proposals.known import Known
from argo_compiler.script.proposals.mentions import (
    OF_FORMS,
    Mention,
    Mentions,
    checkpoint_words,
    mentions_in,
)
from argo_compiler.script.proposals.neighbours import Neighbours
from argo_compiler.script.proposals.parts import MOST_TAKEN_APART
from argo_compiler.script.proposals.round_fields import propose_rounds
from argo_compiler.script.proposals.rows import naming, of_floor, only_floors, propose_row
from argo_compiler.script.sentences.tree.nouns import AllOf, Noun, TheOne
from argo_compiler.script.sentences.tree.orders import Measure, Sentence
from argo_compiler.script.sentences.tree.script import ScriptStep
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.loading import pattern

MAX_PROPOSED = 2000
"""pieces of a script; no more are looked at"""
Made = dict[tuple[object, ...], tuple[Any, int]]
"""what was made of pieces, by what was known then, and how many of their characters were taken
apart"""
_Result = TypeVar("_Result")
_REORDERED = "a row in the order that is chosen at the headings"
_NUMBERED = re.compile(r"checkpoint ([0-9]+)")
_RETURN = re.compile(r"Return to the docking station(?: in starting area ([0-9]+))?\.")


def propose(
    script: Script,
    unread: Collection[int],
    unclear: Collection[int],
    catalog: Catalog,
    start_area: int | None,
    chosen: Mapping[int, Sentences],
    sure: Collection[int],
    made: Made,
) -> dict[int, Proposal]:
    """Return what is proposed for the unread pieces, and the choices of those that are unclear; by
    the offset at which a piece begins.

    Args:
        script: the script
        unread: offsets of the pieces that the grammar does not take
        unclear: offsets of those that it takes, and that have an error
        catalog: names and places of the site
        start_area: where the mission starts if the script does not say it
        chosen: choices that a person has taken; what is not offered has no effect
        sure: offsets of those that are offered whatever else is chosen
        made: what was made of pieces of this script before; what is made now is added
    """
    source = script.source
    places = [place.name for place in catalog.places]
    language = Language.of(script.source_text, places)
    understanding = Understanding(language, frozenset(), Diagnostics(source))
    known = Known(understanding, catalog)
    known.start_area = _start_area(script) or start_area
    composer = Composer(understanding, known)
    return _Proposer(script, unread, unclear, composer, chosen, sure, made).all()


class _Proposer:
    """Goes through the pieces of a script. Mutable: what one means depends on those before it."""

    def __init__(
        self,
        script: Script,
        unread: Collection[int],
        unclear: Collection[int],
        composer: Composer,
        chosen: Mapping[int, Sentences],
        sure: Collection[int],
        made: Made,
    ) -> None:
        self.script = script
        self.unread = unread
        self.unclear = unclear
        self.composer = composer
        self.understanding = composer.understanding
        texts = (self._whole(p) for p in script.pieces if p.text.first in unread)
        self.neighbours = Neighbours(script, composer)
        self.plan = None if self.neighbours.is_log else find_plan(texts, composer.understanding)
        self.rounds = propose_rounds(
            (p for p in script.pieces if p.text.first in unread), script.rows, self.understanding
        )
        self.found: dict[int, Proposal] = {}
        self.chosen = chosen
        self.sure = sure
        self.made = made
        self.known: tuple[object, ...] = ()
        self.floor: Mention | None = None
        """of the heading directly above, where Argo does not understand that as a sentence"""
        self.reordered: set[int] = set()
        """offsets of headings above rows that are read in another order"""
        self.over_floor = False
        """whether the piece is such a heading"""

    def all(self) -> dict[int, Proposal]:
        """Return the proposals of all pieces."""
        measured = _measured(self.script.steps, self.script.pieces)
        for named in measured.values():
            with suppress(RefusedError):
                ids = {c.id for c in self.composer.known.checkpoints(named)}
                self.composer.known.asked |= ids
        self.composer.known.excepted.clear()
        for number, mention in _numbered(self.script.steps):
            with suppress(RefusedError):
                checkpoint, *others = self.composer.known.checkpoints([mention])
                self.composer.known.items |= {} if others else {str(number): checkpoint.id}
        for i, piece in enumerate(self.script.pieces):
            start = piece.text.first
            self.neighbours.note_heading(piece)
            self._note_section(piece)
            self._note_floor(piece, i, measured)
            if start not in self.script.rows:
                self.composer.known.listed = None
            named = measured.get(start, [])
            proposal: Proposal | None = None
            if start in self.unread and len(self.found) < MAX_PROPOSED:
                proposal = self._proposal(piece, i)
            elif start in self.unclear and len(self.found) < MAX_PROPOSED:
                proposal = Proposal()
            elif self.plan is not None and has_date(piece.text) and not named:
                proposal = Proposal(choices=((),), doubt=NO_DATES)
            elif self._is_heading_of_rows(piece, i):
                proposal = Proposal(aside="a heading")
            elif named and self._is_spared(named, piece.text):
                proposal = Proposal(aside="left out, as another line says")
            elif named and self.floor is not None:
                proposal = self._on_floor(piece.text, named, self.floor)
            if proposal is not None and self._is_left_out(proposal):
                proposal = Proposal(aside="left out, as another line says")
            in_row = start in self.script.rows
            sought = proposal is not None and proposal.is_open and not proposal.complete
            if proposal is not None and sought and (in_row or not any(proposal.choices)):
                choices = self._choices(piece, proposal.choices)
                proposal = replace(proposal, choices=choices)
            if proposal is not None:
                if proposal.is_open:
                    proposal = self._with_chosen(piece, proposal)
                    self._note_reordered(piece, proposal)
                self.found[start] = proposal
                self._note_item(piece, proposal)
            else:
                self._remember(named)
            said = proposal.sentences if proposal is not None else ()
            aside = piece.aside if proposal is None else proposal.aside
            self.neighbours.note(i, aside, asks=bool(named or said) and not aside)
            self.composer.before = said[-1] if said else piece.text.content
        self._end_later({*measured})
        return self.found

    def _with_chosen(self, piece: Piece, proposal: Proposal) -> Proposal:
        """Return an open proposal with the sentences that a person has chosen, if they are
        offered."""
        chosen = self.chosen.get(piece.text.first)
        offered = {*proposal.choices, *map(self._ending, proposal.choices)}
        if not chosen or not (chosen in offered or piece.text.first in self.sure):
            return proposal
        for sentence in filter(_checks, chosen):
            self.composer.propose(piece.text.replaced(sentence))  # later texts refer to it
        return replace(proposal, sentences=chosen, doubt="")

    def _end_later(self, measured: set[int]) -> None:
        """Let a return that tasks follow say where the mission ends: `Arrival: starting area 1`
        above the checkpoints."""
        checking = (
            at
            for at, one in self.found.items()
            if any(map(_checks, (*one.sentences, *chain(*one.choices[:1]))))
        )
        last = max((*measured, *checking), default=-1)
        for at, proposal in self.found.items():
            if at < last:
                choices = tuple(map(self._ending, proposal.choices))
                sentences = self._ending(proposal.sentences)
                self.found[at] = replace(proposal, sentences=sentences, choices=choices)

    def _ending(self, sentences: Sentences) -> Sentences:
        """Return sentences of which the last, a return, says only where the mission ends."""
        returned = _RETURN.fullmatch(sentences[-1]) if sentences else None
        if returned is None:
            return sentences
        area = returned[1] or self.composer.known.start_area
        where = "docking station" if area is None else f"starting area {area}"
        return (*sentences[:-1], f"End of the mission: {where}.")

    def _is_heading_of_rows(self, piece: Piece, i: int) -> bool:
        """Return True for a kind over rows of a sheet: `PRESSURE GAUGES (bar)`. What these name by
        a number alone is of that kind."""
        found = mentions_in(piece.text, self.understanding)
        below = self.script.pieces[i + 1 : i + 2]
        over_rows = all(one.text.first in self.script.rows for one in below)
        nouns = (noun for mention in found.of("checkpoints") for noun in mention.nouns)
        kinds = {noun.kind for noun in nouns if _is_kind(noun)}
        alone = found.only("checkpoints", *OF_FORMS, "UNIT", "LPAR_HOW")
        if not (below and over_rows and len(kinds) == 1 and alone):
            return False
        (self.composer.known.listed,) = kinds
        return True

    def _note_section(self, piece: Piece) -> None:
        """Note the floor that a heading names for the rows below it; another heading ends that."""
        row = self.script.rows.get(piece.text.first)
        texts = [piece.text] if row is None else [cell.text for cell in row.cells]
        found = [mentions_in(text, self.understanding) for text in texts]
        floors = [one.mentions[0] for one in found if only_floors(one) and not one.unknown]
        if row is None and (piece.text.first in self.unread or piece.text.first in self.unclear):
            floors = []  # it is asked about
        if (
            row is None
            or row.is_heading
            or (floors and not any(one.has("checkpoints") for one in found))
        ):
            self.composer.known.section = floors[0] if len(floors) == 1 else None

    def _note_reordered(self, piece: Piece, proposal: Proposal) -> None:
        """Note that a choice at the headings of a table says what all its rows ask for."""
        row = self.script.rows.get(piece.text.first)
        if row is not None and row.is_heading and proposal.sentences:
            self.reordered |= {cell.text.first for cell in row.cells}

    def _note_floor(self, piece: Piece, i: int, measured: Mapping[int, Sequence[Mention]]) -> None:
        """Note the floor of a title, or of a line that Argo does not understand, which names no
        more than that: it is a heading of the lines directly below it, which name checkpoints."""
        start = piece.text.first
        self.over_floor = False
        if start in measured or start in self.script.rows:
            return
        found = mentions_in(piece.text, self.understanding)
        below = self.script.pieces[i + 1 : i + 2]
        headed = bool(below) and below[0].text.first in {*measured, *self.script.rows}
        adjacent = headed and _line(below[0].text) == _line(piece.text) + 1
        single = only_floors(found) and len(found.mentions) == 1 and not found.unknown
        self.over_floor = start in self.unread and single and adjacent
        titled = bool(piece.aside) and single
        self.floor = found.mentions[0] if self.over_floor or titled else None
        if self.floor is not None:
            self.composer.known.section = self.floor

    def _on_floor(
        self, text: ScriptText, named: Sequence[Mention], floor: Mention
    ) -> Proposal | None:
        """Return what a line below the heading of a floor asks for: `all gauges` are those on this
        floor. None if it names checkpoints on it."""
        known = self.composer.known
        nouns = [noun for mention in named for noun in mention.nouns]
        with suppress(RefusedError):
            checkpoints = [c for mention in named for c in of_floor(mention, floor, known)]
            if not any(map(has_no_floor, nouns)):
                floors = known.floors(floor_names(floor))
                other = next((c for c in checkpoints if c.floor not in floors), None)
                if other is None or any(
                    m.has("place") for m in [mentions_in(text, self.understanding)]
                ):
                    return None
                doubt = f"{other.name} is on floor {other.floor}"
                return Proposal(
                    choices=((f"Check {checkpoint_words(checkpoints)}.",), ()), doubt=doubt
                )
            check = f"Check {checkpoint_words(checkpoints)} in any order." if checkpoints else ""
            found = mentions_in(text, self.understanding)
            if check and found.only("checkpoints", "MEASURE", "measuring") and not found.unknown:
                known.measured(checkpoints)
                return Proposal((check,))
            choices = ((check,), ()) if check else ((),)
            return Proposal(choices=choices, doubt="only what is on the floor above can be meant")
        return Proposal(doubt="it is not clear what is meant on the floor above")

    def _note_item(self, piece: Piece, proposal: Proposal) -> None:
        """Note which checkpoint a numbered row is about."""
        row = self.script.rows.get(piece.text.first)
        numbers = [c.text.content for c in row.cells if c.role is CellRole.NUMBER] if row else []
        named = _NUMBERED.findall(" ".join(proposal.sentences))
        words = row.place.content.strip(" |").split() if row is not None else []
        first = words[0].strip(".):|") if words else ""
        if row is not None and len({*named}) == 1:
            self.composer.known.items[(numbers or [first])[0].strip(".")] = int(named[0])

    def _whole(self, piece: Piece) -> ScriptText:
        row = self.script.rows.get(piece.text.first)
        return piece.text if row is None else row.place

    def _proposal(self, piece: Piece, i: int) -> Proposal:
        whole = self._whole(piece)
        if piece.text.first in self.rounds:
            return self.rounds[piece.text.first]
        if self.over_floor:
            return Proposal(aside="a heading")
        if reason := self.neighbours.reason(i, whole):
            return Proposal(aside=reason)
        at_time = self._at_time(whole)
        if at_time is not None:
            return at_time
        row = self.script.rows.get(piece.text.first)
        if (
            row is not None
            and row.is_heading
            and (column := self._column_of_order(row)) is not None
        ):
            doubt = f"`{row.cells[column].text.content}` can give another order of the rows"
            ordered = self._in_order(row, i, column)
            return Proposal(choices=(*ordered, ()), doubt=doubt, complete=bool(ordered))
        if row is not None and row.headed_at in self.reordered:
            return Proposal(aside=_REORDERED)
        if row is not None:
            return self._once(piece, (), lambda: propose_row(row, self.composer, first=i == 0))
        made = self._once(piece, (), lambda: self.composer.propose(piece.text))
        if made.aside and self._empties_heading(i):
            return Proposal(doubt="this may be of the line above")
        if made.aside.startswith("a field") and self.neighbours.stands_over_points(i):
            return Proposal(doubt="this may say who does what is below it")
        return made

    def _column_of_order(self, heading: FormRow) -> int | None:
        """Return the column whose numbers give the rows below another order; None if none does."""
        starts = {cell.text.first for cell in heading.cells}
        rows = [row for row in self.script.rows.values() if row.headed_at in starts]
        for column, heading_cell in enumerate(heading.cells):
            cells = [row.cell_in(column) for row in rows]
            places = [place_in_order(c.text.content) if c is not None else None for c in cells]
            numbers = [place for place in places if place is not None]
            visits = any(c is not None and c.role is CellRole.ORDER for c in cells)
            named = visits or pattern(r"\b<ordering>\b").search(heading_cell.text.content)
            partly = visits and 0 < len(numbers) < len(places)
            if named and (numbers != sorted(numbers) or partly):
                return column
        return None

    def _in_order(self, heading: FormRow, i: int, column: int) -> tuple[Sentences, ...]:
        """Return what the rows below headings ask for in the order of the numbers in a column;
        nothing if it is not clear, or if other lines stand between the rows."""
        starts = {cell.text.first for cell in heading.cells}
        below = (self.script.rows.get(p.text.first) for p in self.script.pieces[i + 1 :])
        rows = list(takewhile(lambda row: row is not None and row.headed_at in starts, below))
        count = sum(row.headed_at in starts for row in self.script.rows.values())
        placed_rows: dict[int, FormRow] = {}
        for row in rows:
            cell = row.cell_in(column) if row is not None else None
            place = place_in_order(cell.text.content) if cell is not None else None
            if row is not None and place is not None:
                placed_rows[place] = row
        if not 1 < len(placed_rows) == count:
            return ()
        sentences: list[str] = []
        with self.composer.known.unchanged():
            for place in sorted(placed_rows):
                made = propose_row(placed_rows[place], self.composer)
                if not made.sentences or made.unused:
                    return ()
                sentences += made.sentences
        return (tuple(sentences),)

    def _choices(self, piece: Piece, likeliest: Sequence[Sentences]) -> tuple[Sentences, ...]:
        row = self.script.rows.get(piece.text.first)
        whole, key = piece.text if row is None else naming(row), ("choices", *likeliest)
        return self._once(piece, key, lambda: choices_of(whole, self.composer, likeliest))

    def _once(self, piece: Piece, key: tuple[object, ...], make: Callable[[], _Result]) -> _Result:
        """Return what is made of a piece. It is not made again where all that is known is the same,
        and remained so."""
        composer = self.composer
        known = composer.known.fingerprint()
        if known == self.known:
            known = self.known  # one object for many pieces
        self.known = known
        taken_apart = composer.taken_apart
        left = max(MOST_TAKEN_APART - taken_apart, -1)
        before = self.made.get(whole := (piece.text.first, key, composer.before, left, known))
        if before is not None:
            result: _Result = before[0]
            composer.taken_apart += before[1]
            return result
        result = make()
        if composer.known.fingerprint() == known:
            self.made[whole] = result, composer.taken_apart - taken_apart
        return result

    def _empties_heading(self, i: int) -> bool:
        """Return True for a line below a kind that stands alone: `Gauges` over `none today`."""
        above = self.script.pieces[i - 1].text if i > 0 else None
        return above is not None and {*self.understanding.types(above)} == {"KIND"}

    def _at_time(self, text: ScriptText) -> Proposal | None:
        """Return what is done at a time of day; None if the text names none, or if it is not known
        when the mission starts."""
        said = timed(text, self.understanding) if self.plan is not None else None
        if said is None or self.plan is None:
            return None
        minutes = self.plan.since_start(said)
        found = mentions_in(said.text, self.understanding)
        if said.until and waits(found):
            return Proposal((wait_until(minutes),)) if self._is_here(found) else None
        made = self.composer.propose(said.text)
        sentences = windowed(made.sentences, minutes, said.until)
        return None if sentences is None else replace(made, sentences=sentences, certain=False)

    def _is_here(self, found: Mentions) -> bool:
        """Return True if the places of a text are where the robot has measured last."""
        here = {c.floor for c in self.composer.known.memory.last}
        with suppress(RefusedError):
            places = [self.composer.known.floors(floor_names(place)) for place in found.of("place")]
            return all(here and here <= floors for floors in places)
        return False

    def _is_spared(self, named: Sequence[Mention], text: ScriptText) -> bool:
        """Return True for an item of a list that a line above it leaves out; an order of its own
        contradicts that line."""
        if "MEASURE" in self.understanding.types(text):
            return False
        with suppress(RefusedError):
            ids = {c.id for c in self.composer.known.checkpoints(named)}
            return bool(ids) and ids <= self.composer.known.spared
        return False

    def _is_left_out(self, proposal: Proposal) -> bool:
        """Return True if a proposal only checks what another line leaves out."""
        checks = [sentence for sentence in proposal.sentences if _checks(sentence)]
        named = {int(n) for sentence in checks for n in _NUMBERED.findall(sentence)}
        return (
            bool(named)
            and len(checks) == len(proposal.sentences)
            and named <= self.composer.known.spared
        )

    def _remember(self, named: Sequence[Mention]) -> None:
        for mention in named:
            with suppress(RefusedError):
                self.composer.known.measured(self.composer.known.checkpoints([mention]))


def _is_kind(noun: Noun) -> TypeGuard[AllOf | TheOne]:
    """Return True for `pressure gauges`, without a number."""
    return isinstance(noun, AllOf) or (isinstance(noun, TheOne) and noun.plural)


def _checks(sentence: str) -> bool:
    """Return True for a sentence that measures something."""
    return sentence.startswith("Check ")


def _line(text: ScriptText) -> int:
    return text.source.line_at(text.first)


def _start_area(script: Script) -> int | None:
    header = script.header
    if header.start_area is not None:
        return header.start_area.area
    areas = header.initial_position.areas if header.initial_position is not None else ()
    return areas[0] if len(areas) == 1 else None


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


def _numbered(steps: Sequence[ScriptStep]) -> Iterator[tuple[int, Mention]]:
    """Yield the numbers of steps that measure one noun phrase, with that."""
    for step in steps:
        orders = list(_measures([replace(step, steps=())]))
        if step.number is not None and len(orders) == 1 and len(orders[0].what.nouns) == 1:
            yield step.number, Mention("checkpoints", 0, 0, orders[0].what)


def _measures(steps: Sequence[ScriptStep]) -> Iterator[Measure]:
    for step in steps:
        for sentence in step.sentences:
            if isinstance(sentence, Sentence):
                yield from (order for order in sentence.orders if isinstance(order, Measure))
        yield from _measures(step.steps)
