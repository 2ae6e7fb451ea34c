"""Progress and interim results of a mission's evaluation, for clients."""

from collections import Counter
from statistics import median

from argo_compiler.base.model import Model
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.rates import Decision, IntervalMethod, PlanRate, approximate_success_rate
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.runner import EvaluationProgress
from argo_env.run.verdict import VerdictPart

MOST_FAILING = 100
"""failed runs that are listed one by one; the rows have all of them"""
_MOST_POINTS = 200


class TimesTold(Model):
    """Durations of the successful runs, in s."""

    least: float
    median: float
    most: float


class RateTold(Model):
    """Success rate, 0 to 1, with a 95 % interval."""

    runs: int
    """number of counted runs: those that could be executed"""
    value: float | None
    """share of successful runs; None: no run counts"""
    low: float
    high: float
    method: IntervalMethod

    @staticmethod
    def from_rate(rate: PlanRate) -> "RateTold":
        return RateTold(
            runs=rate.runs,
            value=rate.value if rate.runs else None,
            low=rate.low,
            high=rate.high,
            method=rate.method,
        )


class FaultsTold(Model):
    """Runs with the same faults."""

    name: str
    rate: RateTold
    outcomes: dict[RunOutcome, int]


class FailedRun(Model):
    """Failed run, which can be replayed by its key."""

    key: str
    seed: int
    faults: str
    outcome: RunOutcome
    reason: str
    """what is missing or went wrong, in English"""
    verdict: tuple[VerdictPart, ...] = ()
    """the same as data; empty if the run could not be carried out"""
    task: str | None
    """first task that failed, or the last task if none did"""
    duration: float | None
    """duration of the run in s"""


class RequirementTold(Model):
    """Verdict on a requirement."""

    requirement: str
    verdict: Decision
    low: float
    high: float
    """bounds of the rate that the requirement limits, 0 to 1, valid at any stopping time"""
    worlds: int
    """number of worlds that count"""


class EvaluationStanding(Model):
    """Progress and results of an evaluation."""

    done: int
    """number of runs that have ended"""
    most: int
    """largest possible number of runs; at the end of the evaluation, the number of its runs"""
    planned: int
    """number of requested runs; the evaluation may stop earlier, when a requirement is decided"""
    remaining: float | None
    """longest remaining time in s at the present speed; None: not known yet, or not running"""
    rate: RateTold
    """success rate of all runs; during the evaluation its interval is only approximate. After an
    early end it covers only the worlds before the first one with a missing run"""
    curve: tuple[RateTold, ...]
    """success rates after some of the runs, in the order of the runs"""
    outcomes: dict[RunOutcome, int]
    by_faults: tuple[FaultsTold, ...]
    times: TimesTold | None
    """durations of the successful runs; None: no run was successful yet"""
    failing: tuple[FailedRun, ...]
    """the first failed runs"""
    more_failing: int
    """number of further failed runs"""
    requirements: tuple[RequirementTold, ...] = ()
    """verdicts on the requirements; empty while the evaluation is running"""


class RunCount:
    """Counters of an evaluation's runs, updated with each run that ends."""

    def __init__(self, evaluation: EvaluationPlan) -> None:
        self._evaluation = evaluation
        self._outcomes: Counter[RunOutcome] = Counter()
        self._by_faults: dict[str, Counter[RunOutcome]] = {}
        self._durations: list[float] = []
        self._failing: list[FailedRun] = []
        self._failed = 0
        self._curve: list[RateTold] = []
        self._every = 1  # runs between two points of the curve

    def add(self, row: RunRow) -> None:
        """Add a run that has ended, with the result in `row`, to the counters."""
        self._outcomes[row.outcome] += 1
        faults = self._evaluation.faults_for(row.faults, row.seed)
        self._by_faults.setdefault(faults, Counter())[row.outcome] += 1
        if row.success and row.duration is not None:
            self._durations.append(row.duration)
        if not row.success:
            self._failed += 1
            if len(self._failing) < MOST_FAILING:
                self._failing.append(
                    FailedRun(
                        key=row.key,
                        seed=row.seed,
                        faults=faults,
                        outcome=row.outcome,
                        reason=row.reason,
                        verdict=row.verdict,
                        task=row.task,
                        duration=row.duration,
                    )
                )
        if self._outcomes.total() % self._every == 0:
            self._curve.append(RateTold.from_rate(approximate_success_rate(self._outcomes)))
            if len(self._curve) > _MOST_POINTS:
                self._curve, self._every = self._curve[1::2], 2 * self._every

    def interim_standing(self, progress: EvaluationProgress) -> EvaluationStanding:
        """Return the progress and the results so far, while the evaluation is running."""
        return self._standing(progress.max_runs, progress.longest_remaining_seconds, None)

    def final_standing(self, results: EvaluationResults) -> EvaluationStanding:
        """Return the progress and the results at the end of the evaluation, regular or early."""
        most = self._planned if results.cut_short else self._outcomes.total()
        return self._standing(most, None, results)

    @property
    def _planned(self) -> int:
        return len(self._evaluation.seeds) * len(self._evaluation.cases)

    def _standing(
        self, most: int, remaining: float | None, results: EvaluationResults | None
    ) -> EvaluationStanding:
        rate = approximate_success_rate(self._outcomes)
        groups = {
            name: approximate_success_rate(counts) for name, counts in self._by_faults.items()
        }
        requirements: tuple[RequirementTold, ...] = ()
        if results is not None:
            (plan,) = results.plan.plans
            rate = results.rate(plan)
            for group in results.by_faults(plan):
                interval, lost = group.rate, group.outcomes.total() - group.rate.runs
                groups[group.name] = PlanRate(
                    interval.value, interval.low, interval.high, interval.runs, lost, group.method
                )
            requirements = tuple(
                RequirementTold.model_validate(verdict, from_attributes=True)
                for verdict in results.verdicts
            )
        return EvaluationStanding(
            done=self._outcomes.total(),
            most=most,
            planned=self._planned,
            remaining=remaining,
            rate=RateTold.from_rate(rate),
            curve=tuple(self._curve),
            outcomes=dict(self._outcomes),
            by_faults=tuple(
                FaultsTold(
                    name=name, rate=RateTold.from_rate(group), outcomes=self._by_faults[name]
                )
                for name, group in groups.items()
            ),
            times=self._times(),
            failing=tuple(self._failing),
            more_failing=self._failed - len(self._failing),
            requirements=requirements,
        )

    def _times(self) -> TimesTold | None:
        if not self._durations:
            return None
        return TimesTold(
            least=min(self._durations), median=median(self._durations), most=max(self._durations)
        )
