"""Meaning and cost of a route: the definition that all solvers must agree with.

The code is written to be read, and on purpose uses no code of the solvers.
"""

from dataclasses import dataclass

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.problem import NEVER, Objective, Round, RouteProblem, Tour


@dataclass(frozen=True)
class RouteEvaluation:
    """Prize, times and violations of a route; times in the problem's units."""

    prize: int
    """sum of the prizes of the visits that are made"""
    duration: int
    """time when the robot reaches the end"""
    waiting: int
    """part of the duration in which the robot waits for time windows"""
    arrivals: tuple[int, ...]
    """time when each visit of the order begins, in the first repetition of its round"""
    violations: tuple[str, ...]
    """violated constraints, as messages; empty: the route is feasible"""

    @property
    def feasible(self) -> bool:
        return not self.violations

    def cost(self, objective: Objective) -> int:
        """Return the value that the objective minimises: a time in units of time; 0 for PRIZE."""
        match objective:
            case Objective.DURATION:
                return self.duration
            case Objective.TRAVEL:
                return self.duration - self.waiting
            case Objective.PRIZE:
                return 0


def evaluate(problem: RouteProblem, route: Tour) -> RouteEvaluation:
    """Compute the prize, the times and the violated constraints of a route.

    Raises Invalid if the route names a visit or a charger that does not exist.
    """
    if not set(route.order) <= set(range(problem.size)):
        raise Invalid(
            Message(
                "the route has a visit that does not exist: use the numbers of the "
                "problem's {size} visits, which are counted from 0",
                size=problem.size,
            )
        )
    if not set(route.charges.values()) <= set(range(len(problem.chargers))):
        raise Invalid(
            Message(
                "the route uses a charger that does not exist: use the numbers of the "
                "problem's {count} chargers, which are counted from 0",
                count=len(problem.chargers),
            )
        )
    return _Simulation(problem, route).evaluation()


def state_after_all_repetitions(
    problem: RouteProblem, round_index: int, order: tuple[int, ...], locations: frozenset[int]
) -> tuple[int, int, frozenset[int]] | None:
    """Compute the robot's state after all repetitions of an outermost Round.

    Returns the time and the energy used since the robot left one of `locations`, and the possible
    locations at the end; None if that is infeasible. `round_index`: position of the round in
    `problem.rounds`. `order`: the round's members in their order.
    """
    simulation = _Simulation(problem, Tour(order))
    state = simulation._rounds(_State(0, 0, locations), round_index, order)
    return None if simulation._violations else (state.time, state.used, state.locations)


@dataclass(frozen=True)
class _State:
    """State of the robot between two visits.

    It may be at any of `locations`; the worst one counts for the next drive.
    """

    time: int
    used: int
    locations: frozenset[int]


