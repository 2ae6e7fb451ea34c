"""Script text to syntax tree."""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import chain, groupby, pairwise
from types import MappingProxyType

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.documents.document import Document
from argo_compiler.script.documents.healing import MOST_ERRORS, heal
from argo_compiler.script.documents.source import Diagnostics, ScriptText, Source
from argo_compiler.script.layout.asides import Asides
from argo_compiler.script.layout.cells import Cells
from argo_compiler.script.layout.fields import Field, ScriptFields
from argo_compiler.script.layout.forms import ROW, FormRow, forms
from argo_compiler.script.layout.glossary import Tags, explain
from argo_compiler.script.layout.items import LineItem, LineSense, items_of
from argo_compiler.script.layout.lines import (
    LineMark,
    ScriptLine,
    lines_of,
    sentences,
    stamped,
    unmarked,
)
from argo_compiler.script.layout.lists import Lists, on_floors
from argo_compiler.script.layout.rows import COLUMN_HEADINGS, tables
from argo_compiler.script.parsing.repeats import Repeats, repeats
from argo_compiler.script.parsing.script import Piece, Script
from argo_compiler.script.parsing.sentence_reading import SentenceReader
from argo_compiler.script.sentences.doubts import (
    PlacingCheck,
    ask_of_dots,
    asks_for_work,
    returns_at_end,
)
from argo_compiler.script.sentences.tree.nouns import Labelled
from argo_compiler.script.sentences.tree.orders import Measure, Sentence, Start
from argo_compiler.script.sentences.tree.script import Said, ScriptStep, Unread
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexicon import Lexicon, expand
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.unknown import UnknownError, UnknownValue

MAX_LINES = 120_000
"""of a script; one with more is refused unread"""

BY_HAND = "set aside by a person"
_ANSWERS = 2
"""different letters before the lines of a list, `(y)` and `(n)`, that are no items"""
_DITTO = re.compile(r"\s*(?:[\"”„″〃]|''|-\s*[\"”″]\s*-)(?=\s|[:;|,]|$)")
"""a line, or its first cell, that repeats what is above"""
_QUOTES = re.compile(r'[^\s:;|,]"|"[^\s:;|,]')
"""a quotation mark beside a word"""
_EDITS = ("ADD", "DELETE", "REPLACE", "MOVE")


@collector_held()
def parse(
    text: str | Document,
    places: Collection[str] = (),
    source_name: str = "script",
    names: Collection[str] = (),
    decided: Mapping[int, Sequence[str]] = MappingProxyType({}),
    tags: Tags = MappingProxyType({}),
) -> Script:
    """The syntax tree of the script, with all that was found on the way in its `diagnostics`.

    `places` and `names` are those of the site's places and checkpoints. `decided` has the sentences
    that a person has decided on for pieces of the script, none for one that is set aside; its keys
    are the offsets at which these pieces begin in the text. `tags` are the site's plant tags, with
    the checkpoints that have them. Raises DiagnosticError for what is no
    script at all.
    """
    source = replace(Source.of(text, source_name), decided=decided)
    _require_size(source)
    diagnostics = Diagnostics(source)
    language = Language.of(source.text, places)
    words = frozenset(word for name in (*names, *places) for word in name.lower().split())
    understanding = Understanding(language, words, diagnostics)
    explained = explain(source, understanding, tags, diagnostics)
    asides = Asides(understanding)
    fields = ScriptFields(understanding, diagnostics)
    reader = SentenceReader(understanding, asides, fields, diagnostics)
    known = repeats(language.lexicon, words)
    parser = _Parser(understanding, asides, fields, diagnostics, reader, known, decided=decided)
    parser.pieces += (Piece(text, aside) for text, aside in explained.explanations)
    return parser.script(explained.source)


def _require_size(source: Source) -> None:
    diagnostics = Diagnostics(source)
    if not source.text.strip("\ufeff \t\r\n"):
        hint = "write, for example, `Start in starting area 1` and `Check checkpoint #4`"
        diagnostics.error("empty", "the script is empty", None, hint)
    lines = max(source.text.count("\n"), source.text.count("\r")) + 1
    if lines > MAX_LINES:
        message = f"the script has {lines} lines; at most {MAX_LINES} are read"
        diagnostics.error("too-long", message, None, "split the mission into several scripts")
    if diagnostics.errors:
        raise DiagnosticError(source.name, diagnostics.entries)


