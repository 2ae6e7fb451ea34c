"""Measures the tracked drive on UMAD: every flight, and how fast it is simulated.

python -m benchmarks.tracked --stairs [--seeds 20] [--processes 2]
python -m benchmarks.tracked --speed
"""

import argparse
import math
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from multiprocessing import get_context
from statistics import mean

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus, Trouble
from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.navigation import Navigator, Path
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.site import load_site
from argo_env.world.world import World

OFFSET = 0.05  # m, to each side, of the start
TURNED = math.radians(5.0)
GRIP = 0.15  # share
MASS = 0.05  # share
LONGEST = 300.0  # s of simulated time for one climb
THESIS_SPEED = 0.43  # simulated over wall time, both summed over the thesis' appendix A.2
LANDINGS = {"west tower": ((1.9, 2.8), (1.9, 7.95)), "east tower": ((12.3, 5.55), (12.3, 5.55))}
"""where a climb of one storey begins and ends, x and y in m"""
FLIGHTS = {"west tower": 1, "east tower": 2}
"""in a storey"""


@dataclass(frozen=True)
class Climb:
    """One way from floor to floor by one tower, up or down, with the dice of one seed."""

    tower: str
    storey: int
    up: bool
    seed: int


@dataclass(frozen=True)
class ClimbOutcome:
    """How a climb went."""

    climb: Climb
    arrived: bool
    failure: str | None
    stuck: int
    slipped: int
    seconds: float
    planned: float
    error: float
    """m from the end of the path"""
    turned: float
    """rad from its heading"""
    slip: float
    """share of the way of the belts by which it is longer than the path"""
    contacts: tuple[str, ...]


@lru_cache(maxsize=1)
def _site() -> tuple[Navigator, World]:
    opened = open_site("umad")
    return opened.navigator, World(opened.site, opened.robot)


def path_of(navigator: Navigator, tower: str, storey: int, up: bool) -> Path:
    """The way by that tower between the floor `storey` and the one above it."""
    floors = {f.number: f.z for f in navigator.site.spec.floors}
    (ax, ay), (bx, by) = LANDINGS[tower]
    low = Pose(x=ax, y=ay, z=floors[storey], yaw=0.0)
    high = Pose(x=bx, y=by, z=floors[storey + 1], yaw=0.0)
    return navigator.plan(low, high) if up else navigator.plan(high, low)


def run(climb: Climb) -> ClimbOutcome:
    """Drives one climb."""
    navigator, world = _site()
    path = path_of(navigator, climb.tower, climb.storey, climb.up)
    dice = generator(climb.seed, "tracked", climb.tower, climb.storey, int(climb.up))
    traction = Traction().scaled(1.0 + GRIP * dice.uniform(-1.0, 1.0))
    mass = 1.0 + MASS * dice.uniform(-1.0, 1.0)
    x, y = dice.uniform(-OFFSET, OFFSET, 2)
    start = path.start
    drive = TrackedDrive(world, navigator.robot, traction, mass)
    drive.place(
        BodyPose(start.x + x, start.y + y, start.z, start.yaw + TURNED * dice.uniform(-1.0, 1.0))
    )
    drive.begin(path, None)
    status, steps, belts, contacts = DriveStatus.MOVING, 0, 0.0, set()
    while status is DriveStatus.MOVING and steps * drive.time_step < LONGEST:
        status = drive.step()
        steps += 1
        belts += abs(sum(drive.body.belt_speeds)) / 2 * drive.time_step
        contacts |= {f"{t.link} on {t.element}" for t in world.touches()}
    end, pose = path.end, drive.pose
    kinds = [i.trouble for i in drive.incidents]
    outcome = ClimbOutcome(
        climb,
        status is DriveStatus.ARRIVED,
        drive.failure or (None if status is DriveStatus.ARRIVED else "it took too long"),
        kinds.count(Trouble.STUCK),
        kinds.count(Trouble.SLIPPING),
        steps * drive.time_step,
        path.duration(navigator.robot),
        math.dist((pose.x, pose.y, pose.z), (end.x, end.y, end.z)),
        abs(math.remainder(pose.yaw - end.yaw, 2 * math.pi)),
        1.0 - path.length / belts,
        tuple(sorted(contacts)),
    )
    drive.body.close()
    return outcome


