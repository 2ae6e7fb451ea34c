"""What a route means, and what it costs: the definition that every solver is held against.

Written for reading, and on purpose without anything that the solvers use.
"""

from dataclasses import dataclass

from argo_compiler.base.errors import Invalid
from argo_compiler.route.problem import NEVER, Objective, Round, RouteProblem, Tour


@dataclass(frozen=True)
class RouteEvaluation:
    """What a route is worth; times in the problem's units."""

    prize: int
    """of all visits that are made"""
    duration: int
    """when the robot is at the end"""
    waiting: int
    """how much of it it waits for time windows"""
    arrivals: tuple[int, ...]
    """when each visit of the order begins, in the first of its rounds"""
    violations: tuple[str, ...]
    """what the route does not keep to; empty: it is feasible"""

    @property
    def feasible(self) -> bool:
        return not self.violations

    def cost(self, objective: Objective) -> int:
        """What the objective makes small."""
        match objective:
            case Objective.DURATION:
                return self.duration
            case Objective.TRAVEL:
                return self.duration - self.waiting
            case Objective.PRIZE:
                return 0


def evaluate(problem: RouteProblem, route: Tour) -> RouteEvaluation:
    """What the route is worth, and what it does not keep to.

    Raises Invalid if it names a visit or a charger that there isn't.
    """
    if not set(route.order) <= set(range(problem.size)):
        raise Invalid(f"a route makes a visit that there isn't: there are {problem.size}, from 0")
    if not set(route.charges.values()) <= set(range(len(problem.chargers))):
        raise Invalid(f"a route uses a charger that there isn't: there are {len(problem.chargers)}")
    return _Walk(problem, route).evaluation()


def after_rounds(
    problem: RouteProblem, number: int, order: tuple[int, ...], places: frozenset[int]
) -> tuple[int, int, frozenset[int]] | None:
    """Time, energy used and where the robot may be after all rounds of an outermost Round whose
    members come in the order given, counted from the places from which it is entered; None: that
    can't be."""
    walk = _Walk(problem, Tour(order))
    state = walk._rounds(_State(0, 0, places), number, order)
    return None if walk._violations else (state.time, state.used, state.places)


@dataclass(frozen=True)
class _State:
    """Between two visits. `places`: where the robot may be: it is reckoned with the worst."""

    time: int
    used: int
    places: frozenset[int]


