"""Script text to syntax tree."""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.documents.healing import MOST_ERRORS, heal
from argo_compiler.script.documents.source import Diagnostics, ScriptText, Source
from argo_compiler.script.layout.asides import Asides
from argo_compiler.script.layout.cells import Cells
from argo_compiler.script.layout.fields import ScriptFields
from argo_compiler.script.layout.items import LineItem, LineSense, items_of
from argo_compiler.script.layout.lines import LineMark, lines_of, sentences
from argo_compiler.script.layout.lists import Lists, on_floors
from argo_compiler.script.layout.rows import tables
from argo_compiler.script.parsing.repeats import Repeats, repeats
from argo_compiler.script.parsing.sentence_reading import SentenceReader
from argo_compiler.script.sentences.doubts import PlacingCheck, ask_of_dots
from argo_compiler.script.sentences.tree.nouns import Labelled
from argo_compiler.script.sentences.tree.orders import Measure, Sentence, Start
from argo_compiler.script.sentences.tree.script import Said, Script, ScriptStep, Unread
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexicon import Lexicon
from argo_compiler.script.sentences.words.unknown import UnknownError, UnknownFigure

MAX_LINES = 120_000
"""of a script; one with more is refused unread"""

_EDITS = ("ADD", "DELETE", "REPLACE", "MOVE")


@collector_held()
def parse(
    text: str,
    places: Collection[str] = (),
    source_name: str = "script",
    names: Collection[str] = (),
) -> Script:
    """The syntax tree of the script, with all that was found on the way in its `diagnostics`.

    `places` and `names` are those of the site's places and checkpoints. Raises DiagnosticError for
    what is no script at all.
    """
    source = Source(text, source_name)
    _require_size(source)
    diagnostics = Diagnostics(source)
    language = Language.of(text, places)
    words = frozenset(word for name in (*names, *places) for word in name.lower().split())
    understanding = Understanding(language, words, diagnostics)
    asides = Asides(understanding)
    fields = ScriptFields(understanding, diagnostics)
    reader = SentenceReader(understanding, asides, fields, diagnostics)
    known = repeats(language.lexicon, words)
    return _Parser(understanding, asides, fields, diagnostics, reader, known).script()


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

    def script(self) -> Script:
        source = self.diagnostics.source
        language = self.understanding.language
        rows = tables(source, self.understanding, self.diagnostics)
        healed = heal(source, _vocabulary(self.understanding, source.text), rows)
        self.diagnostics.extend(healed.diagnostics)
        texts = Cells(self.fields, self.understanding).joined(healed.lines)
        sense = LineSense(self.understanding, self.asides, self.fields)
        items = items_of(lines_of(texts), sense, language.words)
        lists = Lists(self.understanding, self.reader.note)
        steps = list(self._steps(lists.told(items)))
        PlacingCheck(self.diagnostics).steps(steps)
        _ask_of_title(steps, self.diagnostics)
        _ask_of_quotes(steps, self.diagnostics)
        first = [_step_of(sentence) for sentence in self.fields.first]
        last = [_step_of(sentence) for sentence in self.fields.last]
        return Script(
            source_name=source.name,
            source_text=source.text,
            header=self.fields.header,
            steps=(*first, *steps, *last),
            diagnostics=self.diagnostics.by_place(),
        )

    # ---- lines

    def _steps(self, items: Iterable[LineItem]) -> Iterator[ScriptStep]:
        for item in items:
            if self.stopped:
                return
            if self.diagnostics.errors > MOST_ERRORS:
                self.stopped = True
                message = f"more than {MOST_ERRORS} errors; the rest is not read"
                hint = "correct these first"
                self.diagnostics.error("too-many-errors", message, item.text.span(0, 1), hint)
                return
            step = self._step(item)
            if step is not None:
                yield step

    def _step(self, item: LineItem) -> ScriptStep | None:
        known = self.repeats.said(item.text) if self._is_plain(item) else None
        said = on_floors(self._said(item) if known is None else known, item.floors)
        inner = tuple(self._steps(item.items))
        if not said and not inner and item.line.number is None:
            return None
        return ScriptStep(
            span=item.text.span(), number=item.line.number, sentences=tuple(said), steps=inner
        )

    def _said(self, item: LineItem) -> list[Said]:
        """What an item says; kept, if it says so wherever it stands."""
        before = len(self.diagnostics.entries)
        plain = self._is_plain(item)  # now: what is said first hangs on being first
        text = self._without_letter(item)
        text = self.fields.relabelled(text)
        if self.fields.is_field(text):
            self.reader.begun = True
            text = self.fields.read(text)
        said: list[Said] = []
        remark = False
        parts = sentences(text)
        if not self.asides.is_remark(text.content):
            ask_of_dots(text, self.diagnostics)
        for sentence in parts:
            # What stands behind a remark is one as well, unless it makes sense.
            after = remark and not self.understanding.fits(sentence)
            remark = after or self.asides.is_remark(sentence.content)
            if remark:
                said += self.reader.remark(sentence)
                continue
            if self.fields.is_field(sentence):
                sentence = self.fields.read(sentence)
            if sentence.content:
                said += self.reader.read(sentence, item)
        whole = text is item.text and not self.fields.is_field(text)
        whole = whole and len(said) == len(parts) and len(self.diagnostics.entries) == before
        plain = plain and whole and not self.understanding.unknown and self._is_plain(item)
        if plain and not any(isinstance(s, Unread) for s in said):
            self.repeats.keep(text, said, lambda text, unknown: self._again(item, text, unknown))
        return said

    def _again(
        self, item: LineItem, text: ScriptText, unknown: Mapping[int, UnknownFigure]
    ) -> list[Said] | None:
        """What a plain item says with another text, in which some figures are not known; None if
        that hangs on them."""
        before, errors = len(self.diagnostics.entries), self.diagnostics.errors
        self.understanding.unknown = unknown
        try:
            said = self._said(replace(item, text=text))
        except UnknownError:
            return None
        finally:
            self.understanding.unknown = {}
            found = self.diagnostics.entries[before:]
            del self.diagnostics.entries[before:]
            self.diagnostics.errors = errors
        return None if found else said

    def _is_plain(self, item: LineItem) -> bool:
        """Whether what an item says follows from its text alone."""
        over = item.line.heading or item.text.content.endswith(":")
        return self.reader.ordered and not self.closed and not over

    def _without_letter(self, item: LineItem) -> ScriptText:
        """The text of an item without what makes a letter of it."""
        text = item.text
        signed = self.closed and item.line.mark in (LineMark.NONE, LineMark.LETTER)  # `T. Kunz`
        if signed and self.asides.is_signature(text):
            self.reader.note(text, "the end of a letter")
            return text[:0]
        if item.line.mark is not LineMark.NONE:
            return text
        greeting = self.asides.greeting(text)
        if greeting:
            self.reader.note(text[:greeting].strip(), "a greeting")
            return text[greeting:].strip()
        if self.asides.closing(text):
            self.closed = True
            self.reader.note(text, "the end of a letter")
            return text[:0]
        return text


def _step_of(sentence: Sentence) -> ScriptStep:
    return ScriptStep(span=sentence.span, number=None, sentences=(sentence,))


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
    return plain and len(order.what.nouns) == 1 and order.manner is None


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
