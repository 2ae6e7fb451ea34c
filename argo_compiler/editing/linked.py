"""A list in which any item is put in, taken out or moved in the same short time.

The order of tasks while it is edited, whether they are those of a mission or of the plan that a
script's commands make: each item knows its neighbours, so that thousands of changes of a list of a
hundred thousand take no longer than the list is long.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Generic, Self, TypeVar


@dataclass(eq=False, slots=True)
class Linked:
    """What stands in a linked list. Mutable: the list changes its neighbours."""

    before: Self | None = field(default=None, init=False, repr=False)
    after: Self | None = field(default=None, init=False, repr=False)
    listed: bool = field(default=False, init=False)
    """whether it stands in a list now"""


_Item = TypeVar("_Item", bound=Linked)


class LinkedList(Generic[_Item]):
    """Items in order. Has state: what is put in, taken out or moved changes its neighbours."""

    def __init__(self) -> None:
        self.first: _Item | None = None
        self.last: _Item | None = None

    def __iter__(self) -> Iterator[_Item]:
        item = self.first
        while item is not None:
            yield item
            item = item.after

    def append(self, item: _Item) -> None:
        """Puts the item behind all."""
        self.insert_after(self.last, item)

    def insert_after(self, anchor: _Item | None, item: _Item) -> None:
        """Puts the item behind the anchor; None: before all."""
        after = anchor.after if anchor is not None else self.first
        item.before, item.after, item.listed = anchor, after, True
        if anchor is not None:
            anchor.after = item
        else:
            self.first = item
        if after is not None:
            after.before = item
        else:
            self.last = item

    def put(self, items: Sequence[_Item], behind: _Item | None) -> None:
        """Puts the items one after the other behind the anchor; None: before all."""
        for item in items:
            self.insert_after(behind, item)
            behind = item

    def remove(self, item: _Item) -> None:
        """Takes the item out; its neighbours follow each other."""
        if item.before is not None:
            item.before.after = item.after
        else:
            self.first = item.after
        if item.after is not None:
            item.after.before = item.before
        else:
            self.last = item.before
        item.before = item.after = None
        item.listed = False
