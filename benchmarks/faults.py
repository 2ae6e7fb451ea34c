"""What the robot finds by itself, and what it takes for something where there is nothing.

    python -m benchmarks.faults --clean 100
    python -m benchmarks.faults --scenarios
    python -m benchmarks.faults --bricks 50

`--clean` runs random missions without any fault: a start in one of the docks, one to three
checkpoints anywhere on the site, and an end in one of the docks, all drawn from the mission's seed,
which also draws the noise of all sensors. Whatever is found there is a false alarm.

`--scenarios` runs the shipped scenarios of faults, each with several seeds, and prints what was
found, and how long after the fault had begun.

`--bricks` runs random missions to one checkpoint and back with a brick somewhere on the planned way
on a level floor, turned in any way, and counts what was found, touched and reached all the same.
"""

import argparse
import statistics
import time
from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from argo_compiler.hfsm import Resume
from argo_compiler.il import Action, EventKind, Mission, Task, Transition
from argo_compiler.script import import_script, read_script
from argo_env.faults.reading import read_faults
from argo_env.faults.walkway import Brick
from argo_env.files import resources
from argo_env.navigation import Navigator
from argo_env.planning import OpenedSite, open_site
from argo_env.planning.catalog import make_catalog
from argo_env.run.drives_and_sensors import DRIVES
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged
from argo_env.seeding import generator
from benchmarks.options import seed_number

OPERATOR = 300.0  # s, when a person lets a mission go on that waits for one


def random_mission(navigator: Navigator, seed: int) -> Mission:
    """A mission through checkpoints from dock to dock."""
    site, rng = navigator.site, generator(seed, "clean mission")
    start, end = (int(rng.choice(sorted(site.docks))) for _ in range(2))
    ids = [c.id for c in site.checkpoints]
    chosen = rng.choice(ids, size=min(len(ids), int(rng.integers(1, 4))), replace=False)
    tasks = [
        Task(name="START", action=Action.START, pose=site.docks[start]),
        *(
            Task(name=f"MEASURE {id}", action=Action.MEASURE, object_id=str(id))
            for id in chosen.tolist()
        ),
        Task(name="DOCK", action=Action.WAYPOINT, pose=site.docks[end]),
    ]
    mission = _chained(site.name, *tasks)
    return mission.model_copy(update={"start_area": start, "end_area": end})


def clean(navigator: Navigator, count: int, first_seed: int, drive: str) -> None:
    """Runs missions without faults and prints what was found all the same."""
    alarms: Counter[str] = Counter()
    failed, simulated, wall = 0, 0.0, 0.0
    for done, seed in enumerate(range(first_seed, first_seed + count)):
        if done and done % 10 == 0:
            print(f"{done} missions, {simulated:.0f} s, {sum(alarms.values())} alarms", flush=True)
        mission = random_mission(navigator, seed)
        began = time.perf_counter()
        record = simulate(
            RunSpec(mission=mission, site=navigator.site.name, seed=seed, drive=drive),
            OpenedSite.of_navigator(navigator),
        )
        wall += time.perf_counter() - began
        simulated += record.result.duration
        for anomaly in record.anomalies:
            alarms[anomaly.kind] += 1
            print(f"seed {seed}, {anomaly.t:.1f} s: {anomaly.kind}: {anomaly.detail}", flush=True)
        if not record.result.success:
            failed += 1
            print(f"seed {seed}: {record.result.verdict}", flush=True)
    print(
        f"{count} missions without a fault with the drive {drive}, {simulated / 3600:.1f} h of "
        f"simulated time, {simulated / wall:.0f} times real time: {sum(alarms.values())} false "
        f"alarms, {failed} missions without success"
    )


def scenarios(navigator: Navigator, seeds: int, drive: str) -> None:
    """Runs each shipped scenario and prints when its fault was found."""
    catalog = make_catalog(navigator)
    folder = resources.scenarios() / "umad" / "faults"
    print(
        "| fault | runs | as intended | found after (s), median | largest |\n|---|---|---|---|---|"
    )
    for path in sorted(folder.glob("*.yaml")):
        script = folder / f"{_mission_of(path)}.txt"
        mission = import_script(read_script(script), catalog).mission
        usual: set[str] = set()
        delays, good = [], 0
        for seed in range(seeds):
            spec = RunSpec(
                mission=mission,
                site=navigator.site.name,
                seed=seed,
                drive=drive,
                faults=read_faults(path),
                events=logged((OPERATOR, Resume())),
            )
            record = simulate(spec, OpenedSite.of_navigator(navigator))
            kinds = {str(a.kind) for a in record.anomalies}
            usual = usual or kinds
            good += kinds == usual and len(record.anomalies) <= 2 and record.contacts == ()
            delays += _delay(record)
        found = f"{statistics.median(delays):.1f} | {max(delays):.1f}" if delays else "| "
        print(f"| {path.stem} | {seeds} | {good} | {found} |", flush=True)


