"""Errors of the times of the cheap drives relative to the tracked one, and their calibration.

    python -m benchmarks.drives
    python -m benchmarks.drives --missions 40 --seed 500
    python -m benchmarks.drives --fit

The same random missions on a site are run with the drives `route`, `kinematic` and `tracked`. A
mission starts in a dock, has three to eight stops, each a checkpoint or a position on a floor where
the robot can turn, and ends in a dock; all of it is drawn from the mission's seed. The error is
that of the whole mission's simulated time, relative to `tracked`. The wall time of a run includes
making its world but not the navigator; as many runs as there are workers take place at the same
time. Missions that the tracked drive does not complete are counted, and left out of the errors.

With `--fit` the tracked drive follows the paths of missions with other seeds, each motion is timed,
and `urdf/robot/<robot>.calibration.yaml` is fitted to these times and replaced.
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

from argo_compiler.base.model import Pose
from argo_compiler.files.yaml_text import dump_yaml
from argo_compiler.il import Action, Mission, Task, Transition
from argo_env.drives.drive import Drive, DriveStatus
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.navigation import Navigator, Path
from argo_env.navigation.path import Motion
from argo_env.planning import OpenedSite, open_site
from argo_env.planning.start import start_pose_or_area_dock
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import Calibration, MotionKind, RobotSpec, calibration_file, load_robot
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.seeding import generator
from argo_env.world.world import World
from benchmarks.fitting import TimedDrive, fit_calibration, measured_minus_predicted_seconds
from benchmarks.options import parse_seed

CHEAP = ("route", "kinematic")
FIRST_SEED = 0
FIRST_FIT_SEED = 1_000
"""first seed of the fit, whose missions differ from those of the comparison"""


_turning_poses = cache(Navigator.turning_poses)


def random_mission(navigator: Navigator, seed: int) -> Mission:
    """Draw a mission with three to eight stops anywhere on the site, from a dock to a dock."""
    site, rng = navigator.site, generator(seed, "random mission")
    start, end = (int(rng.choice(sorted(site.docks))) for _ in range(2))
    tasks = [Task(name="START", action=Action.START, pose=site.docks[start])]
    for k in range(1, 1 + int(rng.integers(3, 9))):
        if rng.random() < 0.5:
            checkpoint = str(site.checkpoints[rng.integers(len(site.checkpoints))].id)
            task = Task(name=f"STOP {k}", action=Action.MEASURE, object_id=checkpoint)
        else:
            floor = site.spec.floors[rng.integers(len(site.spec.floors))].number
            poses = _turning_poses(navigator, floor)
            x, y, z, _ = poses[rng.integers(len(poses))].tolist()
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
    """Result of one mission with one drive: its verdict, simulated time and wall time (s)."""

    seed: int
    drive: str
    verdict: str | None
    """reason of the failure; None: the mission was completed"""
    simulated: float
    wall: float


def run_seed(navigator: Navigator, seed: int, drive: str) -> Run:
    """Run the random mission of a seed with a drive."""
    mission = random_mission(navigator, seed)
    began = time.perf_counter()
    result = simulate(
        RunSpec(mission=mission, site=navigator.site.name, drive=drive, seed=seed),
        OpenedSite.from_navigator(navigator),
    ).result
    wall = time.perf_counter() - began
    return Run(seed, drive, None if result.success else result.verdict, result.duration, wall)


class DriveWithMotion(Drive, Protocol):
    """Drive that has the current motion of its path as an attribute; None: the path is done."""

    @property
    def motion(self) -> Motion | None: ...


def time_motions_and_count_failed_paths(
    navigator: Navigator,
    seed: int,
    make: Callable[[World, RobotSpec], DriveWithMotion] = TrackedDrive,
) -> tuple[list[TimedDrive], int]:
    """Drive the paths of a random mission and time their motions one by one.

    A path on which the drive fails is left out; the robot is then put at its end.

    Returns:
        The timed motions, and the number of paths on which the drive failed.
    """
    mission = random_mission(navigator, seed)
    timed: list[TimedDrive] = []
    failed = 0
    with World(navigator.site, navigator.robot) as world:
        drive = make(world, navigator.robot)
        start = navigator.snap_keeping_heading(
            start_pose_or_area_dock(mission, navigator.site.docks)
        )
        drive.place_robot(BodyPose(start.x, start.y, start.z, start.yaw))
        for task in mission.tasks[1:]:
            here = Pose(x=drive.pose.x, y=drive.pose.y, z=drive.pose.z, yaw=drive.pose.yaw)
            if task.pose is None:
                path = navigator.plan_to_view(here, int(task.object_id or 0))
            else:
                path = navigator.plan(here, task.pose)
            try:
                timed += time_path(drive, path)
            except RuntimeError:
                failed += 1
                drive.place_robot(BodyPose(path.end.x, path.end.y, path.end.z, path.end.yaw))
    return timed, failed


def time_path(drive: DriveWithMotion, path: Path) -> list[TimedDrive]:
    """Drive along a path; return its motions, each timed to a whole number of time steps.

    The last motion lasts until the robot is at rest.

    Raises:
        RuntimeError: The drive fails.
    """
    drive.follow(path, None)
    timed: list[TimedDrive] = []
    steps, begun, status = 0, 0, DriveStatus.MOVING
    while status is DriveStatus.MOVING:
        status = drive.step()
        steps += 1
        remaining = path.motions[len(timed) :]
        # A motion that takes less than a step ends together with the one before it.
        while len(remaining) > 1 and drive.motion is not remaining[0]:
            timed.append(TimedDrive(remaining[:1], (steps - begun) * drive.time_step))
            begun, remaining = steps, remaining[1:]
    if status is DriveStatus.FAILED:
        raise RuntimeError(drive.failure)
    for motion in path.motions[len(timed) :]:
        timed.append(TimedDrive((motion,), (steps - begun) * drive.time_step))
        begun = steps
    return timed


_navigator: Navigator | None = None


def _prepare(site: str) -> None:
    global _navigator
    _navigator = open_site(site).prepare().navigator


def _run(job: tuple[int, str]) -> Run:
    assert _navigator
    return run_seed(_navigator, *job)


def _time_motions(seed: int) -> tuple[list[TimedDrive], int]:
    assert _navigator
    return time_motions_and_count_failed_paths(_navigator, seed)


def error_table(runs: list[Run]) -> Iterator[str]:
    """Yield the lines of the table of the cheap drives' errors."""
    by_seed_and_drive = {(r.seed, r.drive): r for r in runs}
    tracked = [r for r in runs if r.drive == "tracked"]
    completed = [r for r in tracked if r.verdict is None]
    simulated = [r.simulated for r in completed]
    yield f"{len(completed)} of {len(tracked)} missions completed by the tracked drive"
    for r in tracked:
        if r.verdict is not None:
            yield f"  mission {r.seed} failed after {r.simulated:.0f} s: {r.verdict}"
    if not completed:
        return
    yield (
        f"they take {min(simulated):.0f} to {max(simulated):.0f} s, "
        f"{statistics.median(simulated):.0f} s in the median\n"
    )
    heads = ("median", "90 %", "largest", "mean", "wall", "real time")
    yield f"{'drive':<10} " + " ".join(f"{head:>9}" for head in heads)
    for drive in (*CHEAP, "tracked"):
        same = [by_seed_and_drive[r.seed, drive] for r in completed]
        errors = np.array(
            [a.simulated / b.simulated - 1 for a, b in zip(same, completed, strict=True)]
        )
        size = np.abs(errors) * 100
        wall = sum(r.wall for r in same)
        yield (
            f"{drive:<10} {np.median(size):>7.2f} % {np.quantile(size, 0.9):>7.2f} % "
            f"{size.max():>7.2f} % {errors.mean() * 100:>+7.2f} % {wall / len(same):>7.2f} s "
            f"{sum(simulated) / wall:>7.0f} x"
        )


