"""What is different between two missions, as data from which one is made from the other."""

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

from argo_compiler.base.model import Model
from argo_compiler.editing.commands import SetHeader
from argo_compiler.il import Group, Mission, Reaction, Task

Item = TypeVar("Item", Task, Group, Reaction)
HEADER = tuple(name for name in SetHeader.model_fields if name != "kind")
"""the fields of a mission that belong to no task, group or reaction"""


class ListChange(Model, Generic[Item]):
    """What is different in a list whose items have names. To make the new list: take out what is
    `gone` and what is `placed`, exchange or keep the items in `put`, then put the placed ones in
    again, one after the other."""

    put: tuple[Item, ...] = ()
    """what is new or different, as a whole"""
    gone: tuple[str, ...] = ()
    """names of those that are not there any more"""
    placed: tuple[tuple[str, str | None], ...] = ()
    """what is new or moved, and behind which other one it stands now; None: it is the first"""


class MissionChange(Model):
    """What is different between two missions. Applied to the first one it gives the second."""

    header: SetHeader | None = None
    """the fields that have other values"""
    tasks: ListChange[Task] | None = None
    groups: ListChange[Group] | None = None
    reactions: ListChange[Reaction] | None = None
    """they are named by their events"""

    @property
    def subjects(self) -> frozenset[tuple[str, str]]:
        """What it touches: kinds of things, and their names."""
        found = {("header", name) for name in (self.header.given_fields() if self.header else ())}
        for kind in LISTS:
            change: ListChange[Any] | None = getattr(self, kind)
            if change is not None:
                names = [*(name_of(item) for item in change.put), *change.gone]
                names += [name for name, _ in change.placed]
                found.update((kind, name) for name in names)
        return frozenset(found)


LISTS = ("tasks", "groups", "reactions")


def name_of(item: Task | Group | Reaction) -> str:
    """What an item is called in its list."""
    return str(item.event) if isinstance(item, Reaction) else item.name


def difference(before: Mission, after: Mission) -> MissionChange:
    """What turns the first mission into the second. n log n for n tasks."""
    header = {n: getattr(after, n) for n in HEADER if getattr(after, n) != getattr(before, n)}
    return MissionChange.model_construct(
        header=SetHeader(**header) if header else None,
        tasks=_of_lists(before.tasks, after.tasks),
        groups=_of_lists(before.groups, after.groups),
        reactions=_of_lists(before.reactions, after.reactions),
    )


def _of_lists(before: Sequence[Item], after: Sequence[Item]) -> ListChange[Item] | None:
    if before is after:
        return None
    if len(before) == len(after):
        # Most edits change an item or two where they stand.
        pairs = [(old, new) for old, new in zip(before, after, strict=True) if old is not new]
        if all(name_of(old) == name_of(new) for old, new in pairs):
            changed = tuple(new for old, new in pairs if old != new)
            return ListChange.model_construct(put=changed) if changed else None
    old: dict[str, Item] = {name_of(item): item for item in before}
    new: dict[str, Item] = {name_of(item): item for item in after}
    put = tuple(i for n, i in new.items() if old.get(n) is not i and old.get(n) != i)
    gone = tuple(n for n in old if n not in new)
    placed = placements([*old], [*new])
    if not (put or gone or placed):
        return None
    return ListChange.model_construct(put=put, gone=gone, placed=placed)


def placements(before: Sequence[str], after: Sequence[str]) -> tuple[tuple[str, str | None], ...]:
    """What is new in the second order or stands elsewhere in it, as few as can be, each with what
    it stands behind."""
    if before == after:
        return ()
    at = {name: k for k, name in enumerate(before)}
    common = [name for name in after if name in at]
    stays = _longest_rising([at[name] for name in common])
    still = {common[k] for k in stays}
    behind = [None, *after[:-1]]
    return tuple(
        (name, other) for name, other in zip(after, behind, strict=False) if name not in still
    )


def _longest_rising(numbers: Sequence[int]) -> list[int]:
    """The places of a longest rising part of different numbers. n log n."""
    ends: list[int] = []  # the smallest number that ends a rising part of each length
    places: list[int] = []
    earlier: list[int | None] = []
    for place, number in enumerate(numbers):
        length = bisect_left(ends, number)
        earlier.append(places[length - 1] if length else None)
        ends[length : length + 1] = [number]
        places[length : length + 1] = [place]
    found: list[int] = []
    place_or_none = places[-1] if places else None
    while place_or_none is not None:
        found.append(place_or_none)
        place_or_none = earlier[place_or_none]
    return found[::-1]


def applied(mission: Mission, change: MissionChange) -> Mission:
    """The mission that the change leads to. KeyError if it is a change of another mission."""
    update: dict[str, Any] = dict(change.header.given_fields()) if change.header else {}
    for kind in LISTS:
        of_list: ListChange[Any] | None = getattr(change, kind)
        if of_list is not None:
            update[kind] = _with(getattr(mission, kind), of_list)
    return mission.model_copy(update=update) if update else mission


def _with(items: Sequence[Item], change: ListChange[Item]) -> tuple[Item, ...]:
    known = {name_of(item): item for item in items}
    for name in change.gone:
        del known[name]
    known.update((name_of(item), item) for item in change.put)
    moved = {name for name, _ in change.placed}
    kept = [name_of(i) for i in items if name_of(i) in known and name_of(i) not in moved]
    order = put_behind(kept, change.placed)
    if len(order) != len(known):
        raise KeyError("this is a change of another mission")
    return tuple(known[name] for name in order)


def put_behind(kept: Sequence[str], placed: Sequence[tuple[str, str | None]]) -> list[str]:
    """The names in the order that they have when each of the placed ones, one after the other, is
    put right behind what it is to stand behind. Linear time."""
    following: dict[str | None, str] = {}
    for name, other in placed:
        if other in following:
            following[name] = following[other]
        following[other] = name
    order: list[str | None] = []
    for start in (None, *kept):
        order.append(start)
        while (last := order[-1]) in following:
            order.append(following[last])
    return [name for name in order if name is not None]
