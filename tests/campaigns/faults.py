"""What the robot finds by itself, and what it takes for something where there is nothing.

    python -m tests.campaigns.faults --clean 100
    python -m tests.campaigns.faults --bricks 50

`--clean` runs random missions without any fault: a start in one of the docks, one to three
checkpoints anywhere on the site, and an end in one of the docks, all drawn from the mission's seed,
which also draws the noise of all sensors. Whatever is found there is a false alarm.

`--bricks` runs random missions to one checkpoint and back with a brick somewhere on the planned way
on a level floor, turned in any way, and counts what was found, touched and reached all the same.
"""

import argparse
import time
from collections import Counter
from collections.abc import Sequence

from argo_compiler.il import EventKind, Mission
from argo_env.faults.walkway import Brick
from argo_env.navigation import Navigator
from argo_env.planning import OpenedSite, open_site
from argo_env.run.drives_and_sensors import DRIVES
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.seeding import generator
from argo_env.site import Site
from benchmarks.options import parse_seed
from tests.mission_writing import drive as waypoint
from tests.yard import from_place, measure


def random_mission(navigator: Navigator, seed: int) -> Mission:
    """A mission through checkpoints from dock to dock."""
    site, rng = navigator.site, generator(seed, "clean mission")
    start, end = (int(rng.choice(sorted(site.docks))) for _ in range(2))
    ids = [c.id for c in site.checkpoints]
    chosen = rng.choice(ids, size=min(len(ids), int(rng.integers(1, 4))), replace=False)
    mission = _round(site, start, end, chosen.tolist())
    return mission.model_copy(update={"start_area": start, "end_area": end})


def _round(site: Site, start: int, end: int, checkpoints: Sequence[int]) -> Mission:
    """A mission from dock to dock, without what a header says of them."""
    home = waypoint("DOCK", pose=site.docks[end])
    return from_place(site.docks[start], *map(measure, checkpoints), home, site=site.name)


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


def bricks(navigator: Navigator, count: int, first_seed: int, drive: str) -> None:
    """Runs missions with a brick in the way and prints what came of it."""
    runs = found = touched = reached = 0
    for seed in range(first_seed, first_seed + count):
        rng = generator(seed, "brick mission")
        site, area = navigator.site, min(navigator.site.docks)
        checkpoint = int(rng.choice([c.id for c in site.checkpoints]))
        way = navigator.plan_to_view(navigator.snap(site.docks[area]), checkpoint)
        floors = {f.z: f for f in site.spec.floors}
        places = [
            (floors[motion.start.z].number, motion.pose_at(float(rng.random())))
            for motion in way.motions
            if not motion.turn and motion.start.z == motion.end.z and motion.start.z in floors
        ]
        if not places:
            continue  # all on the ground beside the slab
        runs += 1
        floor, pose = places[int(rng.integers(len(places)))]
        brick = Brick(floor=floor, place=(pose.x, pose.y), yaw=float(rng.uniform(-90, 90)))
        mission = _round(site, area, area, [checkpoint])
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


def main(arguments: Sequence[str] | None = None) -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--clean", type=int, metavar="N", help="random missions without a fault")
    parser.add_argument("--bricks", type=int, metavar="N", help="missions with one in the way")
    parser.add_argument("--site", default="umad")
    parser.add_argument("--seed", type=parse_seed, default=0, help="of the first mission")
    parser.add_argument("--drive", choices=DRIVES, default="kinematic")
    given = parser.parse_args(arguments)
    if not given.clean and not given.bricks:
        parser.error("say --clean N or --bricks N")
    navigator = open_site(given.site).prepare().navigator
    if given.clean:
        clean(navigator, given.clean, given.seed, given.drive)
    if given.bricks:
        bricks(navigator, given.bricks, given.seed, given.drive)


if __name__ == "__main__":
    main()
