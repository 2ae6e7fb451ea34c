"""Campaign: detection of gas, heat, sound and obstacles: `python -m tests.campaigns.signals`.

The watches observe random drives over a site: without any source, to count false alarms, and with
one source or obstacle at a time, to measure whether and from how far it is detected.
"""

import argparse
import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from argo_compiler.base.model import Pose
from argo_compiler.il import EventKind
from argo_env.drives.drive import DriveStatus
from argo_env.drives.kinematic import KinematicDrive
from argo_env.faults.walkway import BlockedStairs, Brick, MissingPlate
from argo_env.navigation import Navigator
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import load_robot
from argo_env.seeding import generator
from argo_env.sensing.signals import standard_watches
from argo_env.sensing.signals.frames import NOSE, to_site
from argo_env.sensing.signals.microphone import pump_positions
from argo_env.sensing.watch import Detection
from argo_env.site import Site
from argo_env.site.shapes import Box, Cylinder, Role, Solid, Vector
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpFault, PumpSound, Surroundings
from argo_env.surroundings.surroundings import Source
from argo_env.world.world import World

PAUSE = 8.0  # s at each checkpoint
STEP = 0.1  # s

Track = list[tuple[float, BodyPose]]


@dataclass(frozen=True)
class PlacementResult:
    """Result of one placement: whether it was within reach, and figures of its detection."""

    within_reach: bool
    figures: dict[str, float] | None = None
    """figures by name, such as `m away`; None: it was not detected"""


def random_drives(
    navigator: Navigator, world: World, count: int, duration: float
) -> Iterator[Track]:
    """Yield random drives of at least `duration` (s) from checkpoint to checkpoint."""
    for number in range(count):
        rng = generator(number, "drive")
        drive = KinematicDrive(world, navigator.robot, STEP)
        dock = navigator.snap_keeping_heading(next(iter(navigator.site.docks.values())))
        drive.place_robot(BodyPose(dock.x, dock.y, dock.z, dock.yaw))
        track: Track = [(0.0, drive.pose)]

        def record(track: Track = track, drive: KinematicDrive = drive) -> None:
            track.append((round(track[-1][0] + STEP, 3), drive.pose))

        while track[-1][0] < duration:
            here = Pose(x=drive.pose.x, y=drive.pose.y, z=drive.pose.z, yaw=drive.pose.yaw)
            goal = navigator.site.checkpoints[int(rng.integers(len(navigator.site.checkpoints)))]
            drive.follow(navigator.plan_to_view(here, goal.id), None)
            while drive.step() is DriveStatus.MOVING:
                record()
            for _ in range(round(PAUSE / STEP)):
                record()
        yield track


def detections(
    world: World, around: Surroundings, track: Track, seed: int, names: Sequence[str]
) -> Iterator[tuple[float, BodyPose, Detection]]:
    """Yield the detections of the watches with these names along the track."""
    watches = [w for w in standard_watches(world, around, seed) if w.name in names]
    due = dict.fromkeys(names, track[0][0])
    for now, pose in track:
        for watch in watches:
            if now >= due[watch.name] - 1e-6:
                due[watch.name] += watch.period
                for detection in watch.update(now, pose):
                    yield now, pose, detection


EVERYTHING = ("gas", "heat", "pumps", "alarm", "terrain")


def count_false_alarms(world: World, tracks: Sequence[Track], missions: int) -> None:
    """Print detections without any source, and the processor time of the watches."""
    count, seconds = 0, 0.0
    cost = -time.process_time()
    for mission in range(missions):
        track = tracks[mission % len(tracks)]
        seconds += track[-1][0]
        around = Surroundings(world.site)
        for now, pose, detection in detections(world, around, track, 1000 + mission, EVERYTHING):
            count += 1
            print(f"  false alarm in mission {mission} at {now} s, {pose}: {detection}")
    cost += time.process_time()
    print(f"false alarms: {count} in {missions} clean missions, {seconds:.0f} s observed")
    print(
        f"cost of all watches: {1000 * cost / seconds:.2f} ms of processor time a simulated second"
    )


