"""Remaining machine: the part that can still be reached from a mission's progress."""

import heapq
from itertools import count

from argo_compiler.hfsm.model import DONE, Composite, Hfsm, Leaf
from argo_compiler.hfsm.progress import GroupProgress, Progress
from argo_compiler.hfsm.restoring import leaf_for
from argo_compiler.hfsm.tables import CompiledTransition, GroupNode, LeafNode, build_tables


def remaining_machine(hfsm: Hfsm, progress: Progress) -> Hfsm:
    """Return the machine without the states that can't be reached from the progress (rule H5).

    It is unknown which conditions will be satisfied, so all of them are assumed to be possible. The
    new machine begins with the active task of the progress.

    Raises:
        ArgoError: the machine does not have the active task of the progress.
    """
    reach = _Reach(hfsm, progress)
    leaves = tuple(leaf for leaf in hfsm.leaves if leaf.id in reach.leaves)
    # Parents come before their children, so in reverse order each child is decided first.
    kept_ids = {leaf.parent for leaf in leaves} | {hfsm.mission.id}
    for composite in reversed(hfsm.composites):
        if composite.id in kept_ids and composite.parent is not None:
            kept_ids.add(composite.parent)
    first = _first_leaves(hfsm, leaves)
    composites = []
    for composite in hfsm.composites:
        if composite.id in kept_ids:
            reachable = composite.initial in reach.leaves
            initial = composite.initial if reachable else first.get(composite.id, DONE)
            composites.append(_prune(composite, initial, kept_ids, reach))
    active = DONE if reach.start is None else reach.start.id
    mission = composites[0].model_copy(update={"initial": active})
    return hfsm.model_copy(update={"composites": (mission, *composites[1:]), "leaves": leaves})


def remaining_tasks(hfsm: Hfsm, progress: Progress) -> tuple[str, ...] | None:
    """Return the names of the tasks that can still follow if none fails, in the machine's order.

    The active task is among them. None: the mission is on its way to the dock after a failure, and
    the progress does not say of which task.
    """
    reach = _Reach(hfsm, progress, with_failures=False)
    if reach.start is not None and reach.start.is_return:
        return None
    return tuple(leaf.task.name for leaf in hfsm.leaves if leaf.id in reach.leaves)


def _prune(composite: Composite, initial: str, kept_ids: set[str], reach: "_Reach") -> Composite:
    children = tuple(
        child
        for child in composite.children
        if child in kept_ids or child in reach.leaves or child == DONE
    )
    # Transitions that can't be taken are removed: those of a round whose end is never reached, and
    # those whose target is never reached, such as the default one of an endless group.
    ends = composite.id in reach.completed
    transitions = tuple(
        t
        for t in composite.transitions
        if ends and (t.target in reach.leaves or t.target == DONE or t.completes in reach.completed)
    )
    update = {"children": children, "initial": initial, "transitions": transitions}
    return composite.model_copy(update=update)


def _first_leaves(hfsm: Hfsm, leaves: tuple[Leaf, ...]) -> dict[str, str]:
    """Return the id of the first of these leaves in each composite, by the composite's id."""
    parents = {composite.id: composite.parent for composite in hfsm.composites}
    first: dict[str, str] = {}
    for leaf in leaves:
        id: str | None = leaf.parent
        while id is not None and id not in first:
            first[id] = leaf.id
            id = parents[id]
    return first


class _Reach:
    """Search for the states that can be reached. It fills `leaves` and `completed`.

    A group that is already active may be in its last round, and then is not repeated; a group that
    is entered again has all its rounds. So the search state is a leaf together with `under_way`:
    how many of the groups that are active at first, from the outermost, have not been left. The
    smaller the number, the more states can be reached; the search expands the smallest numbers
    first.
    """

    def __init__(self, hfsm: Hfsm, progress: Progress, with_failures: bool = True) -> None:
        self._with_failures = with_failures
        known = build_tables(hfsm)
        self.start: LeafNode | None = None
        self.leaves: set[str] = set()
        self.completed: set[str] = set()
        self._fewest: dict[str, int] = {}
        self._searched: set[tuple[str, int, bool]] = set()
        self._order = count()
        self._pending: list[tuple[int, int, LeafNode]] = []
        if progress.outcome is not None or progress.active is None:
            return
        self.start = leaf_for(known, progress.active)
        self._last_round = _last_round_flags(self.start, progress.groups)
        self._add(self.start, len(self._last_round))
        while self._pending:
            under_way, _, leaf = heapq.heappop(self._pending)
            if under_way <= self._fewest[leaf.id]:
                self._follow(leaf, under_way)

    def _add(self, leaf: LeafNode | None, under_way: int) -> None:
        # Only groups in their last round restrict what can be reached.
        while under_way and not self._last_round[under_way - 1]:
            under_way -= 1
        if leaf is None or under_way >= self._fewest.get(leaf.id, len(self._last_round) + 1):
            return
        self.leaves.add(leaf.id)
        self._fewest[leaf.id] = under_way
        heapq.heappush(self._pending, (under_way, next(self._order), leaf))

    def _follow(self, leaf: LeafNode, under_way: int) -> None:
        self._follow_transitions(leaf.transitions, under_way)
        missable = leaf.latest is not None and self._with_failures
        if missable and leaf.missed is not None:
            self._follow_transitions((leaf.missed,), under_way)
        if leaf.failure is not None and (
            (leaf.can_fail_by_action_or_limit and self._with_failures)
            or (missable and leaf.missed is None)
        ):
            self._follow_transitions((leaf.failure,), under_way)
        for group in leaf.groups_outward:
            if (group.id, under_way, True) in self._searched:
                break
            if group.timeout is not None:
                self._complete(group, under_way, time_up=True)
            self._searched.add((group.id, under_way, True))

    def _follow_transitions(
        self, transitions: tuple[CompiledTransition, ...], under_way: int
    ) -> None:
        for transition in transitions:
            if transition.completes is not None:
                self._complete(transition.completes, under_way, time_up=False)
            else:
                self._add(transition.target, min(under_way, transition.kept_groups))

    def _complete(self, group: GroupNode, under_way: int, time_up: bool) -> None:
        """Add what can follow the end of a group's round, and of rounds around it that end with it.

        `under_way`: see the class. With `time_up`, the group is left by its time-out and has no
        further round.
        """
        following: GroupNode | None = group
        while following is not None:
            group, following = following, None
            if (group.id, under_way, False) in self._searched and not time_up:
                return
            self.completed.add(group.id)
            if not time_up:
                self._searched.add((group.id, under_way, False))
            for transition in group.transitions:
                if transition.repeats is None:
                    following = transition.completes
                    if following is None:
                        self._add(transition.target, min(under_way, transition.kept_groups))
                elif not time_up:
                    last = group.depth < under_way and self._last_round[group.depth]
                    if group.count != 1 and not last:
                        self._add(transition.target, min(under_way, transition.kept_groups))
                    if not group.count and not group.duration and not group.until:
                        break
            time_up = False


def _last_round_flags(leaf: LeafNode, progress: tuple[GroupProgress, ...]) -> list[bool]:
    """Return, for each group around the leaf, outermost first, whether it is in its last round."""
    known = {p.group: p for p in progress}
    last = []
    for group in leaf.groups_outward:
        p = known.get(group.name)
        last.append(
            p is not None
            and bool(
                (group.count and p.round >= group.count)
                or (group.duration and max(p.elapsed, p.round * group.every) >= group.duration)
            )
        )
    return last[::-1]