def stairs(seeds: int, processes: int) -> None:
    """Drives every flight up and down with every seed, and prints how it went."""
    storeys = len(load_site("umad").spec.floors) - 1
    climbs = [
        Climb(tower, storey, up, seed)
        for seed, tower, storey, up in product(
            range(seeds), LANDINGS, range(1, storeys + 1), (True, False)
        )
    ]
    context = get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        outcomes = []
        for outcome in pool.map(run, climbs, chunksize=4):
            outcomes.append(outcome)
            if len(outcomes) % 20 == 0:
                print(f"{len(outcomes)} of {len(climbs)} climbs", flush=True)
    print(f"{'way':22} flights  ok  stuck  slips  time/plan  end cm (max)  end deg  slip  contacts")
    for tower, up in product(LANDINGS, (True, False)):
        rows = [o for o in outcomes if o.climb.tower == tower and o.climb.up == up]
        ratio = mean(o.seconds / o.planned for o in rows)
        print(
            f"{tower + (' up' if up else ' down'):22} {len(rows) * FLIGHTS[tower]:7} "
            f"{sum(o.arrived for o in rows) * FLIGHTS[tower]:4} {sum(o.stuck for o in rows):5} "
            f"{sum(o.slipped for o in rows):6} {ratio:10.3f} "
            f"{100 * mean(o.error for o in rows):7.1f} ({100 * max(o.error for o in rows):.1f}) "
            f"{math.degrees(mean(o.turned for o in rows)):8.2f} "
            f"{mean(o.slip for o in rows):6.3f} {sum(bool(o.contacts) for o in rows):6}"
        )
    for outcome in outcomes:
        if outcome.failure or outcome.stuck:
            print(outcome.climb, outcome.failure or "was stuck, and got free")
    for contact in sorted({c for o in outcomes for c in o.contacts}):
        print(f"contact: {contact} ({sum(contact in o.contacts for o in outcomes)} times)")


def _laps(navigator: Navigator) -> Iterator[tuple[str, Path]]:
    a, b = (Pose(x=x, y=1.6, z=0.0, yaw=0.0) for x in (2.0, 12.0))
    yield "slab", navigator.plan(a, b)
    for tower, up in product(LANDINGS, (True, False)):
        yield f"{tower} {'up' if up else 'down'}", path_of(navigator, tower, 1, up)


def speed(repeats: int) -> None:
    """Prints simulated seconds per second of one core, with the whole site loaded; the best of
    some repeats each, since whatever else the machine does only makes it slower."""
    navigator, world = _site()
    drive = TrackedDrive(world, navigator.robot)
    simulated_all, spent_all = 0.0, 0.0
    for name, path in _laps(navigator):
        laps = [_lap(drive, path) for _ in range(repeats)]
        simulated, spent = min(laps, key=lambda lap: lap[1])
        simulated_all, spent_all = simulated_all + simulated, spent_all + spent
        worst = max(lap[1] for lap in laps)
        print(
            f"{name:16} {simulated:6.1f} s in {spent:5.2f} CPU s: {simulated / spent:5.1f} x "
            f"(worst of {repeats}: {simulated / worst:.1f} x)"
        )
    load = os.getloadavg()[0]
    print(
        f"all: {simulated_all / spent_all:.1f} times real time on one core, with a load of "
        f"{load:.1f} on {os.cpu_count()}; the thesis' simulation: {THESIS_SPEED}"
    )


def _lap(drive: TrackedDrive, path: Path) -> tuple[float, float]:
    """Drives a path; gives the simulated seconds and those of the processor."""
    start = path.start
    drive.place(BodyPose(start.x, start.y, start.z, start.yaw))
    drive.begin(path, None)
    begun, steps = time.process_time(), 0
    while drive.step() is DriveStatus.MOVING:
        steps += 1
    return steps * drive.time_step, time.process_time() - begun


def main() -> None:
    """Runs what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--stairs", action="store_true", help="every flight, up and down")
    parser.add_argument("--speed", action="store_true", help="simulated over CPU time")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=3, help="of each lap of --speed")
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    if not arguments.stairs and not arguments.speed:
        parser.error("say --stairs or --speed")
    if arguments.stairs:
        stairs(arguments.seeds, arguments.processes)
    if arguments.speed:
        speed(arguments.repeats)


if __name__ == "__main__":
    main()
