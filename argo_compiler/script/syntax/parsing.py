"""Script text to syntax tree."""

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.garbage_collector import collector_held
from argo_compiler.script.syntax.asides import Asides
from argo_compiler.script.syntax.cells import Cells
from argo_compiler.script.syntax.fields import HeaderFields
from argo_compiler.script.syntax.grammar import StumbleError
from argo_compiler.script.syntax.healing import MOST_ERRORS, heal
from argo_compiler.script.syntax.hints import not_understood
from argo_compiler.script.syntax.labels import Labels
from argo_compiler.script.syntax.layout import Item, Mark, items_of, lines_of, sentences
from argo_compiler.script.syntax.rows import tables
from argo_compiler.script.syntax.source import Diagnostics, ScriptText, Source
from argo_compiler.script.syntax.tree.facts import Fact
from argo_compiler.script.syntax.tree.orders import Sentence, Start
from argo_compiler.script.syntax.tree.script import Script, Step, Text, Unread
from argo_compiler.script.syntax.understanding import Reading, Understanding
from argo_compiler.script.syntax.words.language import Language

MAX_LINES = 120_000
"""of a script; one with more is refused unread"""

_LONGEST_MENDED = 300
"""characters of a sentence that is mended to see whether it goes on"""
Said = Sentence | Fact | Unread
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
    labels = Labels(understanding, diagnostics)
    fields = HeaderFields(understanding, asides, diagnostics)
    return _Parser(understanding, asides, fields, labels, diagnostics).script()


def _require_size(source: Source) -> None:
    diagnostics = Diagnostics(source)
    if not source.text.strip("\ufeff \t\r\n"):
        hint = "write, say, `Start in starting area 1` and `Check checkpoint #4`"
        diagnostics.error("empty", "the script is empty", None, hint)
    lines = max(source.text.count("\n"), source.text.count("\r")) + 1
    if lines > MAX_LINES:
        message = f"the script has {lines} lines; at most {MAX_LINES} are read"
        diagnostics.error("too-long", message, None, "divide the mission")
    if diagnostics.errors:
        raise DiagnosticError(source.name, diagnostics.entries)


def _vocabulary(understanding: Understanding, text: str) -> frozenset[str]:
    """The words by which cut ones are put together. Those that only edits have are none of
    them, unless the script has them elsewhere: `a⇥d` is `and` rather than `add`."""
    if "\t" not in text:
        return frozenset()
    phrases = understanding.language.lexicon.phrases
    edits = (said for kind in _EDITS for said in phrases.get((kind, None), ()))
    unsaid = {word for said in edits for word in said.split()}
    unsaid -= set(re.findall(r"[\w'-]+", text.lower()))
    for alike in phrases.values():
        # `check points` and `checkpoints` are one: no cut between them leaves a doubt.
        parts = (said.split() for said in alike)
        unsaid.update(p[1] for p in parts if len(p) == 2 and "".join(p) in alike)
    known: frozenset[str] = understanding.known | understanding.language.prose.words
    return understanding.names | (known - unsaid)


