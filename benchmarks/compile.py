"""How long a mission takes from script text to an executable machine, and how that grows.

    python benchmarks/compile.py
    python benchmarks/compile.py --sizes 1000 10000 --repeats 5

The script is made for each number of tasks, always the same one. Of its steps

- 35 % measure one checkpoint, by number or by name, in several wordings;
- 15 % drive to a place, an area or coordinates of their own;
- 15 % measure or drive with a manner: retries, what to do after a failure, a speed;
- 15 % measure and decide by one or two conditions where to go on;
- 10 % give two commands joined by `and`, or a task with a name of its own;
- 10 % patrol one of three floors, four tasks each, for a time of their own;

and for every fifty steps one line repeats ten of them as a group. Numbers, names and coordinates
differ from line to line. `parse` includes healing, `resolve` names and links the tasks, `lower`
checks the mission first. Times are CPU seconds of this process (all stages run on one core and wait
for nothing), the median of the repeats, after the grammars have been loaded, which is shown once.
Growth is the time for a task over that at the size before: 1 is linear. The memory is the most that
Python objects took at once, in a run of its own.

For scale, the same number of flat states, each with one transition to the next, is declared in
python-statemachine where it is installed. That reads no script, checks nothing and nests nothing:
it is the least that building a machine of this size takes there.
"""

import argparse
import gc
import importlib.util
import random
import statistics
import time
import tracemalloc
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from argo_compiler.base.catalog import (
    Area,
    Catalog,
    CheckpointInfo,
    CheckpointKind,
    Floor,
    Interval,
    Place,
)
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Executor, lower
from argo_compiler.script import parse
from argo_compiler.script.resolve.importing import resolve_script

SIZES = (1_000, 10_000, 30_000, 100_000)


def make_catalog() -> Catalog:
    """A made-up site of three floors with sixty checkpoints."""
    kinds = list(CheckpointKind)
    scale = Interval(low=0, high=100)
    checkpoints = tuple(
        CheckpointInfo(
            id=k,
            kind=kinds[k % 3],
            name=f"{kinds[k % 3]} {'R' if kinds[k % 3] is CheckpointKind.VALVE else ''}{k}",
            floor=1 + k % 3,
            unit="bar",
            range=scale,
            nominal=Interval(low=20, high=80),
        )
        for k in range(1, 61)
    )
    corners = [(1, 1), (11, 1), (11, 7), (1, 7)]
    return Catalog(
        site="yard",
        checkpoints=checkpoints,
        areas=(Area(number=1, dock=Pose(x=-4, y=2, z=0)),),
        floors=tuple(
            Floor(number=f, z=2.5 * f, patrol=tuple(Pose(x=x, y=y, z=2.5 * f) for x, y in corners))
            for f in (1, 2, 3)
        ),
        places=(Place(name="front of the site", pose=Pose(x=-1, y=4, z=0)),),
    )


def make_script(tasks: int, catalog: Catalog) -> str:
    """A protocol of that many tasks besides START; see above for what it is made of."""
    draw = random.Random(tasks)
    lines = ["Mission Protocol #1", "Maximum duration: 900 h", ""]
    lines.append("1. Set the starting point in starting area 1.")
    readings = {"valve": "position", "pressure gauge": "value", "liquid level gauge": "level"}
    step = 1
    groups = []
    left = tasks
    while left > 0:
        step += 1
        checkpoint = draw.choice(catalog.checkpoints)
        k = checkpoint.id
        kind = draw.random()
        planned = 1
        if left >= 4 and kind < 0.10:
            said = f"Patrol floor {draw.randint(1, 3)} in circles for {draw.randint(2, 90)} minutes"
            planned = 4
        elif left >= 2 and kind < 0.15:
            said = f"Check checkpoint #{k} and go to the front of the site"
            planned = 2
        elif kind < 0.20:
            said = f'"look {step}": inspect checkpoint #{k}'
        elif kind < 0.35:
            to = max(2, step - draw.randint(1, 20))
            said = draw.choice(
                [
                    f"Check #{k}; if it is above {draw.randint(50, 99)} bar, skip to step {to}",
                    f"Check checkpoint #{k}. If the value is between {draw.randint(1, 20)} and"
                    f" {draw.randint(21, 90)}, go to step {to}; otherwise go on",
                    f"Measure checkpoint #{k}; if it is below {draw.random() * 9:.2f} and the value"
                    f" of checkpoint #{1 + (k + draw.randint(1, 58)) % 60} is at least 3,"
                    f" continue with step {to}",
                ]
            )
        elif kind < 0.50:
            said = draw.choice(
                [
                    f"Check checkpoint #{k}, retry {draw.randint(2, 5)} times",
                    f"Inspect #{k}; if it fails, abort the mission",
                    f"Go to ({draw.random() * 50:.2f}, 3, 2.5) at 0.{draw.randint(1, 9)} m/s",
                ]
            )
        elif kind < 0.65:
            said = draw.choice(
                [
                    "Go to the front of the site",
                    "Drive to starting area 1",
                    f"Go to ({draw.random() * 50:.2f}, {draw.random() * 20:.2f}, 0) heading"
                    f" {draw.randint(0, 359)} degrees",
                ]
            )
        else:
            reading = readings[checkpoint.kind]
            said = draw.choice(
                [
                    f"Check the checkpoint #{k}",
                    f"Let the robot measure checkpoint {k}",
                    f"Read the {reading} of {checkpoint.name}",
                ]
            )
        lines.append(f"{step}. {said}.")
        left -= planned
        if step % 50 == 0:
            groups.append(f"Repeat steps {step - 20} to {step - 10} {draw.randint(2, 5)} times.")
    return "\n".join(lines + groups) + "\n"


