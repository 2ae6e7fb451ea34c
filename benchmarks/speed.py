"""Speed of Argo as a dozen ratios, each to a reference on the same machine in the same run.

    make speed                              # compare with the values in benchmarks/speed.json
    python -m benchmarks.speed --write      # store the values of this run
    python -m benchmarks.speed --only edit executor
    python -m benchmarks.speed --smallest   # one repeat of all short figures, as its test does

Each subject and its reference are timed alternately, so that other load on the machine slows both;
a figure is the median of the repeats. The reference of commands is `import numpy` (wall time), that
of the executor py_trees, if it is installed, and that of all others a fixed piece of work in Python
and NumPy (processor time). Edits are made by a service in a process of its own and wait for the
disk: their reference is three times the fixed work and as many durable writes as edits (wall time).
Figures that have become slower by more than 15 % are named, and the exit status is then 1.
"""

import argparse
import gc
import importlib.util
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from statistics import median

import numpy as np

from benchmarks import against, hfsm, startup
from benchmarks.against import Work

STORED_VALUES = Path(__file__).with_name("speed.json")
TOLERATED_LOSS = 0.15
"""share of its speed that a figure may lose before it is named"""
TASKS, EDITED_TASKS, EDITS = 1_000, 200, 10
Clock = Callable[[], float]


@dataclass(frozen=True)
class Figure:
    """Ratio that is measured and stored."""

    name: str
    unit: str
    measure: Callable[[int], float | None]
    """function from the number of repeats to the ratio; None: the reference is not installed"""
    repeats: int = 5
    more_is_faster: bool = False
    """whether the ratio compares speeds; otherwise it compares times"""
    short: bool = True
    """whether it is measured with `--smallest`"""

    def relative_speed(self, ratio_now: float, ratio_stored: float) -> float:
        """Return how many times as fast `ratio_now` is as `ratio_stored`; above 1: faster now."""
        return ratio_now / ratio_stored if self.more_is_faster else ratio_stored / ratio_now


def run_fixed_work() -> object:
    """Compute for some hundredths of a second with dictionaries and small arrays, as a reference.

    The returned number has no meaning.
    """
    sums: dict[int, float] = {}
    for number in range(40_000):
        sums[number % 997] = sums.get(number % 991, 0.0) * 0.5 + number
    grid = np.linspace(0.0, 1.0, 4_096).reshape(64, 64)
    for _ in range(200):
        grid = np.sqrt(grid @ grid.T / 64.0 + 0.5)
    return sum(sums.values()) + float(grid.sum())


def median_ratio_to_fixed_work(
    prepare: Callable[[], Work],
    repeats: int,
    *,
    calls: int = 1,
    fixed: Work = run_fixed_work,
    clock: Clock = time.process_time,
) -> float:
    """Return the time of the prepared work over that of `fixed`, the median of the repeats.

    A repeat does the work `calls` times and `fixed` three times; the mean times of a call are
    compared. If there are several repeats, one more comes first, which is not counted.
    """
    work = prepare()
    ratios = []
    for _ in range(repeats + (repeats > 1)):
        gc.collect()
        before = clock()
        for _ in range(3):
            fixed()
        between = clock()
        for _ in range(calls):
            work()
        ratios.append((clock() - between) / calls / ((between - before) / 3))
    return median(ratios[repeats > 1 :])


def executor_rate_over_py_trees(repeats: int) -> float | None:
    """Return the executor's events per second over those of py_trees; None: no py_trees."""
    if importlib.util.find_spec("py_trees") is None:
        return None
    machines = {name: hfsm.MACHINES[name] for name in ("Argo", "py_trees")}
    rates = hfsm.measure_median_rates(hfsm.EVENTS, repeats, machines)
    return rates["Argo"] / rates["py_trees"]


def compare_command_with_numpy(name: str, repeats: int) -> float:
    """Return the median ratio of a command's time to that of `import numpy`; see `startup`."""
    with tempfile.TemporaryDirectory() as folder:
        chosen = {name: startup.commands_and_max_ratios(Path(folder))[name]}
        return startup.measure_ratios_to_numpy(chosen, repeats)[name].median_ratio


def prepare_import() -> Work:
    """Return a function that imports a script of a thousand tasks, with empty caches."""
    from argo_compiler.script import import_script
    from argo_compiler.script.drafts.making import read_cached
    from argo_compiler.script.parsing.repeats import repeats
    from benchmarks.compile import make_catalog, make_script

    catalog = make_catalog()
    text = make_script(TASKS, catalog)

    def work() -> None:
        repeats.cache_clear()
        read_cached.cache_clear()
        import_script(text, catalog)

    return work


def prepare_check() -> Work:
    """Return a function that checks and analyses a mission of a thousand tasks."""
    from argo_compiler.analysis import analyse
    from argo_compiler.checks import check
    from argo_compiler.script import import_script
    from benchmarks.compile import make_catalog, make_script

    catalog = make_catalog()
    mission = import_script(make_script(TASKS, catalog), catalog).mission
    return lambda: (check(mission, catalog), analyse(mission, catalog))


