"""How far the evaluation of a mission is, and what it says by then: for those who watch."""

from collections import Counter
from statistics import median

from argo_compiler.base.model import Model
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.rates import Decision, IntervalMethod, PlanRate, quick_rate
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.runner import EvaluationProgress

MOST_FAILING = 100
"""runs that are told one by one; all are among the rows"""
_MOST_POINTS = 200


class TimesTold(Model):
    """How long the runs took that were a success (s)."""

    least: float
    median: float
    most: float


class RateTold(Model):
    """A rate of success, 0 to 1, with an interval of 95 %."""

    runs: int
    """that count: those that could be carried out"""
    value: float | None
    """None: there are none"""
    low: float
    high: float
    method: IntervalMethod

    @staticmethod
    def of(rate: PlanRate) -> "RateTold":
        return RateTold(
            runs=rate.runs,
            value=rate.value if rate.runs else None,
            low=rate.low,
            high=rate.high,
            method=rate.method,
        )


class FaultsTold(Model):
    """The runs in which the same went wrong."""

    name: str
    rate: RateTold
    outcomes: dict[RunOutcome, int]


class FailedRun(Model):
    """A run that was no success; it can be replayed by its key."""

    key: str
    seed: int
    faults: str
    outcome: RunOutcome
    reason: str
    task: str | None
    """at which it failed first, or which was the last one"""
    duration: float | None
    """s"""


class RequirementTold(Model):
    """What is shown of something that was required."""

    requirement: str
    verdict: Decision
    low: float
    high: float
    """of the share, whenever one stops"""
    worlds: int


class EvaluationStanding(Model):
    """How far an evaluation is."""

    done: int
    """runs that have ended"""
    most: int
    """runs that there are at most; once all that it takes have been made, those"""
    planned: int
    """runs that were asked for: it may stop before, as soon as a requirement is decided"""
    remaining: float | None
    """s that it takes at most, if it goes on as fast; None: not known yet"""
    rate: RateTold
    """of all runs; while they come, by an interval that claims nothing. Of an evaluation that was
    cut short that of the first worlds of which no run is missing"""
    curve: tuple[RateTold, ...]
    """the rate as it was after some of the runs, in their order"""
    outcomes: dict[RunOutcome, int]
    by_faults: tuple[FaultsTold, ...]
    times: TimesTold | None
    """None: no run was a success yet"""
    failing: tuple[FailedRun, ...]
    """the first of them"""
    more_failing: int
    """how many more there are"""
    requirements: tuple[RequirementTold, ...] = ()
    """once all has been run"""


class RunCount:
    """Counts the runs of an evaluation of one plan as they come."""

    def __init__(self, evaluation: EvaluationPlan) -> None:
        self._evaluation = evaluation
        self._outcomes: Counter[RunOutcome] = Counter()
        self._by_faults: dict[str, Counter[RunOutcome]] = {}
        self._durations: list[float] = []
        self._failing: list[FailedRun] = []
        self._failed = 0
        self._curve: list[RateTold] = []
        self._every = 1

    def add(self, row: RunRow) -> None:
        """One more run has ended."""
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
                        task=row.task,
                        duration=row.duration,
                    )
                )
        if self._outcomes.total() % self._every == 0:
            self._curve.append(RateTold.of(quick_rate(self._outcomes)))
            if len(self._curve) > _MOST_POINTS:
                self._curve, self._every = self._curve[1::2], 2 * self._every

    def under_way(self, progress: EvaluationProgress) -> EvaluationStanding:
        """How it stands while more runs come."""
        return self._told(progress.max_runs, progress.remaining, None)

    def ended(self, results: EvaluationResults) -> EvaluationStanding:
        """How it stands at its end, with these results, or where it was cut short."""
        most = self._planned if results.cut_short else self._outcomes.total()
        return self._told(most, None, results)

    @property
    def _planned(self) -> int:
        return len(self._evaluation.seeds) * len(self._evaluation.cases)

    def _told(
        self, most: int, remaining: float | None, results: EvaluationResults | None
    ) -> EvaluationStanding:
        rate = quick_rate(self._outcomes)
        groups = {name: quick_rate(counts) for name, counts in self._by_faults.items()}
        requirements: tuple[RequirementTold, ...] = ()
        if results is not None:
            (plan,) = results.plan.plans
            rate = results.rate(plan)
            for group in results.by_faults(plan):
                found, lost = group.rate, group.outcomes.total() - group.rate.runs
                groups[group.name] = PlanRate(
                    found.value, found.low, found.high, found.runs, lost, group.method
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
            rate=RateTold.of(rate),
            curve=tuple(self._curve),
            outcomes=dict(self._outcomes),
            by_faults=tuple(
                FaultsTold(name=name, rate=RateTold.of(group), outcomes=self._by_faults[name])
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
