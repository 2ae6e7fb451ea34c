"""Where the rounds of a script end: what branches off inside of one joins there.

A round ends with the unconditional way on from its last task and with nothing else (G5, G14). Where
others come to its end as well, a place of no duration is put behind that task and ends the round.
Only words that say so leave a round before its end: a step that is named, the way home, the end.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from argo_compiler.il import Action
from argo_compiler.script.resolve.plan import Item, Plan, PlannedGroup, ResolvedBranch, place_item
from argo_compiler.script.syntax.commands import Plain
from argo_compiler.script.syntax.source import Diagnostics


@dataclass(slots=True)
class PlannedRange:
    """A round with the places of its first and last task in the list."""

    round: PlannedGroup
    first: int
    last: int
    order: int
    base: str = ""
    name: str = ""

    @property
    def key(self) -> tuple[int, int, int, int]:
        """Sorts ranges by where they begin, each one before those that lie in it."""
        return (self.first, -self.last, (self.round.name or "").count("/"), -self.order)


def close_rounds(
    plan: Plan, ranges: Sequence[PlannedRange], diagnostics: Diagnostics
) -> dict[int, Item | None]:
    """Puts a place at the end of each round that needs one, and lets the ranges reach to it and to
    all that their conditions lead to.

    Returns what follows each item where nothing else is said, by the identity of the item; None:
    the mission ends. Linear time.
    """
    return _Rounds(plan, ranges, diagnostics).close()


class _Rounds:
    """The ranges over a plan while their ends are put in. Changes the plan and the ranges."""

    def __init__(
        self, plan: Plan, ranges: Sequence[PlannedRange], diagnostics: Diagnostics
    ) -> None:
        self.plan = plan
        self.diagnostics = diagnostics
        self.items = list(plan)
        self.at = {id(item): i for i, item in enumerate(self.items)}
        self.following = {id(item): _following(item) for item in self.items}
        self.owners = self._owners()
        for r in ranges:
            r.last = self._whole_end(r)
        self.ranges = sorted(ranges, key=lambda r: r.key)

    def close(self) -> dict[int, Item | None]:
        open_ways = self._open_ways()
        wanted = {id(r) for r in (*open_ways.values(), *self._led_away())}
        ends: dict[int, Item] = {}
        tails: dict[int, Item] = {}
        bounds: list[tuple[PlannedRange, Item, Item]] = []
        for r in reversed(self.ranges):  # the inner ones first
            last = tails.get(r.last, self.items[r.last])
            if id(r) in wanted:
                last = tails[r.last] = ends[id(r)] = self._put_end(r, last)
            bounds.append((r, self.items[r.first], last))
            self._lead_behind(r, last)
        for item, r in open_ways.items():
            self.following[item] = ends[id(r)]
        at = {id(item): i for i, item in enumerate(self.plan)}
        for r, first, last in bounds:
            r.first, r.last = at[id(first)], at[id(last)]
        return self.following

    # ---- what conditions lead to

    def _owners(self) -> list[int | None]:
        """For each item, the innermost one for which it is carried out in one case only."""
        owners: list[int | None] = []
        around: list[tuple[int, int]] = []
        for i, item in enumerate(self.items):
            while around and around[-1][1] < i:
                around.pop()
            owners.append(around[-1][0] if around else None)
            if item.detour is not None:
                around.append((i, self.at[id(item.detour)]))
        return owners

    def _whole_end(self, r: PlannedRange) -> int:
        """The last of all that the conditions inside of a range lead to."""
        end = r.last
        owner: int | None = r.last
        while owner is not None and owner >= r.first:
            tail = self.items[owner].detour
            if tail is not None:
                end = max(end, self.at[id(tail)])
            owner = self.owners[owner]
        return end

    def _is_branched(self, r: PlannedRange) -> bool:
        """Whether the last task of a range is carried out in one case of its rounds only."""
        owner = self.owners[r.last]
        return owner is not None and owner >= r.first

    # ---- which rounds need a place

    def _open_ways(self) -> dict[int, PlannedRange]:
        """The items that would leave their innermost range without a word, by their identity."""
        found: dict[int, PlannedRange] = {}
        around: list[PlannedRange] = []
        opened = 0
        for i, item in enumerate(self.items):
            while around and around[-1].last < i:
                around.pop()
            while opened < len(self.ranges) and self.ranges[opened].first == i:
                around.append(self.ranges[opened])
                opened += 1
            if not around or item.action is Action.START:
                continue
            last = around[-1].last
            goes_on = i != last and not any(_is_explicit(leg) for leg in item.routes or ())
            if goes_on or any(_is_onward_case(leg) for leg in item.routes or ()):
                following = self.following[id(item)]
                if following is None or self.at[id(following)] > last:
                    found[id(item)] = around[-1]
        return found

    def _led_away(self) -> Iterator[PlannedRange]:
        """The innermost ranges that end with a task which leads elsewhere in one case only."""
        known: set[int] = set()
        for r in reversed(self.ranges):
            legs = [leg for leg in self.items[r.last].routes or () if _is_explicit(leg)]
            case = any(leg.otherwise for leg in legs) or (legs and self._is_branched(r))
            if case and r.last not in known:
                known.add(r.last)
                yield r

    # ---- places

    def _put_end(self, r: PlannedRange, last: Item) -> Item:
        """Puts a place behind the last item of a range, to which it leads on."""
        place = place_item(f"end of '{r.round.title}'", r.round.span)
        self.plan.insert_after(last, place)
        self.following[id(place)] = self.following[id(last)]
        self.following[id(last)] = place
        if not self._is_branched(r):
            _hand_on(last, place)
        return place

    def _lead_behind(self, r: PlannedRange, last: Item) -> None:
        """Lets the place behind a range lead to where its last task led."""
        after = r.round.after
        if after is None or not after.listed:
            return
        if r.first <= self.at[id(after)] <= r.last:
            message = "what follows this repetition would lie among the steps that it repeats"
            hint = "write it behind the last of them, with what follows it"
            self.diagnostics.error("step-range", message, r.round.span, hint)
        elif not self._is_branched(r):
            _hand_on(last, after)


def _following(item: Item) -> Item | None:
    """The item that follows an item and its detours in the list; None: the mission ends."""
    while item.returns is not None:
        item = item.returns
    while item.detour is not None:
        item = item.detour
    following = item.after
    while following is not None and following.action is Action.START:
        following = following.after
    return None if following is None or following.apart else following


def _hand_on(item: Item, place: Item) -> None:
    """Lets a place lead to where an item led then, and the item to what follows it."""
    legs = [leg for leg in item.routes or () if _is_explicit(leg) and not leg.otherwise]
    if legs:
        item.routes = [leg for leg in item.routes or () if leg not in legs]
        place.routes = [*(place.routes or ()), *legs]


def _is_explicit(leg: ResolvedBranch) -> bool:
    """Whether it leads elsewhere in any case."""
    return not leg.alternatives and leg.target is not Plain.GO_ON


def _is_onward_case(leg: ResolvedBranch) -> bool:
    """Whether it goes on in one case."""
    return bool(leg.alternatives) and leg.target is Plain.GO_ON
