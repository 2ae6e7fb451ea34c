"""Reference implementation of routes, written from the docstrings of `argo_compiler.route.problem`.

It shares no code with the package's own evaluation and solvers, so that it shows mistakes that
these have in common. It finds the best route by trying all, for problems of up to about six visits.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations, product
from typing import TypeAlias

from argo_compiler.route import NEVER, Objective, Round, RouteProblem, Tour

Item: TypeAlias = "int | Block"
"""a visit, or a round with its items"""


@dataclass(frozen=True)
class Block:
    """Round with one order of its items."""

    round: Round
    items: tuple[Item, ...]

    @property
    def order(self) -> tuple[int, ...]:
        return tuple(v for item in self.items for v in order_of(item))


@dataclass(frozen=True)
class Robot:
    """State of the robot: its possible locations, the time and the used energy."""

    locations: tuple[int, ...]
    """possible locations; several only after an interrupted round"""
    time: int = 0
    waiting: int = 0
    used: int = 0


@dataclass(frozen=True)
class Best:
    """Best route with its prize and cost."""

    tour: Tour
    prize: int
    cost: int


def order_of(item: Item) -> tuple[int, ...]:
    return (item,) if isinstance(item, int) else item.order


class Reference:
    """Reference evaluation and search for the routes of one problem."""

    def __init__(self, problem: RouteProblem) -> None:
        self.problem = problem
        self.travel: list[list[int]] = problem.travel.tolist()
        battery = problem.battery
        self.energy: list[list[int]] | None = None if battery is None else battery.energy.tolist()
        self.capacity = 0 if battery is None else battery.capacity
        self.start = Robot((problem.size,), used=0 if battery is None else battery.used)
        # Of two rounds with the same members, the later one in the problem is the inner one.
        backwards = reversed(problem.rounds)
        self.rounds = sorted(backwards, key=lambda round_: len(round_.members))

    # Simulation

    def drive(self, robot: Robot, to: int) -> Robot | None:
        """Return the robot at another location, or None if it can't get there."""
        time = max(self.travel[origin][to] for origin in robot.locations)
        used = robot.used
        if self.energy is not None:
            used += max(self.energy[origin][to] for origin in robot.locations)
            if used > self.capacity:
                return None
        if time >= NEVER:
            return None
        return Robot((to,), robot.time + time, robot.waiting, used)

    def visit(self, robot: Robot, number: int) -> Robot | None:
        arrived = self.drive(robot, number)
        if arrived is None:
            return None
        visit = self.problem.visits[number]
        begun = max(arrived.time, visit.earliest)
        if visit.latest is not None and begun > visit.latest:
            return None
        waiting = robot.waiting + begun - arrived.time
        return Robot((number,), begun + visit.service, waiting, arrived.used)

    def charge(self, robot: Robot, charger: int) -> Robot | None:
        arrived = self.drive(robot, self.problem.charger(charger))
        if arrived is None or self.problem.battery is None:
            return None
        time = arrived.time + self.problem.battery.overhead + arrived.used
        return Robot(arrived.locations, time, robot.waiting, 0)

    def make(self, robot: Robot, item: Item) -> Robot | None:
        """Return the robot after a visit or a round, or None if that is infeasible.

        Except for its time, an interrupted repetition of a round counts in full.
        """
        if isinstance(item, int):
            return self.visit(robot, item)
        round_, repetitions, limit = item.round, 0, robot.time + item.round.duration
        while True:
            begun = robot.time
            for inner in item.items:
                moved = self.make(robot, inner)
                if moved is None:
                    return None
                robot = moved
            repetitions += 1
            if round_.duration and robot.time > limit and not round_.soft:
                return Robot(round_.members, limit, robot.waiting, robot.used)
            if round_.duration and (
                robot.time >= limit or (robot.time == begun and repetitions > 1)
            ):
                return robot
            if repetitions == round_.repeat:
                return robot

    # Routes

    def blocks(self, visits: tuple[int, ...]) -> tuple[Item, ...] | None:
        """Return the order with its rounds as blocks, or None if the order splits a round."""
        items: list[Item] = list(visits)
        for round_ in self.rounds:
            members = set(round_.members)
            inside = [k for k, item in enumerate(items) if members & set(order_of(item))]
            if not inside:
                continue
            parts = tuple(items[inside[0] : inside[-1] + 1])
            if sorted(v for item in parts for v in order_of(item)) != sorted(members):
                return None
            items[inside[0] : inside[-1] + 1] = [Block(round_, parts)]
        return tuple(items)

    def is_in_order(self, visits: tuple[int, ...]) -> bool:
        """Return True if the visits, in this order, meet all precedences."""
        positions = {visit: position for position, visit in enumerate(visits)}
        for precedence in self.problem.precedences:
            last, left_out = -1, False
            for visit in precedence.sequence:
                if visit not in positions:
                    left_out = True
                    continue
                if positions[visit] <= last or (left_out and precedence.needed):
                    return False
                last = positions[visit]
        return True

    def evaluate(self, tour: Tour) -> Robot | None:
        """Return the robot at the end of a tour, or None if the tour is infeasible."""
        items = self.blocks(tour.order)
        left_out = set(range(self.problem.size)) - set(tour.order)
        if (
            items is None
            or not self.is_in_order(tour.order)
            or any(self.problem.visits[visit].mandatory for visit in left_out)
        ):
            return None
        charges = dict(tour.charges)
        robot: Robot | None = self.start
        position = 0
        for item in items:
            if position in charges and robot is not None:
                robot = self.charge(robot, charges.pop(position))
            robot = None if robot is None else self.make(robot, item)
            position += len(order_of(item))
        if position in charges and robot is not None:
            robot = self.charge(robot, charges.pop(position))
        if robot is None or charges:
            return None
        robot = self.drive(robot, self.problem.end)
        limit = self.problem.max_duration
        return robot if robot and (limit is None or robot.time <= limit) else None

    def cost(self, robot: Robot) -> int:
        return {
            Objective.DURATION: robot.time,
            Objective.TRAVEL: robot.time - robot.waiting,
            Objective.PRIZE: 0,
        }[self.problem.objective]

    def prize(self, visits: tuple[int, ...]) -> int:
        return sum(self.problem.visits[visit].prize for visit in visits)

    # All routes

    def arrangements(self, visits: set[int], rounds: list[Round]) -> Iterator[list[Item]]:
        """Yield the items of one level of nesting, for each choice of orders of its rounds.

        The items are the visits outside of rounds, and each outermost round in one order of its
        own items. Their order in the result has no meaning.
        """
        rest, choices = set(visits), list[list[Block]]()
        while rounds:
            *rounds, outer = rounds
            inner = [r for r in rounds if set(r.members) <= set(outer.members)]
            rounds = [r for r in rounds if not set(r.members) <= set(outer.members)]
            rest -= set(outer.members)
            choices.append(
                [
                    Block(outer, order)
                    for level in self.arrangements(set(outer.members), inner)
                    for order in permutations(level)
                ]
            )
        for blocks in product(*choices):
            yield [*rest, *blocks]

    def best(self) -> Best | None:
        """Return the best route, or None if there is none."""
        search = Search(self)
        everything = set(range(self.problem.size))
        levels = self.arrangements(everything, self.rounds)
        for level in levels:
            search.extend(self.start, (), (), tuple(level))
        return search.best


