"""How fast Argo is: a dozen ratios to something else on the same machine in the same run.

    make speed                              # beside the values kept in benchmarks/speed.json
    python -m benchmarks.speed --write      # keeps those of this run
    python -m benchmarks.speed --only edit executor
    python -m benchmarks.speed --smallest   # one turn of what is short, as its test does

What is timed and what it is held against are timed in turn, so that what slows the machine down
slows both; a figure is the median of the turns. Commands are held against `import numpy` (wall
time), the executor against py_trees where it is installed, and all else against a fixed piece of
work in Python and NumPy (processor time). Edits are made by a service of its own, and wait for the
disk: they are held against three times that work and as many durable writes (wall time).
What has become slower by more than 15 % is named, and then the status is 1.
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

KEPT = Path(__file__).with_name("speed.json")
MOST_LOST = 0.15
"""share of its speed that something may lose before it is named"""
TASKS, EDITED_TASKS, EDITS = 1_000, 200, 10
Clock = Callable[[], float]


@dataclass(frozen=True)
class Figure:
    """A ratio that is kept; `measure` takes how many turns count."""

    name: str
    unit: str
    measure: Callable[[int], float | None]
    """None: what it is held against is not installed"""
    turns: int = 5
    more_is_faster: bool = False
    short: bool = True

    def speed(self, now: float, kept: float) -> float:
        """Return how many times as fast it is now as it was."""
        return now / kept if self.more_is_faster else kept / now


def fixed_work() -> float:
    """Do what never changes, some hundredths of a second: calls, dictionaries and small arrays."""
    found: dict[int, float] = {}
    for number in range(40_000):
        found[number % 997] = found.get(number % 991, 0.0) * 0.5 + number
    grid = np.linspace(0.0, 1.0, 4_096).reshape(64, 64)
    for _ in range(200):
        grid = np.sqrt(grid @ grid.T / 64.0 + 0.5)
    return sum(found.values()) + float(grid.sum())


def beside_fixed_work(
    prepare: Callable[[], Work],
    turns: int,
    *,
    calls: int = 1,
    fixed: Work = fixed_work,
    clock: Clock = time.process_time,
) -> float:
    """Return how many times as long as the fixed work a work takes. A turn does it `calls` times;
    of several turns the first does not count."""
    work = prepare()
    ratios = []
    for _ in range(turns + (turns > 1)):
        gc.collect()
        before = clock()
        for _ in range(3):
            fixed()
        between = clock()
        for _ in range(calls):
            work()
        ratios.append((clock() - between) / calls / ((between - before) / 3))
    return median(ratios[turns > 1 :])


def executor(turns: int) -> float | None:
    """Return how many times as many events as py_trees the executor takes."""
    if importlib.util.find_spec("py_trees") is None:
        return None
    machines = {name: hfsm.PEERS[name] for name in ("Argo", "py_trees")}
    rates = hfsm.measure(hfsm.EVENTS, turns, machines)
    return rates["Argo"] / rates["py_trees"]


def command(name: str, turns: int) -> float:
    """Return how many times as long as `import numpy` a command takes."""
    with tempfile.TemporaryDirectory() as folder:
        chosen = {name: startup.commands(Path(folder))[name]}
        return startup.measure(chosen, turns)[name][0]


def importing() -> Work:
    """Scripts of a thousand tasks become missions; each is read for the first time."""
    from argo_compiler.script import import_script
    from argo_compiler.script.syntax.repeats import repeats
    from benchmarks.compile import make_catalog, make_script

    catalog = make_catalog()
    text = make_script(TASKS, catalog)

    def work() -> None:
        repeats.cache_clear()
        import_script(text, catalog)

    return work


def checking() -> Work:
    """A mission of a thousand tasks is checked, and its paths are analysed."""
    from argo_compiler.analysis import analyse
    from argo_compiler.checks import check
    from argo_compiler.script import import_script
    from benchmarks.compile import make_catalog, make_script

    catalog = make_catalog()
    mission = import_script(make_script(TASKS, catalog), catalog).mission
    return lambda: (check(mission, catalog), analyse(mission, catalog))


def route_steps() -> Work:
    """A hundred steps of 64 episodes of Route-v0."""
    from benchmarks.env import argo_batch

    steps = argo_batch(64)
    return lambda: [next(steps) for _ in range(100)]


def proving() -> Work:
    """The best routes of eight problems of a dozen visits are found and proven."""
    from argo_compiler.route.suggestion import suggest_route
    from benchmarks.route_parts import generated

    problems = list(generated(("plain", "windows", "optional", "order"), 2, 12, 0))

    def work() -> None:
        for problem in problems:
            assert suggest_route(problem, 30.0, explain=False).proven

    return work


@contextmanager
def editing() -> Iterator[Work]:
    """Yield what makes ten durable edits of a mission of 200 tasks, by a service of its own."""
    import httpx

    from benchmarks.service import HEADERS, edit, mission, service

    with (
        tempfile.TemporaryDirectory() as folder,
        service(Path(folder)) as (address, _),
        httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client,
    ):
        body = {"name": "edited", "mission": mission(EDITED_TASKS)}
        id = client.post("/api/missions", json=body).raise_for_status().json()["id"]
        revisions = count(1)

        def work() -> None:
            for _ in range(EDITS):
                revision = next(revisions)
                edit(client, id, revision, f"t{revision % 50}", 0.1 + revision / 1e5)

        yield work


def edits(turns: int) -> float:
    """Return how many times as long as three times the fixed work, and as many durable writes, ten
    edits take."""
    with editing() as work, tempfile.TemporaryFile() as file:

        def fixed() -> None:
            for _ in range(3):  # about as much as the service has to do
                fixed_work()
            for _ in range(EDITS):
                file.write(bytes(300))
                file.flush()
                os.fsync(file.fileno())

        return beside_fixed_work(lambda: work, turns, fixed=fixed, clock=time.perf_counter)


def _argo(name: str) -> Figure:
    return Figure(name, "x `import numpy`", partial(command, name), turns=9)


def _work(
    name: str, prepare: Callable[[], Work], turns: int = 5, calls: int = 1, short: bool = True
) -> Figure:
    measure = partial(beside_fixed_work, prepare, calls=calls)
    return Figure(name, "x the fixed work", measure, turns, short=short)


FIGURES = (
    Figure("executor", "x py_trees", executor, turns=9, more_is_faster=True),
    _argo("argo --help"),
    _argo("argo check, a script"),
    _argo("argo check, a mission"),
    _argo("argo import"),
    _work("import of 1,000 tasks", importing, 3),
    _work("check of 1,000 tasks", checking, 3),
    _work("100 steps of Route-v0", route_steps),
    _work("50 steps of Drive-v0", against.drive_random),
    _work("run, route", partial(against.mission_run, "route", again=True), calls=5),
    _work("run, kinematic", partial(against.mission_run, "kinematic", again=True)),
    _work("run, tracked", partial(against.mission_run, "tracked"), 2, short=False),
    _work("8 routes proven", proving),
    Figure("10 edits", "x 3 times that, and 10 writes", edits),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print all of it; the status is 1 where something has become slower."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", metavar="WORD", help="figures with one of these words")
    parser.add_argument("--smallest", action="store_true", help="one turn of each")
    parser.add_argument("--write", action="store_true", help="keep the values of this run")
    parser.add_argument("--kept", type=Path, default=KEPT, help="where they are kept")
    options = parser.parse_args(arguments)
    kept = json.loads(options.kept.read_text(encoding="utf-8")) if options.kept.exists() else {}
    fallen = []
    print(f"{'':24}{'now':>9}{'kept':>9}   speed")
    for figure in FIGURES:
        if options.only and not any(word in figure.name for word in options.only):
            continue
        if options.smallest and not figure.short:
            continue
        now = figure.measure(1 if options.smallest else figure.turns)
        if now is None:
            print(f"{figure.name:24}{'-':>9}   not installed: {figure.unit.removeprefix('x ')}")
            continue
        line = f"{figure.name:24}{now:9.2f}"
        if (before := kept.get(figure.name)) is not None:
            speed = figure.speed(now, before)
            line += f"{before:9.2f}{speed:8.2f}"
            fallen += [f"{figure.name} ({speed:.2f})"] if speed < 1.0 - MOST_LOST else []
        print(f"{line}   {figure.unit}", flush=True)
        if options.write:
            kept[figure.name] = round(now, 3)
    if options.write:
        options.kept.write_text(json.dumps(kept, indent=2) + "\n", encoding="utf-8")
        return 0
    if fallen:
        print(f"slower by more than {MOST_LOST:.0%}: {', '.join(fallen)}")
    return 1 if fallen else 0


if __name__ == "__main__":
    sys.exit(main())