@dataclass
class _Parser:
    """Reads one script. Mutable: what a line is depends on those before it."""

    understanding: Understanding
    asides: Asides
    fields: HeaderFields
    labels: Labels
    diagnostics: Diagnostics
    remarks: list[Text] = field(default_factory=list)
    closed: bool = False
    """whether a letter has come to its end"""
    stopped: bool = False
    """whether there are too many errors"""
    ordered: bool = False
    """whether anything is to be done by now but to start"""
    begun: bool = False
    """whether anything but a title has been read"""

    def script(self) -> Script:
        source = self.diagnostics.source
        language = self.understanding.language
        rows = tables(source, self.understanding, self.diagnostics)
        healed = heal(source, _vocabulary(self.understanding, source.text), rows)
        self.diagnostics.extend(healed.diagnostics)
        texts = Cells(self.labels, self.understanding).joined(healed.lines)
        items = items_of(lines_of(texts), self.is_complete, self.stands_alone, language.words)
        steps = list(self._steps(items))
        first = [_step_of(sentence) for sentence in self.fields.first]
        last = [_step_of(sentence) for sentence in self.fields.last]
        return Script(
            source_name=source.name,
            source_text=source.text,
            header=self.fields.header,
            steps=(*first, *steps, *last),
            remarks=tuple(self.remarks),
            diagnostics=self.diagnostics.by_place(),
        )

    def stands_alone(self, text: ScriptText) -> bool:
        """Whether a line never goes on with the one above it."""
        content = text.content
        asides = self.asides
        numbered = content[-1:].isdigit() and asides.is_explicit_title(text)
        alone = numbered or asides.is_remark(content) or asides.opens(content)
        return alone or self.labels.is_field(text)

    def is_complete(self, text: ScriptText) -> bool:
        """Whether a text makes sense by itself."""
        if self.labels.is_field(text):
            return True
        return all(self._fits(sentence) for sentence in sentences(text))

    def _fits(self, sentence: ScriptText) -> bool:
        understanding = self.understanding
        return understanding.fits(sentence) or (
            len(sentence.content) <= _LONGEST_MENDED
            and "WORD" in understanding.types(sentence)
            and understanding.respelled(sentence, quiet=True) is not None
        )

    # ---- lines

    def _steps(self, items: Iterable[Item]) -> Iterator[Step]:
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

    def _step(self, item: Item) -> Step | None:
        text = self._without_letter(item)
        text = self.labels.relabelled(text)
        if self.labels.is_field(text):
            self.begun = True
            text = self.fields.read(text)
        said: list[Said] = []
        remark = False
        for sentence in sentences(text):
            # What stands behind a remark is one as well, unless it makes sense.
            after = remark and not self.understanding.fits(sentence)
            remark = after or self.asides.is_remark(sentence.content)
            if remark:
                self.note(sentence, "a remark")
            else:
                said += self._sentence(sentence, item)
        return self._of(item, said, list(self._steps(item.items)))

    def _of(self, item: Item, said: list[Said], inner: list[Step]) -> Step | None:
        if not said and not inner and item.line.number is None:
            return None
        return Step(
            span=item.text.span(),
            number=item.line.number,
            sentences=tuple(said),
            steps=tuple(inner),
        )

    def _without_letter(self, item: Item) -> ScriptText:
        """The text of an item without what makes a letter of it."""
        text = item.text
        if item.line.mark is not Mark.NONE:
            return text
        greeting = self.asides.greeting(text)
        if greeting:
            self.note(text[:greeting].strip(), "a greeting")
            return text[greeting:].strip()
        if self.asides.closing(text) or (self.closed and self.asides.is_signature(text)):
            self.closed = True
            self.note(text, "the end of a letter")
            return text[:0]
        return text

    def note(self, text: ScriptText, what: str) -> None:
        """Says that a text has no effect."""
        said = text.content if len(text.content) <= 60 else f"{text.content[:57]}..."
        message = f"`{said}` is taken for {what} and has no effect"
        self.diagnostics.note("no-effect", message, text.span())
        self.remarks.append(Text(span=text.span(), text=text.content))

    # ---- sentences

    def _sentence(self, text: ScriptText, item: Item) -> list[Said]:
        text = self.understanding.figures(text)
        if not self.understanding.types(text):
            self.note(text, "a remark")
            return []
        stands_over = item.line.heading or text.content.endswith(":")
        if stands_over and self.fields.introduces(text):
            return []
        if not self.ordered and self.fields.whole_mission(text):
            return []
        reading = self.understanding.read(text)
        if isinstance(reading, StumbleError) or "WORD" in self.understanding.types(text):
            respelled = self.understanding.respelled(text)
            if respelled is not None:
                text, reading = respelled, self.understanding.read(respelled)
                if stands_over and self.fields.introduces(text):
                    return []
        if isinstance(reading, StumbleError):
            cut = self.asides.without(text)
            if cut is not None:
                text, asides = cut
                for aside in asides:
                    self.note(aside, "a remark")
                reading = self.understanding.read(text)
        if isinstance(reading, StumbleError):
            return self._not_understood(text, item, reading)
        joint = self.understanding.unfinished(text)
        if joint is not None:
            message = f"nothing stands behind `{joint.content}`"
            hint = "say what follows, or leave it out"
            self.diagnostics.error("unfinished", message, joint.span(), hint)
        return [self._node(text, reading)]

    def _node(self, text: ScriptText, reading: Reading) -> Said:
        self.begun = True
        for idle in self.asides.idle(text):
            self.diagnostics.note("no-effect", f"`{idle.content}` has no effect", idle.span())
        node = self.understanding.node(text, reading)
        if isinstance(node, Sentence):
            self.ordered |= any(not isinstance(order, Start) for order in node.orders)
        return Unread(span=text.span()) if node is None else node

    def _not_understood(self, text: ScriptText, item: Item, stumble: StumbleError) -> list[Said]:
        """What makes no sense: said of the mission as a whole, a title, small talk or an error."""
        if self.fields.whole_mission(text):
            return []
        free = item.line.mark in (Mark.NONE, Mark.BULLET) and item.line.number is None
        if free and self.fields.leaves_open(text):
            return []
        if free and self.asides.is_small_talk(text):
            self.note(text, "a remark")
            return []
        titled = self._title(text, item)
        if titled is not None:
            return titled
        if not self.labels.is_unknown(text):
            not_understood(text, stumble, self.understanding, self.diagnostics)
        self.begun = True
        return [Unread(span=text.span())]

    def _title(self, text: ScriptText, item: Item) -> list[Said] | None:
        """Takes a text for a title, if it may be one, and reads what stands behind a comma in it:
        `Evening round, at most 40 minutes`. None: it is none."""
        header = self.fields.header
        first = not self.begun and header.title is None and item.line.number is None
        if not first and not self._is_heading(text, item):
            return None
        if self.asides.is_title(text):
            head, behind = text, []
        elif first and "," in text.content:
            head = text[: text.content.index(",")]
            behind = self._behind_title(text[len(head.content) + 1 :].strip())
            if not self.asides.is_title(head) or not behind:
                return None
        else:
            return None
        if first:
            header.title = Text(span=head.span(), text=head.content)
        if not first or not self.asides.is_explicit_title(head):
            self.note(head, "the title" if first else "a heading")
        said: list[Said] = []
        for part in behind:
            reading = self.understanding.read(part)
            if not self.fields.whole_mission(part) and not isinstance(reading, StumbleError):
                said.append(self._node(part, reading))
        return said

    def _behind_title(self, text: ScriptText) -> list[ScriptText]:
        """The parts of what stands behind a title, if all of them make sense."""
        commas = [i for i, sign in enumerate(text.content) if sign == ","]
        ends = [*commas, len(text.content)]
        parts = [
            text[a:b].strip() for a, b in zip([0, *(c + 1 for c in commas)], ends, strict=True)
        ]
        for behind in (parts, [text]):
            if all(self._makes_sense(part) for part in behind):
                return behind
        return []

    def _makes_sense(self, text: ScriptText) -> bool:
        return self.fields.says_whole(text) or self.understanding.fits(text)

    def _is_heading(self, text: ScriptText, item: Item) -> bool:
        """Whether a line stands over others: marked as a heading, or with items of its own."""
        line = item.line
        whole = text.content == item.text.content.rstrip(".!")
        if self.labels.has_value(text):
            return False
        return line.heading or (
            whole and line.number is None and (bool(item.items) or text.content.endswith(":"))
        )


def _step_of(sentence: Sentence) -> Step:
    return Step(span=sentence.span, number=None, sentences=(sentence,))
