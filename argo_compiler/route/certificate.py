"""What is sure of a suggestion, checked by means that share no code with the solvers.

The route is followed as `evaluation` defines it. That none is better is checked by going through
all routes (`exhaustion`) where they are few, else by a relaxation (`relaxation`), which may be too
weak to tell.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from math import inf

from argo_compiler.base.errors import Invalid
from argo_compiler.route.blocks import Blocks
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.exhaustion import Exhaustion
from argo_compiler.route.problem import RouteProblem, Tour
from argo_compiler.route.relaxation import Relaxation
from argo_compiler.route.suggested import RouteSuggestion

_TRIVIAL = "no route is worth more than all visits, or costs less than nothing"
_PLAIN = 20_000
"""steps of work that all routes may take without comparing any"""


class Claim(StrEnum):
    """What a suggestion says."""

    ROUTE = "route"
    """the route keeps to everything, and wins, costs and leaves out what is said"""
    PRIZE_BOUND = "prize bound"
    """no route wins more"""
    BOUND = "bound"
    """no route that wins the prize bound costs less"""
    BEST = "best"
    """no route wins more than is said of this one, or as much and costs less"""
    NONE = "none"
    """there is no route"""
    SUBSET = "infeasible subset"
    """these requirements can't all be met, though each smaller set of them can"""


