"""From a program to tasks, transitions and groups.

Each node has a point at which it is come to. A task's ways lead to points; which task a point is,
is known when all nodes have been gone through. Where ways meet and no task stands, a place of no
duration is put: before a condition that more than one way comes to, and at the end of a round.
"""

from collections.abc import Callable
from dataclasses import field

from argo_compiler.base.records import dataclass
from argo_compiler.il import Action, Condition, WaitRule
from argo_compiler.script.resolve.program import (
    Ahead,
    Choice,
    Do,
    HomeAhead,
    Leave,
    ProgramBlock,
    ProgramNode,
    ProgramRound,
    Target,
    inner_blocks,
)
from argo_compiler.script.sentences.tree.places import Steps

MEETING = WaitRule(duration=0)

Find = Callable[[Steps], ProgramNode | None]
"""the first node of a step; None if there is none, with an error"""


@dataclass(eq=False, slots=True)
class Point:
    """Target of a way: a task or a point. With neither the mission ends."""

    item: "Item | None" = None
    same: "Point | None" = None
    """it is this one"""

    def circles(self) -> bool:
        """Return whether the point leads to itself, and to no task."""
        point, seen = self, set()
        while point.same is not None and id(point) not in seen:
            seen.add(id(point))
            point = point.same
        return point.same is not None

    def reached(self) -> "Item | None":
        """The task that is come to here."""
        point = self
        while point.same is not None:
            point = point.same
        return point.item


@dataclass(eq=False, slots=True)
class Item:
    """A task with its ways on."""

    do: Do
    ways: list[tuple[tuple[Condition, ...], Point]] = field(default_factory=list)
    """in order; one without conditions is taken if no other is"""
    next: Point | None = None
    """where it leads if no way is taken"""
    failure: Point | None = None
    missed: Point | None = None


@dataclass(frozen=True, slots=True)
class Range:
    """A round, and the places of its first and last task."""

    round: ProgramRound
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Lowered:
    """The tasks in order with their ways, and the rounds over them, the outer ones first."""

    items: list[Item]
    ranges: list[Range]
    circling: list[Leave]
    """those that only lead to themselves"""


def lower_program(block: ProgramBlock, find: Find, home: Callable[[HomeAhead], Do]) -> Lowered:
    """The tasks of a program. `home` is the drive with which the mission ends where a way home
    leads to it; it is put at the end unless it stands there."""
    return _Lowering(find, home).lower(block)