class _Walk:
    """Follows a route. Collects violations and arrivals."""

    def __init__(self, problem: RouteProblem, route: Tour) -> None:
        self._problem, self._route = problem, route
        self._violations: list[str] = []
        self._arrivals: dict[int, int] = {}
        self._waiting = 0

    def evaluation(self) -> RouteEvaluation:
        problem, order = self._problem, self._route.order
        prize = sum(problem.visits[visit].prize for visit in set(order))
        self._check_precedences()
        if not self._check_selection():
            nowhere = (NEVER,) * len(order)
            return RouteEvaluation(prize, NEVER, 0, nowhere, tuple(self._violations))
        used = 0 if problem.battery is None else problem.battery.used
        state = _State(0, used, frozenset([problem.size]))
        position, between = 0, {len(order)}
        while position < len(order):
            between.add(position)
            state = self._charge(state, position)
            whole = self._outermost(order[position])
            if whole is None:
                state = self._visit(state, order[position])
                position += 1
            else:
                size = len(problem.rounds[whole].members)
                state = self._rounds(state, whole, order[position : position + size])
                position += size
        state = self._drive(self._charge(state, len(order)), problem.end)
        duration = state.time
        if problem.max_duration is not None and duration > problem.max_duration:
            self._violations.append(f"it takes {duration}, longer than {problem.max_duration}")
        if not set(self._route.charges) <= between:
            self._violations.append("it charges within a round, or outside of the order")
        arrivals = tuple(self._arrivals.get(visit, NEVER) for visit in order)
        return RouteEvaluation(prize, duration, self._waiting, arrivals, tuple(self._violations))

    def _check_selection(self) -> bool:
        """Whether there is a way to follow: no round is torn, and no visit made twice."""
        order, whole = self._route.order, len(set(self._route.order)) == len(self._route.order)
        if len(set(order)) < len(order):
            self._violations.append("a visit is made twice")
        for number, visit in enumerate(self._problem.visits):
            if visit.mandatory and number not in order:
                self._violations.append(f"{visit.name} is left out")
        for one in self._problem.rounds:
            made = sorted(k for k, visit in enumerate(order) if visit in one.members)
            if made and (
                len(made) != len(one.members) or made[-1] - made[0] + 1 != len(one.members)
            ):
                self._violations.append(f"{one.name} is not made as one")
                whole = False
        return whole

    def _check_precedences(self) -> None:
        position = {visit: k for k, visit in enumerate(self._route.order)}
        for precedence in self._problem.precedences:
            places = [position.get(visit) for visit in precedence.sequence]
            there = [place for place in places if place is not None]
            if there != sorted(set(there)):
                self._violations.append(precedence.words)
            elif precedence.needed and None in places[: len(there)]:
                self._violations.append(f"{precedence.words}: the first is left out")

    def _outermost(self, visit: int) -> int | None:
        """The number of the outermost round around a visit."""
        around = self._around(visit)
        return around[0] if around else None

    def _around(self, visit: int) -> list[int]:
        """The rounds around a visit, from the outermost; of equal ones the first is outside."""
        rounds = self._problem.rounds
        numbers = [k for k, one in enumerate(rounds) if visit in one.members]
        return sorted(numbers, key=lambda k: (-len(rounds[k].members), k))

    def _charge(self, state: _State, position: int) -> _State:
        battery, number = self._problem.battery, self._route.charges.get(position)
        if battery is None or number is None:
            return state
        there = self._drive(state, self._problem.charger(number))
        return _State(there.time + battery.overhead + there.used, 0, there.places)

    def _drive(self, state: _State, place: int) -> _State:
        """To the place, and what energy is used there as well."""
        problem = self._problem
        time = max(int(problem.travel[origin, place]) for origin in state.places)
        if time == NEVER:
            self._violations.append("there is no way")
        used = state.used
        if problem.battery is not None:
            energy = max(int(problem.battery.energy[origin, place]) for origin in state.places)
            used += energy
            if used > problem.battery.capacity:
                self._violations.append("the battery is empty")
        return _State(state.time + time, used, frozenset([place]))

    def _visit(self, state: _State, number: int) -> _State:
        visit = self._problem.visits[number]
        there = self._drive(state, number)
        begin = max(there.time, visit.earliest)
        self._waiting += begin - there.time
        self._arrivals.setdefault(number, begin)
        if visit.latest is not None and begin > visit.latest:
            self._violations.append(f"{visit.name} is begun at {begin}, after {visit.latest}")
        return _State(begin + visit.service, there.used, there.places)

    def _rounds(self, state: _State, number: int, order: tuple[int, ...]) -> _State:
        """All rounds of one Round, whose members come in the order given."""
        one = self._problem.rounds[number]
        entered, rounds = state.time, 0
        while self._wants_another(one, rounds, state.time - entered):
            begun = state.time
            state = self._one_round(state, number, order)
            rounds += 1
            if one.duration and rounds > 1 and state.time == begun:
                return state  # rounds that take no time would never fill it
            if one.duration and not one.soft and state.time - entered > one.duration:
                return _State(entered + one.duration, state.used, frozenset(one.members))
        return state

    def _wants_another(self, one: Round, rounds: int, elapsed: int) -> bool:
        if rounds == 0:
            return True
        return (not one.repeat or rounds < one.repeat) and (
            not one.duration or elapsed < one.duration
        )

    def _one_round(self, state: _State, number: int, order: tuple[int, ...]) -> _State:
        position = 0
        while position < len(order):
            around = self._around(order[position])
            inside = around[around.index(number) + 1 :]
            if inside:
                size = len(self._problem.rounds[inside[0]].members)
                state = self._rounds(state, inside[0], order[position : position + size])
                position += size
            else:
                state = self._visit(state, order[position])
                position += 1
        return state
