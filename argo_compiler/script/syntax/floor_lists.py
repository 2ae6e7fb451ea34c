"""Lists under a floor: `Second floor:`, then `- all valves`. What they name is on that floor."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from argo_compiler.script.syntax.layout import LineItem
from argo_compiler.script.syntax.lines import LineMark
from argo_compiler.script.syntax.sentence_reading import Said
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.nouns import Pronoun
from argo_compiler.script.syntax.tree.orders import Measure, ScriptOrder, Sentence
from argo_compiler.script.syntax.tree.places import FloorName
from argo_compiler.script.syntax.understanding import Understanding

_FLOORS = frozenset(["FLOOR", "FLOOR_NAME", "ORDINAL"])
_LONGEST = 40
"""characters of a floor's name over a list"""


@dataclass(frozen=True)
class FloorLists:
    """Takes the headings that name a floor away, and tells the items below them where they are."""

    understanding: Understanding

    def told(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items without such headings."""
        waiting = list(items)
        floors: Sequence[FloorName] = ()
        chapter = False
        for item, after in zip(waiting, [*waiting[1:], None], strict=False):
            heading = item.line.heading or bool(item.items)
            marked = item.line.mark is not LineMark.NONE
            listed = after is not None and after.line.mark is not LineMark.NONE
            found = self._floors(item) if heading or listed else ()
            if found and item.items:
                _place(item.items, found)
                item.text = item.text[:0]
                floors = ()
            elif found:
                floors, chapter = found, marked  # `# Second floor` stands over all to the next one
                continue
            elif (item.line.heading and (marked or not chapter)) or not (marked or chapter):
                floors = ()
            elif floors:
                _place([item], floors)
            yield item

    def _floors(self, item: LineItem) -> Sequence[FloorName]:
        """The floors that a text names, if it says nothing else."""
        text = item.text[: len(item.text.content.rstrip(" :."))]
        if not 0 < len(text.content) <= _LONGEST:
            return ()
        if {*self.understanding.types(text)[:1]}.isdisjoint(_FLOORS):
            return ()
        found = self.understanding.location(text)
        return found if isinstance(found, tuple) else ()


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
    manner = order.manner or Manner()
    return order if manner.floors else replace(order, manner=replace(manner, floors=tuple(floors)))
