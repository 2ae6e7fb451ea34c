"""Expensive runs that cheap ones help: how much the cheap ones tell is measured first."""

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
from argo_env.evaluation.estimates.rates import Estimate, weighted_world_means
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.run.drives_and_sensors import IDEAL, ROUTE
from argo_env.run.run_setup import check_spec

PILOT = 30
"""worlds in which both are run first"""
MOST_CHEAP = 20_000
"""worlds in which the cheap runs alone are made"""
_FEWEST = 10
"""successes, and failures, from which on a rate is about normally distributed"""
_KEPT = "control.json"
_QUANTITIES: dict[str, Callable[[RunRow], float]] = {
    "success": lambda row: float(row.success),
    "duration": lambda row: row.duration or 0.0,
}

MakeRuns = Callable[[EvaluationPlan], EvaluationResults]
"""carries a plan out; what it has made before it does not make again"""


class _MeasuredCost(Model):
    """What is kept of the pilot: when it is there, its runs take no time any more."""

    cost: float = Field(gt=0)


@dataclass(frozen=True)
class ControlledMean:
    """A mean over worlds, by expensive runs alone and with the help of cheap ones."""

    quantity: str
    """`success`, or `duration` (s) of all runs, whatever they came to"""
    control: ControlVariate
    """as it was measured in the first worlds"""
    alone: Estimate
    """by the expensive runs alone"""
    helped: Estimate | None
    """None: it does not pay; or there are so few failures or successes that no interval of this
    kind holds"""
    expensive: int
    """worlds in which the expensive runs were made"""
    cheap: int
    """worlds in which only the cheap ones were"""


def run_controlled(
    plan: EvaluationPlan,
    drive: str,
    make: MakeRuns,
    folder: Path,
    clock: Callable[[], float] = time.monotonic,
) -> tuple[EvaluationResults, tuple[ControlledMean, ...]]:
    """Carries the plan out, and with the cheap `drive` as many more worlds as pay, if any do.

    Both are run in the first worlds, which tells how they go together and what they cost; what was
    measured is kept in the folder. No means are told where too few worlds could be run with both.
    Raises ArgoError for several plans at once, strata, few worlds, or a cheap drive that can't have
    the same faults.
    """
    cheap = with_drive(plan, drive)
    first = plan.seeds[:PILOT]
    begun = clock()
    expensive_pilot = make(_part(plan, first))
    between = clock()
    cheap_pilot = make(_part(cheap, first))
    cost = _cost(folder, between - begun, clock() - between)
    results = make(plan)
    pairs = _by_world(expensive_pilot, "success").keys() & _by_world(cheap_pilot, "success").keys()
    if len(pairs) < FEWEST_PAIRS:
        return results, ()
    controls = {name: _measured(name, expensive_pilot, cheap_pilot, cost) for name in _QUANTITIES}
    seeds = tuple(dict.fromkeys(row.seed for row in results.rows))
    paying = [control for control in controls.values() if control.pays]
    more: tuple[int, ...] = ()
    if paying:
        times = max(min(control.cheap_runs, MOST_CHEAP) for control in paying)
        count = min(MOST_CHEAP, math.ceil((times - 1) * len(seeds)))
        more = tuple(range(max(plan.seeds) + 1, max(plan.seeds) + 1 + count))
    cheap_results = make(_part(cheap, (*seeds, *more))) if more else None
    return results, tuple(
        _mean(name, control, results, cheap_results if control.pays else None)
        for name, control in controls.items()
    )


def with_drive(plan: EvaluationPlan, drive: str) -> EvaluationPlan:
    """The same plan with a cheap drive. Raises ArgoError if it can't have that."""
    if len(plan.plans) > 1 or plan.strata:
        raise Invalid("cheap runs help one plan without strata: give one mission, drive and policy")
    if len(plan.seeds) < FEWEST_PAIRS:
        raise Invalid(
            f"how runs of two drives go together takes at least {FEWEST_PAIRS} worlds to measure: "
            "give more seeds"
        )
    if plan.plans[0].drive == drive:
        raise Conflict(f"the drive `{drive}` can't help itself: take a cheaper one")
    cases = []
    for case in plan.cases:
        sensor = IDEAL if drive == ROUTE else case.spec.sensor
        spec = case.spec.model_copy(update={"drive": drive, "sensor": sensor})
        check_spec(spec, open_site(spec.site, load_robot(spec.robot)).site)
        cases.append(case.model_copy(update={"spec": spec}))
    return plan.changed(cases=tuple(cases), stopping=Stopping())


def _part(plan: EvaluationPlan, seeds: Sequence[int]) -> EvaluationPlan:
    return plan.model_copy(update={"seeds": tuple(seeds), "stopping": Stopping()})


def _cost(folder: Path, expensive: float, cheap: float) -> float:
    """Of a cheap run, as a share of that of an expensive one, as it was measured first."""
    path = folder / _KEPT
    try:
        return _MeasuredCost.model_validate_json(read_bytes(path, "measured cost", 1_000)).cost
    except (NotFound, ValidationError):
        cost = max(cheap, 1e-6) / max(expensive, 1e-6)
        write_atomically(path, _MeasuredCost(cost=cost).model_dump_json().encode())
        return cost


def _measured(
    name: str, expensive: EvaluationResults, cheap: EvaluationResults, cost: float
) -> ControlVariate:
    a, b = _by_world(expensive, name), _by_world(cheap, name)
    both = [seed for seed in a if seed in b]
    return ControlVariate.measured(
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
    whole = sum(row.success for row in results.rows)
    rare = name == "success" and not _FEWEST <= whole <= len(results.rows) - _FEWEST
    if cheap is None or rare:
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
    """Return by seed the weighted mean over the cases, for worlds in which all have run."""
    weights = {case.faults: case.weight for case in results.plan.cases}
    ran = (row for row in results.rows if row.carried_out)
    values = ((row.seed, row.faults, _QUANTITIES[quantity](row)) for row in ran)
    return weighted_world_means(values, weights)


def _estimate(values: NDArray[np.float64]) -> Estimate:
    """The mean with the interval of Student's distribution."""
    from scipy.stats import t

    n = len(values)
    value = float(values.mean()) if n else math.nan
    half = float(t.ppf(0.975, n - 1) * values.std(ddof=1) / math.sqrt(n)) if n > 1 else math.inf
    return Estimate(value, value - half, value + half)
