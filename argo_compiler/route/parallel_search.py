"""Two searches of one network beside each other, in two threads. The first that proves something
ends the other."""

import threading

from ortools.sat.python import cp_model

from argo_compiler.route import or_opt
from argo_compiler.route.cp_sat import solve_cp_sat
from argo_compiler.route.first_routes import improve, is_ordered, prepare
from argo_compiler.route.network import StepNetwork
from argo_compiler.route.pruning import Pruned
from argo_compiler.route.search import Search
from argo_compiler.route.solution import Solution, make_solution, no_solution

_FROM_NOTHING = 0.2
"""share of the time for the first try where a good route will soon be known"""
_TURNS = ((0.3, 0.2), (0.8, 1.0))
"""shares of the time that is left, for a proof and then for a better route"""
_FAR = 1.15
"""of the bound: from there on, there is no use in trying to prove something"""


def raced(
    network: StepNetwork, pruned: Pruned, search: Search, best: Solution | None, method: str
) -> tuple[Solution | None, str, Solution]:
    """CP-SAT from nothing on one core, and on the other CP-SAT from what is known, after other
    searches where the order is tight. Gives the best route, its solver, and what CP-SAT knows."""
    return _Race(network, pruned, search).run(best, method)


class _Race:
    """Has state: what has been found."""

    def __init__(self, network: StepNetwork, pruned: Pruned, search: Search) -> None:
        self._network, self._pruned, self._search = network, pruned, search
        self._ordered = is_ordered(network, pruned)
        self._plain = self._ordered and not network.selective and or_opt.applies(network)
        self._alone = search.alone()
        self._running: list[cp_model.CpSolver] = []
        self._known: Solution | None = None
        self._ready = threading.Event()
        self._beside = no_solution(network, proven=False)
        self._failure: BaseException | None = None

    def run(self, best: Solution | None, method: str) -> tuple[Solution | None, str, Solution]:
        """See `raced`."""
        thread = threading.Thread(target=self._run_beside)
        thread.start()
        try:
            best, method, exact = self._run_here(best, method)
        finally:
            self._alone.stop()
            self._stop_solvers()
            self._ready.set()
            while thread.is_alive():
                # A solver that was only just about to begin has not heard it.
                self._stop_solvers()
                thread.join(0.1)
        if self._failure is not None:
            raise self._failure
        return best, method, _both(self._network, self._search, exact, self._beside)

    def _run_beside(self) -> None:
        try:
            self._prove()
        except BaseException as error:
            self._failure = error
        if self._failure is not None or self._beside.proven:
            self._search.stop()
            self._stop_solvers()

    def _prove(self) -> None:
        """From nothing; where good routes are soon known, again from each of those."""
        network, alone = self._network, self._alone
        with alone.part(_FROM_NOTHING if self._plain else 1.0):
            self._beside = self._solved(alone)
        if not self._plain:
            return
        self._ready.wait()
        begun: Solution | None = None
        while not (alone.stopped or self._beside.proven or self._known is begun):
            begun = self._known
            again = self._solved(alone, begun)
            self._beside = _both(network, alone, self._beside, again)

    def _run_here(
        self, best: Solution | None, method: str
    ) -> tuple[Solution | None, str, Solution | None]:
        network, pruned, search = self._network, self._pruned, self._search
        if self._ordered:
            best, method = prepare(network, pruned, search, best, method)
        self._known = best
        self._ready.set()
        if best is not None and best.proven:
            return best, method, best
        if search.stopped:
            return best, method, None
        if best is None or not self._plain:
            return best, method, self._solved(search, best, hinted=self._ordered)
        return self._alternated(best, method)

    def _alternated(self, best: Solution, method: str) -> tuple[Solution, str, Solution]:
        """CP-SAT and local search by turns: a better route makes the proof easier."""
        network, pruned, search = self._network, self._pruned, self._search
        search.say("CP-SAT with times and local search by turns, beside CP-SAT with positions")
        exact = no_solution(network, proven=False)
        for proving, improving in _TURNS:
            if self._known is not best:
                self._known = best
                self._stop_solvers()  # the one beside goes on from this
            far = best.cost > _FAR * max(search.bound, self._alone.bound)
            if not far:
                with search.part(proving):
                    exact = self._solved(search, best, timed=True)
                if exact.better_than(best):
                    best, method = exact, "CP-SAT"
                if exact.proven:
                    break
            until = search.clock() + (1.0 if far else improving) * search.left()
            best, method = improve(network, pruned, search, until, best, method)
        return best, method, exact

    def _solved(
        self,
        search: Search,
        best: Solution | None = None,
        *,
        hinted: bool = True,
        timed: bool = False,
    ) -> Solution:
        network, pruned, running = self._network, self._pruned, self._running
        return solve_cp_sat(
            network, pruned, search, best, hinted=hinted, timed=timed, running=running
        )

    def _stop_solvers(self) -> None:
        for solver in self._running:
            solver.stop_search()


def _both(network: StepNetwork, search: Search, one: Solution | None, other: Solution) -> Solution:
    """The better path of two searches, with the better bounds of both."""
    if one is None or other.proven:
        return other
    if one.proven:
        return one
    best = other if other.better_than(one) else one
    if best.path is None:
        return no_solution(network, proven=False, bound=max(one.bound, other.bound))
    search.route(best.prize, best.cost)
    prize_bound = min(one.prize_bound, other.prize_bound)
    search.known(prize_bound, max(one.bound, other.bound))
    return make_solution(network, best.path, best.charges, prize_bound, max(one.bound, other.bound))
