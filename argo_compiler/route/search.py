"""What a search has found and proven, and the time that it has: what all its solvers share."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from math import inf

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import RouteProblem, Tour
from argo_compiler.route.pruning import Pruned
from argo_compiler.route.stop import SearchProgress, SolverTurn, StopCriterion


@dataclass(frozen=True)
class Solution:
    """A route that keeps to everything."""

    tour: Tour
    prize: int
    cost: int
    path: tuple[int, ...] | None
    """its nodes of the network; None: it has others"""
    charges: Mapping[int, int]
    """the charger by the position in the path before which it is used"""
    method: str

    def better_than(self, other: "Solution | None") -> bool:
        """Whether it wins more, or as much at less cost."""
        return other is None or (-self.prize, self.cost) < (-other.prize, other.cost)


@dataclass(frozen=True)
class SearchLimits:
    """When a search ends."""

    seconds: float | None = None
    work: float | None = None
    """s by the solvers' own count"""
    stop: StopCriterion | None = None


@dataclass(frozen=True)
class Observers:
    """Who is told while a search runs, from whatever thread."""

    on_best: Callable[[SearchProgress, Tour], None] | None = None
    on_bound: Callable[[SearchProgress], None] | None = None


@dataclass
class _Known:
    """What all views of a search share. Has state."""

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
    """what no route costs less than that wins at least so much"""
    impossible: bool = False
    stopped: bool = False
    method: str = ""
    reasons: list[str] = field(default_factory=list)
    history: list[SearchProgress] = field(default_factory=list)
    turns: list[SolverTurn] = field(default_factory=list)
    lock: threading.RLock = field(default_factory=threading.RLock)


