"""How far the times of the cheap drives are from those of the tracked one, and their calibration.

    python -m benchmarks.drives
    python -m benchmarks.drives --missions 40 --seed 500
    python -m benchmarks.drives --fit

The same random missions on a site are run with the drives `route`, `kinematic` and `tracked`: a
start in one of the docks, three to eight stops, each a checkpoint or a place on a floor where the
robot can turn, and an end in one of the docks. All of it is drawn from the mission's seed. The
error is that of the whole mission's simulated time against `tracked`. Wall time is that of a run,
with the making of its world and without that of the navigator, while as many others run as there
are workers. Missions that the tracked drive does not complete are counted, and left out of the
errors.

With `--fit` the tracked drive goes along the ways of missions with other seeds, the time of each
motion is taken, and `urdf/robot/<robot>.calibration.yaml` is written anew from that.
"""

import argparse
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Protocol

import numpy as np
import yaml

from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission, Task, Transition
from argo_env.drives.drive import Drive, DriveStatus
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.navigation import Navigator, Path
from argo_env.navigation.path import Motion
from argo_env.planning import OpenedSite, open_site
from argo_env.planning.start import start_pose
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import Calibration, MotionKind, RobotSpec, calibration_file, load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.seeding import generator
from argo_env.world.world import World
from benchmarks.fitting import TimedDrive, errors, fit
from benchmarks.options import seed_number

CHEAP = ("route", "kinematic")
FIRST_SEED = 0
FIRST_FITTED_SEED = 1_000
"""The missions of the fit are others than those of the comparison."""


_places = cache(Navigator.turning_poses)


def random_mission(navigator: Navigator, seed: int) -> Mission:
    """A start in a dock, three to eight stops all over the site, and an end in a dock."""
    site, rng = navigator.site, generator(seed, "random mission")
    start, end = (int(rng.choice(sorted(site.docks))) for _ in range(2))
    tasks = [Task(name="START", action=Action.START, pose=site.docks[start])]
    for k in range(1, 1 + int(rng.integers(3, 9))):
        if rng.random() < 0.5:
            checkpoint = str(site.checkpoints[rng.integers(len(site.checkpoints))].id)
            task = Task(name=f"STOP {k}", action=Action.MEASURE, object_id=checkpoint)
        else:
            floor = site.spec.floors[rng.integers(len(site.spec.floors))].number
            places = _places(navigator, floor)
            x, y, z, _ = places[rng.integers(len(places))].tolist()
            yaw = float(rng.uniform(-np.pi, np.pi))
            pose = Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=yaw)
            task = Task(name=f"STOP {k}", action=Action.WAYPOINT, pose=pose)
        tasks.append(task)
    tasks.append(Task(name="DOCK", action=Action.WAYPOINT, pose=site.docks[end]))
    linked = [
        a.model_copy(update={"transitions": (Transition(target=b.name),)})
        for a, b in pairwise(tasks)
    ]
    return Mission(site=site.name, start_area=start, end_area=end, tasks=(*linked, tasks[-1]))


@dataclass(frozen=True)
class Run:
    """One mission with one drive: what became of it, its simulated time and its wall time (s)."""

    seed: int
    drive: str
    verdict: str | None
    """None if it was completed"""
    simulated: float
    wall: float


def run(navigator: Navigator, seed: int, drive: str) -> Run:
    """Runs a random mission."""
    mission = random_mission(navigator, seed)
    began = time.perf_counter()
    result = simulate(
        RunSpec(mission=mission, site=navigator.site.name, drive=drive, seed=seed),
        OpenedSite.of_navigator(navigator),
    ).result
    wall = time.perf_counter() - began
    return Run(seed, drive, None if result.success else result.verdict, result.duration, wall)


class TellingDrive(Drive, Protocol):
    """A drive that tells which motion of its path is under way, None when that is done."""

    @property
    def motion(self) -> Motion | None: ...


def timed_motions(
    navigator: Navigator,
    seed: int,
    make: Callable[[World, RobotSpec], TellingDrive] = TrackedDrive,
) -> tuple[list[TimedDrive], int]:
    """The motions of the ways of a random mission, one by one, and how many ways failed.

    A way that fails is left out; the robot is put where it leads to.
    """
    mission = random_mission(navigator, seed)
    found: list[TimedDrive] = []
    failed = 0
    with World(navigator.site, navigator.robot) as world:
        drive = make(world, navigator.robot)
        start = navigator.snap(start_pose(mission, navigator.site.docks))
        drive.place(BodyPose(start.x, start.y, start.z, start.yaw))
        for task in mission.tasks[1:]:
            here = Pose(x=drive.pose.x, y=drive.pose.y, z=drive.pose.z, yaw=drive.pose.yaw)
            if task.pose is None:
                path = navigator.plan_to_view(here, int(task.object_id or 0))
            else:
                path = navigator.plan(here, task.pose)
            try:
                found += drive_along(drive, path)
            except RuntimeError:
                failed += 1
                drive.place(BodyPose(path.end.x, path.end.y, path.end.z, path.end.yaw))
    return found, failed