def _names(catalog: Catalog) -> tuple[list[str], str, list[str]]:
    """The names of places, of the script, and of checkpoints, as `parse` takes them."""
    places = [place.name for place in catalog.places]
    return places, "script", [checkpoint.name for checkpoint in catalog.checkpoints]


def stages(text: str, catalog: Catalog) -> dict[str, float]:
    """Seconds of each stage from the text to an executor."""
    seconds: dict[str, float] = {}

    def timed(name: str, stage: Callable[..., Any], *arguments: Any) -> Any:
        gc.collect()
        began = time.process_time()
        result = stage(*arguments)
        seconds[name] = time.process_time() - began
        return result

    script = timed("parse", parse, text, *_names(catalog))
    resolved = timed("resolve", resolve_script, script, catalog)
    machine = timed("lower", lower, resolved.mission)
    timed("executor", Executor, machine)
    seconds["total"] = sum(seconds.values())
    return seconds


def peak_memory(text: str, catalog: Catalog) -> float:
    """MB that Python objects took at most on the way."""
    tracemalloc.start()
    mission = resolve_script(parse(text, *_names(catalog)), catalog).mission
    Executor(lower(mission))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak / 1e6


def flat_statemachine(states: int) -> float:
    """Seconds to declare a flat chain of states in python-statemachine, and to make an instance."""
    from statemachine import State, StateMachine

    began = time.process_time()
    chain = [State(f"s{i}", initial=i == 0, final=i + 1 == states) for i in range(states)]
    body: dict[str, Any] = {f"s{i}": state for i, state in enumerate(chain)}
    for i, (one, other) in enumerate(pairwise(chain)):
        body[f"go{i}"] = one.to(other)
    type(StateMachine)("Flat", (StateMachine,), body)()
    return time.process_time() - began


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="numbers of tasks")
    parser.add_argument("--repeats", type=int, default=3, help="of which the median is shown")
    parser.add_argument(
        "--states",
        type=int,
        default=1_000,
        help="of python-statemachine, which takes minutes for more",
    )
    given = parser.parse_args(arguments)
    from argo_compiler.script.syntax.repeats import repeats

    catalog = make_catalog()
    began = time.process_time()
    stages(make_script(200, catalog), catalog)
    print(f"first mission of 200 tasks, grammars loaded: {time.process_time() - began:.2f} s\n")
    print(f"{'tasks':>7} {'stage':<9} {'seconds':>9} {'µs/task':>9} {'growth per task':>16}")
    before: dict[str, float] = {}
    for size in given.sizes:
        text = make_script(size, catalog)
        runs = []
        for _ in range(given.repeats):
            repeats.cache_clear()  # lines that the compiler has read before
            runs.append(stages(text, catalog))
        for stage in runs[0]:
            median = statistics.median(run[stage] for run in runs)
            each = median / size * 1e6
            growth = f"{each / before[stage]:.2f}" if stage in before else ""
            print(f"{size:>7} {stage:<9} {median:>9.3f} {each:>9.1f} {growth:>16}")
            before[stage] = each
        memory = peak_memory(text, catalog)
        print(f"{size:>7} {'memory':<9} {memory:>9.0f} MB for {len(text) / 1e6:.1f} MB of text\n")
    if importlib.util.find_spec("statemachine") is None:
        print("python-statemachine is not installed: no flat machine to compare with")
        return
    seconds = flat_statemachine(given.states)
    print(
        f"python-statemachine, {given.states} flat states: {seconds:.3f} s,"
        f" {seconds / given.states * 1e6:.1f} µs/state"
    )


if __name__ == "__main__":
    main()