class Judgement(StrEnum):
    """What can be said of a claim."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    OPEN = "open"
    """not checked, or to no result"""


@dataclass(frozen=True)
class CheckedClaim:
    """A claim, and what can be said of it."""

    claim: Claim
    judgement: Judgement
    why: str
    counterexample: Tour | None = None
    """a route that shows that the claim is wrong"""
    shown: tuple[int, int] | None = None
    """where a relaxation is too weak, what it shows: no route wins more than the first, and none
    that wins what is claimed costs less than the second, in units"""


@dataclass(frozen=True)
class Certificate:
    """Each claim of a suggestion, and what can be said of it."""

    claims: tuple[CheckedClaim, ...]

    def of(self, claim: Claim) -> CheckedClaim | None:
        """None: the suggestion does not claim it."""
        return next((one for one in self.claims if one.claim is claim), None)

    @property
    def refuted(self) -> tuple[CheckedClaim, ...]:
        return tuple(one for one in self.claims if one.judgement is Judgement.REFUTED)


def certify(
    problem: RouteProblem,
    suggestion: RouteSuggestion,
    time_limit: float = 10.0,
    clock: Callable[[], float] = time.perf_counter,
) -> Certificate:
    """Checks what the suggestion claims of the problem, for about that long (s)."""
    check = _Check(problem, suggestion, clock, clock() + time_limit)
    check.follow()
    check.search()
    return check.certificate()


class _OutOfTime(Exception):
    """Ends a search."""


class _Check:
    """Has state: what is said of each claim, and how long a search may take."""

    def __init__(
        self,
        problem: RouteProblem,
        made: RouteSuggestion,
        clock: Callable[[], float],
        deadline: float,
    ) -> None:
        self._problem, self._made = problem, made
        self._clock, self._deadline, self._until = clock, deadline, deadline
        self._work, self._most_work = 0, inf
        self._done: dict[Claim, CheckedClaim] = {}
        self._why: dict[Claim, tuple[str, tuple[int, int] | None]] = {}
        # What no route is said to be better than: a prize and, at that prize, a cost; None: there
        # is said to be no route.
        self._open: dict[Claim, tuple[int, int] | None] = {
            Claim.PRIZE_BOUND: (made.prize_bound, 0),
            Claim.BOUND: (made.prize_bound, made.bound),
        }
        if made.proven:
            self._open |= (
                {Claim.NONE: None} if made.route is None else {Claim.BEST: (made.prize, made.cost)}
            )

    def certificate(self) -> Certificate:
        for claim in list(self._open):
            why, shown = self._why.get(claim, ("there was too little time", None))
            self._say(claim, Judgement.OPEN, why, shown=shown)
        return Certificate(tuple(self._done[claim] for claim in Claim if claim in self._done))

    def follow(self) -> None:
        """Checks the route itself, and what it shows of the other claims."""
        made = self._made
        if made.infeasible_subset:
            self._say(Claim.SUBSET, Judgement.OPEN, "requirements in words can't be tried")
        if made.route is None:
            return
        try:
            worth = evaluate(self._problem, made.route)
        except Invalid as error:
            self._say(Claim.ROUTE, Judgement.REFUTED, str(error))
            return
        faults = list(worth.violations)
        prize, cost = worth.prize, worth.cost(self._problem.objective)
        if (prize, cost) != (made.prize, made.cost):
            faults.append(f"it wins {prize} and costs {cost}, not {made.prize} and {made.cost}")
        if set(made.dropped) != set(range(self._problem.size)) - set(made.order):
            faults.append("it leaves out something else than is said")
        judgement = Judgement.REFUTED if faults else Judgement.CONFIRMED
        self._say(Claim.ROUTE, judgement, "; ".join(faults) or "followed from visit to visit")
        self._try(made.route)

    def search(self) -> None:
        """Looks for better routes, and for reasons why there are none."""
        self._bounded(sum(v.prize for v in self._problem.visits), lambda *_: 0, _TRIVIAL)
        self._why.clear()
        with suppress(_OutOfTime):
            blocks = Blocks(self._problem, self._spend)
            self._exhaust(blocks, same_place=False)
            self._until = (self._clock() + self._deadline) / 2
            with suppress(_OutOfTime):
                self._relax(blocks)
            self._until = self._deadline
            self._exhaust(blocks, same_place=True)

    def _spend(self) -> None:
        self._work += 1
        if self._work > self._most_work or (self._work % 256 == 0 and self._clock() > self._until):
            raise _OutOfTime

    def _exhaust(self, blocks: Blocks, *, same_place: bool) -> None:
        """Goes through all routes; without comparing any, as long as they are few."""
        if not self._open or not blocks.exact:
            return
        search, through = Exhaustion(blocks, _weakest(self._open), self._spend), False
        self._most_work = inf if same_place else self._work + _PLAIN
        with suppress(_OutOfTime):
            search.run(same_place=same_place)
            through = True
        self._most_work = inf
        if search.best is not None:
            self._try(search.best)
        for claim in list(self._open) if through else []:
            why = f"all routes gone through, by {search.count} beginnings"
            self._say(claim, Judgement.CONFIRMED, why)

    def _relax(self, blocks: Blocks) -> None:
        if not self._open:
            return
        relaxation = Relaxation(blocks, self._clock, self._until)
        prize = relaxation.most_prize(min(than[0] if than else -1 for than in self._open.values()))
        if prize is not None:
            self._bounded(prize, cache(relaxation.least_cost), "a relaxation shows it")
            return
        for claim in list(self._open):
            self._say(claim, Judgement.CONFIRMED, "even a relaxation has no route")

    def _bounded(self, most: int, least: Callable[[int, int], int | None], why: str) -> None:
        """Confirms what follows if no route wins more than that, and none that wins a prize costs
        less than its least; None: none wins it."""
        for claim, than in list(self._open.items()):
            if than is None:
                self._why[claim] = "a relaxation has a route", None
                continue
            cost = 0 if claim is Claim.PRIZE_BOUND else least(*than)
            cheaper = cost is not None and cost < than[1]
            if cheaper or (claim is not Claim.BOUND and most > than[0]):
                self._why[claim] = "a relaxation is too weak", (most, cost or 0)
            else:
                self._say(claim, Judgement.CONFIRMED, why)

    def _try(self, route: Tour) -> None:
        """Refutes what the route shows to be wrong."""
        worth = evaluate(self._problem, route)
        prize, cost = worth.prize, worth.cost(self._problem.objective)
        for claim, than in list(self._open.items()) if worth.feasible else []:
            if than is None or (-prize, cost) < (-than[0], than[1]):
                # Of the bound nothing is known if the prize bound is wrong.
                other = claim is Claim.BOUND and than is not None and prize > than[0]
                judgement = Judgement.OPEN if other else Judgement.REFUTED
                self._say(claim, judgement, f"a route wins {prize} and costs {cost}", route)

    def _say(
        self,
        claim: Claim,
        judgement: Judgement,
        why: str,
        counterexample: Tour | None = None,
        shown: tuple[int, int] | None = None,
    ) -> None:
        self._open.pop(claim, None)
        self._done[claim] = CheckedClaim(claim, judgement, why, counterexample, shown)


def _weakest(claims: dict[Claim, tuple[int, int] | None]) -> tuple[int, int] | None:
    """What the best route is better than if any claim is wrong."""
    worths = [than for than in claims.values() if than is not None]
    if len(worths) < len(claims):
        return None
    return min(worths, key=lambda than: (than[0], -than[1]))
