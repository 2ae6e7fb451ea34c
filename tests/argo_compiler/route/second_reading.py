"""What a route means, read a second time: from what `argo_compiler.route.problem` says alone.

Nothing here comes from the package's own evaluation or solvers, so that a mistake in what they
share shows. The best route is found by trying all: for problems of some six visits.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations, product
from typing import TypeAlias

from argo_compiler.route import NEVER, Objective, Round, RouteProblem, Tour

Item: TypeAlias = "int | Block"
"""a visit, or a round with what lies in it"""


@dataclass(frozen=True)
class Block:
    """A round, in one order of what lies in it."""

    round: Round
    items: tuple[Item, ...]

    @property
    def order(self) -> tuple[int, ...]:
        return tuple(v for item in self.items for v in order_of(item))


@dataclass(frozen=True)
class Robot:
    """Where the robot may be, when, and with what used of its battery."""

    places: tuple[int, ...]
    """it is at one of these: several only where a round was left in its middle"""
    time: int = 0
    waiting: int = 0
    used: int = 0


@dataclass(frozen=True)
class Best:
    """What the best route wins and costs."""

    tour: Tour
    prize: int
    cost: int


def order_of(item: Item) -> tuple[int, ...]:
    return (item,) if isinstance(item, int) else item.order


class Reading:
    """One problem, and what its routes mean."""

    def __init__(self, problem: RouteProblem) -> None:
        self.problem = problem
        self.travel: list[list[int]] = problem.travel.tolist()
        battery = problem.battery
        self.energy: list[list[int]] | None = None if battery is None else battery.energy.tolist()
        self.capacity = 0 if battery is None else battery.capacity
        self.start = Robot((problem.size,), used=0 if battery is None else battery.used)
        # Of two rounds with the same members, the later one in the problem lies within.
        backwards = reversed(problem.rounds)
        self.rounds = sorted(backwards, key=lambda one: len(one.members))

    # What happens on the way

    def go(self, robot: Robot, to: int) -> Robot | None:
        """The robot at another place; None: it can't get there."""
        time = max(self.travel[place][to] for place in robot.places)
        used = robot.used
        if self.energy is not None:
            used += max(self.energy[place][to] for place in robot.places)
            if used > self.capacity:
                return None
        if time >= NEVER:
            return None
        return Robot((to,), robot.time + time, robot.waiting, used)

    def visit(self, robot: Robot, number: int) -> Robot | None:
        there = self.go(robot, number)
        if there is None:
            return None
        what = self.problem.visits[number]
        begun = max(there.time, what.earliest)
        if what.latest is not None and begun > what.latest:
            return None
        waiting = robot.waiting + begun - there.time
        return Robot((number,), begun + what.service, waiting, there.used)

    def charge(self, robot: Robot, charger: int) -> Robot | None:
        there = self.go(robot, self.problem.charger(charger))
        if there is None or self.problem.battery is None:
            return None
        time = there.time + self.problem.battery.overhead + there.used
        return Robot(there.places, time, robot.waiting, 0)

    def make(self, robot: Robot, item: Item) -> Robot | None:
        """The robot after a visit or a round; a round that has begun counts as a whole, whether
        or not it is left in its middle, but for its time."""
        if isinstance(item, int):
            return self.visit(robot, item)
        one, rounds, over = item.round, 0, robot.time + item.round.duration
        while True:
            begun = robot.time
            for inner in item.items:
                moved = self.make(robot, inner)
                if moved is None:
                    return None
                robot = moved
            rounds += 1
            if one.duration and robot.time > over and not one.soft:
                return Robot(one.members, over, robot.waiting, robot.used)
            if one.duration and (robot.time >= over or (robot.time == begun and rounds > 1)):
                return robot
            if rounds == one.repeat:
                return robot

    # Routes

    def blocks(self, visits: tuple[int, ...]) -> tuple[Item, ...] | None:
        """The order with its rounds; None where the order tears one apart."""
        items: list[Item] = list(visits)
        for one in self.rounds:
            members = set(one.members)
            inside = [k for k, item in enumerate(items) if members & set(order_of(item))]
            if not inside:
                continue
            taken = tuple(items[inside[0] : inside[-1] + 1])
            if sorted(v for item in taken for v in order_of(item)) != sorted(members):
                return None
            items[inside[0] : inside[-1] + 1] = [Block(one, taken)]
        return tuple(items)

    def in_order(self, visits: tuple[int, ...]) -> bool:
        """Whether these visits, in this order, keep to all precedences."""
        where = {visit: position for position, visit in enumerate(visits)}
        for precedence in self.problem.precedences:
            last, left_out = -1, False
            for visit in precedence.sequence:
                if visit not in where:
                    left_out = True
                    continue
                if where[visit] <= last or (left_out and precedence.needed):
                    return False
                last = where[visit]
        return True

    def evaluate(self, tour: Tour) -> Robot | None:
        """The robot at the end of a tour; None where the tour can't be made, or may not be."""
        items = self.blocks(tour.order)
        left_out = set(range(self.problem.size)) - set(tour.order)
        if (
            items is None
            or not self.in_order(tour.order)
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
        robot = self.go(robot, self.problem.end)
        longest = self.problem.max_duration
        return robot if robot and (longest is None or robot.time <= longest) else None

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
        """The visits that lie in no round, and for each round that lies in no other one order of
        what lies in it: all that a level consists of, in one order."""
        rest, parts = set(visits), list[list[Block]]()
        while rounds:
            *rounds, outer = rounds
            within = [one for one in rounds if set(one.members) <= set(outer.members)]
            rounds = [one for one in rounds if not set(one.members) <= set(outer.members)]
            rest -= set(outer.members)
            parts.append(
                [
                    Block(outer, order)
                    for level in self.arrangements(set(outer.members), within)
                    for order in permutations(level)
                ]
            )
        for blocks in product(*parts):
            yield [*rest, *blocks]

    def best(self) -> Best | None:
        """The best route; None where there is none."""
        search = Search(self)
        everything = set(range(self.problem.size))
        levels = self.arrangements(everything, self.rounds)
        for level in levels:
            search.extend(self.start, (), (), tuple(level))
        return search.best


class Search:
    """All routes, depth first, less those that can't become better than the best so far."""

    def __init__(self, reading: Reading) -> None:
        self.reading = reading
        self.best: Best | None = None
        self.chargers = range(len(reading.problem.chargers))

    def extend(
        self,
        robot: Robot,
        order: tuple[int, ...],
        charges: tuple[tuple[int, int], ...],
        left: tuple[Item, ...],
    ) -> None:
        if self.hopeless(robot, order, left):
            return
        reading = self.reading
        starts: list[tuple[Robot, tuple[tuple[int, int], ...]]] = [(robot, charges)]
        for charger in self.chargers:
            charged = reading.charge(robot, charger)
            if charged is not None:
                starts.append((charged, (*charges, (len(order), charger))))
        for begun, with_charge in starts:
            self.finish(begun, order, with_charge, left)
        for k, item in enumerate(left):
            extended = order + order_of(item)
            if reading.problem.precedences and not reading.in_order(extended):
                continue
            for begun, with_charge in starts:
                made = reading.make(begun, item)
                if made is not None:
                    self.extend(made, extended, with_charge, left[:k] + left[k + 1 :])

    def hopeless(self, robot: Robot, order: tuple[int, ...], left: tuple[Item, ...]) -> bool:
        longest = self.reading.problem.max_duration
        if longest is not None and robot.time > longest:
            return True
        if self.best is None:
            return False
        possible = self.reading.prize(order) + sum(
            self.reading.prize(order_of(item)) for item in left
        )
        return (-possible, self.reading.cost(robot)) >= (-self.best.prize, self.best.cost)

    def finish(
        self,
        robot: Robot,
        order: tuple[int, ...],
        charges: tuple[tuple[int, int], ...],
        left: tuple[Item, ...],
    ) -> None:
        problem = self.reading.problem
        if any(problem.visits[visit].mandatory for item in left for visit in order_of(item)):
            return
        end = self.reading.go(robot, problem.end)
        if end is None or (problem.max_duration is not None and end.time > problem.max_duration):
            return
        found = Best(Tour(order, dict(charges)), self.reading.prize(order), self.reading.cost(end))
        if self.best is None or (-found.prize, found.cost) < (-self.best.prize, self.best.cost):
            self.best = found


def best_worth(problem: RouteProblem) -> tuple[int, int] | None:
    """The prize and cost of the best route; None: there is none."""
    best = Reading(problem).best()
    return None if best is None else (best.prize, best.cost)