def draw_straight_drive(
    track: Track, rng: np.random.Generator, lowest: int, site: Site
) -> int | None:
    """Return the index of a random time after 3 m straight ahead on a level floor; None: none."""
    indices = []
    for k in range(100, len(track) - 20):
        poses = [p for _, p in track[k - 80 : k + 10 : 10]]
        level = all(abs(p.pitch) < 0.01 and abs(p.z - poses[0].z) < 0.04 for p in poses)
        straight = all(abs(math.remainder(p.yaw - poses[0].yaw, math.tau)) < 0.05 for p in poses)
        length = math.dist((poses[0].x, poses[0].y), (poses[-1].x, poses[-1].y))
        floor = site.floor_at(poses[0].z)
        on_deck = abs(poses[0].z - site.spec.floors[floor - 1].z) < 0.01
        if level and straight and length > 2.9 and on_deck and floor >= lowest:
            indices.append(k)
    return int(rng.choice(indices)) if indices else None


def distance_ahead(
    pose: BodyPose, corners: Sequence[tuple[float, float]], backwards: bool
) -> float:
    """Return the distance (m) ahead of the robot's leading edge to the nearest corner."""
    sign, edge = (-1.0, 0.55) if backwards else (1.0, 0.5)
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return min(sign * ((x - pose.x) * c + (y - pose.y) * s) for x, y in corners) - edge


def place_obstacle(kind: str, site: Site, tracks: Sequence[Track], number: int) -> PlacementResult:
    """Put a brick on the path, or remove a plate from it, and measure its detection."""
    rng = generator(number, kind)
    track = tracks[number % len(tracks)]
    moment = draw_straight_drive(track, rng, 1 if kind == "brick" else 2, site)
    if moment is None:
        return PlacementResult(False)
    _, pose = track[moment]
    aside = float(rng.uniform(-0.2, 0.2))
    x, y = pose.x - aside * math.sin(pose.yaw), pose.y + aside * math.cos(pose.yaw)
    floor = site.floor_at(pose.z)
    if kind == "brick":
        yaw = float(rng.uniform(-90, 90))
        fault: Brick | MissingPlate = Brick(
            floor=floor, place=(x, y), size=(0.1, 0.2, 0.1), yaw=yaw
        )
        half = (0.05, 0.1, math.radians(yaw))
    else:
        edge = float(rng.uniform(0.4, 0.8)) / 2
        fault = MissingPlate(floor=floor, rect=(x - edge, y - edge, x + edge, y + edge))
        half = (edge, edge, 0.0)
    corners = [
        (
            x + a * half[0] * math.cos(half[2]) - b * half[1] * math.sin(half[2]),
            y + a * half[0] * math.sin(half[2]) + b * half[1] * math.cos(half[2]),
        )
        for a in (-1, 1)
        for b in (-1, 1)
    ]
    approach = track[moment - 120 if moment >= 120 else 0 : moment + 1]
    before = approach[-2][1]
    backwards = (
        math.cos(pose.yaw) * (pose.x - before.x) + math.sin(pose.yaw) * (pose.y - before.y) < 0
    )
    with World(site, load_robot(), elements=fault.site_elements_with_fault(site)) as world:
        for _, at, detection in detections(
            world, Surroundings(site), approach, number, ("terrain",)
        ):
            is_right_kind = (detection.kind is EventKind.POSITIVE_OBSTACLE) == (kind == "brick")
            if detection.place is None or not is_right_kind:
                return PlacementResult(True)
            error = math.hypot(detection.place[0] - x, detection.place[1] - y)
            return PlacementResult(
                True, {"m ahead": distance_ahead(at, corners, backwards), "m off": error}
            )
    return PlacementResult(True)


