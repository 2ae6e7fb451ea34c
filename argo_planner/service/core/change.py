"""Changes between two missions, as data that turns the first mission into the second."""

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

from argo_compiler.base.model import Model
from argo_compiler.editing.commands import SetHeader
from argo_compiler.il import Group, Mission, Reaction, Task

Item = TypeVar("Item", Task, Group, Reaction)
HEADER = tuple(name for name in SetHeader.model_fields if name != "kind")
"""fields of a mission that belong to no task, group or reaction"""


class ListChange(Model, Generic[Item]):
    """Changes of a list whose items have names.

    To make the new list: remove the items in `gone` and in `placed`, replace the remaining items
    that are in `put`, then insert the placed items, one after the other.
    """

    put: tuple[Item, ...] = ()
    """new and changed items, each one complete"""
    gone: tuple[str, ...] = ()
    """names of removed items"""
    placed: tuple[tuple[str, str | None], ...] = ()
    """names of new and moved items, each with the item before it; None: it becomes the first"""


class MissionChange(Model):
    """Changes that turn one mission into another."""

    header: SetHeader | None = None
    """header fields with their new values"""
    tasks: ListChange[Task] | None = None
    groups: ListChange[Group] | None = None
    reactions: ListChange[Reaction] | None = None
    """changes of reactions, which are named by their events"""

    @property
    def subjects(self) -> frozenset[tuple[str, str]]:
        """Changed things: a kind (`header`, `tasks`, `groups`, `reactions`) and a name each."""
        changed = {("header", name) for name in (self.header.given_fields() if self.header else ())}
        for kind in LISTS:
            change: ListChange[Any] | None = getattr(self, kind)
            if change is not None:
                names = [*(item_name(item) for item in change.put), *change.gone]
                names += [name for name, _ in change.placed]
                changed.update((kind, name) for name in names)
        return frozenset(changed)


LISTS = ("tasks", "groups", "reactions")


def item_name(item: Task | Group | Reaction) -> str:
    """Return the name of an item in its list; a reaction is named by its event."""
    return str(item.event) if isinstance(item, Reaction) else item.name


def mission_change(before: Mission, after: Mission) -> MissionChange:
    """Return the change from the first mission to the second, in O(n log n) for n tasks."""
    header = {n: getattr(after, n) for n in HEADER if getattr(after, n) != getattr(before, n)}
    return MissionChange.model_construct(
        header=SetHeader(**header) if header else None,
        tasks=_list_change(before.tasks, after.tasks),
        groups=_list_change(before.groups, after.groups),
        reactions=_list_change(before.reactions, after.reactions),
    )


def _list_change(before: Sequence[Item], after: Sequence[Item]) -> ListChange[Item] | None:
    if before is after:
        return None
    if len(before) == len(after):
        # Most edits change one or two items and leave the order as it is.
        pairs = [(old, new) for old, new in zip(before, after, strict=True) if old is not new]
        if all(item_name(old) == item_name(new) for old, new in pairs):
            changed = tuple(new for old, new in pairs if old != new)
            return ListChange.model_construct(put=changed) if changed else None
    old: dict[str, Item] = {item_name(item): item for item in before}
    new: dict[str, Item] = {item_name(item): item for item in after}
    put = tuple(i for n, i in new.items() if old.get(n) is not i and old.get(n) != i)
    gone = tuple(n for n in old if n not in new)
    placed = new_and_moved_names([*old], [*new])
    if not (put or gone or placed):
        return None
    return ListChange.model_construct(put=put, gone=gone, placed=placed)


def new_and_moved_names(
    before: Sequence[str], after: Sequence[str]
) -> tuple[tuple[str, str | None], ...]:
    """Return the names that are new or moved in the order `after`, as few as possible.

    They are in that order. Each one comes with the name before it in `after`, or None if it is the
    first.
    """
    if before == after:
        return ()
    index = {name: k for k, name in enumerate(before)}
    common = [name for name in after if name in index]
    unmoved_indices = _longest_increasing_subsequence([index[name] for name in common])
    unmoved = {common[k] for k in unmoved_indices}
    predecessors = [None, *after[:-1]]
    return tuple(
        (name, predecessor)
        for name, predecessor in zip(after, predecessors, strict=False)
        if name not in unmoved
    )


def _longest_increasing_subsequence(numbers: Sequence[int]) -> list[int]:
    """Return the indices of a longest increasing subsequence of distinct numbers, in O(n log n)."""
    ends: list[int] = []  # the smallest last number of a subsequence of each length
    end_indices: list[int] = []
    predecessors: list[int | None] = []
    for index, number in enumerate(numbers):
        length = bisect_left(ends, number)
        predecessors.append(end_indices[length - 1] if length else None)
        ends[length : length + 1] = [number]
        end_indices[length : length + 1] = [index]
    subsequence: list[int] = []
    next_index = end_indices[-1] if end_indices else None
    while next_index is not None:
        subsequence.append(next_index)
        next_index = predecessors[next_index]
    return subsequence[::-1]


def apply_change(mission: Mission, change: MissionChange) -> Mission:
    """Return the mission with the change applied.

    Raises KeyError if the change does not fit the mission, as it was made for another one.
    """
    update: dict[str, Any] = dict(change.header.given_fields()) if change.header else {}
    for kind in LISTS:
        list_change: ListChange[Any] | None = getattr(change, kind)
        if list_change is not None:
            update[kind] = _apply_list_change(getattr(mission, kind), list_change)
    return mission.model_copy(update=update) if update else mission


def _apply_list_change(items: Sequence[Item], change: ListChange[Item]) -> tuple[Item, ...]:
    known = {item_name(item): item for item in items}
    for name in change.gone:
        del known[name]
    known.update((item_name(item), item) for item in change.put)
    moved = {name for name, _ in change.placed}
    unmoved = [item_name(i) for i in items if item_name(i) in known and item_name(i) not in moved]
    order = insert_after_predecessors(unmoved, change.placed)
    if len(order) != len(known):
        raise KeyError("this is a change of another mission")
    return tuple(known[name] for name in order)


def insert_after_predecessors(
    unmoved: Sequence[str], placed: Sequence[tuple[str, str | None]]
) -> list[str]:
    """Return the unmoved names with the placed ones inserted, one after the other, in linear time.

    `placed` has names with their predecessors. Each name is inserted directly after its
    predecessor; None inserts it as the first. A name whose predecessor is missing is left out.
    """
    following: dict[str | None, str] = {}
    for name, predecessor in placed:
        if predecessor in following:
            following[name] = following[predecessor]
        following[predecessor] = name
    order: list[str | None] = []
    for start in (None, *unmoved):
        order.append(start)
        while (last := order[-1]) in following:
            order.append(following[last])
    return [name for name in order if name is not None]
