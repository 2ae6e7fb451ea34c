"""Estimates from expensive runs with cheap runs as a control variate, if these pay.

An evaluation runs with its own, expensive drive. Runs with a cheap drive in the same worlds and in
many more can narrow the intervals. A pilot first measures the correlation and the costs.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.loading import read_bytes
from argo_env.evaluation.estimates.control import (
    FEWEST_PAIRS,
    ControlVariate,
    controlled_mean,
)
from argo_env.evaluation.estimates.rates import Estimate, weighted_means_of_complete_worlds
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.files.checked_files import checked_json, read_checked
from argo_env.files.folders import reporting_write_errors
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.run.drives_and_sensors import IDEAL, ROUTE
from argo_env.run.run_setup import check_spec

PILOT = 30
"""number of worlds of the pilot, in which both drives are run first"""
MOST_CHEAP = 20_000
"""largest number of worlds with cheap runs only"""
_MIN_COUNT = 10
"""smallest number of successes, and of failures, for which a rate is about normally distributed"""
_COST_FILE = "control.json"
_REMEDY = "restore it from a copy, or evaluate into another folder, where it is measured anew"
_QUANTITIES: dict[str, Callable[[RunRow], float]] = {
    "success": lambda row: float(row.success),
    "duration": lambda row: row.duration or 0.0,
}

MakeRuns = Callable[[EvaluationPlan], EvaluationResults]
"""function that runs an evaluation plan; it doesn't repeat runs that it has made before"""


class _MeasuredCost(Model):
    """Cost measured in the pilot; stored, since runs that are already stored take no time."""

    cost: float = Field(gt=0)
    """time of a cheap run, as a share of the time of an expensive run"""


@dataclass(frozen=True)
class ControlledMean:
    """Mean over worlds, estimated from expensive runs alone and with the help of cheap runs."""

    quantity: str
    """`success`, or `duration` (s) of all runs, whatever their outcomes"""
    control: ControlVariate
    """correlation and cost, measured in the pilot"""
    uncontrolled: Estimate
    """estimate from the expensive runs alone"""
    controlled: Estimate | None
    """estimate with the cheap runs; None if these don't pay, or if there are too few failures or
    successes for an interval of this kind"""
    expensive: int
    """number of worlds with expensive runs"""
    cheap: int
    """number of worlds with cheap runs only"""


def run_with_control_variate(
    plan: EvaluationPlan,
    cheap_drive: str,
    make: MakeRuns,
    folder: Path,
    clock: Callable[[], float] = time.monotonic,
) -> tuple[EvaluationResults, tuple[ControlledMean, ...]]:
    """Run the evaluation, and run more worlds with `cheap_drive` if that pays.

    Both drives run in the worlds of a pilot first, which measures their correlation and costs (wall
    times of runs); the measured cost is stored in the folder. Returns the results with the plan's
    own drive, and the estimated means of success and duration; these are empty if too few worlds
    could be run with both drives. Raises ArgoError for several plans at once, strata, too few
    worlds, or a cheap drive that can't have the same faults.
    """
    cheap = make_cheap_plan(plan, cheap_drive)
    pilot_seeds = plan.seeds[:PILOT]
    expensive_start = clock()
    expensive_pilot = make(_with_seeds(plan, pilot_seeds))
    cheap_start = clock()
    cheap_pilot = make(_with_seeds(cheap, pilot_seeds))
    cost = _relative_cost(folder, cheap_start - expensive_start, clock() - cheap_start)
    results = make(plan)
    pairs = _by_world(expensive_pilot, "success").keys() & _by_world(cheap_pilot, "success").keys()
    if len(pairs) < FEWEST_PAIRS:
        return results, ()
    controls = {name: _measure(name, expensive_pilot, cheap_pilot, cost) for name in _QUANTITIES}
    seeds = tuple(dict.fromkeys(row.seed for row in results.rows))
    paying = [control for control in controls.values() if control.pays]
    more: tuple[int, ...] = ()
    if paying:
        times = max(min(control.cheap_runs_per_expensive_run, MOST_CHEAP) for control in paying)
        count = min(MOST_CHEAP, math.ceil((times - 1) * len(seeds)))
        more = tuple(range(max(plan.seeds) + 1, max(plan.seeds) + 1 + count))
    cheap_results = make(_with_seeds(cheap, (*seeds, *more))) if more else None
    return results, tuple(
        _mean(name, control, results, cheap_results if control.pays else None)
        for name, control in controls.items()
    )


