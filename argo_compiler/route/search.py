"""State that all solvers of a search share: best route, bounds, proofs, and the remaining time."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from math import inf

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import RouteProblem, Tour
from argo_compiler.route.pruning import Pruned
from argo_compiler.route.stop import SearchProgress, SolverTurn, StopCriterion


@dataclass(frozen=True)
class Solution:
    """Feasible route, with its value and the solver that found it."""

    tour: Tour
    prize: int
    cost: int
    path: tuple[int, ...] | None
    """nodes of the network that the route visits; None: the network has no nodes for it"""
    charges: Mapping[int, int]
    """number of the charger by the position in the path before which the robot charges"""
    method: str

    def better_than(self, other: "Solution | None") -> bool:
        """Return True if this wins a higher prize, or the same prize at a lower cost.

        It is also True if `other` is None.
        """
        return other is None or (-self.prize, self.cost) < (-other.prize, other.cost)


@dataclass(frozen=True)
class SearchLimits:
    """Limits of a search: time, work, and a criterion; None for each that does not apply."""

    seconds: float | None = None
    work: float | None = None
    """nominal s of work, by the solvers' own count"""
    stop: StopCriterion | None = None


@dataclass(frozen=True)
class Observers:
    """Callbacks that a running search calls, from any thread."""

    on_best: Callable[[SearchProgress, Tour], None] | None = None
    on_bound: Callable[[SearchProgress], None] | None = None


@dataclass
class _SharedState:
    """Mutable state that all views of a search share."""

    clock: Callable[[], float]
    limits: SearchLimits
    observers: Observers
    prize_bound: int
    begun: float
    work: float = 0.0
    iterations: int = 0
    best: Solution | None = None
    better: tuple[float, int] = (0.0, 0)
    bounds: dict[int, int] = field(default_factory=dict)
    """lower bound on the cost of the routes that win at least a prize, by that prize"""
    impossible: bool = False
    stopped: bool = False
    method: str = ""
    reasons: list[str] = field(default_factory=list)
    history: list[SearchProgress] = field(default_factory=list)
    turns: list[SolverTurn] = field(default_factory=list)
    lock: threading.RLock = field(default_factory=threading.RLock)