class _Lowering:
    def __init__(self, find: Find, home: Callable[[HomeAhead], Do]) -> None:
        self.find = find
        self.home = home
        self.items: list[Item] = []
        self.ranges: list[Range] = []
        self.points: dict[int, Point] = {}
        self.homes: dict[int, Point] = {}
        self.apart: list[Do] = []
        self.left: list[tuple[Leave, Point]] = []
        self.onward = Point()
        """where `go on` leads: behind all conditions of a step"""
        self.jumped: set[int] = set()
        """the nodes that a way from elsewhere leads to, by identity"""

    def lower(self, block: ProgramBlock) -> Lowered:
        self._note_jumps(block)
        self._block(block, Point(), Point())
        circling = [leave for leave, point in self.left if point.circles()]
        if circling:
            return Lowered([], [], circling)
        for do in self.apart:
            item = Item(do)
            self._place(item, self.homes[id(do)])
        self._end()
        return Lowered(self.items, self.ranges, [])

    def _end(self) -> None:
        """A way with a condition leads to a task: where the mission ends, to one that does nothing,
        and behind which nothing follows."""
        end = Point()
        for item in self.items:
            for i, (conditions, point) in enumerate(item.ways):
                if conditions and point.reached() is None:
                    item.ways[i] = (conditions, end)
                    end.item = end.item or Item(Do("END", Action.WAIT, wait=MEETING))
        if end.item is not None:
            self.items.append(end.item)

    # ---- where ways lead

    def _note_jumps(self, block: ProgramBlock) -> None:
        stack = [block]
        while stack:
            for node in stack.pop():
                stack.extend(inner_blocks(node))
                targets = [node.target] if isinstance(node, Leave) else []
                if isinstance(node, Do):
                    targets += [way.target for way in node.ways]
                for target in targets:
                    found = self.find(target) if isinstance(target, Steps) else None
                    if found is not None:
                        self.jumped.add(id(found))

    def _point(self, node: ProgramNode) -> Point:
        return self.points.setdefault(id(node), Point())

    def _target(self, target: Target) -> Point:
        if target is Ahead.GO_ON:
            return self.onward
        if target is Ahead.END:
            return Point()
        if isinstance(target, HomeAhead):
            do = self.home(target)
            if do.block is not None:
                return self._point(do)
            if id(do) not in self.homes:
                self.homes[id(do)] = Point()
                self.apart.append(do)
            return self.homes[id(do)]
        node = self.find(target)
        return Point() if node is None else self._point(node)

    # ---- blocks

    def _block(
        self, block: ProgramBlock, entry: Point, following: Point, before: Item | None = None
    ) -> None:
        """Lays a block out: `entry` is where it is come to, `following` where it leads. `before`
        is the task from which alone it is come to, if a condition there may decide in it."""
        point = entry
        around = onward = self.onward
        for node in block:
            known = isinstance(block.owner, Choice) or (isinstance(node, Choice) and node.bound)
            self.onward = onward = onward if known else self._onward(node, following)
            behind = following if node.after is None else self._point(node.after)
            if isinstance(node, Do) and node.action is Action.START:
                # The mission passes over it: what leads to it leads to what follows.
                before = self._do(node, self._point(node), behind)
                point.same = behind
            else:
                own = self.points.setdefault(id(node), point)
                if own is not point:
                    point.same = own
                before = self._node(node, own, behind, before)
            point = behind
        self.onward = around
        if block.first is None:
            entry.same = following

    def _onward(self, node: ProgramNode, following: Point) -> Point:
        """Where a node leads if none of the conditions that belong to it is looked at."""
        after = node.after
        while isinstance(after, Choice) and after.bound:
            after = after.after
        return following if after is None else self._point(after)

    def _node(
        self, node: ProgramNode, entry: Point, behind: Point, before: Item | None
    ) -> Item | None:
        """Lays a node out; the task whose ways a condition behind it may be added to."""
        match node:
            case Do():
                return self._do(node, entry, behind)
            case Choice():
                return self._choice(node, entry, behind, before)
            case ProgramRound():
                self._round(node, entry, behind)
            case Leave():
                entry.same = self._target(node.target)
                self.left.append((node, entry))
        return None

    def _place(self, item: Item, entry: Point) -> None:
        entry.item = item
        self.items.append(item)

    def _do(self, do: Do, entry: Point, behind: Point) -> Item | None:
        item = Item(do, next=behind)
        self._place(item, entry)
        for way in do.ways:
            target = self._target(way.target)
            for conditions in way.alternatives or ((),):
                item.ways.append((conditions, target))
        if do.failure is not None:
            item.failure = Point()
            self._block(do.failure, item.failure, behind)
        if do.missed is not None:
            item.missed = Point()
            self._block(do.missed, item.missed, behind)
        return item if do.failure is None and do.missed is None else None

    def _choice(
        self, choice: Choice, entry: Point, behind: Point, before: Item | None
    ) -> Item | None:
        """Decides at the task before it, or at a place of its own if others come here as well."""
        item = before
        if item is None or not self._comes_only_from(item, entry, choice):
            last = choice.before
            base = f"after '{last.title}'" if isinstance(last, ProgramRound) else "MEET"
            item = Item(Do(base, Action.WAIT, choice.span, wait=MEETING))
            self._place(item, entry)
        then, otherwise = Point(), Point()
        taken, left = (otherwise, then) if choice.negated else (then, otherwise)
        item.ways += [(conditions, taken) for conditions in choice.alternatives]
        item.next = left
        for block, point in ((choice.then, then), (choice.otherwise, otherwise)):
            self._block(block, point, behind, item if point is left else None)
        # A condition behind this one is looked at here as well if the task leads on to it alone.
        alone = choice.otherwise.first is None and not choice.negated and _leaves(choice.then)
        if alone and behind.item is None:
            item.next = behind
            return item
        return None

    def _comes_only_from(self, item: Item, entry: Point, choice: Choice) -> bool:
        """Whether a condition is come to from this task alone, if none of its ways is taken."""
        if item.next is not entry or id(choice) in self.jumped:
            return False
        return all(conditions and point is not entry for conditions, point in item.ways)

    # ---- rounds

    def _round(self, round_: ProgramRound, entry: Point, behind: Point) -> None:
        first = len(self.items)
        end = Point()
        index = len(self.ranges)
        closes = _closes(round_.body)
        self._block(round_.body, entry, behind if closes else end)
        if not closes or len(self.items) == first:
            do = Do(f"end of '{round_.title}'", Action.WAIT, round_.span, wait=MEETING)
            self._place(Item(do, next=behind), end)
        self.ranges.insert(index, Range(round_, first, len(self.items) - 1))


def _leaves(block: ProgramBlock) -> bool:
    """Whether a way leads elsewhere from the beginning of a block."""
    return isinstance(block.first, Leave) and block.first.target is not Ahead.GO_ON


def _closes(body: ProgramBlock) -> bool:
    """Whether all ways through a block come to its last task."""
    last = body.last
    if isinstance(last, Do):
        open_ = any(
            (not way.alternatives and not way.last_round and way.target is not Ahead.GO_ON)
            or (way.alternatives and way.target is Ahead.GO_ON)
            for way in last.ways
        )
        left = all(block is None or _leaves(block) for block in (last.failure, last.missed))
        return left and not open_
    return isinstance(last, ProgramRound)