def describe_fit(drives: list[TimedDrive], robot: RobotSpec, source: str) -> list[str]:
    """Return the lines that state how the robot's calibration was made and which errors remain.

    `source` says on which missions the drives were timed.
    """
    errors = measured_minus_predicted_seconds(drives, robot)
    seconds = np.array([d.seconds for d in drives])
    lines = [
        "Made by `python -m benchmarks.drives --fit` from the motions of the tracked drive in",
        f"{source}.",
        "For each kind of motion: the share of the commanded speed that is reached, and the",
        "seconds that each motion takes in addition. Least squares over the times of the motions:",
    ]
    for kind in MotionKind:
        chosen = np.array([all(m.kind is kind for m in d.motions) for d in drives])
        if chosen.any():
            lines.append(
                f"- {kind}: {chosen.sum()} motions, {seconds[chosen].sum():.0f} s, "
                f"error of a motion {np.sqrt((errors[chosen] ** 2).mean()):.2f} s "
                "(root mean square)"
            )
    lines.append(
        f"All together: {errors.sum() / seconds.sum() * 100:+.2f} % of {seconds.sum():.0f} s."
    )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Compare the drives and print the errors, or fit the calibration and print it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--site", default="umad", help="name of the site")
    parser.add_argument("--missions", type=int, default=24, help="number of missions")
    parser.add_argument(
        "--seed",
        type=parse_seed,
        help="seed of the first mission; the others have those that follow",
    )
    parser.add_argument(
        "--workers", type=int, default=min(2, os.cpu_count() or 1), help="number of processes"
    )
    parser.add_argument(
        "--fit", action="store_true", help="fit the calibration and replace its file"
    )
    options = parser.parse_args(arguments)
    first = options.seed
    if first is None:
        first = FIRST_FIT_SEED if options.fit else FIRST_SEED
    seeds = range(first, first + options.missions)
    with ProcessPoolExecutor(
        options.workers, initializer=_prepare, initargs=(options.site,)
    ) as pool:
        if not options.fit:
            jobs = [(seed, drive) for seed in seeds for drive in (*CHEAP, "tracked")]
            runs = []
            for done in pool.map(_run, jobs):
                print(f"mission {done.seed}, {done.drive}: {done.simulated:.1f} s", flush=True)
                runs.append(done)
            print("\n".join(["", *error_table(runs)]))
            return
        timed = list(pool.map(_time_motions, seeds))
    drives = [drive for motions, _ in timed for drive in motions]
    robot = load_robot()
    calibration = fit_calibration(drives, robot)
    robot = robot.model_copy(update={"calibration": calibration})
    source = (
        f"{len(seeds)} missions on {options.site} (seeds {seeds[0]} to {seeds[-1]}); "
        f"failed paths left out: {sum(failed for _, failed in timed)}"
    )
    write_calibration(calibration, describe_fit(drives, robot, source))


def write_calibration(calibration: Calibration, header: list[str]) -> None:
    """Write the calibration, after its header lines, beside the robot's description; print it."""
    text = "".join(f"# {line}\n" for line in header) + "\n"
    text += dump_yaml(calibration.model_dump())
    path = calibration_file("tracker")
    path.write_text(text, encoding="utf-8")
    print(f"{text}\nwritten to {path}")


if __name__ == "__main__":
    main()