def place_barriers(site: Site, tracks: Sequence[Track], number: int) -> PlacementResult:
    """Put barriers at both ends of a stairway on the path, and measure their detection."""
    rng = generator(number, "stairs")
    track = tracks[number % len(tracks)]
    base, storey = site.spec.floors[0].z, site.spec.storey
    on_stairs = [
        k
        for k, (_, p) in enumerate(track)
        if abs(p.pitch) > 0.3 and 0.2 < (p.z - base) / storey % 1.0 < 0.8
    ]
    if not on_stairs:
        return PlacementResult(False)
    moment = int(rng.choice(on_stairs))
    pose = track[moment][1]
    tower = "west tower" if pose.x < 5 else "east tower"
    fault = BlockedStairs(tower=tower, floor=site.floor_at(pose.z))
    with World(site, load_robot(), elements=fault.site_elements_with_fault(site)) as world:
        barriers = [
            s
            for e in fault.site_elements_with_fault(site)
            if e.name.startswith("barrier")
            for s in e.solids
        ]
        start = max(0, moment - 900)
        for _, at, detection in detections(
            world, Surroundings(site), track[start : moment + 1], number, ("terrain",)
        ):
            distance = min(
                math.hypot(x - at.x, y - at.y)
                for b in barriers
                if abs(b.center[2] - at.z) < 1.5
                for x, y in np.linspace(*_ends(b), 10)
            )
            if detection.kind is EventKind.POSITIVE_OBSTACLE:
                return PlacementResult(True, {"m ahead": distance - 0.55})
    return PlacementResult(True)


