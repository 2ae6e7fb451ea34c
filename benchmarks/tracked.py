"""Speed of the simulation of the tracked drive on UMAD, on the flat and on stairs.

    python -m benchmarks.tracked
    python -m benchmarks.tracked --laps slab --repeats 1

Prints simulated seconds per second of one core, with the whole site loaded: the best of some
repeats of each lap, since other load on the machine only makes it slower.
"""

import argparse
import os
import time
from collections.abc import Sequence
from functools import lru_cache, partial
from itertools import product

from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.navigation import Navigator, Path
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.world.world import World

THESIS_SPEED = 0.43  # sum of simulated time over sum of wall time in the thesis' appendix A.2
LANDINGS = {"west tower": ((1.9, 2.8), (1.9, 7.95)), "east tower": ((12.3, 5.55), (12.3, 5.55))}
"""start and end of a climb of one storey, x and y in m"""


@lru_cache(maxsize=1)
def open_world() -> tuple[Navigator, World]:
    """Return the navigator of UMAD and a world with the robot, opened once per process."""
    opened = open_site("umad")
    return opened.navigator, World(opened.site, opened.robot)


def plan_stair_path(navigator: Navigator, tower: str, lower_floor: int, up: bool) -> Path:
    """Return the path in a stair tower from a floor to the one above, or else back down."""
    floors = {f.number: f.z for f in navigator.site.spec.floors}
    (ax, ay), (bx, by) = LANDINGS[tower]
    low = Pose(x=ax, y=ay, z=floors[lower_floor], yaw=0.0)
    high = Pose(x=bx, y=by, z=floors[lower_floor + 1], yaw=0.0)
    return navigator.plan(low, high) if up else navigator.plan(high, low)


def _plan_on_slab(navigator: Navigator) -> Path:
    return navigator.plan(*(Pose(x=x, y=1.6, z=0.0, yaw=0.0) for x in (2.0, 12.0)))


LAPS = {"slab": _plan_on_slab} | {
    f"{tower} {'up' if up else 'down'}": partial(plan_stair_path, tower=tower, lower_floor=1, up=up)
    for tower, up in product(LANDINGS, (True, False))
}


def _drive_lap(drive: TrackedDrive, path: Path) -> tuple[float, float]:
    """Drive a path, and return the simulated seconds and the processor seconds."""
    start = path.start
    drive.place_robot(BodyPose(start.x, start.y, start.z, start.yaw))
    drive.follow(path, None)
    begun, steps = time.process_time(), 0
    while drive.step() is DriveStatus.MOVING:
        steps += 1
    return steps * drive.time_step, time.process_time() - begun


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the speed of each lap, and that of all laps together."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--laps", nargs="+", choices=LAPS, default=list(LAPS))
    parser.add_argument("--repeats", type=int, default=3, help="of each lap")
    options = parser.parse_args(arguments)
    navigator, world = open_world()
    drive = TrackedDrive(world, navigator.robot)
    simulated_all, spent_all = 0.0, 0.0
    for name in options.laps:
        path = LAPS[name](navigator)
        laps = [_drive_lap(drive, path) for _ in range(options.repeats)]
        simulated, spent = min(laps, key=lambda lap: lap[1])
        simulated_all, spent_all = simulated_all + simulated, spent_all + spent
        worst = max(lap[1] for lap in laps)
        print(
            f"{name:16} {simulated:6.1f} s in {spent:5.2f} CPU s: {simulated / spent:5.1f} x "
            f"(worst of {options.repeats}: {simulated / worst:.1f} x)"
        )
    load = os.getloadavg()[0]
    print(
        f"all: {simulated_all / spent_all:.1f} times real time on one core, with a load of "
        f"{load:.1f} on {os.cpu_count()}; the thesis' simulation: {THESIS_SPEED}"
    )


if __name__ == "__main__":
    main()