class Search:
    """Depth-first search of all routes, except those that can't be better than the best so far."""

    def __init__(self, reference: Reference) -> None:
        self.reference = reference
        self.best: Best | None = None
        self.chargers = range(len(reference.problem.chargers))

    def extend(
        self,
        robot: Robot,
        order: tuple[int, ...],
        charges: tuple[tuple[int, int], ...],
        remaining: tuple[Item, ...],
    ) -> None:
        if self.is_hopeless(robot, order, remaining):
            return
        reference = self.reference
        starts: list[tuple[Robot, tuple[tuple[int, int], ...]]] = [(robot, charges)]
        for charger in self.chargers:
            charged = reference.charge(robot, charger)
            if charged is not None:
                starts.append((charged, (*charges, (len(order), charger))))
        for start, with_charge in starts:
            self.finish(start, order, with_charge, remaining)
        for k, item in enumerate(remaining):
            extended = order + order_of(item)
            if reference.problem.precedences and not reference.is_in_order(extended):
                continue
            for start, with_charge in starts:
                after = reference.make(start, item)
                if after is not None:
                    self.extend(after, extended, with_charge, remaining[:k] + remaining[k + 1 :])

    def is_hopeless(
        self, robot: Robot, order: tuple[int, ...], remaining: tuple[Item, ...]
    ) -> bool:
        limit = self.reference.problem.max_duration
        if limit is not None and robot.time > limit:
            return True
        if self.best is None:
            return False
        possible = self.reference.prize(order) + sum(
            self.reference.prize(order_of(item)) for item in remaining
        )
        return (-possible, self.reference.cost(robot)) >= (-self.best.prize, self.best.cost)

    def finish(
        self,
        robot: Robot,
        order: tuple[int, ...],
        charges: tuple[tuple[int, int], ...],
        remaining: tuple[Item, ...],
    ) -> None:
        problem = self.reference.problem
        if any(problem.visits[visit].mandatory for item in remaining for visit in order_of(item)):
            return
        end = self.reference.drive(robot, problem.end)
        if end is None or (problem.max_duration is not None and end.time > problem.max_duration):
            return
        route = Best(
            Tour(order, dict(charges)), self.reference.prize(order), self.reference.cost(end)
        )
        if self.best is None or (-route.prize, route.cost) < (-self.best.prize, self.best.cost):
            self.best = route


def best_value(problem: RouteProblem) -> tuple[int, int] | None:
    """Return the prize and cost of the best route, or None if there is none."""
    best = Reference(problem).best()
    return None if best is None else (best.prize, best.cost)
