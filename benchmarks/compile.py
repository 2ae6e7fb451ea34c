"""Time from script text to an executable machine, and its growth with the number of tasks.

    python benchmarks/compile.py
    python benchmarks/compile.py --sizes 1000 10000 --repeats 5
    python benchmarks/compile.py --canonical 10000    # only print a script, in canonical sentences

The script for a number of tasks is always the same. Of its steps

- 35 % measure one checkpoint, by number or by name, in several wordings;
- 15 % drive to a named pose, an area or coordinates, which differ;
- 15 % measure or drive with a modifier: retries, the handling of a failure, a speed;
- 15 % measure, and choose the next step by one or two conditions;
- 10 % give two orders joined by `and`, or a task with its own name;
- 10 % patrol one of three floors, with four tasks each, for a duration that differs;

and for every fifty steps one line repeats eleven of them as a group. Numbers, names and coordinates
differ from line to line. `parse` includes the correction of misspellings, `resolve` names and links
the tasks, and `lower` checks the mission first. Times are CPU seconds of this process, in which all
stages run on one core without waiting. They are medians of the repeats, after the grammars have
been loaded; that time is printed once. Growth is the time for a task over that at the previous
size: 1 is linear. Memory is the peak of Python objects, measured in a separate run.

For comparison, the same number of flat states, each with one transition to the next, is declared in
python-statemachine if it is installed. That neither reads a script nor checks or nests anything, so
it is a lower limit of the time to build a machine of this size there.
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
    """Return an invented site of three floors with sixty checkpoints."""
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
    """Return a script of that many tasks besides START; the module describes its lines."""
    draw = random.Random(tasks)
    lines = ["Mission Protocol #1", "Maximum duration: 900 h", ""]
    lines.append("1. Set the starting point in starting area 1.")
    quantities = {"valve": "position", "pressure gauge": "value", "liquid level gauge": "level"}
    step = 1
    groups = []
    remaining = tasks
    while remaining > 0:
        step += 1
        checkpoint = draw.choice(catalog.checkpoints)
        k = checkpoint.id
        kind = draw.random()
        added = 1
        if remaining >= 4 and kind < 0.10:
            sentence = (
                f"Patrol floor {draw.randint(1, 3)} in circles for {draw.randint(2, 90)} minutes"
            )
            added = 4
        elif remaining >= 2 and kind < 0.15:
            sentence = f"Check checkpoint #{k} and go to the front of the site"
            added = 2
        elif kind < 0.20:
            sentence = f'"look {step}": inspect checkpoint #{k}'
        elif kind < 0.35:
            to = max(2, step - draw.randint(1, 20))
            sentence = draw.choice(
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
            sentence = draw.choice(
                [
                    f"Check checkpoint #{k}, retry {draw.randint(2, 5)} times",
                    f"Inspect #{k}; if it fails, abort the mission",
                    f"Go to ({draw.random() * 50:.2f}, 3, 2.5) at 0.{draw.randint(1, 9)} m/s",
                ]
            )
        elif kind < 0.65:
            sentence = draw.choice(
                [
                    "Go to the front of the site",
                    "Drive to starting area 1",
                    f"Go to ({draw.random() * 50:.2f}, {draw.random() * 20:.2f}, 0) heading"
                    f" {draw.randint(0, 359)} degrees",
                ]
            )
        else:
            quantity = quantities[checkpoint.kind]
            sentence = draw.choice(
                [
                    f"Check the checkpoint #{k}",
                    f"Let the robot measure checkpoint {k}",
                    f"Read the {quantity} of {checkpoint.name}",
                ]
            )
        lines.append(f"{step}. {sentence}.")
        remaining -= added
        if step % 50 == 0:
            groups.append(f"Repeat steps {step - 20} to {step - 10} {draw.randint(2, 5)} times.")
    return "\n".join(lines + groups) + "\n"


def make_canonical_script(tasks: int, catalog: Catalog) -> str:
    """Return the script of `make_script` in canonical sentences, as `format_script` writes it."""
    from argo_compiler.script import format_script, import_script

    return format_script(
        import_script(make_script(tasks, catalog), catalog).require_mission(), catalog
    )


def _parse_arguments(catalog: Catalog) -> tuple[list[str], str, list[str]]:
    """Return the names of poses, of the script, and of checkpoints, as `parse` takes them."""
    places = [place.name for place in catalog.places]
    return places, "script", [checkpoint.name for checkpoint in catalog.checkpoints]


def time_stages(text: str, catalog: Catalog) -> dict[str, float]:
    """Return the CPU seconds of each stage from the text to an executor, and `total`, their sum."""
    seconds: dict[str, float] = {}

    def time_stage(name: str, stage: Callable[..., Any], *arguments: Any) -> Any:
        gc.collect()
        began = time.process_time()
        result = stage(*arguments)
        seconds[name] = time.process_time() - began
        return result

    script = time_stage("parse", parse, text, *_parse_arguments(catalog))
    resolved = time_stage("resolve", resolve_script, script, catalog)
    machine = time_stage("lower", lower, resolved.mission)
    time_stage("executor", Executor, machine)
    seconds["total"] = sum(seconds.values())
    return seconds


def peak_memory_mb(text: str, catalog: Catalog) -> float:
    """Return the peak memory of Python objects from the text to an executor, in MB."""
    tracemalloc.start()
    mission = resolve_script(parse(text, *_parse_arguments(catalog)), catalog).mission
    Executor(lower(mission))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak / 1e6


def seconds_to_build_flat_statemachine(states: int) -> float:
    """Return the CPU seconds to declare and create a chain of states in python-statemachine."""
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
    parser.add_argument(
        "--repeats", type=int, default=3, help="repeats, of which the median is printed"
    )
    parser.add_argument(
        "--states",
        type=int,
        default=1_000,
        help="states in python-statemachine, which takes minutes for more",
    )
    parser.add_argument(
        "--canonical", type=int, metavar="TASKS", help="print a script with so many tasks instead"
    )
    options = parser.parse_args(arguments)
    if options.canonical:
        print(make_canonical_script(options.canonical, make_catalog()), end="")
        return
    from argo_compiler.script.parsing.repeats import repeats

    catalog = make_catalog()
    began = time.process_time()
    time_stages(make_script(200, catalog), catalog)
    print(f"first mission of 200 tasks, grammars loaded: {time.process_time() - began:.2f} s\n")
    print(f"{'tasks':>7} {'stage':<9} {'seconds':>9} {'µs/task':>9} {'growth per task':>16}")
    before: dict[str, float] = {}
    for size in options.sizes:
        text = make_script(size, catalog)
        runs = []
        for _ in range(options.repeats):
            repeats.cache_clear()  # clears lines that were read before
            runs.append(time_stages(text, catalog))
        for stage in runs[0]:
            median = statistics.median(run[stage] for run in runs)
            each = median / size * 1e6
            growth = f"{each / before[stage]:.2f}" if stage in before else ""
            print(f"{size:>7} {stage:<9} {median:>9.3f} {each:>9.1f} {growth:>16}")
            before[stage] = each
        memory = peak_memory_mb(text, catalog)
        print(f"{size:>7} {'memory':<9} {memory:>9.0f} MB for {len(text) / 1e6:.1f} MB of text\n")
    if importlib.util.find_spec("statemachine") is None:
        print("python-statemachine is not installed: no flat machine to compare with")
        return
    seconds = seconds_to_build_flat_statemachine(options.states)
    print(
        f"python-statemachine, {options.states} flat states: {seconds:.3f} s,"
        f" {seconds / options.states * 1e6:.1f} µs/state"
    )


if __name__ == "__main__":
    main()
