"""Linked list in which any item can be inserted, removed or moved in constant time.

It holds the order of the tasks while a mission or a script's program is edited. Each item knows its
neighbours, so thousands of changes to a list of a hundred thousand items take no longer than one
pass over the list.
"""

from collections.abc import Iterator
from dataclasses import field
from typing import Generic, Self, TypeVar

from argo_compiler.base.records import dataclass


@dataclass(eq=False, slots=True)
class ListItem:
    """Item of a linked list. Mutable: the list changes its neighbours."""

    before: Self | None = field(default=None, init=False, repr=False)
    after: Self | None = field(default=None, init=False, repr=False)
    is_listed: bool = field(default=False, init=False)
    """whether it is in a list now"""


_Item = TypeVar("_Item", bound=ListItem)


class LinkedList(Generic[_Item]):
    """Items in order. Mutable: an insertion or removal also changes the items next to it."""

    def __init__(self) -> None:
        self.first: _Item | None = None
        self.last: _Item | None = None

    def __iter__(self) -> Iterator[_Item]:
        item = self.first
        while item is not None:
            yield item
            item = item.after

    def append(self, item: _Item) -> None:
        """Add the item at the end."""
        self.insert_after(self.last, item)

    def insert_after(self, anchor: _Item | None, item: _Item) -> None:
        """Insert the item after the anchor, or at the start if the anchor is None."""
        after = anchor.after if anchor is not None else self.first
        item.before, item.after, item.is_listed = anchor, after, True
        if anchor is not None:
            anchor.after = item
        else:
            self.first = item
        if after is not None:
            after.before = item
        else:
            self.last = item

    def remove(self, item: _Item) -> None:
        """Remove an item that is in the list, and link its neighbours to each other."""
        if item.before is not None:
            item.before.after = item.after
        else:
            self.first = item.after
        if item.after is not None:
            item.after.before = item.before
        else:
            self.last = item.before
        item.before = item.after = None
        item.is_listed = False
