"""Lists under what their items are: `Check these pressure gauges:`, then `- 1` and `- 3`."""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache

from argo_compiler.script.syntax.layout import LineItem
from argo_compiler.script.syntax.lines import LineMark
from argo_compiler.script.syntax.sentence_ends import sentences
from argo_compiler.script.syntax.text.source import ScriptText, join
from argo_compiler.script.syntax.understanding import Understanding
from argo_compiler.script.syntax.words.prose import either

_HEADS = ((), ("MEASURE",), ("ALL",), ("MEASURE", "ALL"))
"""what may stand before the kind in the sentence over a list"""
_LABELS = frozenset(["NUMBER", "IDENT", "HASH"])
_ENDS = frozenset("0123456789.!?…")
"""signs, none of which ends the sentence over a list; most lines end with one of them"""
_LONGEST_HEAD = 80
"""characters"""


@dataclass(frozen=True, slots=True)
class _Head:
    """The sentence over a list."""

    text: ScriptText
    said: ScriptText
    """what it says of each item: `Check pressure gauges`"""
    listing: bool
    """whether it says that a list follows"""


@dataclass(frozen=True)
class KindLists:
    """Puts the sentence over a list of bare numbers and identifiers before each of them."""

    understanding: Understanding
    note: Callable[[ScriptText, str], None]
    """says that a text has no effect"""

    def told(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items; those of such a list say themselves what they are."""
        over: LineItem | None = None
        head: _Head | None = None
        for item in items:
            if head is not None and self._is_label(item.text):
                over = self._without(over, head)
                item.text = join([head.said, item.text])
            elif head is not None and head.listing and item.line.mark is not LineMark.NONE:
                if over is not None:
                    self.note(head.text, "a heading")
                over = self._without(over, head)
            else:
                head = None
            if over is not None:
                yield over
                over = None
            if head is None:
                head = self._head(item.text)
                if head is not None and item.items and self._is_label(item.items[0].text):
                    self._put_before(head, item)
                    head = None
                elif head is not None:
                    over = item
                    continue
            yield item
        if over is not None:
            yield over

    def _without(self, item: LineItem | None, head: _Head) -> LineItem | None:
        """An item without the sentence at its end; None if nothing is left."""
        if item is None:
            return None
        item.text = item.text[: len(item.text.content) - len(head.text.content)].strip()
        return item if item.text.content else None

    def _put_before(self, head: _Head, item: LineItem) -> None:
        """Puts the sentence before the items that lie within its own one."""
        first, *others = item.items
        start = item.text[: len(item.text.content) - len(head.text.content)]
        item.text = join([*([start] if start.content else []), head.said, first.text])
        for other in others:
            if self._is_label(other.text):
                other.text = join([head.said, other.text])
        item.items = [*first.items, *others]

    def _head(self, text: ScriptText) -> _Head | None:
        if text.content[-1:] in _ENDS:
            return None
        last = sentences(text)[-1:]
        if not last or not text.content.endswith(last[0].content):
            return None
        content = last[0].content.rstrip(": ")
        if not content or len(content) > _LONGEST_HEAD or content[-1].isdigit():
            return None
        said = last[0][: len(content)]
        if found := _listing(self.understanding.language.prose.listing).search(content):
            parts = said[: found.start()].strip(), said[found.end() :].strip()
            said = join([part for part in parts if part.content] or [said])
        types = self.understanding.types(said)
        fits = types[-1:] == ("KIND",) and types[:-1] in _HEADS
        return _Head(last[0], said, found is not None) if fits else None

    def _is_label(self, text: ScriptText) -> bool:
        return {*self.understanding.types(text)[:1]} <= _LABELS


@cache
def _listing(phrases: str) -> re.Pattern[str]:
    return re.compile(rf"\b(?:{either(phrases)})\b", re.IGNORECASE)
