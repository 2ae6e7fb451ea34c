"""Campaign: the tracked drive on every flight of UMAD's stair towers, up and down.

    python -m tests.campaigns.stairs --seeds 20 --processes 2

The start, grip and mass of each climb are drawn from a seed. Prints a table of the climbs, and each
climb that failed, got stuck or touched something; the exit status is then 1.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from multiprocessing import get_context
from statistics import mean

from argo_env.drives.drive import DriveStatus, Trouble
from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.site import load_site
from benchmarks.tracked import LANDINGS, open_world, plan_stair_path

START_ERROR = 0.05  # m, largest displacement of the start to each side
TURN_ERROR = math.radians(5.0)
GRIP_ERROR = 0.15  # share
MASS_ERROR = 0.05  # share
TIME_LIMIT = 300.0  # s of simulated time for one climb
FLIGHTS = {"west tower": 1, "east tower": 2}
"""number of flights of each tower in a storey"""


@dataclass(frozen=True)
class Climb:
    """Path from floor to floor in one tower, up or down, with the random values of one seed."""

    tower: str
    storey: int
    up: bool
    seed: int


@dataclass(frozen=True)
class ClimbOutcome:
    """Result of a climb."""

    climb: Climb
    arrived: bool
    failure: str | None
    stuck: int
    slipped: int
    seconds: float
    planned: float
    error: float
    """distance from the end of the path in m"""
    turned: float
    """difference from the heading at the end of the path in rad"""
    slip: float
    """share of the belts' travel by which it exceeds the length of the path"""
    contacts: tuple[str, ...]


def run(climb: Climb) -> ClimbOutcome:
    """Drive one climb."""
    navigator, world = open_world()
    path = plan_stair_path(navigator, climb.tower, climb.storey, climb.up)
    rng = generator(climb.seed, "tracked", climb.tower, climb.storey, int(climb.up))
    traction = Traction().with_scaled_grip(1.0 + GRIP_ERROR * rng.uniform(-1.0, 1.0))
    mass = 1.0 + MASS_ERROR * rng.uniform(-1.0, 1.0)
    x, y = rng.uniform(-START_ERROR, START_ERROR, 2)
    start = path.start
    drive = TrackedDrive(world, navigator.robot, traction, mass)
    drive.place_robot(
        BodyPose(start.x + x, start.y + y, start.z, start.yaw + TURN_ERROR * rng.uniform(-1.0, 1.0))
    )
    drive.follow(path, None)
    status, steps, belts, contacts = DriveStatus.MOVING, 0, 0.0, set()
    while status is DriveStatus.MOVING and steps * drive.time_step < TIME_LIMIT:
        status = drive.step()
        steps += 1
        belts += abs(sum(drive.body.belt_speeds)) / 2 * drive.time_step
        contacts |= {f"{t.link} on {t.element}" for t in world.touches()}
    end, pose = path.end, drive.pose
    kinds = [i.trouble for i in drive.incidents]
    outcome = ClimbOutcome(
        climb,
        status is DriveStatus.ARRIVED,
        drive.failure or (None if status is DriveStatus.ARRIVED else "it exceeded the time limit"),
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


def print_outcomes(outcomes: Sequence[ClimbOutcome]) -> None:
    """Print the table of the climbs, and those that failed, got stuck or touched something."""
    print(
        f"{'path':22} flights  ok  stuck  slips  time/plan  end cm (max)  end deg  slip  contacts"
    )
    for tower, up in product(LANDINGS, (True, False)):
        rows = [o for o in outcomes if o.climb.tower == tower and o.climb.up == up]
        if not rows:
            continue
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
            print(outcome.climb, outcome.failure or "was stuck, and freed itself")
    for contact in sorted({c for o in outcomes for c in o.contacts}):
        print(f"contact: {contact} ({sum(contact in o.contacts for o in outcomes)} times)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Drive every flight up and down with every seed."""
    storeys = range(1, len(load_site("umad").spec.floors))
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=20, help="number of seeds")
    parser.add_argument("--towers", nargs="+", choices=("west", "east"), default=("west", "east"))
    parser.add_argument("--storeys", nargs="+", type=int, choices=storeys, default=list(storeys))
    parser.add_argument("--processes", type=int, default=2, help="number of processes")
    options = parser.parse_args(arguments)
    climbs = [
        Climb(tower, storey, up, seed)
        for seed, tower, storey, up in product(
            range(options.seeds),
            [f"{name} tower" for name in options.towers],
            options.storeys,
            (True, False),
        )
    ]
    outcomes = []
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        for outcome in pool.map(
            run, climbs, chunksize=min(4, len(climbs) // options.processes or 1)
        ):
            outcomes.append(outcome)
            if len(outcomes) % 20 == 0:
                print(f"{len(outcomes)} of {len(climbs)} climbs", flush=True)
    print_outcomes(outcomes)
    return int(any(o.failure or o.stuck or o.contacts for o in outcomes))


if __name__ == "__main__":
    sys.exit(main())
