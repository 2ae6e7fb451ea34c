"""Which runs are made next, and whether more are needed."""

from collections.abc import Iterator, Sequence

from argo_env.evaluation.plan import EvaluationPlan, PlannedRun
from argo_env.evaluation.rates import Decision, judge_requirements, rate_of
from argo_env.evaluation.row import RunRow
from argo_env.evaluation.statistics.rates import Stratum, allocation


def batches(plan: EvaluationPlan, rows: Sequence[RunRow]) -> Iterator[Iterator[PlannedRun]]:
    """The runs of an evaluation, in batches. `rows` has those of all batches before when the next
    one is asked for, so that what is decided does not depend on which run was the quickest."""
    if plan.strata:
        yield from _by_strata(plan, rows)
        return
    stopping = plan.stopping
    if stopping.width is None and not stopping.require:
        yield plan.runs()
        return
    for first in range(0, len(plan.seeds), stopping.every):
        if first and is_enough(plan, rows):
            return
        yield plan.runs(plan.seeds[first : first + stopping.every])


def is_enough(plan: EvaluationPlan, rows: Sequence[RunRow]) -> bool:
    """Whether all that one stops for is reached."""
    stopping = plan.stopping
    if stopping.require:
        verdicts = judge_requirements(plan, rows)
        if any(one.verdict is Decision.OPEN for one in verdicts):
            return False
    if stopping.width is not None:
        rates = [rate_of(plan, name, rows) for name in plan.plans]
        if any(rate.high - rate.low > stopping.width for rate in rates):
            return False
    return bool(stopping.require) or stopping.width is not None


def _by_strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> Iterator[Iterator[PlannedRun]]:
    """First as many runs of each case, then where they tell most. No seed is used twice, so that
    the strata know nothing of each other."""
    seeds = iter(plan.seeds)
    left = len(plan.seeds)
    cases = len(plan.cases)
    shares = (plan.stopping.every,) * cases
    while left:
        runs: list[PlannedRun] = []
        for case, share in enumerate(shares):
            for _ in range(min(share, left)):
                runs.append(plan.run(case, next(seeds)))
                left -= 1
        yield iter(runs)
        if plan.stopping.width is not None and is_enough(plan, rows):
            return
        shares = allocation(_strata(plan, rows), min(left, plan.stopping.every * cases))


def _strata(plan: EvaluationPlan, rows: Sequence[RunRow]) -> list[Stratum]:
    whole = sum(case.weight for case in plan.cases)
    found = []
    for case in plan.cases:
        ran = [row for row in rows if row.faults == case.faults and row.carried_out]
        done = sum(row.success for row in ran)
        found.append(Stratum(case.weight / whole, done, len(ran)))
    return found
