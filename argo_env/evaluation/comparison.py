"""Paired comparison of two plans that were run in the same worlds."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, NotFound, Remedy
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.estimates.pairs import (
    MIN_PAIRS,
    FirstMinusSecond,
    SuccessPairs,
    mean_first_minus_second,
    power,
)
from argo_env.evaluation.estimates.rates import world_means_in_order_seen
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow

_Pairs = list[tuple[RunRow, RunRow]]


@dataclass(frozen=True)
class PlanComparison:
    """Comparison of two plans that were run in the same worlds with the same faults."""

    first: str
    second: str
    pairs: tuple[tuple[RunRow, RunRow], ...]
    """pairs of runs, one of each plan, that were both carried out"""
    lost: int
    """number of pairs with a run that could not be carried out"""
    unpaired: tuple[int, int] = (0, 0)
    """number of each plan's runs that have no partner in the other plan; they do not count"""
    any_time: bool = False
    """whether the number of pairs may depend on the outcomes of the runs"""

    def __repr__(self) -> str:
        """Return what is compared, without the pairs, of which there may be thousands."""
        return (
            f"PlanComparison(first={self.first!r}, second={self.second!r}, "
            f"pairs=<{len(self.pairs)} pairs>, lost={self.lost}, unpaired={self.unpaired}, "
            f"any_time={self.any_time}; {self.conclusion})"
        )

    @cached_property
    def successes(self) -> SuccessPairs:
        """Numbers of pairs of runs by which of the two plans succeeded: both, one or none."""
        return _successes(list(self.pairs))

    @cached_property
    def by_faults(self) -> dict[str, SuccessPairs]:
        """Numbers of pairs of runs by outcome, as in `successes`, by name of the set of faults."""
        names = dict.fromkeys(a.faults for a, _ in self.pairs)
        return {
            name: _successes([pair for pair in self.pairs if pair[0].faults == name])
            for name in names
        }

    @cached_property
    def success(self) -> FirstMinusSecond:
        """Difference of the success rates, first plan minus second plan, over worlds.

        Runs of one world with several sets of faults depend on each other and count as one. The 95
        % interval is valid whatever the true rates are.
        """
        shares = _world_means(lambda row: float(row.success), list(self.pairs))
        estimate = mean_first_minus_second(*shares)
        if not self.pairs:
            return estimate
        if self.has_independent_pairs and not self.any_time:
            low, high = self.successes.interval()
        else:
            sequence = ConfidenceSequence()
            sequence.add(((1.0 + shares[0] - shares[1]) / 2.0).tolist())
            low, high = (2.0 * end - 1.0 for end in sequence.interval)
        return replace(estimate, low=low, high=high)

    @cached_property
    def p_value(self) -> float:
        """Probability of a difference in success at least this large if there is truly none.

        McNemar's exact test gives it if each world has one pair, else the permutation test over
        worlds. It is NaN if the number of pairs may depend on the outcomes of the runs, as neither
        test is valid then.
        """
        if self.any_time:
            return math.nan
        return self.successes.p_value if self.has_independent_pairs else self.success.p_value

    @property
    def has_independent_pairs(self) -> bool:
        """True if no world has several pairs; only then the pairs are independent of each other."""
        return len({a.seed for a, _ in self.pairs}) == len(self.pairs)

    @cached_property
    def duration(self) -> FirstMinusSecond:
        """Mean difference of the durations in s, first plan minus second, where both succeeded."""
        both = [pair for pair in self.pairs if pair[0].success and pair[1].success]
        return mean_first_minus_second(*_world_means(lambda row: row.duration or 0.0, both))

    @cached_property
    def distance(self) -> FirstMinusSecond:
        """Mean difference of the distances in m, first plan minus second, where both succeeded."""
        both = [pair for pair in self.pairs if pair[0].success and pair[1].success]
        return mean_first_minus_second(*_world_means(lambda row: row.distance or 0.0, both))

    def power(self, gain: float) -> float:
        """Return the power of McNemar's exact test for this number of pairs.

        That is the probability that the test shows a difference if one plan truly succeeds more
        often by `gain` (0 to 1). The share of pairs in which only the worse plan succeeds is
        assumed to be the smaller of the two such shares here, and that of the better plan `gain`
        more.
        """
        pairs = self.successes
        noise = min(pairs.first_only, pairs.second_only) / pairs.pairs if pairs.pairs else 0.0
        noise = min(noise, (1.0 - gain) / 2.0)
        return power(pairs.pairs, noise + gain, noise)

    @property
    def conclusion(self) -> str:
        """Conclusion in one sentence; A is the first of the evaluated plans, B the second."""
        excludes_zero = self.success.low > 0.0 or self.success.high < 0.0
        is_significant = excludes_zero if self.any_time else self.p_value <= 0.05
        if is_significant:
            return f"{'A' if self.success.value > 0 else 'B'} succeeds more often."
        time = self.duration
        faster = "A" if time.value < 0 else "B"
        if time.is_significant_by_p_value:
            return f"No difference in success is shown; {faster} is faster where both succeed."
        if time.value and 0 < time.pairs < MIN_PAIRS:
            return (
                f"No difference in success is shown. {faster} is faster where both succeed, but "
                f"{time.pairs} worlds can't exclude chance: evaluate at least {MIN_PAIRS}."
            )
        return "No difference is shown."