def drive_along(drive: TellingDrive, path: Path) -> list[TimedDrive]:
    """The motions of a path, each with the time that it took, to a step; RuntimeError if the drive
    fails. The last one takes until the robot is at rest."""
    drive.follow(path, None)
    found: list[TimedDrive] = []
    steps, begun, status = 0, 0, DriveStatus.MOVING
    while status is DriveStatus.MOVING:
        status = drive.step()
        steps += 1
        left = path.motions[len(found) :]
        # What is over in less than a step has ended together with the one before it.
        while len(left) > 1 and drive.motion is not left[0]:
            found.append(TimedDrive(left[:1], (steps - begun) * drive.time_step))
            begun, left = steps, left[1:]
    if status is DriveStatus.FAILED:
        raise RuntimeError(drive.failure)
    for motion in path.motions[len(found) :]:
        found.append(TimedDrive((motion,), (steps - begun) * drive.time_step))
        begun = steps
    return found


_navigator: Navigator | None = None


def _prepare(site: str) -> None:
    global _navigator
    _navigator = open_site(site).prepare().navigator


def _run(job: tuple[int, str]) -> Run:
    assert _navigator
    return run(_navigator, *job)


def _timed(seed: int) -> tuple[list[TimedDrive], int]:
    assert _navigator
    return timed_motions(_navigator, seed)


def compare(runs: list[Run]) -> Iterator[str]:
    """The table of the errors of the cheap drives, line by line."""
    of = {(r.seed, r.drive): r for r in runs}
    tracked = [r for r in runs if r.drive == "tracked"]
    done = [r for r in tracked if r.verdict is None]
    simulated = [r.simulated for r in done]
    yield f"{len(done)} of {len(tracked)} missions completed by the tracked drive"
    for r in tracked:
        if r.verdict is not None:
            yield f"  mission {r.seed} was not, after {r.simulated:.0f} s: {r.verdict}"
    if not done:
        return
    yield (
        f"they take {min(simulated):.0f} to {max(simulated):.0f} s, "
        f"{statistics.median(simulated):.0f} s in the median\n"
    )
    heads = ("median", "90 %", "most", "mean", "wall", "real time")
    yield f"{'drive':<10} " + " ".join(f"{head:>9}" for head in heads)
    for drive in (*CHEAP, "tracked"):
        same = [of[r.seed, drive] for r in done]
        away = np.array([a.simulated / b.simulated - 1 for a, b in zip(same, done, strict=True)])
        size = np.abs(away) * 100
        wall = sum(r.wall for r in same)
        yield (
            f"{drive:<10} {np.median(size):>7.2f} % {np.quantile(size, 0.9):>7.2f} % "
            f"{size.max():>7.2f} % {away.mean() * 100:>+7.2f} % {wall / len(same):>7.2f} s "
            f"{sum(simulated) / wall:>7.0f} x"
        )


def describe_fit(drives: list[TimedDrive], robot: RobotSpec, source: str) -> list[str]:
    """How a calibration was made and what it leaves over, line by line."""
    away = errors(drives, robot)
    seconds = np.array([d.seconds for d in drives])
    lines = [
        "Made by `python -m benchmarks.drives --fit` from the motions of the tracked drive in",
        f"{source}.",
        "For each kind of motion: the share of the told speed that is reached, and the seconds",
        "that each motion takes in addition. Least squares over the times of the motions:",
    ]
    for kind in MotionKind:
        mine = np.array([all(m.kind is kind for m in d.motions) for d in drives])
        if mine.any():
            lines.append(
                f"- {kind}: {mine.sum()} motions, {seconds[mine].sum():.0f} s, "
                f"error of one {np.sqrt((away[mine] ** 2).mean()):.2f} s (root mean square)"
            )
    lines.append(
        f"All together: {away.sum() / seconds.sum() * 100:+.2f} % of {seconds.sum():.0f} s."
    )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the comparison, or fit the calibration and print that."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--site", default="umad")
    parser.add_argument("--missions", type=int, default=24)
    parser.add_argument("--seed", type=seed_number, help="of the first mission; the others follow")
    parser.add_argument("--workers", type=int, default=min(2, os.cpu_count() or 1))
    parser.add_argument("--fit", action="store_true", help="write the calibration anew")
    given = parser.parse_args(arguments)
    first = given.seed
    if first is None:
        first = FIRST_FITTED_SEED if given.fit else FIRST_SEED
    seeds = range(first, first + given.missions)
    with ProcessPoolExecutor(given.workers, initializer=_prepare, initargs=(given.site,)) as pool:
        if not given.fit:
            jobs = [(seed, drive) for seed in seeds for drive in (*CHEAP, "tracked")]
            runs = []
            for done in pool.map(_run, jobs):
                print(f"mission {done.seed}, {done.drive}: {done.simulated:.1f} s", flush=True)
                runs.append(done)
            print("\n".join(["", *compare(runs)]))
            return
        timed = list(pool.map(_timed, seeds))
    drives = [d for found, _ in timed for d in found]
    robot = load_robot()
    calibration = fit(drives, robot)
    robot = robot.model_copy(update={"calibration": calibration})
    source = (
        f"{len(seeds)} missions on {given.site} (seeds {seeds[0]} to {seeds[-1]}), "
        f"{sum(failed for _, failed in timed)} ways left out that failed"
    )
    write(calibration, describe_fit(drives, robot, source))


def write(calibration: Calibration, header: list[str]) -> None:
    """Writes the calibration beside the robot's description, and prints it."""
    text = "".join(f"# {line}\n" for line in header) + "\n"
    text += yaml.safe_dump(calibration.model_dump(), sort_keys=False, default_flow_style=None)
    path = calibration_file("tracker")
    path.write_text(text, encoding="utf-8")
    print(f"{text}\nwritten to {path}")


if __name__ == "__main__":
    main()
