"""Lists under a condition: `If it is above 5:`, then `a) check #4` and `b) check #8`."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile

from argo_compiler.script.syntax.layout import LineItem
from argo_compiler.script.syntax.lines import LineMark
from argo_compiler.script.syntax.sentence_ends import sentences
from argo_compiler.script.syntax.text.source import ScriptText, join
from argo_compiler.script.syntax.understanding import Understanding

_CASES = frozenset(["IF", "UNLESS", "ELSE", "IN_ALL_OTHERS"])
"""what a sentence begins with that says in which case something is done"""


@dataclass(frozen=True)
class CaseLists:
    """Puts the items under a condition into its sentence."""

    understanding: Understanding

    def told(self, items: Iterable[LineItem]) -> Iterator[LineItem]:
        """The items; of those under a condition one with all of them, where that makes sense."""
        waiting = list(items)
        taken = 0
        for i, item in enumerate(waiting):
            if taken:
                taken -= 1
                continue
            if item.text.content.endswith(":"):
                inner, item.items = item.items, []
                below = inner or _list_of(waiting, i + 1)
                if not self._put_together(item, below):
                    item.items = inner
                elif not inner:
                    taken = len(below)
            yield item

    def _put_together(self, item: LineItem, below: Sequence[LineItem]) -> bool:
        over = sentences(item.text)[-1:]
        inner = [one for lower in below for one in sentences(lower.text)]
        plain = len(inner) == len(below) > 0 and not any(lower.items for lower in below)
        if not plain or not over or not self._is_case(over[0]) or any(map(self._is_case, inner)):
            return False
        head = self._head(over[0])
        whole = join([head, *(one[: len(one.content.rstrip(" .;,"))] for one in inner)], ", ")
        if not self.understanding.fits(whole):
            return False
        before = item.text[: len(item.text.content) - len(over[0].content)].strip()
        item.text = join([before, whole]) if before.content else whole
        return True

    def _head(self, text: ScriptText) -> ScriptText:
        """The condition without `, do the following:`."""
        words = self.understanding.words(text)
        end = words[-1].start if words[-1].type == "DO_FOLLOWING" else len(text.content)
        return text[: len(text.content[:end].rstrip(" :,"))]

    def _is_case(self, text: ScriptText) -> bool:
        return not {*self.understanding.types(text)[:1]}.isdisjoint(_CASES)


def _list_of(items: Sequence[LineItem], start: int) -> list[LineItem]:
    """The items of a list that begins here, if its marks are no numbers of steps."""
    mark = items[start].line.mark if start < len(items) else LineMark.NONE
    if mark not in (LineMark.BULLET, LineMark.LETTER):
        return []
    return list(takewhile(lambda item: item.line.mark is mark, items[start:]))
