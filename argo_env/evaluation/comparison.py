"""Two plans in the same worlds: which is better, and how sure that is."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, NotFound, Remedy
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.estimates.pairs import Difference, SuccessPairs, difference, power
from argo_env.evaluation.estimates.rates import world_means
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow

_Pairs = list[tuple[RunRow, RunRow]]


@dataclass(frozen=True)
class PlanComparison:
    """Two plans, run in the same worlds with the same faults."""

    first: str
    second: str
    pairs: tuple[tuple[RunRow, RunRow], ...]
    """runs of both that were carried out"""
    lost: int
    """pairs of which one could not be carried out"""
    alone: tuple[int, int] = (0, 0)
    """runs of each that the other one has not, and that do not count"""
    any_time: bool = False
    """whether the number of pairs may depend on what came of them"""

    @cached_property
    def successes(self) -> SuccessPairs:
        """How often which succeeded, over all pairs."""
        return _successes(list(self.pairs))

    @cached_property
    def by_faults(self) -> dict[str, SuccessPairs]:
        """The same for each set of faults."""
        names = dict.fromkeys(a.faults for a, _ in self.pairs)
        return {
            name: _successes([pair for pair in self.pairs if pair[0].faults == name])
            for name in names
        }

    @cached_property
    def success(self) -> Difference:
        """By how much the first one's rate of success is higher, over worlds: the runs of one world
        with several faults depend on each other, and count as one. The interval holds whatever the
        rates are."""
        shares = _world_means(lambda row: float(row.success), list(self.pairs))
        found = difference(*shares)
        if not self.pairs:
            return found
        if self.one_each and not self.any_time:
            low, high = self.successes.interval()
        else:
            sequence = ConfidenceSequence()
            sequence.add(((1.0 + shares[0] - shares[1]) / 2.0).tolist())
            low, high = (2.0 * end - 1.0 for end in sequence.interval)
        return replace(found, low=low, high=high)

    @cached_property
    def p_value(self) -> float:
        """How likely a difference in success as great as this is where there is none: by McNemar's
        exact test if each world has one pair, else by the test over worlds. NaN where the number of
        pairs may depend on what came of them, so that neither holds."""
        if self.any_time:
            return math.nan
        return self.successes.p_value if self.one_each else self.success.p_value

    @property
    def one_each(self) -> bool:
        """Whether each world has one pair: only then pairs do not depend on each other."""
        return len({a.seed for a, _ in self.pairs}) == len(self.pairs)

    @cached_property
    def duration(self) -> Difference:
        """By how many seconds the first one takes longer, where both succeeded."""
        both = [pair for pair in self.pairs if pair[0].success and pair[1].success]
        return difference(*_world_means(lambda row: row.duration or 0.0, both))

    @cached_property
    def distance(self) -> Difference:
        """By how many metres the first one drives farther, where both succeeded."""
        both = [pair for pair in self.pairs if pair[0].success and pair[1].success]
        return difference(*_world_means(lambda row: row.distance or 0.0, both))

    def power(self, gain: float) -> float:
        """How likely so many pairs show that one plan succeeds more often by `gain` (0 to 1), if
        as many pairs differ as here beside that."""
        pairs = self.successes
        noise = min(pairs.first_only, pairs.second_only) / pairs.pairs if pairs.pairs else 0.0
        noise = min(noise, (1.0 - gain) / 2.0)
        return power(pairs.pairs, noise + gain, noise)

    @property
    def conclusion(self) -> str:
        """What the comparison shows, in a sentence."""
        apart = self.success.low > 0.0 or self.success.high < 0.0
        better = apart if self.any_time else self.p_value <= 0.05
        if better:
            return f"{'A' if self.success.value > 0 else 'B'} succeeds more often."
        if self.duration.found:
            faster = "A" if self.duration.value < 0 else "B"
            return f"No difference in success is shown; {faster} is faster where both succeed."
        return "No difference is shown."


def compare_plans(
    first: EvaluationResults,
    second: EvaluationResults,
    first_plan: PlanName | None = None,
    second_plan: PlanName | None = None,
) -> PlanComparison:
    """Two plans of the same or of two evaluations; of one that has one plan only, that one.

    Raises Conflict where the plans have no world in common, or it is not clear which are meant.
    """
    a_name = first_plan or _only(first)
    b_name = second_plan or _only(second)
    a = {(row.seed, row.faults): row for row in first.of(a_name)}
    b = {(row.seed, row.faults): row for row in second.of(b_name)}
    common = [key for key in a if key in b]
    if not common:
        raise Conflict(
            "the two have no world in common: evaluate both with the same seeds and faults"
        )
    if first.plan.variation != second.plan.variation:
        raise Conflict("the worlds of the two vary in different ways: evaluate both in the same")
    pairs = [(a[key], b[key]) for key in common]
    whole = [pair for pair in pairs if pair[0].carried_out and pair[1].carried_out]
    names = (a_name, b_name)
    said = [str(name.beside(names)) for name in names]
    if said[0] == said[1]:
        said = [f"{first.plan.name}: {said[0]}", f"{second.plan.name}: {said[1]}"]
    alone = len(a) - len(common), len(b) - len(common)
    stopped = any(
        of.cut_short or of.plan.stopping.require or of.plan.stopping.width is not None
        for of in (first, second)
    )
    return PlanComparison(said[0], said[1], tuple(whole), len(pairs) - len(whole), alone, stopped)


def named_plan(results: EvaluationResults, name: str) -> PlanName:
    """The plan that is called so in the tables of an evaluation, or whose mission is.

    Raises NotFound if there is none, Conflict if there are several.
    """
    plans = results.plan.plans
    found = [plan for plan in plans if plan.beside(plans) == name]
    found = found or [plan for plan in plans if plan.mission == name]
    known = "; ".join(plan.beside(plans) for plan in plans)
    if not found:
        raise NotFound(f"{results.plan.name} has no plan `{name}`; there are: {known}")
    if len(found) > 1:
        raise Conflict(f"{results.plan.name}: several plans are of `{name}`: {known}")
    return found[0]


def _only(results: EvaluationResults) -> PlanName:
    if len(results.plan.plans) != 1:
        names = "; ".join(plan.beside(results.plan.plans) for plan in results.plan.plans)
        raise Conflict(
            f"{results.plan.name} has several plans, say which is meant: {names}",
            remedies=(Remedy.CHOOSE_PLAN,),
        )
    return results.plan.plans[0]


def _world_means(value: Callable[[RunRow], float], pairs: _Pairs) -> NDArray[np.float64]:
    """Return the mean of each plan's runs in each world, shape (2, worlds)."""
    return world_means((a.seed, (value(a), value(b))) for a, b in pairs).reshape(-1, 2).T


def _successes(pairs: _Pairs) -> SuccessPairs:
    a = np.array([pair[0].success for pair in pairs], dtype=bool)
    b = np.array([pair[1].success for pair in pairs], dtype=bool)
    return SuccessPairs.of(a, b)
