"""Checks of a suggestion's claims, by code that shares nothing with the solvers.

The route is simulated as `evaluation` defines it. The claim that no route is better is checked by
an enumeration of all routes (`enumeration`) if they are few, otherwise by a relaxation
(`relaxation`), which may be too weak to decide.
"""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from math import inf

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.blocks import Blocks
from argo_compiler.route.enumeration import Enumeration
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import RouteProblem, Tour
from argo_compiler.route.relaxation import Relaxation
from argo_compiler.route.suggested import RouteSuggestion

_TRIVIAL = Message("no route wins more than the prizes of all visits, or costs less than 0")
_STEPS_WITHOUT_DOMINANCE = 20_000
"""highest number of steps of work for the enumeration without dominance"""


class Claim(StrEnum):
    """Claim of a suggestion."""

    ROUTE = "route"
    """the route is feasible, with the stated prize, cost and left out visits"""
    PRIZE_BOUND = "prize bound"
    """no route wins more than the prize bound"""
    BOUND = "bound"
    """no route that wins the prize bound costs less than the bound"""
    BEST = "best"
    """no route wins more than the stated prize of this one, or as much at a lower cost"""
    NONE = "none"
    """there is no route"""
    SUBSET = "infeasible subset"
    """the requirements cannot all be met, although each smaller set of them can"""


