"""Campaign: findings of the robot without any fault, and with a brick on its path.

    python -m tests.campaigns.faults --clean 100
    python -m tests.campaigns.faults --bricks 50

`--clean` runs random missions without any fault, from a dock through one to three checkpoints
anywhere on the site to a dock. All of it is drawn from the mission's seed, from which the noise of
all sensors is drawn too. Each finding is a false alarm.

`--bricks` runs random missions to one checkpoint and back, with a brick of any orientation
somewhere on the planned path on a level floor. It counts the missions in which the brick was
detected, in which the robot touched something, and which succeeded all the same.
"""

import argparse
import time
from collections import Counter
from collections.abc import Sequence

from argo_compiler.il import EventKind, Mission
from argo_env.faults.walkway import Brick
from argo_env.navigation import Navigator
from argo_env.planning import OpenedSite, open_site
from argo_env.run.drives_and_sensors import drive_names
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.seeding import generator
from argo_env.site import Site
from benchmarks.options import parse_seed
from tests.mission_writing import drive as waypoint
from tests.yard import from_place, measure


def random_mission(navigator: Navigator, seed: int) -> Mission:
    """Draw a mission from a dock through one to three checkpoints to a dock."""
    site, rng = navigator.site, generator(seed, "clean mission")
    start, end = (int(rng.choice(sorted(site.docks))) for _ in range(2))
    ids = [c.id for c in site.checkpoints]
    chosen = rng.choice(ids, size=min(len(ids), int(rng.integers(1, 4))), replace=False)
    mission = _mission_through(site, start, end, chosen.tolist())
    return mission.model_copy(update={"start_area": start, "end_area": end})


def _mission_through(site: Site, start: int, end: int, checkpoints: Sequence[int]) -> Mission:
    """Return a mission from dock to dock, whose header does not state them."""
    home = waypoint("DOCK", pose=site.docks[end])
    return from_place(site.docks[start], *map(measure, checkpoints), home, site=site.name)


def run_without_faults(navigator: Navigator, count: int, first_seed: int, drive: str) -> None:
    """Run missions without faults, and print all findings."""
    alarms: Counter[str] = Counter()
    failed, simulated, wall = 0, 0.0, 0.0
    for done, seed in enumerate(range(first_seed, first_seed + count)):
        if done and done % 10 == 0:
            print(f"{done} missions, {simulated:.0f} s, {sum(alarms.values())} alarms", flush=True)
        mission = random_mission(navigator, seed)
        begun = time.perf_counter()
        record = simulate(
            RunSpec(mission=mission, site=navigator.site.name, seed=seed, drive=drive),
            OpenedSite.from_navigator(navigator),
        )
        wall += time.perf_counter() - begun
        simulated += record.result.duration
        for anomaly in record.anomalies:
            alarms[anomaly.kind] += 1
            print(f"seed {seed}, {anomaly.t:.1f} s: {anomaly.kind}: {anomaly.detail}", flush=True)
        if not record.result.success:
            failed += 1
            print(f"seed {seed}: {record.result.verdict}", flush=True)
    print(
        f"{count} missions without a fault, with the drive {drive}, {simulated / 3600:.1f} h of "
        f"simulated time, {simulated / wall:.0f} times real time: {sum(alarms.values())} false "
        f"alarms, {failed} missions without success"
    )


def run_with_bricks(navigator: Navigator, count: int, first_seed: int, drive: str) -> None:
    """Run missions with a brick on the path, and print the results."""
    runs = detected = touched = succeeded = 0
    for seed in range(first_seed, first_seed + count):
        rng = generator(seed, "brick mission")
        site, area = navigator.site, min(navigator.site.docks)
        checkpoint = int(rng.choice([c.id for c in site.checkpoints]))
        path = navigator.plan_to_view(navigator.snap_keeping_heading(site.docks[area]), checkpoint)
        floors = {f.z: f for f in site.spec.floors}
        poses = [
            (floors[motion.start.z].number, motion.pose_at(float(rng.random())))
            for motion in path.motions
            if not motion.turn and motion.start.z == motion.end.z and motion.start.z in floors
        ]
        if not poses:
            continue  # all motions are on the ground beside the slab
        runs += 1
        floor, pose = poses[int(rng.integers(len(poses)))]
        brick = Brick(floor=floor, place=(pose.x, pose.y), yaw=float(rng.uniform(-90, 90)))
        mission = _mission_through(site, area, area, [checkpoint])
        spec = RunSpec(mission=mission, site=site.name, seed=seed, drive=drive, faults=(brick,))
        record = simulate(spec, OpenedSite.from_navigator(navigator))
        detected += any(a.kind is EventKind.POSITIVE_OBSTACLE for a in record.anomalies)
        touched += bool(record.contacts)
        succeeded += record.result.success
        print(
            f"seed {seed}: checkpoint {checkpoint}, brick on floor {floor} at "
            f"({pose.x:.2f}, {pose.y:.2f}): {len(record.anomalies)} findings, "
            f"{len(record.contacts)} contacts, {record.result.verdict}",
            flush=True,
        )
    print(
        f"{runs} missions with a brick on the path, with the drive {drive}: detected in "
        f"{detected}, contacts in {touched}, successful all the same {succeeded}"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the campaigns that the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--clean", type=int, metavar="N", help="random missions without a fault")
    parser.add_argument(
        "--bricks", type=int, metavar="N", help="random missions with a brick on the path"
    )
    parser.add_argument("--site", default="umad")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of the first mission")
    parser.add_argument("--drive", choices=drive_names(), default="kinematic")
    options = parser.parse_args(arguments)
    if not options.clean and not options.bricks:
        parser.error("give --clean N, --bricks N or both")
    navigator = open_site(options.site).prepare().navigator
    if options.clean:
        run_without_faults(navigator, options.clean, options.seed, options.drive)
    if options.bricks:
        run_with_bricks(navigator, options.bricks, options.seed, options.drive)


if __name__ == "__main__":
    main()