def compare_plans(
    first: EvaluationResults,
    second: EvaluationResults,
    first_plan: PlanName | None = None,
    second_plan: PlanName | None = None,
) -> PlanComparison:
    """Compare two plans of the same or of two evaluations.

    A plan may be omitted if its evaluation has only one. Raises Conflict if the plans have no world
    in common, if their worlds vary in different ways, or if an omitted plan is ambiguous.
    """
    a_name = first_plan or _only_plan(first)
    b_name = second_plan or _only_plan(second)
    a = {(row.seed, row.faults): row for row in first.rows_for(a_name)}
    b = {(row.seed, row.faults): row for row in second.rows_for(b_name)}
    common = [key for key in a if key in b]
    if not common:
        raise Conflict(
            "the two plans have no world in common: evaluate both with the same seeds and faults"
        )
    if first.plan.variation != second.plan.variation:
        raise Conflict(
            "the worlds of the two plans vary in different ways: evaluate both with the same "
            "variation"
        )
    pairs = [(a[key], b[key]) for key in common]
    complete = [pair for pair in pairs if pair[0].is_completed and pair[1].is_completed]
    names = (a_name, b_name)
    labels = [str(name.label(names)) for name in names]
    if labels[0] == labels[1]:
        labels = [f"{first.plan.name}: {labels[0]}", f"{second.plan.name}: {labels[1]}"]
    unpaired = len(a) - len(common), len(b) - len(common)
    any_time = any(
        results.cut_short
        or results.plan.stopping.require
        or results.plan.stopping.width is not None
        for results in (first, second)
    )
    return PlanComparison(
        labels[0], labels[1], tuple(complete), len(pairs) - len(complete), unpaired, any_time
    )


def plan_by_label_or_mission(results: EvaluationResults, label_or_mission: str) -> PlanName:
    """Return the evaluation's plan with this label or, if no plan has it, the one of this mission.

    Raises NotFound if there is no such plan, Conflict if there are several.
    """
    plans = results.plan.plans
    matches = [plan for plan in plans if plan.label(plans) == label_or_mission]
    matches = matches or [plan for plan in plans if plan.mission == label_or_mission]
    known = "; ".join(plan.label(plans) for plan in plans)
    if not matches:
        raise NotFound(f"{results.plan.name} has no plan `{label_or_mission}`; there are: {known}")
    if len(matches) > 1:
        raise Conflict(
            f"`{label_or_mission}` can be several plans of {results.plan.name}; "
            f"name one of: {known}"
        )
    return matches[0]


def _only_plan(results: EvaluationResults) -> PlanName:
    if len(results.plan.plans) != 1:
        names = "; ".join(plan.label(results.plan.plans) for plan in results.plan.plans)
        raise Conflict(
            f"{results.plan.name} has several plans, say which is meant: {names}",
            remedies=(Remedy.CHOOSE_PLAN,),
        )
    return results.plan.plans[0]


def _world_means(value: Callable[[RunRow], float], pairs: _Pairs) -> NDArray[np.float64]:
    """Return, for each plan, the mean of a value of its runs in each world; shape (2, worlds)."""
    return (
        world_means_in_order_seen((a.seed, (value(a), value(b))) for a, b in pairs).reshape(-1, 2).T
    )


def _successes(pairs: _Pairs) -> SuccessPairs:
    a = np.array([pair[0].success for pair in pairs], dtype=bool)
    b = np.array([pair[1].success for pair in pairs], dtype=bool)
    return SuccessPairs.from_successes(a, b)
