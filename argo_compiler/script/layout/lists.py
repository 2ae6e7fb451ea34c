"""Lists of items that a line over them says something of: a condition, a floor, a kind.

`If it is above 5:` stands over `a) check #4` and `b) check #8`, `Second floor:` over `- all
valves`, `Check these pressure gauges:` over `- 1` and `- 3`.
"""

import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice

from argo_compiler.script.documents.source import ScriptText, join
from argo_compiler.script.layout.items import LineItem
from argo_compiler.script.layout.lines import LineMark, sentences
from argo_compiler.script.sentences.tree.nouns import Pronoun
from argo_compiler.script.sentences.tree.orders import Measure, ScriptOrder, Sentence
from argo_compiler.script.sentences.tree.places import FloorName
from argo_compiler.script.sentences.tree.script import Said
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.prose import either

_CASES = frozenset(["IF", "UNLESS", "ELSE", "IN_ALL_OTHERS"])
"""what a sentence begins with that says in which case something is done"""
_FLOORS = frozenset(["FLOOR", "FLOOR_NAME", "ORDINAL"])
_FIGURE = re.compile(r"[0-9]+")
_LONGEST = 40
"""characters of a floor's name over a list"""
_HEADS = ((), ("MEASURE",), ("ALL",), ("MEASURE", "ALL"))
"""what may stand before the kind in the sentence over a list"""
_INTRODUCING = frozenset(["MEASURE", "BE_MEASURED", "DO_FOLLOWING", "ALL", "COLON"])
"""words, besides a kind and the order, of a sentence that introduces a list"""
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
    every: bool
    """whether it says `all`, which the items do not repeat"""