def make_cheap_plan(plan: EvaluationPlan, cheap_drive: str) -> EvaluationPlan:
    """Return the evaluation plan with this cheap drive in all cases, and without its rule to stop.

    Raises ArgoError if cheap runs can't help this evaluation, or the drive can't have its faults.
    """
    if len(plan.plans) > 1 or plan.strata:
        raise Invalid("cheap runs help one plan without strata: give one mission, drive and policy")
    if len(plan.seeds) < FEWEST_PAIRS:
        raise Invalid(
            f"the correlation of two drives takes at least {FEWEST_PAIRS} worlds to measure: "
            "give more seeds"
        )
    if plan.plans[0].drive == cheap_drive:
        raise Conflict(f"the drive `{cheap_drive}` can't help itself: name a cheaper one")
    cases = []
    for case in plan.cases:
        sensor = IDEAL if cheap_drive == ROUTE else case.spec.sensor
        spec = case.spec.model_copy(update={"drive": cheap_drive, "sensor": sensor})
        check_spec(spec, open_site(spec.site, load_robot(spec.robot)).site)
        cases.append(case.model_copy(update={"spec": spec}))
    return plan.with_changes(cases=tuple(cases), stopping=Stopping())


def _with_seeds(plan: EvaluationPlan, seeds: Sequence[int]) -> EvaluationPlan:
    return plan.model_copy(update={"seeds": tuple(seeds), "stopping": Stopping()})


def _relative_cost(folder: Path, expensive: float, cheap: float) -> float:
    """Return the cost of a cheap run relative to an expensive one, as the first pilot measured it.

    It is read from the folder; if it is not there yet, it is the ratio of the pilot's wall times
    `cheap` and `expensive` (s), and is stored.
    """
    path = folder / _COST_FILE
    try:
        content = read_bytes(path, "measured cost", 1_000)
        return read_checked(_MeasuredCost, content, path, _REMEDY).cost
    except (NotFound, ValidationError):
        cost = max(cheap, 1e-6) / max(expensive, 1e-6)
        with reporting_write_errors(path):
            write_atomically(
                path, checked_json(_MeasuredCost(cost=cost).model_dump_json()), private=True
            )
        return cost


def _measure(
    name: str, expensive: EvaluationResults, cheap: EvaluationResults, cost: float
) -> ControlVariate:
    a, b = _by_world(expensive, name), _by_world(cheap, name)
    both = [seed for seed in a if seed in b]
    return ControlVariate.from_pairs(
        np.array([a[seed] for seed in both]), np.array([b[seed] for seed in both]), cost
    )


def _mean(
    name: str,
    control: ControlVariate,
    results: EvaluationResults,
    cheap: EvaluationResults | None,
) -> ControlledMean:
    worlds = _by_world(results, name)
    alone = _estimate(np.array([*worlds.values()]))
    successes = sum(row.success for row in results.rows)
    too_rare = name == "success" and not _MIN_COUNT <= successes <= len(results.rows) - _MIN_COUNT
    if cheap is None or too_rare:
        return ControlledMean(name, control, alone, None, len(worlds), 0)
    known = _by_world(cheap, name)
    both = [seed for seed in worlds if seed in known]
    more = [value for seed, value in known.items() if seed not in worlds]
    helped = controlled_mean(
        np.array([worlds[seed] for seed in both]),
        np.array([known[seed] for seed in both]),
        np.array(more),
    )
    return ControlledMean(name, control, alone, helped, len(both), len(more))


def _by_world(results: EvaluationResults, quantity: str) -> dict[int, float]:
    """Return, by seed, the weighted mean of a quantity over the cases of a world.

    Worlds in which not all cases could be run are left out.
    """
    weights = {case.faults: case.weight for case in results.plan.cases}
    ran = (row for row in results.rows if row.is_completed)
    values = ((row.seed, row.faults, _QUANTITIES[quantity](row)) for row in ran)
    return weighted_means_of_complete_worlds(values, weights)


def _estimate(values: NDArray[np.float64]) -> Estimate:
    """Return the mean of the values with its 95 % interval by Student's t distribution."""
    from scipy.stats import t

    n = len(values)
    value = float(values.mean()) if n else math.nan
    half = float(t.ppf(0.975, n - 1) * values.std(ddof=1) / math.sqrt(n)) if n > 1 else math.inf
    return Estimate(value, value - half, value + half)