class Search:
    """The search for the best route of one problem, as one solver sees it: with a share of the time
    that is left. Solvers in several threads may share one."""

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
        """`clock` in s, of whatever begin; `begun`: on it, now if it is None."""
        self.network, self.pruned, self.seed = network, pruned, seed
        begun = clock() if begun is None else begun
        most = sum(visit.prize for visit in network.problem.visits)
        self._known = _Known(clock, limits, observers or Observers(), most, begun)
        limit = limits.seconds if limits.work is None else limits.work
        self._deadline = inf if limit is None else limit
        self._method = ""

    @property
    def problem(self) -> RouteProblem:
        return self.network.problem

    # Time

    @property
    def timed(self) -> bool:
        """Whether the limit is one of time; else nothing may depend on time."""
        return self._known.limits.work is None

    def now(self) -> float:
        """s since the search began, of time or of work."""
        known = self._known
        return known.clock() - known.begun if self.timed else known.work

    def left(self) -> float:
        """s of time or of work that are left; 0 when the search is over."""
        known, limits = self._known, self._known.limits
        if not known.stopped:
            late = limits.seconds is not None and known.clock() - known.begun >= limits.seconds
            if late or (limits.stop is not None and limits.stop(self.progress())):
                known.stopped = True
        return 0.0 if known.stopped or self.done else max(0.0, self._deadline - self.now())

    def part(self, share: float, most: float = inf) -> "Search":
        """The same search with a share of the time that is left, and not more than `most` s."""
        return self.until(self.now() + min(most, share * self.left()))

    def until(self, deadline: float) -> "Search":
        """The same search until then on the clock of `now`, or until its own end if that is
        sooner."""
        view = object.__new__(Search)
        view.__dict__.update(self.__dict__)
        view._deadline = min(self._deadline, deadline)
        return view

    @contextmanager
    def by(self, solver: str) -> Iterator["Search"]:
        """The same search, whose routes and proofs are by that solver: its turn."""
        view, known = self.until(inf), self._known
        view._method = solver
        begin = known.clock() - known.begun
        yield view
        known.turns.append(SolverTurn(solver, begin, known.clock() - known.begun))

    def spend(self, work: float, iterations: int = 0) -> None:
        """A solver has worked so long by its own count (s), and tried so many routes."""
        with self._known.lock:
            self._known.work += work
            self._known.iterations += iterations

    def stop(self) -> None:
        """Ends the search, for all that share it."""
        self._known.stopped = True

    # What is known

    @property
    def best(self) -> Solution | None:
        return self._known.best

    @property
    def prize_bound(self) -> int:
        """No route wins more."""
        return self._known.prize_bound

    @property
    def bound(self) -> int:
        """No route that wins `prize_bound` costs less."""
        known = self._known
        with known.lock:
            valid = (b for prize, b in known.bounds.items() if prize <= known.prize_bound)
            return max(valid, default=0)

    @property
    def infeasible(self) -> bool:
        """Whether it is proven that there is no route."""
        return self._known.impossible

    @property
    def done(self) -> bool:
        """Whether the best route is proven to be that, or that there is none."""
        best = self._known.best
        if best is None or not self.network.exact:
            return self._known.impossible
        return best.prize >= self._known.prize_bound and best.cost <= self.bound

    @property
    def method(self) -> str:
        """The solver whose finding completed the proof; without one, that of the best route."""
        best = self._known.best
        return self._known.method if self.done or best is None else best.method

    @property
    def reasons(self) -> tuple[str, ...]:
        return tuple(self._known.reasons)

    @property
    def history(self) -> tuple[SearchProgress, ...]:
        return tuple(self._known.history)

    @property
    def turns(self) -> tuple[SolverTurn, ...]:
        return tuple(sorted(self._known.turns, key=lambda turn: turn.begin))

    def progress(self) -> SearchProgress:
        """How far the search is."""
        known, best = self._known, self._known.best
        return SearchProgress(
            known.clock() - known.begun,
            known.work,
            known.iterations,
            None if best is None else best.prize,
            None if best is None else best.cost,
            known.prize_bound,
            self.bound,
            known.better,
        )

    # What is found

    def say(self, reason: str) -> None:
        """Notes why the route is as it is, for those who asked for it."""
        self._known.reasons.append(reason)

    def offer(self, path: Iterable[int], charges: Mapping[int, int] | None = None) -> bool:
        """A route by its nodes was found, with the charger by the position in the path; whether it
        is better than the best one. Raises Invalid if it breaks a rule."""
        path, charges = tuple(path), dict(charges or {})
        return self._offer(self.network.route(path, charges), path, charges)

    def offer_tour(self, tour: Tour) -> bool:
        """The same by visits."""
        path, charges = self.network.path(tour)
        return self._offer(tour, path, charges)

    def _offer(self, tour: Tour, path: tuple[int, ...] | None, charges: Mapping[int, int]) -> bool:
        worth = evaluate(self.problem, tour)
        if not worth.feasible:
            raise Invalid(
                f"solver {self._method!r} offers a route that breaks a rule: {worth.violations[0]}"
            )
        cost = worth.cost(self.problem.objective)
        solution = Solution(tour, worth.prize, cost, path, charges, self._method)
        known = self._known
        with known.lock:
            if not solution.better_than(known.best):
                return False
            known.best = solution
            known.better = known.clock() - known.begun, known.iterations
            self._note()
        if known.observers.on_best:
            known.observers.on_best(self.progress(), tour)
        return True

    def known(
        self, prize_bound: int | None = None, bound: int | None = None, prize: int = 0
    ) -> None:
        """Proven of the network's routes: none wins more than `prize_bound`; none that wins at
        least `prize` costs less than `bound`."""
        known = self._known
        if not self.network.exact:
            return
        with known.lock:
            before = known.prize_bound, self.bound
            if prize_bound is not None:
                known.prize_bound = min(known.prize_bound, prize_bound)
            if bound is not None and bound > known.bounds.get(prize, 0):
                known.bounds[prize] = bound
            if before == (known.prize_bound, self.bound):
                return
            self._note()
        if known.observers.on_bound:
            known.observers.on_bound(self.progress())

    def impossible(self) -> None:
        """Proven of the network: there is no route."""
        if not self.network.exact:
            return
        with self._known.lock:
            self._known.impossible = True
            self._note()

    def _note(self) -> None:
        """Raises Conflict where what is found contradicts what is said to be proven."""
        known, best = self._known, self._known.best
        over = best is not None and best.prize > known.prize_bound
        under = best is not None and best.prize >= known.prize_bound and best.cost < self.bound
        if (known.impossible and best is not None) or over or under:
            raise Conflict(
                f"solver {self._method!r}: what it finds contradicts what is said to be proven of "
                "this route problem; please report it with the problem"
            )
        known.method = self._method or known.method
        known.history.append(replace(self.progress(), solver=self._method))