def _ends(barrier: Solid) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return both ends of a barrier, x and y in m."""
    assert isinstance(barrier, Box)
    (x, y, _), half = barrier.center, barrier.size[1] / 2
    dx, dy = -half * math.sin(barrier.rpy[2]), half * math.cos(barrier.rpy[2])
    return (x - dx, y - dy), (x + dx, y + dy)


def draw_point_on_surface(
    site: Site, track: Track, rng: np.random.Generator, reach: float
) -> Vector | None:
    """Draw a point on a pipe or vessel within `reach` (m) of the path, on the facing side."""
    solids = [
        s
        for e in site.elements
        if e.role in (Role.PIPE, Role.VESSEL)
        for s in e.solids
        if isinstance(s, Cylinder) and s.rpy[1] == 0.0
    ]
    for _ in range(200):
        pose = track[int(rng.integers(len(track)))][1]
        solid = solids[int(rng.integers(len(solids)))]
        (x, y, z), up = solid.center, float(rng.uniform(0.2, 1.8))
        distance = math.hypot(x - pose.x, y - pose.y)
        if distance < reach and abs(pose.z + up - z) < solid.length / 2:
            share = solid.radius / distance
            return (x + share * (pose.x - x), y + share * (pose.y - y), pose.z + up)
    return None


def least_distance(track: Track, point: Vector) -> float:
    """Return the least distance (m) of the microphone from a point along the track."""
    return min(math.dist(to_site(p, NOSE).tolist(), point) for _, p in track[::5])


def place_source(
    kind: EventKind, name: str, make: Callable[[Track, np.random.Generator], Source | None],
    world: World, tracks: Sequence[Track], number: int,
) -> PlacementResult:  # fmt: skip
    """Add a source, an alarm at a random time, and measure when and where it is detected."""
    rng = generator(number, name, kind)
    track = tracks[number % len(tracks)]
    source = make(track, rng)
    if source is None:
        return PlacementResult(False)
    since = float(rng.uniform(0.0, 60.0)) if isinstance(source, Alarm) else 0.0
    around = Surroundings(world.site)
    for part, pairs in ((0, track[: round(since / STEP)]), (1, track[round(since / STEP) :])):
        if part:
            around.add(source, since)
        for now, pose, detection in (
            detections(world, around, pairs, number, (name,)) if pairs else ()
        ):
            if detection.kind is not kind or not part:
                return PlacementResult(True)
            figures = {"s after": now - since} if isinstance(source, Alarm) else {}
            if isinstance(source, GasLeak | HotSpot):
                figures["m away"] = math.dist(to_site(pose, NOSE).tolist(), source.place)
            if isinstance(source, PumpSound):
                place = pump_positions(world.site)[source.pump]
                figures["m away"] = math.dist(to_site(pose, NOSE).tolist(), place)
                figures["right pump"] = float(source.pump in detection.detail)
            if isinstance(source, HotSpot) and detection.place:
                figures["m off"] = math.dist(detection.place, source.place)
            return PlacementResult(True, figures)
    return PlacementResult(True)


def print_results(name: str, results: list[PlacementResult]) -> None:
    """Print how many of the placements within reach were detected, with their figures."""
    reached = [r for r in results if r.within_reach]
    hits = [r.figures for r in reached if r.figures is not None]
    values = defaultdict(list)
    for figures in hits:
        for key, value in figures.items():
            values[key].append(value)
    text = "; ".join(
        f"{key}: median {np.median(v):.2f}, 5 % {np.percentile(v, 5):.2f}, "
        f"95 % {np.percentile(v, 95):.2f}"
        for key, v in values.items()
    )
    print(f"{name}: detected {len(hits)} of {len(reached)}; {text}", flush=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run all measurements and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--site", default="umad", help="name of the site")
    parser.add_argument("--placements", type=int, default=60, help="placements of each source")
    parser.add_argument("--missions", type=int, default=100, help="missions without a source")
    parser.add_argument("--drives", type=int, default=20, help="random drives")
    parser.add_argument(
        "--duration", type=float, default=300.0, help="least duration of a drive in seconds"
    )
    options = parser.parse_args(arguments)
    navigator = open_site(options.site).navigator
    site, robot = navigator.site, navigator.robot
    placements = range(options.placements)
    with World(site, robot) as world:
        begun = time.process_time()
        tracks = list(random_drives(navigator, world, options.drives, options.duration))
        seconds = sum(t[-1][0] for t in tracks)
        print(
            f"{len(tracks)} drives, {seconds:.0f} s, kinematic: "
            f"{1000 * (time.process_time() - begun) / seconds:.2f} ms a simulated second",
            flush=True,
        )
        for kind in ("brick", "missing plate"):
            print_results(kind, [place_obstacle(kind, site, tracks, k) for k in placements])
        print_results("blocked stairs", [place_barriers(site, tracks, k) for k in placements])

        def leak(track: Track, rng: np.random.Generator) -> GasLeak | None:
            place = draw_point_on_surface(site, track, rng, 4.0)
            return place and GasLeak(place, float(10 ** rng.uniform(-2.3, -1.3)))

        def spot(track: Track, rng: np.random.Generator) -> HotSpot | None:
            place = draw_point_on_surface(site, track, rng, 3.0)
            radius, temperature = float(rng.uniform(0.08, 0.25)), float(rng.uniform(70, 150))
            return place and HotSpot(place, radius, temperature)

        def pump(fault: PumpFault, track: Track, rng: np.random.Generator) -> PumpSound | None:
            near = [n for n, p in pump_positions(site).items() if least_distance(track, p) < 2.5]
            return PumpSound(near[int(rng.integers(len(near)))], fault) if near else None

        for name, kind, watch, make in (
            ("gas leak", EventKind.GAS_LEAK, "gas", leak),
            ("hot spot", EventKind.HOT_SPOT, "heat", spot),
            ("bearing", EventKind.ABNORMAL_SOUND, "pumps", partial(pump, PumpFault.BEARING)),
            ("cavitation", EventKind.ABNORMAL_SOUND, "pumps", partial(pump, PumpFault.CAVITATION)),
            ("alarm", EventKind.PLATFORM_ALARM, "alarm", lambda *_: Alarm()),
        ):
            print_results(
                name, [place_source(kind, watch, make, world, tracks, k) for k in placements]
            )
        count_false_alarms(world, tracks, options.missions)


if __name__ == "__main__":
    main()
