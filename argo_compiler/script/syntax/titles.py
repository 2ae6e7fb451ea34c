"""Titles and headings, with what stands behind them: `Evening round, at most 40 minutes`."""

from collections.abc import Sequence
from dataclasses import dataclass

from argo_compiler.script.syntax.asides import Asides
from argo_compiler.script.syntax.fields import ScriptFields
from argo_compiler.script.syntax.labels import FieldLabels
from argo_compiler.script.syntax.layout import LineItem
from argo_compiler.script.syntax.preamble import Preamble
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.tree.nouns import Labelled
from argo_compiler.script.syntax.tree.orders import Measure, Sentence
from argo_compiler.script.syntax.tree.script import ScriptStep
from argo_compiler.script.syntax.understanding import Understanding


@dataclass(frozen=True)
class FoundTitle:
    """A title, and what stands behind it in the same line."""

    head: ScriptText
    fields: ScriptText | None = None
    parts: tuple[ScriptText, ...] = ()
    """what makes sense behind a comma"""


@dataclass(frozen=True)
class Titles:
    """Tells titles of a script and headings in it from what is not understood."""

    understanding: Understanding
    asides: Asides
    fields: ScriptFields
    labels: FieldLabels
    preamble: Preamble

    def found(self, text: ScriptText, item: LineItem, first: bool) -> FoundTitle | None:
        """The title that a text may be. `first`: nothing but it has been read, and it is no
        step."""
        if not first and not self._is_heading(text, item):
            return None
        titled = self.fields.behind(text) if first else None
        if titled is not None and self.asides.is_title(titled[0]):
            return FoundTitle(titled[0], fields=titled[1])
        alone = text.content == item.text.content
        over = first and alone and item.line.heading and self.asides.stands_for_title(text)
        if over or self.asides.is_title(text):
            return FoundTitle(text)
        if not first or "," not in text.content:
            return None
        head = text[: text.content.index(",")]
        parts = self._behind(text[len(head.content) + 1 :].strip())
        return FoundTitle(head, parts=parts) if self.asides.is_title(head) and parts else None

    def _behind(self, text: ScriptText) -> tuple[ScriptText, ...]:
        """The parts of what stands behind a title, if all of them make sense."""
        commas = [i for i, sign in enumerate(text.content) if sign == ","]
        ends = [*commas, len(text.content)]
        starts = [0, *(comma + 1 for comma in commas)]
        parts = tuple(text[a:b].strip() for a, b in zip(starts, ends, strict=True))
        sensible = (p for p in (parts, (text,)) if all(self._makes_sense(part) for part in p))
        return next(sensible, ())

    def _makes_sense(self, text: ScriptText) -> bool:
        return self.preamble.says_whole(text) or self.understanding.fits(text)

    def _is_heading(self, text: ScriptText, item: LineItem) -> bool:
        """Whether a line stands over others: marked as a heading, or with items of its own."""
        line = item.line
        if self.labels.has_value(text):
            return False
        whole = text.content == item.text.content.rstrip(".!")
        above = bool(item.items) or text.content.endswith(":")
        return line.heading or (whole and line.number is None and above)


def ask_of_title(steps: Sequence[ScriptStep], diagnostics: Diagnostics) -> None:
    """Asks about a line over numbered steps that orders to measure a bare number: `Test 12`."""
    if len(steps) < 2 or steps[0].number is not None or steps[1].number != 1:
        return
    first = steps[0]
    for sentence in first.sentences:
        orders = sentence.orders if isinstance(sentence, Sentence) and not sentence.cases else ()
        if len(orders) == 1 and isinstance(orders[0], Measure) and _is_bare_number(orders[0]):
            message = "this line over the steps may be their title, or an order"
            hint = "write `Designation: ...` for the first, a numbered step for the second"
            diagnostics.error("ambiguous-title", message, first.span, hint)
            return


def _is_bare_number(order: Measure) -> bool:
    noun = order.what.nouns[0]
    plain = isinstance(noun, Labelled) and noun.kind is None and not noun.hash
    return plain and len(order.what.nouns) == 1 and order.manner is None