def bricks(navigator: Navigator, count: int, first_seed: int, drive: str) -> None:
    """Runs missions with a brick in the way and prints what came of it."""
    runs = found = touched = reached = 0
    for seed in range(first_seed, first_seed + count):
        rng = generator(seed, "brick mission")
        site, area = navigator.site, min(navigator.site.docks)
        checkpoint = str(rng.choice([c.id for c in site.checkpoints]))
        dock = site.docks[area]
        way = navigator.plan_to_view(navigator.snap(dock), int(checkpoint))
        floors = {f.z: f for f in site.spec.floors}
        places = [
            (floors[motion.start.z].number, motion.at(float(rng.random())))
            for motion in way.motions
            if not motion.turn and motion.start.z == motion.end.z and motion.start.z in floors
        ]
        if not places:
            continue  # all on the ground beside the slab
        runs += 1
        floor, pose = places[int(rng.integers(len(places)))]
        brick = Brick(floor=floor, place=(pose.x, pose.y), yaw=float(rng.uniform(-90, 90)))
        mission = _chained(
            site.name,
            Task(name="START", action=Action.START, pose=dock),
            Task(name="MEASURE", action=Action.MEASURE, object_id=checkpoint),
            Task(name="DOCK", action=Action.WAYPOINT, pose=dock),
        )
        spec = RunSpec(mission=mission, site=site.name, seed=seed, drive=drive, faults=(brick,))
        record = simulate(spec, OpenedSite.of_navigator(navigator))
        found += any(a.kind is EventKind.POSITIVE_OBSTACLE for a in record.anomalies)
        touched += bool(record.contacts)
        reached += record.result.success
        print(
            f"seed {seed}: checkpoint {checkpoint}, brick on floor {floor} at "
            f"({pose.x:.2f}, {pose.y:.2f}): {len(record.anomalies)} findings, "
            f"{len(record.contacts)} contacts, {record.result.verdict}",
            flush=True,
        )
    print(
        f"{runs} missions with a brick in the way with the drive {drive}: found in {found}, "
        f"touched in {touched}, the mission done all the same in {reached}"
    )


def _chained(site: str, *tasks: Task) -> Mission:
    linked = [
        a.model_copy(update={"transitions": (Transition(target=b.name),)})
        for a, b in pairwise(tasks)
    ]
    return Mission(site=site, tasks=(*linked, tasks[-1]))


def _mission_of(path: Path) -> str:
    """The name of the mission that a scenario is made for, from its second line."""
    second = path.read_text(encoding="utf-8").splitlines()[1]
    return second.removeprefix("# Made for ").partition(".txt")[0]


def _delay(record: RunRecord) -> list[float]:
    began = record.faults[0].begins
    return [a.t - began for a in record.anomalies[:1]]


def main() -> None:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--clean", type=int, metavar="N", help="random missions without a fault")
    parser.add_argument("--scenarios", type=int, metavar="SEEDS", nargs="?", const=3)
    parser.add_argument("--bricks", type=int, metavar="N", help="missions with one in the way")
    parser.add_argument("--site", default="umad")
    parser.add_argument("--seed", type=seed_number, default=0, help="of the first mission")
    parser.add_argument("--drive", choices=DRIVES, default="kinematic")
    given = parser.parse_args()
    navigator = open_site(given.site).prepare().navigator
    todo: list[Callable[[], None]] = []
    if given.clean:
        todo.append(lambda: clean(navigator, given.clean, given.seed, given.drive))
    if given.scenarios:
        todo.append(lambda: scenarios(navigator, given.scenarios, given.drive))
    if given.bricks:
        todo.append(lambda: bricks(navigator, given.bricks, given.seed, given.drive))
    if not todo:
        parser.error("say --clean N, --scenarios or --bricks N")
    for work in todo:
        work()


if __name__ == "__main__":
    main()
