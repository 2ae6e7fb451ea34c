"""The best route by trying all of them, by what a route costs by definition and nothing else."""

from itertools import permutations

from argo_compiler.route import Objective, RouteProblem, Tour, evaluate
from argo_compiler.route.evaluation import _State, _Walk


def brute_force(problem: RouteProblem) -> tuple[int, int] | None:
    """The prize and cost of the best route; None: there is none."""
    return _Search(problem).best


class _Search:
    def __init__(self, problem: RouteProblem) -> None:
        self._problem = problem
        self._walk = _Walk(problem, Tour(()))
        self.best: tuple[int, int] | None = None
        self._spans = self._outermost()
        used = 0 if problem.battery is None else problem.battery.used
        self._go_on(_State(0, used, frozenset([problem.size])), (), {})

    def _outermost(self) -> list[tuple[int, ...]]:
        """What is made as one: single visits and outermost rounds, in each of their orders."""
        problem, spans, inside = self._problem, [], set()
        ordered = sorted(
            range(len(problem.rounds)), key=lambda k: (-len(problem.rounds[k].members), k)
        )
        for number in ordered:
            members = problem.rounds[number].members
            if inside.isdisjoint(members):
                inside |= set(members)
                spans += self._orders(number)
        return spans + [(visit,) for visit in range(problem.size) if visit not in inside]

    def _orders(self, number: int) -> list[tuple[int, ...]]:
        """The orders of a round's members that keep those inside it together; with a duration
        somewhere, each such round in its shortest."""
        problem = self._problem
        members = problem.rounds[number].members
        inside = [
            k
            for k, one in enumerate(problem.rounds)
            if set(one.members) <= set(members) and k != number
            and (len(one.members) < len(members) or k > number)
        ]  # fmt: skip
        orders = []
        for order in permutations(members):
            places = {visit: k for k, visit in enumerate(order)}
            whole = all(
                max(places[v] for v in problem.rounds[k].members)
                - min(places[v] for v in problem.rounds[k].members)
                < len(problem.rounds[k].members)
                for k in inside
            )
            legal = all(
                not (a in places and b in places) or places[a] < places[b]
                for precedence in problem.precedences
                for i, a in enumerate(precedence.sequence)
                for b in precedence.sequence[i + 1 :]
            )
            if whole and legal:
                orders.append(order)
        for k in [*inside, number]:
            if problem.rounds[k].duration:
                orders = self._shortest(k, orders)
        return orders

    def _shortest(self, number: int, orders: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
        members = set(self._problem.rounds[number].members)

        def again(order: tuple[int, ...]) -> int:
            part = tuple(visit for visit in order if visit in members)
            walk = _Walk(self._problem, Tour(()))
            once = walk._one_round(_State(0, 0, frozenset([part[0]])), number, part)
            return walk._one_round(_State(0, 0, once.places), number, part).time

        times = [again(order) for order in orders]
        return [o for o, t in zip(orders, times, strict=True) if t == min(times)]

    def _go_on(self, state: _State, order: tuple[int, ...], charges: dict[int, int]) -> None:
        problem, walk = self._problem, self._walk
        self._end(order, charges)
        if not problem.selective and self.best is not None:
            passed = state.time - (0 if problem.objective is Objective.DURATION else walk._waiting)
            if passed >= self.best[1]:
                return
        made = set(order)
        chargers = [None, *range(len(problem.chargers))]
        for span in self._spans:
            if made.isdisjoint(span):
                for charger in chargers:
                    walk._violations, waiting, arrivals = [], walk._waiting, dict(walk._arrivals)
                    walk._route = Tour((), {} if charger is None else {0: charger})
                    there = walk._charge(state, 0)
                    whole = walk._outermost(span[0])
                    there = (
                        walk._visit(there, span[0])
                        if whole is None
                        else walk._rounds(there, whole, span)
                    )
                    late = problem.max_duration is not None and there.time > problem.max_duration
                    if not walk._violations and not late:
                        more = {} if charger is None else {len(order): charger}
                        self._go_on(there, order + span, charges | more)
                    walk._waiting, walk._arrivals = waiting, arrivals

    def _end(self, order: tuple[int, ...], charges: dict[int, int]) -> None:
        problem = self._problem
        if any(v.mandatory and k not in order for k, v in enumerate(problem.visits)):
            return
        for charger in [None, *range(len(problem.chargers))]:
            last = {} if charger is None else {len(order): charger}
            worth = evaluate(problem, Tour(order, charges | last))
            if worth.feasible:
                cost = worth.cost(problem.objective)
                prize = worth.prize
                if self.best is None or (-prize, cost) < (-self.best[0], self.best[1]):
                    self.best = prize, cost