def _vocabulary(understanding: Understanding, text: str) -> frozenset[str]:
    """The words by which cut ones are put together. Those that only edits have are none of
    them, unless the script has them elsewhere: `a⇥d` is `and` rather than `add`."""
    if "\t" not in text:
        return frozenset()
    language = understanding.language
    edits, halves = _unsaid(language.lexicon)
    unsaid = (edits - set(re.findall(r"[\w'-]+", text.lower()))) | halves
    known: frozenset[str] = understanding.known | language.prose.words
    return understanding.names | (known - unsaid)


@lru_cache(maxsize=8)
def _unsaid(lexicon: Lexicon) -> tuple[frozenset[str], frozenset[str]]:
    """The words of edits, and the second halves of words that are written as one as well:
    `check points` and `checkpoints` are one, so that no cut between them leaves a doubt."""
    phrases = lexicon.phrases
    edits = (said for kind in _EDITS for said in phrases.get((kind, None), ()))
    pairs = ((said.split(), alike) for alike in phrases.values() for said in alike)
    halves = (p[1] for p, alike in pairs if len(p) == 2 and "".join(p) in alike)
    return frozenset(word for said in edits for word in said.split()), frozenset(halves)


@dataclass
class _Parser:
    """Reads one script. Mutable: what a line is depends on those before it."""

    understanding: Understanding
    asides: Asides
    fields: ScriptFields
    diagnostics: Diagnostics
    reader: SentenceReader
    repeats: Repeats
    closed: bool = False
    """whether a letter has come to its end"""
    stopped: bool = False
    """whether there are too many errors"""
    decided: Mapping[int, Sequence[str]] = field(default_factory=dict)
    """sentences that a person has decided on for pieces, none for one that is set aside; by the
    offset in the source at which a piece begins"""
    pieces: list[Piece] = field(default_factory=list)
    forms: Mapping[int, FormRow] = field(default_factory=dict)
    """the rows of sheets, by the numbers of their lines"""

    def script(self, source: Source) -> Script:
        """Return the tree of a script, whose short forms are replaced."""
        language = self.understanding.language
        asides = self._asides_of_document()
        found = tables(source, self.understanding, self.diagnostics)
        self.pieces += [Piece(text, COLUMN_HEADINGS) for text in found.headings]
        taken = {**found.rows, **asides}
        sheet = forms(source, taken, language.prose, self._is_plain_line)
        self.forms = sheet.rows
        rows = {number: _as_row(source.line_text(number)) for number in self.forms}
        words = _vocabulary(self.understanding, source.text)
        read = {**stamped(source, self._not_names()), **taken, **sheet.texts, **rows}
        healed = heal(source, words, read)
        unreadable = (source.line_text(number).strip() for number in healed.unreadable)
        self.pieces += [Piece(text) for text in unreadable]
        self.diagnostics.extend(healed.diagnostics)
        texts = Cells(self.fields, self.understanding).joined(
            healed.lines, {*source.unclear, *read}
        )
        width = max(map(len, source.lines))
        sense = LineSense(self.understanding, self.asides, self.fields, width)
        lines = list(lines_of(texts))
        _ask_of_marks(lines, language.lexicon, self.diagnostics)
        _ask_of_ditto(source, self.diagnostics)
        items = items_of(lines, sense, language.words)
        lists = Lists(self.understanding, self._record)
        steps = list(self._steps(lists.told(items)))
        steps, at_end = _with_end_apart(steps)
        PlacingCheck(self.diagnostics).steps(steps)
        _ask_of_title(steps, self.diagnostics)
        refers = phrase_pattern(language.prose.cues["referring"])
        if ">" in source.text and not any(
            refers.search(line) for line in source.lines if not line.lstrip().startswith(">")
        ):
            _ask_of_quotes(steps, self.diagnostics)
        first = [_step_of(sentence) for sentence in self.fields.first]
        last = [_step_of(sentence) for sentence in (*at_end, *self.fields.last)]
        return Script(
            source=source,
            header=self.fields.header,
            steps=(*first, *steps, *last),
            pieces=tuple(sorted(self.pieces, key=lambda piece: piece.text.first)),
            rows={row.place.first: row for row in self.forms.values()},
            diagnostics=self.diagnostics.by_place(),
        )

    # ---- lines

    def _not_names(self) -> frozenset[str]:
        """Return words that are no names of speakers: those of sentences, fields and sheets."""
        prose = self.understanding.language.prose
        labels = (*prose.roles.values(), prose.form["labels"], *prose.labels.values(), prose.remark)
        return self.understanding.known | {word for text in labels for word in expand(text)}

    def _asides_of_document(self) -> dict[int, ScriptText]:
        """Record the lines of a document that its reader tells to have no effect; return what is
        read instead of them, by their numbers."""
        source = self.diagnostics.source
        lines = () if source.document is None else source.document.lines
        found: dict[int, ScriptText] = {}
        for number, line in enumerate(lines, start=1):
            if line.aside and line.text.strip():
                text = source.line_text(number)
                self.pieces.append(Piece(text.strip(), line.aside))
                message = f"`{text.content.strip()}` is set aside: it is {line.aside}"
                self.diagnostics.warning("set-aside", message, text.span())
                found[number] = text[:0]
        return found

    def _steps(self, items: Iterable[LineItem]) -> Iterator[ScriptStep]:
        for item, below in pairwise(chain(items, (None,))):
            if item is None or self.stopped:
                return
            if self.diagnostics.errors > MOST_ERRORS:
                self.stopped = True
                message = f"more than {MOST_ERRORS} errors; the rest is not read"
                hint = "correct these first"
                self.diagnostics.error("too-many-errors", message, item.text.span(0, 1), hint)
                return
            step = self._step(item, self._stands_over_names(item, below))
            if step is not None:
                yield step

    def _stands_over_names(self, item: LineItem, below: LineItem | None) -> bool:
        """Return True if an item ends with `Floor 2 valves` or `Check the valves on floor 2:` over
        what may name some of these."""
        first = item.items[0] if item.items else below
        content = item.text.content
        step = item.line.mark is not LineMark.NONE and not content.endswith(":")
        if first is None or step or self._is_decided(item):
            return False
        marked = first.line.mark is not LineMark.NONE
        if not marked and content.endswith("."):
            return False  # a sentence, and not a heading
        last = sentences(item.text)[-1:]
        if not last or not self.asides.only_lists_kinds(last[0]):
            return False
        bare = marked and not self.asides.has_verb(last[0])
        return bare or self.asides.only_names(first.text)

    def _over_names(self, text: ScriptText, item: LineItem) -> list[Said]:
        """Read kinds over names: a heading if a colon is behind them, else they can be both."""
        if item.text.content.endswith(":"):
            self._record(text, "a heading")
            return []
        said = self._piece(text, item, lambda s: self.reader.read(s, item))
        if said and item.line.mark is LineMark.NONE:
            message = "this line can be a heading of those below it, or a command"
            hint = "write a mark such as `-` before it for a command, a colon behind it for a "
            hint += "heading"
            self.diagnostics.error("ambiguous-title", message, text.span(), hint)
        return said

    def _step(self, item: LineItem, over: bool) -> ScriptStep | None:
        """Read an item. `over`: it stands over names of what it says."""
        known = self.repeats.said(item.text) if self._is_plain(item) and not over else None
        if known is not None and self._is_said_below(item, known[0]):
            said, parts = known
            self.pieces += map(Piece, parts)
        else:
            said = self._said(item, over)
        said = on_floors(said, item.floors)
        inner = tuple(self._steps(item.items)) if item.items else ()
        if not said and not inner and item.line.number is None:
            return None
        return ScriptStep(
            span=item.text.span(), number=item.line.number, sentences=tuple(said), steps=inner
        )

    def _said(self, item: LineItem, over: bool = False) -> list[Said]:
        """What an item says; kept, if it says so wherever it stands."""
        if item.text.content == ROW:
            return self._row(item)
        before, read = len(self.diagnostics.entries), self.fields.count
        plain = self._is_plain(item)  # now: what is said first hangs on being first
        said, text = self._without_letter(item)
        text = self.fields.relabelled(text)
        fields, text = self._fields(text, item)
        said += fields
        remark = False
        parts = sentences(text)
        if not self._is_decided(item) and not self.asides.is_remark(text.content):
            ask_of_dots(text, self.diagnostics)
        for sentence in parts:
            # What stands behind a remark is one as well, unless it makes sense.
            after = remark and not self.understanding.fits(sentence)
            remark = after or self.asides.is_remark(sentence.content)
            if remark:
                said += self._piece(sentence, item, self.reader.remark)
                continue
            fields, sentence = self._fields(sentence, item)
            said += fields
            if over and sentence.last == parts[-1].last:
                said += self._over_names(sentence, item)
            elif sentence.content:
                said += self._piece(sentence, item, lambda s: self.reader.read(s, item))
        whole = text is item.text and len(said) == len(parts)
        whole = whole and len(self.diagnostics.entries) == before
        plain = plain and whole and not self.understanding.unknown and self._is_plain(item)
        plain = plain and self.fields.count == read  # else it says more than its orders
        plain = plain and not over and self._is_said_below(item, said)
        # What a number alone is hangs on the lines around it.
        plain = plain and not any(self.understanding.types(p) == ("NUMBER",) for p in parts)
        if plain and not any(isinstance(s, Unread) for s in said):
            self.repeats.keep(text, said, lambda text, unknown: self._again(item, text, unknown))
        return said

    def _is_plain_line(self, line: ScriptText) -> bool:
        """Return True if a line can be read without columns: as sentences or as a field."""
        text = unmarked(line)
        if self.fields.is_field(text):
            return True
        return bool(text.content) and all(map(self.understanding.fits, sentences(text)))

    def _row(self, item: LineItem) -> list[Said]:
        """Read a row of a sheet: only what is decided on for it, as it is no sentence."""
        row = self.forms[item.text.source.line_at(item.text.first)]

        def ask(text: ScriptText) -> list[Said]:
            message = "it is not decided what this row asks for"
            self.diagnostics.error("row", message, text.span(), "say it as a sentence")
            return [Unread(span=text.span())]

        return self._piece(row.place, item, ask)

    def _piece(
        self, text: ScriptText, item: LineItem, read: Callable[[ScriptText], list[Said]]
    ) -> list[Said]:
        """Read a piece of the script, or the sentences that a person has decided on for it."""
        own = _own_part(text, item)
        decided = self.decided.get(own.first) if self.decided else None
        if decided is not None:
            self.reader.begun = True  # what is decided on is no title, and none comes behind it
            self.pieces.append(Piece(own, "" if decided else BY_HAND))
            return [said for sentence in decided for said in self._decided(sentence, own)]
        self.reader.noted = None
        said = read(text)
        aside = ""
        if not said and self.reader.noted is not None:
            noted, what = self.reader.noted
            whole = (noted.first, noted.last) == (text.first, text.last)
            aside = what if whole else ""
        self.pieces.append(Piece(own, aside))
        return said

    def _record(self, text: ScriptText, aside: str) -> None:
        """Record a piece that is no step."""
        self.pieces.append(Piece(text, aside))
        if aside:
            self.reader.note(text, aside)

    def _decided(self, sentence: str, place: ScriptText) -> list[Said]:
        """Read a sentence that stands for a piece of the script."""
        text = self.fields.read_all(place.replaced(sentence))
        parts = (self.fields.read_all(part) for part in sentences(text))
        return [s for part in parts if part.content for s in self.reader.read_decided(part)]

    def _fields(self, text: ScriptText, item: LineItem) -> tuple[list[Said], ScriptText]:
        """Read the fields that a text begins with; return what is decided on for them instead, and
        the rest of the text."""
        said: list[Said] = []
        while (field := self.fields.next(text)) is not None:
            self.reader.begun = True
            end = len(text.content) - len(field.rest.content)
            said += self._piece(text[:end].strip(), item, _reader_of(self.fields, field))
            text = field.rest
            if field.name == "steps":
                break
        return said, text

    def _again(
        self, item: LineItem, text: ScriptText, unknown: Mapping[int, UnknownValue]
    ) -> list[Said] | None:
        """What a plain item says with another text, in which some figures are not known; None if
        that hangs on them."""
        before, errors = len(self.diagnostics.entries), self.diagnostics.errors
        pieces = len(self.pieces)
        self.understanding.unknown = unknown
        try:
            said = self._said(replace(item, text=text))
        except UnknownError:
            return None
        finally:
            self.understanding.unknown = {}
            del self.pieces[pieces:]
            found = self.diagnostics.entries[before:]
            del self.diagnostics.entries[before:]
            self.diagnostics.errors = errors
        return None if found else said

    def _is_plain(self, item: LineItem) -> bool:
        """Whether what an item says follows from its text alone."""
        plain = self.reader.ordered and not self.closed and not item.text.content.endswith(":")
        return plain and not self._is_decided(item)

    def _is_decided(self, item: LineItem) -> bool:
        """Return True if a person has decided on a piece of an item."""
        return bool(self.decided) and any(o in self.decided for o in item.text.offsets)

    def _is_said_below(self, item: LineItem, said: Sequence[Said]) -> bool:
        """Return True if an item stands over no others, or consists of conditions for these."""
        return not item.line.heading or all(isinstance(one, Sentence) and one.cases for one in said)

    def _without_letter(self, item: LineItem) -> tuple[list[Said], ScriptText]:
        """Read what makes a letter of an item; return what is decided on for it instead, and the
        rest of the text."""
        text = item.text
        signed = self.closed and item.line.mark in (LineMark.NONE, LineMark.LETTER)  # `T. Kunz`
        if signed and self.asides.is_signature(text):
            return self._aside(text, item, "the end of a letter"), text[:0]
        if item.line.mark is not LineMark.NONE:
            return [], text
        greeting = self.asides.greeting(text)
        if greeting:
            said = self._aside(text[:greeting].strip(), item, "a greeting")
            return said, text[greeting:].strip()
        if self.asides.closing(text):
            self.closed = True
            return self._aside(text, item, "the end of a letter"), text[:0]
        return [], text

    def _aside(self, text: ScriptText, item: LineItem, what: str) -> list[Said]:
        """Note that a piece has no effect."""

        def note(text: ScriptText) -> list[Said]:
            self.reader.note(text, what)
            return []

        return self._piece(text, item, note)