class _Simulation:
    """Simulation of one route, which collects violations and arrivals."""

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
            no_arrivals = (NEVER,) * len(order)
            return RouteEvaluation(prize, NEVER, 0, no_arrivals, tuple(self._violations))
        used = 0 if problem.battery is None else problem.battery.used
        state = _State(0, used, frozenset([problem.size]))
        position, charge_positions = 0, {len(order)}
        while position < len(order):
            charge_positions.add(position)
            state = self._charge(state, position)
            outermost = self._outermost(order[position])
            if outermost is None:
                state = self._visit(state, order[position])
                position += 1
            else:
                size = len(problem.rounds[outermost].members)
                state = self._rounds(state, outermost, order[position : position + size])
                position += size
        state = self._drive(self._charge(state, len(order)), problem.end)
        duration = state.time
        if problem.max_duration is not None and duration > problem.max_duration:
            self._violations.append(
                Message(
                    "it takes {duration}, longer than {max_duration}",
                    duration=duration,
                    max_duration=problem.max_duration,
                )
            )
        if not set(self._route.charges) <= charge_positions:
            self._violations.append(Message("it charges within a round, or outside of the order"))
        arrivals = tuple(self._arrivals.get(visit, NEVER) for visit in order)
        return RouteEvaluation(prize, duration, self._waiting, arrivals, tuple(self._violations))

    def _check_selection(self) -> bool:
        """Return True if the order can be simulated: no visit is in it twice, no round is split.

        Adds the violations of the selection: visits made twice or left out, and split rounds.
        """
        order, valid = self._route.order, len(set(self._route.order)) == len(self._route.order)
        if len(set(order)) < len(order):
            self._violations.append(Message("a visit is made twice"))
        for number, visit in enumerate(self._problem.visits):
            if visit.mandatory and number not in order:
                self._violations.append(Message("{visit} is left out", visit=visit.name))
        for round_ in self._problem.rounds:
            positions = sorted(k for k, visit in enumerate(order) if visit in round_.members)
            if positions and (
                len(positions) != len(round_.members)
                or positions[-1] - positions[0] + 1 != len(round_.members)
            ):
                self._violations.append(
                    Message("{round} is incomplete or interrupted", round=round_.name)
                )
                valid = False
        return valid

    def _check_precedences(self) -> None:
        position = {visit: k for k, visit in enumerate(self._route.order)}
        for precedence in self._problem.precedences:
            positions = [position.get(visit) for visit in precedence.sequence]
            made = [place for place in positions if place is not None]
            if made != sorted(set(made)):
                self._violations.append(precedence.words)
            elif precedence.needed and None in positions[: len(made)]:
                self._violations.append(
                    Message("{words}: the first is left out", words=precedence.words)
                )

    def _outermost(self, visit: int) -> int | None:
        """Return the number of the outermost round around a visit, or None if there is none."""
        enclosing = self._rounds_around(visit)
        return enclosing[0] if enclosing else None

    def _rounds_around(self, visit: int) -> list[int]:
        """Return the rounds around a visit, from the outermost.

        Of two rounds with the same members, the first one of the problem is the outer one.
        """
        rounds = self._problem.rounds
        numbers = [k for k, round_ in enumerate(rounds) if visit in round_.members]
        return sorted(numbers, key=lambda k: (-len(rounds[k].members), k))

    def _charge(self, state: _State, position: int) -> _State:
        battery, number = self._problem.battery, self._route.charges.get(position)
        if battery is None or number is None:
            return state
        arrival = self._drive(state, self._problem.charger(number))
        return _State(arrival.time + battery.overhead + arrival.used, 0, arrival.locations)

    def _drive(self, state: _State, location: int) -> _State:
        """Return the state on arrival at a location, before waiting and service.

        Its energy alone already includes that of the service there.
        """
        problem = self._problem
        time = max(int(problem.travel[origin, location]) for origin in state.locations)
        if time == NEVER:
            self._violations.append(Message("there is no path"))
        used = state.used
        if problem.battery is not None:
            energy = max(
                int(problem.battery.energy[origin, location]) for origin in state.locations
            )
            used += energy
            if used > problem.battery.capacity:
                self._violations.append(Message("the battery is empty"))
        return _State(state.time + time, used, frozenset([location]))

    def _visit(self, state: _State, number: int) -> _State:
        visit = self._problem.visits[number]
        arrival = self._drive(state, number)
        begin = max(arrival.time, visit.earliest)
        self._waiting += begin - arrival.time
        self._arrivals.setdefault(number, begin)
        if visit.latest is not None and begin > visit.latest:
            self._violations.append(
                Message(
                    "{visit} begins at {begin}, after {latest}",
                    visit=visit.name,
                    begin=begin,
                    latest=visit.latest,
                )
            )
        return _State(begin + visit.service, arrival.used, arrival.locations)

    def _rounds(self, state: _State, number: int, order: tuple[int, ...]) -> _State:
        """Return the state after all repetitions of a round, with its members in `order`."""
        round_ = self._problem.rounds[number]
        entered, repetitions = state.time, 0
        while self._is_repeated(round_, repetitions, state.time - entered):
            begun = state.time
            state = self._one_repetition(state, number, order)
            repetitions += 1
            if round_.duration and repetitions > 1 and state.time == begun:
                return state  # repetitions that take no time would never fill the duration
            if round_.duration and not round_.soft and state.time - entered > round_.duration:
                return _State(entered + round_.duration, state.used, frozenset(round_.members))
        return state

    def _is_repeated(self, round_: Round, repetitions: int, elapsed: int) -> bool:
        if repetitions == 0:
            return True
        return (not round_.repeat or repetitions < round_.repeat) and (
            not round_.duration or elapsed < round_.duration
        )

    def _one_repetition(self, state: _State, number: int, order: tuple[int, ...]) -> _State:
        position = 0
        while position < len(order):
            enclosing = self._rounds_around(order[position])
            inside = enclosing[enclosing.index(number) + 1 :]
            if inside:
                size = len(self._problem.rounds[inside[0]].members)
                state = self._rounds(state, inside[0], order[position : position + size])
                position += size
            else:
                state = self._visit(state, order[position])
                position += 1
        return state