class Judgement(StrEnum):
    """Result of the check of a claim."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    OPEN = "open"
    """not checked, or the check was not conclusive"""


@dataclass(frozen=True)
class CheckedClaim:
    """Claim with the result of its check."""

    claim: Claim
    judgement: Judgement
    why: str
    counterexample: Tour | None = None
    """route that refutes the claim"""
    shown: tuple[int, int] | None = None
    """bounds of a relaxation that is too weak: no route wins more than the first, and none that
    wins the claimed prize costs less than the second, in units"""


@dataclass(frozen=True)
class Certificate:
    """Claims of a suggestion with the results of their checks."""

    claims: tuple[CheckedClaim, ...]

    def find(self, claim: Claim) -> CheckedClaim | None:
        """Return a claim with its result, or None if the suggestion does not make the claim."""
        return next((checked for checked in self.claims if checked.claim is claim), None)

    @property
    def refuted(self) -> tuple[CheckedClaim, ...]:
        return tuple(c for c in self.claims if c.judgement is Judgement.REFUTED)


def certify(
    problem: RouteProblem,
    suggestion: RouteSuggestion,
    time_limit: float = 10.0,
    clock: Callable[[], float] = time.perf_counter,
) -> Certificate:
    """Check the claims of a suggestion, for about `time_limit` s."""
    check = _Check(problem, suggestion, clock, clock() + time_limit)
    check.check_route()
    check.search()
    return check.certificate()


class _OutOfTime(Exception):
    """Raised when a search has used up its time or work."""


class _Check:
    """Check of one suggestion, which holds the result of each claim and the limits of a search."""

    def __init__(
        self,
        problem: RouteProblem,
        suggestion: RouteSuggestion,
        clock: Callable[[], float],
        deadline: float,
    ) -> None:
        self._problem, self._suggestion = problem, suggestion
        self._clock, self._deadline, self._until = clock, deadline, deadline
        self._work, self._most_work = 0, inf
        self._decided: dict[Claim, CheckedClaim] = {}
        self._why: dict[Claim, tuple[str, tuple[int, int] | None]] = {}
        # The claim is that no route is better than this prize and, at the same prize, this cost;
        # None: the claim is that there is no route.
        self._open: dict[Claim, tuple[int, int] | None] = {
            Claim.PRIZE_BOUND: (suggestion.prize_bound, 0),
            Claim.BOUND: (suggestion.prize_bound, suggestion.bound),
        }
        if suggestion.infeasible:
            self._open[Claim.NONE] = None
        elif suggestion.proven:
            assert suggestion.prize is not None
            assert suggestion.cost is not None
            self._open[Claim.BEST] = suggestion.prize, suggestion.cost

    def certificate(self) -> Certificate:
        for claim in list(self._open):
            why, shown = self._why.get(claim, (Message("there was too little time"), None))
            self._decide(claim, Judgement.OPEN, why, shown=shown)
        return Certificate(tuple(self._decided[claim] for claim in Claim if claim in self._decided))

    def check_route(self) -> None:
        """Record whether the route is as claimed, and refute other claims that it contradicts."""
        suggestion = self._suggestion
        if suggestion.infeasible_subset:
            self._decide(
                Claim.SUBSET, Judgement.OPEN, Message("requirements in words can't be checked")
            )
        if suggestion.route is None:
            return
        try:
            evaluation = evaluate(self._problem, suggestion.route)
        except Invalid as error:
            self._decide(Claim.ROUTE, Judgement.REFUTED, str(error))
            return
        errors = list(evaluation.violations)
        prize, cost = evaluation.prize, evaluation.cost(self._problem.objective)
        if (prize, cost) != (suggestion.prize, suggestion.cost):
            errors.append(
                Message(
                    "it wins {prize} and costs {cost}, not {prize_2} and {cost_2}",
                    prize=prize,
                    cost=cost,
                    prize_2=suggestion.prize,
                    cost_2=suggestion.cost,
                )
            )
        if set(suggestion.dropped or ()) != set(suggestion.route.left_out(self._problem.size)):
            errors.append(Message("it leaves out other visits than it states"))
        judgement = Judgement.REFUTED if errors else Judgement.CONFIRMED
        self._decide(
            Claim.ROUTE, judgement, "; ".join(errors) or Message("followed from visit to visit")
        )
        self._refute_by(suggestion.route)

    def search(self) -> None:
        """Search for routes that refute the open claims, and for proofs that there are none."""
        self._confirm_by_bounds(sum(v.prize for v in self._problem.visits), lambda *_: 0, _TRIVIAL)
        self._why.clear()
        with suppress(_OutOfTime):
            blocks = Blocks(self._problem, self._spend)
            self._enumerate(blocks, use_dominance=False)
            self._until = (self._clock() + self._deadline) / 2
            with suppress(_OutOfTime):
                self._relax(blocks)
            self._until = self._deadline
            self._enumerate(blocks, use_dominance=True)

    def _spend(self) -> None:
        self._work += 1
        if self._work > self._most_work or (self._work % 256 == 0 and self._clock() > self._until):
            raise _OutOfTime

    def _enumerate(self, blocks: Blocks, *, use_dominance: bool) -> None:
        """Enumerate all routes, and decide by them the claims that are still open.

        `use_dominance`: prune a partial route if another one with the same blocks is at least as
        good in every respect. Without it, there is a limit of work.
        """
        if not self._open or not blocks.exact:
            return
        enumeration, is_complete = Enumeration(blocks, _weakest(self._open), self._spend), False
        self._most_work = inf if use_dominance else self._work + _STEPS_WITHOUT_DOMINANCE
        with suppress(_OutOfTime):
            enumeration.run(use_dominance=use_dominance)
            is_complete = True
        self._most_work = inf
        if enumeration.best is not None:
            self._refute_by(enumeration.best)
        for claim in list(self._open) if is_complete else []:
            why = Message(
                "all routes enumerated, by extending {count} partial routes",
                count=enumeration.count,
            )
            self._decide(claim, Judgement.CONFIRMED, why)

    def _relax(self, blocks: Blocks) -> None:
        if not self._open:
            return
        relaxation = Relaxation(blocks, self._clock, self._until)
        prize = relaxation.prize_bound(
            min(claimed[0] if claimed else -1 for claimed in self._open.values())
        )
        if prize is not None:
            self._confirm_by_bounds(
                prize, cache(relaxation.cost_bound), Message("a relaxation shows it")
            )
            return
        for claim in list(self._open):
            self._decide(claim, Judgement.CONFIRMED, Message("even a relaxation has no route"))

    def _confirm_by_bounds(
        self, prize_bound: int, cost_bound: Callable[[int, int], int | None], why: str
    ) -> None:
        """Confirm the claims that follow from bounds, and record why the others don't.

        `prize_bound` is an upper bound on the prize of any route. `cost_bound` takes a prize and
        the claimed cost, and returns a lower bound on the cost of routes that win that prize, or
        None if none wins it.
        """
        for claim, claimed in list(self._open.items()):
            if claimed is None:
                self._why[claim] = Message("a relaxation has a route"), None
                continue
            cost = 0 if claim is Claim.PRIZE_BOUND else cost_bound(*claimed)
            may_be_cheaper = cost is not None and cost < claimed[1]
            if may_be_cheaper or (claim is not Claim.BOUND and prize_bound > claimed[0]):
                self._why[claim] = Message("a relaxation is too weak"), (prize_bound, cost or 0)
            else:
                self._decide(claim, Judgement.CONFIRMED, why)

    def _refute_by(self, route: Tour) -> None:
        """Refute the claims that a route contradicts."""
        evaluation = evaluate(self._problem, route)
        prize, cost = evaluation.prize, evaluation.cost(self._problem.objective)
        for claim, claimed in list(self._open.items()) if evaluation.feasible else []:
            if claimed is None or (-prize, cost) < (-claimed[0], claimed[1]):
                # If the prize bound is wrong, the bound on the cost remains undecided.
                wins_more = claim is Claim.BOUND and claimed is not None and prize > claimed[0]
                judgement = Judgement.OPEN if wins_more else Judgement.REFUTED
                self._decide(
                    claim,
                    judgement,
                    Message("a route wins {prize} and costs {cost}", prize=prize, cost=cost),
                    route,
                )

    def _decide(
        self,
        claim: Claim,
        judgement: Judgement,
        why: str,
        counterexample: Tour | None = None,
        shown: tuple[int, int] | None = None,
    ) -> None:
        self._open.pop(claim, None)
        self._decided[claim] = CheckedClaim(claim, judgement, why, counterexample, shown)


def _weakest(claims: dict[Claim, tuple[int, int] | None]) -> tuple[int, int] | None:
    """Return the worst claimed prize and cost: if any claim is wrong, a route is better than these.

    Returns None if one claim is that there is no route.
    """
    values = [claimed for claimed in claims.values() if claimed is not None]
    if len(values) < len(claims):
        return None
    return min(values, key=lambda claimed: (claimed[0], -claimed[1]))