def _as_row(line: ScriptText) -> ScriptText:
    """Return the text that stands for a row of a sheet among the lines."""
    return line.strip().replaced(f"- {ROW}")


def _own_part(text: ScriptText, item: LineItem) -> ScriptText:
    """Return the part of a text that stands in the item's own lines."""
    if item.own is None:
        return text
    first, last = item.own.first, item.own.last
    inside = [i for i, offset in enumerate(text.offsets) if first <= offset <= last]
    return text[inside[0] : inside[-1] + 1] if inside else text


def _reader_of(fields: ScriptFields, field: Field) -> Callable[[ScriptText], list[Said]]:
    def read(_: ScriptText) -> list[Said]:
        fields.read(field)
        return []

    return read


def _step_of(sentence: Sentence) -> ScriptStep:
    return ScriptStep(span=sentence.span, number=None, sentences=(sentence,))


def _with_end_apart(steps: Sequence[ScriptStep]) -> tuple[list[ScriptStep], list[Sentence]]:
    """Return the steps without those sentences above all tasks that let the mission end docked, and
    those sentences: `At the end, return to the docking station.`"""
    found = list(steps)
    ends: list[Sentence] = []
    for i, step in enumerate(steps):
        apart = [one for one in step.sentences if returns_at_end(one)]
        others = tuple(one for one in step.sentences if one not in apart)
        if step.steps or any(map(asks_for_work, others)):
            return found, ends
        found[i] = replace(step, sentences=others)
        ends += apart
    return list(steps), []


