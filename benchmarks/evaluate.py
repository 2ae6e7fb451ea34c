"""Speed of evaluations: runs per second, time outside the simulation, and gain of a second worker.

    python -m benchmarks.evaluate
    python -m benchmarks.evaluate --runs 1000 --kinematic 100 --backend processes
    python -m benchmarks.evaluate --power

It measures each back end. The time outside the simulation is the wall time of all runs with one
worker, without its start, minus the sum of the runs' times, which the worker measures. For the
comparison of two workers with one, this process makes the same runs one after the other, in parts
that alternate with those of the workers, so that other load on the machine slows both. Memory is
the peak of a worker in the first and in the last tenth of the runs.

`--power` prints how often the comparison of two plans detects a known difference.
"""

import argparse
import resource
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.estimates.pairs import SuccessPairs, power
from argo_env.evaluation.plan import EvaluationPlan
from argo_env.evaluation.pool.backends import BACKENDS, make_backend
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.runner import EvaluationRunner, WorkOrder, execute_run
from argo_env.planning.opening import open_site
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.importing import Upload, import_mission

SCRIPT = Path("scenarios/umad/missions/mission_1.txt")
_PARTS = 5


def make_plan(drive: str, seeds: range) -> EvaluationPlan:
    """Return the evaluation plan of UMAD's mission #1 with a drive, in the worlds of the seeds."""
    upload = Upload(str(SCRIPT), SCRIPT.read_bytes())
    mission = import_mission(upload, open_site("umad").prepare(), 1, 2).mission
    case = EvaluationCase(mission="mission 1", spec=RunSpec(mission=mission, drive=drive))
    return EvaluationPlan(cases=(case,), seeds=tuple(seeds))


def execute_timed_run(order: WorkOrder) -> RunRow:
    """Execute a run, and add its time (s) and the peak memory of its worker (MB) to its row."""
    begun = time.perf_counter()
    row = execute_run(order)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    world = {"seconds": time.perf_counter() - begun, "memory": peak}
    return row.model_copy(update={"world": world})


def seed_parts(seeds: int) -> Iterator[range]:
    """Yield the seeds 0 to `seeds` - 1 in up to five parts of one size; the last may be smaller."""
    size = -(-seeds // _PARTS)
    for first in range(0, seeds, size):
        yield range(first, min(seeds, first + size))


@dataclass(frozen=True)
class Timing:
    """Times and memory of some runs with a number of workers."""

    elapsed: float
    """wall time in s"""
    running: float
    """sum of the runs' times in their workers, in s"""
    alone: float
    """time of the same runs one after the other in this process, in s"""
    memory: tuple[float, ...]
    """peak memory of the worker by the end of each run, in MB"""


def time_runs(name: str, drive: str, runs: int, workers: int) -> Timing:
    """Time runs with the workers of the back end `name`, and the same runs in this process."""
    plan = make_plan(drive, range(runs))
    elapsed, running, alone = 0.0, 0.0, 0.0
    memory: list[float] = []
    backend = make_backend(name, workers)
    try:  # the first runs open the site in the workers and in this process
        list(EvaluationRunner(make_plan(drive, range(10_000, 10_008)), backend).rows_as_completed())
        for run in make_plan(drive, range(20_000, 20_002)).runs():
            execute_run(WorkOrder("", plan.cases[0], run.spec, {}))
        for part in seed_parts(runs):
            partial = plan.model_copy(update={"seeds": tuple(part)})
            begun = time.perf_counter()
            evaluating = EvaluationRunner(partial, backend, call=execute_timed_run)
            rows = list(evaluating.rows_as_completed())
            elapsed += time.perf_counter() - begun
            assert [row.outcome for row in rows] == [RunOutcome.SUCCESS] * len(part)
            running += sum(row.world["seconds"] for row in rows)
            memory += [row.world["memory"] for row in rows]
            begun = time.perf_counter()
            for run in partial.runs():
                execute_timed_run(WorkOrder("", partial.cases[0], run.spec, {}))
            alone += time.perf_counter() - begun
    finally:
        backend.close()
    return Timing(elapsed, running, alone, tuple(memory))


def measure_backend(name: str, drive: str, runs: int) -> None:
    """Print the figures of a back end for a number of runs."""
    one, two = (time_runs(name, drive, runs, workers) for workers in (1, 2))
    # Each is relative to this process at the same time, so that other load affects both sides.
    gain = (two.alone / two.elapsed) / (one.alone / one.elapsed)
    tenth = max(1, runs // 10)
    print(
        f"{name:<10} {drive:<10} {runs:>5} runs: {runs / one.elapsed:6.1f} a second with one "
        f"worker, {runs / two.elapsed:6.1f} with two ({gain:.2f} times as many), "
        f"{100 * (one.elapsed / one.running - 1):5.1f} % outside the simulation, memory of a "
        f"worker {max(two.memory[:tenth]):.0f} MB after a tenth of the runs, "
        f"{max(two.memory[-tenth:]):.0f} MB after all",
        flush=True,
    )


def show_comparison_power(comparisons: int) -> None:
    """Print the power of comparisons, and how often they find a difference where there is none."""
    rng = np.random.default_rng(0)
    for worlds in (100, 300, 1_000):
        for better, worse in ((0.95, 0.90), (0.98, 0.95)):
            # Difficult worlds are difficult for both plans: half of the failures are common.
            common = (1 - better) / 2
            only_better, only_worse = (1 - worse) - common, (1 - better) - common
            counts = rng.multinomial(
                worlds, [only_better, only_worse, 1 - only_better - only_worse], comparisons
            )
            detected = sum(
                SuccessPairs(int(both), int(a), int(b), 0).p_value <= 0.05 for a, b, both in counts
            )
            expected = power(worlds, only_better, only_worse)
            print(
                f"{worlds:>5} worlds, {better:.0%} and {worse:.0%}: detected in "
                f"{detected / comparisons:.0%} of {comparisons} comparisons "
                f"({expected:.0%} expected)"
            )
    errors = 0
    for _ in range(comparisons):
        successes = rng.random(300) < 0.9
        errors += SuccessPairs.from_successes(successes, successes).p_value <= 0.05
    print(f"a plan and itself: a difference in {errors} of {comparisons} comparisons")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=200, help="runs with `route`")
    parser.add_argument("--kinematic", type=int, default=20, help="runs with `kinematic`")
    parser.add_argument(
        "--backend", choices=[*BACKENDS], nargs="*", default=[*BACKENDS], help="back ends"
    )
    parser.add_argument(
        "--power", action="store_true", help="measure the power of comparisons only"
    )
    parser.add_argument(
        "--comparisons", type=int, default=2_000, help="number of comparisons with --power"
    )
    options = parser.parse_args(arguments)
    if options.power:
        show_comparison_power(options.comparisons)
        return
    for name in options.backend:
        for drive, runs in (("route", options.runs), ("kinematic", options.kinematic)):
            if runs:
                measure_backend(name, drive, runs)


if __name__ == "__main__":
    main()
