"""How fast evaluations are: runs a second, what is lost beside the simulation, and two workers
beside one, for each back end.

    python -m benchmarks.evaluate
    python -m benchmarks.evaluate --runs 1000 --kinematic 100 --backend processes
    python -m benchmarks.evaluate --power

The time outside the simulation is that of the whole with one worker, without its start, less that
of its runs, each of which its worker times. Two workers are held against one by the same runs one
after the other in this process, in turn with them in parts, so that other work on the machine slows
both. Memory is the most that workers have taken by the first and by the last
tenth of the runs.
With `--power`: how often two plans with a known difference are told apart.
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


def plan_of(drive: str, seeds: range) -> EvaluationPlan:
    """Mission #1 with a drive, in the worlds of these seeds."""
    upload = Upload(str(SCRIPT), SCRIPT.read_bytes())
    mission = import_mission(upload, open_site("umad").prepare(), 1, 2).mission
    case = EvaluationCase(mission="mission 1", spec=RunSpec(mission=mission, drive=drive))
    return EvaluationPlan(cases=(case,), seeds=tuple(seeds))


def watched(order: WorkOrder) -> RunRow:
    """A run whose row says how long it took (s), and how much memory its worker has taken (MB) by
    its end."""
    begun = time.perf_counter()
    row = execute_run(order)
    taken = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    world = {"seconds": time.perf_counter() - begun, "memory": taken}
    return row.model_copy(update={"world": world})


def parts(seeds: int) -> Iterator[range]:
    """The seeds in some parts, each as large as the others."""
    size = -(-seeds // _PARTS)
    for first in range(0, seeds, size):
        yield range(first, min(seeds, first + size))


@dataclass(frozen=True)
class Measured:
    """What so many workers made of some runs."""

    took: float
    """s"""
    running: float
    """s that the runs took in their workers, all together"""
    alone: float
    """s that the same runs took one after the other in this process, in turn with them"""
    memory: tuple[float, ...]
    """MB that a worker had taken at most by the end of each run"""


def measured(name: str, drive: str, runs: int, workers: int) -> Measured:
    """Makes the runs with so many workers of a back end."""
    plan = plan_of(drive, range(runs))
    took, running, alone = 0.0, 0.0, 0.0
    memory: list[float] = []
    backend = make_backend(name, workers)
    try:  # they open the site
        list(EvaluationRunner(plan_of(drive, range(10_000, 10_008)), backend).rows_as_completed())
        for run in plan_of(drive, range(20_000, 20_002)).runs():
            execute_run(WorkOrder("", plan.cases[0], run.spec, {}))
        for part in parts(runs):
            partial = plan.model_copy(update={"seeds": tuple(part)})
            begun = time.perf_counter()
            evaluating = EvaluationRunner(partial, backend, call=watched)
            rows = list(evaluating.rows_as_completed())
            took += time.perf_counter() - begun
            assert [row.outcome for row in rows] == [RunOutcome.SUCCESS] * len(part)
            running += sum(row.world["seconds"] for row in rows)
            memory += [row.world["memory"] for row in rows]
            begun = time.perf_counter()
            for run in partial.runs():
                watched(WorkOrder("", partial.cases[0], run.spec, {}))
            alone += time.perf_counter() - begun
    finally:
        backend.close()
    return Measured(took, running, alone, tuple(memory))


def measure(name: str, drive: str, runs: int) -> None:
    """Prints what a back end makes of so many runs."""
    one, two = (measured(name, drive, runs, workers) for workers in (1, 2))
    # Each is held against this process at the same time, so that other work counts on both sides.
    times = (two.alone / two.took) / (one.alone / one.took)
    tenth = max(1, runs // 10)
    print(
        f"{name:<10} {drive:<10} {runs:>5} runs: {runs / one.took:6.1f} a second with one worker, "
        f"{runs / two.took:6.1f} with two ({times:.2f} times as many), "
        f"{100 * (one.took / one.running - 1):5.1f} % beside the simulation, memory of a worker "
        f"{max(two.memory[:tenth]):.0f} MB after a tenth of the runs, "
        f"{max(two.memory[-tenth:]):.0f} MB after all",
        flush=True,
    )


def show_power(comparisons: int) -> None:
    """Prints how often plans are told apart whose difference is known, and how often one that is
    compared with itself is."""
    rng = np.random.default_rng(0)
    for worlds in (100, 300, 1_000):
        for better, worse in ((0.95, 0.90), (0.98, 0.95)):
            # As hard worlds are hard for both: half of what fails fails together.
            common = (1 - better) / 2
            only_better, only_worse = (1 - worse) - common, (1 - better) - common
            counts = rng.multinomial(
                worlds, [only_better, only_worse, 1 - only_better - only_worse], comparisons
            )
            found = sum(
                SuccessPairs(int(both), int(a), int(b), 0).p_value <= 0.05 for a, b, both in counts
            )
            expected = power(worlds, only_better, only_worse)
            print(
                f"{worlds:>5} worlds, {better:.0%} beside {worse:.0%}: told apart in "
                f"{found / comparisons:.0%} of {comparisons} comparisons ({expected:.0%} reckoned)"
            )
    same = 0
    for _ in range(comparisons):
        done = rng.random(300) < 0.9
        same += SuccessPairs.from_successes(done, done).p_value <= 0.05
    print(f"a plan beside itself: a difference in {same} of {comparisons} comparisons")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=200, help="with `route`")
    parser.add_argument("--kinematic", type=int, default=20, help="runs with `kinematic`")
    parser.add_argument("--backend", choices=[*BACKENDS], nargs="*", default=[*BACKENDS])
    parser.add_argument("--power", action="store_true", help="of comparisons, and nothing else")
    parser.add_argument("--comparisons", type=int, default=2_000, help="of --power")
    asked = parser.parse_args(arguments)
    if asked.power:
        show_power(asked.comparisons)
        return
    for name in asked.backend:
        for drive, runs in (("route", asked.runs), ("kinematic", asked.kinematic)):
            if runs:
                measure(name, drive, runs)


if __name__ == "__main__":
    main()