def _ask_of_title(steps: Sequence[ScriptStep], diagnostics: Diagnostics) -> None:
    """Asks about a line over numbered steps that orders to measure a bare number: `Test 12`."""
    if len(steps) < 2 or steps[0].number is not None or steps[1].number != 1:
        return
    first = steps[0]
    for sentence in first.sentences:
        orders = sentence.orders if isinstance(sentence, Sentence) and not sentence.cases else ()
        if len(orders) == 1 and isinstance(orders[0], Measure) and _is_bare_number(orders[0]):
            message = "this line above the steps can be their title, or a command"
            hint = "write `Designation: ...` for the first, a numbered step for the second"
            diagnostics.error("ambiguous-title", message, first.span, hint)
            return


def _is_bare_number(order: Measure) -> bool:
    noun = order.what.nouns[0]
    plain = isinstance(noun, Labelled) and noun.kind is None and not noun.hash
    return plain and len(order.what.nouns) == 1 and not order.manner


def _ask_of_marks(lines: Sequence[ScriptLine], lexicon: Lexicon, diagnostics: Diagnostics) -> None:
    """Ask about lines whose letters or ordinals, `c)` or `Third:`, give another order than that in
    which they stand; steps with numbers are compared later."""
    values = {kind[1]: phrases for kind, phrases in lexicon.phrases.items() if kind[0] == "ORDINAL"}
    ordinals = {phrase: int(n) for n, phrases in values.items() for phrase in phrases}

    def rank(line: ScriptLine) -> int | None:
        head, colon, _ = line.text.content.partition(":")
        ordinal = ordinals.get(head.strip().lower()) if colon else None
        return ordinal or line.rank

    for ranked, run in groupby(lines, key=lambda line: (rank(line) is not None, line.indent)):
        same = list(run)
        ranks = [n for n in map(rank, same) if n is not None]
        if ranked[0] and len({*ranks}) < len(ranks) and len({*ranks}) <= _ANSWERS:
            message = "the marks before the lines can say which of them are meant"
            hint = "leave out the lines that are not meant, and the marks"
            diagnostics.error("ambiguous-step", message, same[0].text.span(), hint)
        if ranked[0] and ranks != sorted(ranks) and sorted(ranks) == list(range(1, len(ranks) + 1)):
            message = "the lines can be meant in the order of their marks, or as they are written"
            hint = "write them in the order in which they are done"
            diagnostics.error("ambiguous-step", message, same[0].text.span(), hint)


