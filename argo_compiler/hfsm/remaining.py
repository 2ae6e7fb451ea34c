"""The part of a machine that can still be reached from where a mission stands."""

import heapq
from itertools import count

from argo_compiler.hfsm.model import DONE, Composite, Hfsm, Leaf
from argo_compiler.hfsm.progress import GroupProgress, Progress
from argo_compiler.hfsm.restoring import leaf_of
from argo_compiler.hfsm.tables import CompiledTransition, GroupNode, LeafNode, tables


def remaining(hfsm: Hfsm, progress: Progress) -> Hfsm:
    """The machine without the states that can't be reached any more (rule H5).

    Which conditions will hold is not known, so all are taken to be possible.

    Raises:
        ArgoError: the machine does not have the task that the mission stands at.
    """
    reach = _Reach(hfsm, progress)
    leaves = tuple(leaf for leaf in hfsm.leaves if leaf.id in reach.leaves)
    # Children come after their parents, so a group is known to be kept before the one around it.
    kept = {leaf.parent for leaf in leaves} | {hfsm.mission.id}
    for composite in reversed(hfsm.composites):
        if composite.id in kept and composite.parent is not None:
            kept.add(composite.parent)
    first = _first_leaves(hfsm, leaves)
    composites = []
    for composite in hfsm.composites:
        if composite.id in kept:
            begins = composite.initial in reach.leaves
            initial = composite.initial if begins else first.get(composite.id, DONE)
            composites.append(_pruned(composite, initial, kept, reach))
    here = DONE if reach.start is None else reach.start.id
    mission = composites[0].model_copy(update={"initial": here})
    return hfsm.model_copy(update={"composites": (mission, *composites[1:]), "leaves": leaves})


def _pruned(composite: Composite, initial: str, kept: set[str], reach: "_Reach") -> Composite:
    children = tuple(
        child
        for child in composite.children
        if child in kept or child in reach.leaves or child == DONE
    )
    # The end of a round that is never reached leads nowhere, as the default of an endless group.
    ends = composite.id in reach.completed
    transitions = tuple(
        t
        for t in composite.transitions
        if ends and (t.target in reach.leaves or t.target == DONE or t.completes in reach.completed)
    )
    update = {"children": children, "initial": initial, "transitions": transitions}
    return composite.model_copy(update=update)


def _first_leaves(hfsm: Hfsm, leaves: tuple[Leaf, ...]) -> dict[str, str]:
    """The first leaf in each composite."""
    parents = {composite.id: composite.parent for composite in hfsm.composites}
    first: dict[str, str] = {}
    for leaf in leaves:
        id: str | None = leaf.parent
        while id is not None and id not in first:
            first[id] = leaf.id
            id = parents[id]
    return first


class _Reach:
    """What can be reached: grows as it is searched.

    A visit of a group under way may not be repeated any more, but one that is entered anew may. So
    a leaf is looked at along with how many of the groups under way, from the outermost, have not
    been left. The fewer, the more can be reached; the search takes those with the fewest first.
    """

    def __init__(self, hfsm: Hfsm, progress: Progress) -> None:
        known = tables(hfsm)
        self.start: LeafNode | None = None
        self.leaves: set[str] = set()
        self.completed: set[str] = set()
        self._fewest: dict[str, int] = {}
        self._looked_at: set[tuple[str, int, bool]] = set()
        self._order = count()
        self._pending: list[tuple[int, int, LeafNode]] = []
        if progress.outcome is not None or progress.active is None:
            return
        self.start = leaf_of(known, progress.active)
        self._last_round = _in_last_round(self.start, progress.groups)
        self._add(self.start, len(self._last_round))
        while self._pending:
            under_way, _, leaf = heapq.heappop(self._pending)
            if under_way <= self._fewest[leaf.id]:
                self._follow(leaf, under_way)

    def _add(self, leaf: LeafNode | None, under_way: int) -> None:
        # Only groups in their last round make a difference.
        while under_way and not self._last_round[under_way - 1]:
            under_way -= 1
        if leaf is None or under_way >= self._fewest.get(leaf.id, len(self._last_round) + 1):
            return
        self.leaves.add(leaf.id)
        self._fewest[leaf.id] = under_way
        heapq.heappush(self._pending, (under_way, next(self._order), leaf))

    def _follow(self, leaf: LeafNode, under_way: int) -> None:
        self._take(leaf.ways, under_way)
        missable = leaf.latest is not None
        if missable and leaf.missed is not None:
            self._take((leaf.missed,), under_way)
        if leaf.failure is not None and (leaf.may_fail or (missable and leaf.missed is None)):
            self._take((leaf.failure,), under_way)
        for group in leaf.groups:
            if (group.id, under_way, True) in self._looked_at:
                break
            if group.timeout is not None:
                self._complete(group, under_way, time_up=True)
            self._looked_at.add((group.id, under_way, True))

    def _take(self, ways: tuple[CompiledTransition, ...], under_way: int) -> None:
        for way in ways:
            if way.completes is not None:
                self._complete(way.completes, under_way, time_up=False)
            else:
                self._add(way.target, min(under_way, way.keep))

    def _complete(self, group: GroupNode, under_way: int, time_up: bool) -> None:
        """The round of a group, and perhaps of groups around it, comes to its end."""
        following: GroupNode | None = group
        while following is not None:
            group, following = following, None
            if (group.id, under_way, False) in self._looked_at and not time_up:
                return
            self.completed.add(group.id)
            if not time_up:
                self._looked_at.add((group.id, under_way, False))
            for way in group.ways:
                if way.repeats is None:
                    following = way.completes
                    if following is None:
                        self._add(way.target, min(under_way, way.keep))
                elif not time_up:
                    last = group.depth < under_way and self._last_round[group.depth]
                    if group.count != 1 and not last:
                        self._add(way.target, min(under_way, way.keep))
                    if not group.count and not group.duration and not group.until:
                        break
            time_up = False


def _in_last_round(leaf: LeafNode, progress: tuple[GroupProgress, ...]) -> list[bool]:
    """For each group around the leaf, outermost first, whether it is not repeated in this visit."""
    known = {p.group: p for p in progress}
    found = []
    for group in leaf.groups:
        p = known.get(group.name)
        found.append(
            p is not None
            and bool(
                (group.count and p.round >= group.count)
                or (group.duration and max(p.elapsed, p.round * group.every) >= group.duration)
            )
        )
    return found[::-1]