def prepare_route_steps() -> Work:
    """Return a function that makes a hundred steps of a batch of 64 episodes of Route-v0."""
    from benchmarks.env import step_argo_batch

    steps = step_argo_batch(64)
    return lambda: [next(steps) for _ in range(100)]


def prepare_proofs() -> Work:
    """Return a function that finds and proves the best routes of 8 problems of 6 to 12 visits."""
    from argo_compiler.route.suggestion import suggest_route
    from benchmarks.route_parts import random_problems

    problems = list(random_problems(("plain", "windows", "optional", "order"), 2, 12, 0))

    def work() -> None:
        for problem in problems:
            assert suggest_route(problem, 30.0, explain=False).proven

    return work


@contextmanager
def edit_work_in_own_service() -> Iterator[Work]:
    """Yield a function that makes ten durable edits of a mission in a service of its own."""
    import httpx

    from benchmarks.service import HEADERS, change_velocity, make_mission, start_service

    with (
        tempfile.TemporaryDirectory() as folder,
        start_service(Path(folder)) as (address, _),
        httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client,
    ):
        body = {"name": "edited", "mission": make_mission(EDITED_TASKS)}
        id = client.post("/api/missions", json=body).raise_for_status().json()["id"]
        revisions = count(1)

        def work() -> None:
            for _ in range(EDITS):
                revision = next(revisions)
                change_velocity(client, id, revision, f"t{revision % 50}", 0.1 + revision / 1e5)

        yield work


def compare_edits_with_fixed_work(repeats: int) -> float:
    """Return the time of ten edits over that of three fixed works and ten durable writes."""
    with edit_work_in_own_service() as work, tempfile.TemporaryFile() as file:

        def fixed() -> None:
            for _ in range(3):  # about as much as the service does for ten edits
                run_fixed_work()
            for _ in range(EDITS):
                file.write(bytes(300))
                file.flush()
                os.fsync(file.fileno())

        return median_ratio_to_fixed_work(
            lambda: work, repeats, fixed=fixed, clock=time.perf_counter
        )


def _command_figure(name: str) -> Figure:
    return Figure(name, "x `import numpy`", partial(compare_command_with_numpy, name), repeats=9)


def _work_figure(
    name: str, prepare: Callable[[], Work], repeats: int = 5, calls: int = 1, short: bool = True
) -> Figure:
    measure = partial(median_ratio_to_fixed_work, prepare, calls=calls)
    return Figure(name, "x the fixed work", measure, repeats, short=short)


FIGURES = (
    Figure("executor", "x py_trees", executor_rate_over_py_trees, repeats=9, more_is_faster=True),
    _command_figure("argo --help"),
    _command_figure("argo check, a script"),
    _command_figure("argo check, a mission"),
    _command_figure("argo import"),
    _work_figure("import of 1,000 tasks", prepare_import, 3),
    _work_figure("check of 1,000 tasks", prepare_check, 3),
    _work_figure("100 steps of Route-v0", prepare_route_steps),
    _work_figure("50 steps of Drive-v0", against.prepare_random_drive),
    _work_figure(
        "run, route", partial(against.prepare_mission_run, "route", warmed_up=True), calls=5
    ),
    _work_figure(
        "run, kinematic", partial(against.prepare_mission_run, "kinematic", warmed_up=True)
    ),
    _work_figure("run, tracked", partial(against.prepare_mission_run, "tracked"), 2, short=False),
    _work_figure("8 routes proven", prepare_proofs),
    Figure("10 edits", "x 3 times the fixed work and 10 writes", compare_edits_with_fixed_work),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print all figures; return 1 if one of them has become too slow, otherwise 0."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="WORD",
        help="only figures whose name contains one of these words",
    )
    parser.add_argument("--smallest", action="store_true", help="one repeat of each short figure")
    parser.add_argument("--write", action="store_true", help="store the values of this run")
    parser.add_argument(
        "--kept", type=Path, default=STORED_VALUES, help="file with the stored values"
    )
    options = parser.parse_args(arguments)
    stored = json.loads(options.kept.read_text(encoding="utf-8")) if options.kept.exists() else {}
    slower = []
    print(f"{'':24}{'now':>9}{'stored':>9}   speed")
    for figure in FIGURES:
        if options.only and not any(word in figure.name for word in options.only):
            continue
        if options.smallest and not figure.short:
            continue
        now = figure.measure(1 if options.smallest else figure.repeats)
        if now is None:
            print(f"{figure.name:24}{'-':>9}   not installed: {figure.unit.removeprefix('x ')}")
            continue
        line = f"{figure.name:24}{now:9.2f}"
        if (before := stored.get(figure.name)) is not None:
            speed = figure.relative_speed(now, before)
            line += f"{before:9.2f}{speed:8.2f}"
            slower += [f"{figure.name} ({speed:.2f})"] if speed < 1.0 - TOLERATED_LOSS else []
        print(f"{line}   {figure.unit}", flush=True)
        if options.write:
            stored[figure.name] = round(now, 3)
    if options.write:
        options.kept.write_text(json.dumps(stored, indent=2) + "\n", encoding="utf-8")
        return 0
    if slower:
        print(f"slower by more than {TOLERATED_LOSS:.0%}: {', '.join(slower)}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