class Search:
    """View that one solver has of the search for a problem's best route.

    Each view has its own deadline, a share of the remaining time; all views of a search share what
    is found. Solvers in several threads may share one view.
    """

    def __init__(
        self,
        network: StepNetwork,
        pruned: Pruned,
        limits: SearchLimits,
        seed: int,
        clock: Callable[[], float],
        observers: Observers | None = None,
        begun: float | None = None,
    ) -> None:
        """Start the search.

        `clock` returns s from any start; `begun` is the search's start on that clock, None: now.
        """
        self.network, self.pruned, self.seed = network, pruned, seed
        begun = clock() if begun is None else begun
        most = sum(visit.prize for visit in network.problem.visits)
        self._shared = _SharedState(clock, limits, observers or Observers(), most, begun)
        limit = limits.seconds if limits.work is None else limits.work
        self._deadline = inf if limit is None else limit
        self._method = ""
        self._may_prove = True

    @property
    def problem(self) -> RouteProblem:
        return self.network.problem

    # Time

    @property
    def timed(self) -> bool:
        """True if there is no limit of work; under such a limit nothing may depend on time."""
        return self._shared.limits.work is None

    def elapsed_time(self) -> float:
        """Return the time since the search began in s, or its work if that is limited."""
        shared = self._shared
        return shared.clock() - shared.begun if self.timed else shared.work

    def remaining_time(self) -> float:
        """Return the remaining time in s, or the remaining work if that is limited.

        It is 0 as soon as the search is to end, for whatever reason.
        """
        shared, limits = self._shared, self._shared.limits
        if not shared.stopped:
            is_late = limits.seconds is not None and shared.clock() - shared.begun >= limits.seconds
            if is_late or (limits.stop is not None and limits.stop(self.search_progress())):
                shared.stopped = True
        return (
            0.0 if shared.stopped or self.proven else max(0.0, self._deadline - self.elapsed_time())
        )

    def with_time_share(self, share: float, most: float = inf) -> "Search":
        """Return a view of this search with a share of the remaining time, at most `most` s."""
        return self.with_deadline(self.elapsed_time() + min(most, share * self.remaining_time()))

    def with_deadline(self, elapsed_time: float) -> "Search":
        """Return a view of this search that ends when `elapsed_time()` returns `elapsed_time`.

        The deadline of this view applies as well, if it is earlier.
        """
        view = object.__new__(Search)
        view.__dict__.update(self.__dict__)
        view._deadline = min(self._deadline, elapsed_time)
        return view

    @contextmanager
    def turn_of(self, solver: str) -> Iterator["Search"]:
        """Yield a view for one solver's turn: its routes and proofs are attributed to `solver`."""
        view, shared = self.with_deadline(inf), self._shared
        view._method = solver
        begin = shared.clock() - shared.begun
        yield view
        shared.turns.append(SolverTurn(solver, begin, shared.clock() - shared.begun))

    def without_proofs(self) -> "Search":
        """Return a view of this search that ignores reports of bounds and proofs."""
        view = self.with_deadline(inf)
        view._may_prove = False
        return view

    def spend(self, work: float, iterations: int = 0) -> None:
        """Add a solver's work, in nominal s by its own count, and how many routes it has tried."""
        with self._shared.lock:
            self._shared.work += work
            self._shared.iterations += iterations

    def stop(self) -> None:
        """Stop the search, for all its views."""
        self._shared.stopped = True

    # Best route, bounds and proofs

    @property
    def best(self) -> Solution | None:
        return self._shared.best

    @property
    def prize_bound(self) -> int:
        """Upper bound on the prize of any route."""
        return self._shared.prize_bound

    @property
    def bound(self) -> int:
        """Lower bound on the cost of the routes that win `prize_bound`."""
        shared = self._shared
        with shared.lock:
            valid = (b for prize, b in shared.bounds.items() if prize <= shared.prize_bound)
            return max(valid, default=0)

    @property
    def infeasible(self) -> bool:
        """True if it is proven that there is no route."""
        return self._shared.impossible

    @property
    def proven(self) -> bool:
        """True if the best route is proven to be optimal, or the problem to be infeasible."""
        best = self._shared.best
        if best is None or not self.network.exact:
            return self._shared.impossible
        return best.prize >= self._shared.prize_bound and best.cost <= self.bound

    @property
    def proving_or_finding_solver(self) -> str:
        """Name of the solver that completed the proof, or, without one, found the best route.

        It is empty without a route and a proof.
        """
        best = self._shared.best
        return self._shared.method if self.proven or best is None else best.method

    @property
    def reasons(self) -> tuple[str, ...]:
        return tuple(self._shared.reasons)

    @property
    def history(self) -> tuple[SearchProgress, ...]:
        return tuple(self._shared.history)

    @property
    def turns(self) -> tuple[SolverTurn, ...]:
        return tuple(sorted(self._shared.turns, key=lambda turn: turn.begin))

    def search_progress(self) -> SearchProgress:
        """Return the current progress of the search."""
        shared, best = self._shared, self._shared.best
        return SearchProgress(
            shared.clock() - shared.begun,
            shared.work,
            shared.iterations,
            None if best is None else best.prize,
            None if best is None else best.cost,
            shared.prize_bound,
            self.bound,
            shared.better,
        )

    # Reports of solvers

    def add_reason(self, reason: str) -> None:
        """Add a message for the user about how the route was found."""
        self._shared.reasons.append(reason)

    def offer(self, path: Iterable[int], charges: Mapping[int, int] | None = None) -> bool:
        """Offer a route as nodes of the network, and return True if it is better than the best one.

        `charges`: number of the charger by the position in the path before which the robot charges.
        Raises Invalid if the route violates a constraint.
        """
        path, charges = tuple(path), dict(charges or {})
        return self._offer(self.network.route(path, charges), path, charges)

    def offer_tour(self, tour: Tour) -> bool:
        """Offer a route as visits, and return True if it is better than the best one.

        Raises Invalid if the route violates a constraint.
        """
        path, charges = self.network.tour_path(tour)
        return self._offer(tour, path, charges)

    def _offer(self, tour: Tour, path: tuple[int, ...] | None, charges: Mapping[int, int]) -> bool:
        evaluation = evaluate(self.problem, tour)
        if not evaluation.feasible:
            raise Invalid(
                Message(
                    "solver {method} offers a route that violates a constraint: {violation}",
                    method=repr(self._method),
                    violation=evaluation.violations[0],
                )
            )
        cost = evaluation.cost(self.problem.objective)
        solution = Solution(tour, evaluation.prize, cost, path, charges, self._method)
        shared = self._shared
        with shared.lock:
            if not solution.better_than(shared.best):
                return False
            shared.best = solution
            shared.better = shared.clock() - shared.begun, shared.iterations
            self._record()
        if shared.observers.on_best:
            shared.observers.on_best(self.search_progress(), tour)
        return True

    def report_bounds(
        self, prize_bound: int | None = None, bound: int | None = None, least_prize: int = 0
    ) -> None:
        """Report proven bounds on all routes of the network.

        No route wins more than `prize_bound`; no route that wins at least `least_prize` costs less
        than `bound`. No-op if the network does not have all routes that may be optimal, or this
        is a view `without_proofs`.
        """
        shared = self._shared
        if not (self.network.exact and self._may_prove):
            return
        with shared.lock:
            previous = shared.prize_bound, self.bound
            if prize_bound is not None:
                shared.prize_bound = min(shared.prize_bound, prize_bound)
            if bound is not None and bound > shared.bounds.get(least_prize, 0):
                shared.bounds[least_prize] = bound
            if previous == (shared.prize_bound, self.bound):
                return
            self._record()
        if shared.observers.on_bound:
            shared.observers.on_bound(self.search_progress())

    def report_infeasible(self) -> None:
        """Report the proof that the network has no route.

        No-op if the network does not have all routes that may be optimal, or this is a view
        `without_proofs`.
        """
        if not (self.network.exact and self._may_prove):
            return
        with self._shared.lock:
            self._shared.impossible = True
            self._record()

    def _record(self) -> None:
        """Append the state of the search to its history, with the name of this view's solver.

        Raises Conflict if the best route contradicts a reported bound or proof.
        """
        shared, best = self._shared, self._shared.best
        wins_too_much = best is not None and best.prize > shared.prize_bound
        costs_too_little = (
            best is not None and best.prize >= shared.prize_bound and best.cost < self.bound
        )
        if (shared.impossible and best is not None) or wins_too_much or costs_too_little:
            raise Conflict(
                Message(
                    "solver {method}: its result contradicts another result for this route "
                    "problem (a route, a bound or a proof); please report it with the problem",
                    method=repr(self._method),
                )
            )
        shared.method = self._method or shared.method
        shared.history.append(replace(self.search_progress(), solver=self._method))