def _ask_of_quotes(steps: Sequence[ScriptStep], diagnostics: Diagnostics) -> None:
    """Ask which orders count, where some are lines of a letter that is answered, `> Check #1`, and
    others are not."""
    lines = diagnostics.source.lines
    first: dict[bool, Sentence] = {}  # that is quoted, and that is not
    for sentence in _ordered(steps):
        first.setdefault(lines[sentence.span.line - 1].lstrip().startswith(">"), sentence)
    if len(first) < 2:
        return
    line = first[False].span.line
    message = f"this is quoted, but line {line} is not: it can be a task as well, or part "
    message += "of another script"
    hint = "remove the lines that are not meant, and `>` in front of the others"
    diagnostics.error("ambiguous-quote", message, first[True].span, hint)


def _ordered(steps: Sequence[ScriptStep]) -> Iterator[Sentence]:
    """The sentences with orders other than to start."""
    for step in steps:
        for sentence in step.sentences:
            if isinstance(sentence, Sentence) and any(
                not isinstance(order, Start) for order in sentence.orders
            ):
                yield sentence
        yield from _ordered(step.steps)


def _ask_of_ditto(source: Source, diagnostics: Diagnostics) -> None:
    """Ask about lines that begin with a sign for the same as above."""
    for number, line in enumerate(source.lines, start=1):
        if number > 1 and _DITTO.match(line) and not _QUOTES.search(line):
            message = "the sign at the beginning can repeat what stands above"
            hint = "write out what it repeats"
            span = source.line_text(number).strip().span()
            diagnostics.error("not-understood", message, span, hint)