@dataclass(frozen=True)
class Lists:
    """Tells the items of lists what the lines over them say."""

    understanding: Understanding
    record: Callable[[ScriptText, str], None]
    """records a line over a list: its text, and what it is taken for, if it has no effect"""
    begun: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """the types of the words with which lines begin, by their text with all figures alike"""

    def told(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """Return the items, of which each says by itself what is meant."""
        return self._of_kinds(self._on_floors(self._in_cases(items)))

    # ---- under a condition

    def _in_cases(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items; of those under a condition one with all of them, where that makes sense."""
        rest = iter(items)
        ahead: deque[LineItem] = deque()
        while (item := ahead.popleft() if ahead else next(rest, None)) is not None:
            if item.text.content.endswith(":"):
                inner, item.items = item.items, []
                below = inner or _list_ahead(ahead, rest)
                if not self._put_together(item, below):
                    item.items = inner
                elif not inner:
                    for _ in below:
                        ahead.popleft()
            yield item

    def _put_together(self, item: LineItem, below: Sequence[LineItem]) -> bool:
        over = sentences(item.text)[-1:]
        inner = [one for lower in below for one in sentences(lower.text)]
        plain = len(inner) == len(below) > 0 and not any(lower.items for lower in below)
        if not plain or not over or not self._is_case(over[0]) or any(map(self._is_case, inner)):
            return False
        head = self._condition(over[0])
        whole = join([head, *(one[: len(one.content.rstrip(" .;,"))] for one in inner)], ", ")
        if not self.understanding.fits(whole):
            return False
        before = item.text[: len(item.text.content) - len(over[0].content)].strip()
        item.text = join([before, whole]) if before.content else whole
        return True

    def _condition(self, text: ScriptText) -> ScriptText:
        """The condition without `, do the following:`."""
        words = self.understanding.words(text)
        end = words[-1].start if words[-1].type == "DO_FOLLOWING" else len(text.content)
        return text[: len(text.content[:end].rstrip(" :,"))]

    def _is_case(self, text: ScriptText) -> bool:
        return not {*self.understanding.types(text)[:1]}.isdisjoint(_CASES)

    # ---- under a floor

    def _on_floors(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items without headings that name a floor; those below are told where they are."""
        floors: Sequence[FloorName] = ()
        chapter = False
        for item, after in _with_next(items):
            heading = item.line.heading or bool(item.items)
            marked = item.line.mark is not LineMark.NONE
            listed = after is not None and after.line.mark is not LineMark.NONE
            found = self._floors(item) if heading or listed else ()
            if found and item.items:
                self.record(item.text, "")
                _place(item.items, found)
                item.text = item.text[:0]
                floors = ()
            elif found:
                self.record(item.text, "")
                floors, chapter = found, marked  # `# Second floor` stands over all to the next one
                continue
            elif (item.line.heading and (marked or not chapter)) or not (marked or chapter):
                floors = ()
            elif floors:
                _place([item], floors)
            yield item

    def _floors(self, item: LineItem) -> Sequence[FloorName]:
        """The floors that a text names, if it says nothing else."""
        content = item.text.content.rstrip(" :.")
        if not 0 < len(content) <= _LONGEST:
            return ()
        alike = _FIGURE.sub("9", content)  # many lines differ in figures only
        begun = self.begun.get(alike)
        if begun is None:
            begun = self.begun[alike] = self.understanding.types(item.text.replaced(alike))[:1]
        if _FLOORS.isdisjoint(begun):
            return ()
        found = self.understanding.location(item.text[: len(content)])
        return found if isinstance(found, tuple) else ()

    # ---- under what the items are

    def _of_kinds(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items; those of such a list say themselves what they are."""
        over: LineItem | None = None
        head: _Head | None = None
        for item, after in _with_next(items):
            listed = after is not None and after.line.mark is not LineMark.NONE
            if item.text.content.endswith(":") and (item.items or listed):
                self._drop_introduction(item)
            if head is not None and self._is_label(item.text):
                if over is not None and head.every:
                    self.record(head.text, "a heading")
                over = self._without(over, head)
                _put_before(head, item)
            elif head is not None and head.listing and item.line.mark is not LineMark.NONE:
                if over is not None:
                    self.record(head.text, "a heading")
                over = self._without(over, head)
            else:
                head = None
            if over is not None:
                yield over
                over = None
            if head is None:
                head = self._head(item.text)
                if head is not None and item.items and self._is_label(item.items[0].text):
                    self._join_first(head, item)
                    head = None
                elif head is not None:
                    over = item
                    continue
            yield item
        if over is not None:
            yield over

    def _drop_introduction(self, item: LineItem) -> None:
        """Leave out the sentence over a list that only says that its items, and not all checkpoints
        of the site, are read in this order: `The checkpoints are to be read in this order:`."""
        last = sentences(item.text)[-1]
        types = self.understanding.types(last)
        named = [kind for kind in types if kind not in _INTRODUCING]
        if named == ["KIND", "THIS_ORDER"]:
            self.record(last, "a heading" if self.understanding.named_kinds(last) else "")
            item.text = item.text[: len(item.text.content) - len(last.content)].strip()

    def _without(self, item: LineItem | None, head: _Head) -> LineItem | None:
        """An item without the sentence at its end; None if nothing is left."""
        if item is None:
            return None
        item.text = item.text[: len(item.text.content) - len(head.text.content)].strip()
        return item if item.text.content else None

    def _join_first(self, head: _Head, item: LineItem) -> None:
        """Put the sentence before the items that lie within its own one."""
        if head.every:
            self.record(head.text, "a heading")
        first, *others = item.items
        start = item.text[: len(item.text.content) - len(head.text.content)]
        item.text = join([*([start] if start.content else []), head.said, first.text])
        for other in others:
            if self._is_label(other.text):
                _put_before(head, other)
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
        if types[-1:] != ("KIND",) or types[:-1] not in _HEADS:
            return None
        every = "ALL" in types
        if every:
            if found is None and not last[0].content.endswith(":"):
                return None  # `Check all valves` is an order as well
            word = next(w for w in self.understanding.words(said) if w.type == "ALL")
            said = said.without(word.start, word.end)
        return _Head(last[0], said, found is not None, every)

    def _is_label(self, text: ScriptText) -> bool:
        return {*self.understanding.types(text)[:1]} <= _LABELS


def _put_before(head: _Head, item: LineItem) -> None:
    item.own = item.text
    item.text = join([head.said, item.text])


def _with_next(items: Iterable[LineItem]) -> Iterator[tuple[LineItem, LineItem | None]]:
    """Yield each item with the next one, for which no more items are read than needed."""
    rest = iter(items)
    item = next(rest, None)
    while item is not None:
        after = next(rest, None)
        yield item, after
        item = after


def _list_ahead(ahead: deque[LineItem], rest: Iterator[LineItem]) -> list[LineItem]:
    """Return the items of a list that begins with the next item, if its marks are no numbers of
    steps. Those that are read from `rest` are put into `ahead`, and so is the first behind them."""
    found: list[LineItem] = []
    while True:
        if len(ahead) == len(found):
            ahead.extend(islice(rest, 1))
        mark = ahead[len(found)].line.mark if len(ahead) > len(found) else LineMark.NONE
        if mark not in (LineMark.BULLET, LineMark.LETTER) or mark is not ahead[0].line.mark:
            return found
        found.append(ahead[len(found)])


def _place(items: Iterable[LineItem], floors: Sequence[FloorName]) -> None:
    for item in items:
        item.floors = floors
        _place(item.items, floors)


def on_floors(said: list[Said], floors: Sequence[FloorName]) -> list[Said]:
    """What is said, of checkpoints on these floors."""
    if not floors:
        return said
    return [
        replace(one, orders=tuple(_on(order, floors) for order in one.orders))
        if isinstance(one, Sentence)
        else one
        for one in said
    ]


def _on(order: ScriptOrder, floors: Sequence[FloorName]) -> ScriptOrder:
    if not isinstance(order, Measure) or any(isinstance(n, Pronoun) for n in order.what.nouns):
        return order
    if order.manner.floors:
        return order
    return replace(order, manner=replace(order.manner, floors=tuple(floors)))


@cache
def _listing(phrases: str) -> re.Pattern[str]:
    return re.compile(rf"\b(?:{either(phrases)})\b", re.IGNORECASE)
