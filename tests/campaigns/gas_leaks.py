"""Campaign: no all-clear while a gas leak goes on: `python -m tests.campaigns.gas_leaks`.

Each leak has a random rate, place and wind, and goes on for `GOES_ON` s, in which each all-clear is
false. The robot makes random drives over a site, and answers the leak in each of these ways:

- stop: it stays where it was when it detected the leak; then the leak ends, and the campaign
  measures whether and when the all-clear comes;
- retreat: it drives back to where it came from, waits there for 3 minutes, drives on, and so on;
- go on: it drives on, back and forth;
- linger: it goes back and forth near the leak, and often stands, also where it has stood before.

Finally it stands for hours where a leak is hardly noticed: its concentration is near the limits.
"""

import argparse
import math
import time
from collections.abc import Iterator, Sequence

import numpy as np

from argo_compiler.il import EventKind
from argo_env.planning import open_site
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.signals import standard_watches
from argo_env.sensing.signals.frames import NOSE, to_site
from argo_env.site.shapes import Vector
from argo_env.surroundings import GasLeak, Surroundings, Weather
from argo_env.surroundings.gas import leak_concentration
from argo_env.world.world import World
from tests.campaigns.signals import STEP, draw_point_on_surface, random_drives

REACTIONS = ("stop", "retreat", "go on", "linger")
REACH = 10.0  # m between a leak and the path, at most
RATES, WINDS = (1e-4, 1.0), (0.1, 10.0)
"""kg/s and m/s: lowest and highest; their logarithms are uniform"""
GOES_ON, AFTERWARDS = 1000, 1200
"""s that the leak goes on, and that a robot which has stopped then waits for the all-clear"""
RETREAT = 180  # s that the robot waits where it has driven back to
NEAR_LIMIT = (12.0, 45.0)
"""ppm, lowest and highest mean concentration where the robot stands for `STANDS` s"""
STANDS = 4 * 3600


def poses_after_detection(
    reaction: str, track: Sequence[BodyPose], index: int, rng: np.random.Generator
) -> Iterator[BodyPose]:
    """Yield the robot's pose each second, without end, after it has detected a leak at `index`."""
    while reaction == "stop":
        yield track[index]
    while reaction == "linger":
        index = min(max(index + int(rng.integers(-8, 9)), 0), len(track) - 1)
        yield from [track[index]] * int(rng.integers(1, 90))
    while True:
        if reaction == "retreat":
            yield from reversed(track[: index + 1])
            yield from [track[0]] * RETREAT
            yield from track[: index + 1]
        yield from track[index:]
        yield from reversed(track[index:])


class Leaks:
    """All-clears of the leaks of one reaction: how many were false, and how late the others."""

    def __init__(self) -> None:
        self.detected = 0
        self.false = 0
        self.delays: list[float] = []
        """s from the leak's end to the all-clear"""

    def __str__(self) -> str:
        text = f"{self.detected} leaks detected, {self.false} false all-clears"
        if self.delays:
            median, late, last = np.percentile(self.delays, [50, 95, 100])
            text += f"; the end noticed in {len(self.delays)}, after {median:.0f} s "
            text += f"(95 %: {late:.0f} s, last: {last:.0f} s)"
        return text


def watch_leak(
    world: World, track: Sequence[BodyPose], reaction: str, number: int, leaks: Leaks
) -> None:
    """Add to `leaks` what the watch reports of leak `number`, with a robot that begins anywhere."""
    rng = generator(number, "gas leak")
    place = draw_point_on_surface(world.site, [(0.0, pose) for pose in track], rng, REACH)
    if place is None:
        return
    rate, speed = (math.exp(rng.uniform(*np.log(limits))) for limits in (RATES, WINDS))
    around = Surroundings(world.site, _wind(speed, rng))
    (watch,) = (w for w in standard_watches(world, around, number) if w.name == "gas")
    leak = GasLeak(place, rate)
    around.add(leak, 0.0)
    index = int(rng.integers(len(track)))
    poses = iter([*track[index:], *track])
    detected = False
    for now in range(GOES_ON + AFTERWARDS * (reaction == "stop")):
        if now == GOES_ON:
            around.remove(leak, float(now))
        pose = next(poses, None)
        if pose is None:
            return  # It has passed the leak without detecting it.
        for detection in watch.update(float(now), pose):
            if detection.kind is EventKind.GAS_LEAK and not detected:
                detected = True
                leaks.detected += 1
                at = (index + now) % len(track) if index + now >= len(track) else index + now
                poses = poses_after_detection(reaction, track, at, rng)
            elif detection.kind is EventKind.ALL_CLEAR and now < GOES_ON:
                leaks.false += 1
                print(f"  false all-clear, leak {number}, {reaction}: {rate:.4g} kg/s at {place}")
            elif detection.kind is EventKind.ALL_CLEAR:
                leaks.delays.append(now - GOES_ON)
                return


def count_false_near_limit(world: World, track: Sequence[BodyPose], number: int) -> int:
    """Return the false all-clears of a robot that stands downwind of a leak for `STANDS` s."""
    rng = generator(number, "near the limit")
    pose = track[int(rng.integers(len(track)))]
    nose = to_site(pose, NOSE)
    weather = _wind(math.exp(rng.uniform(*np.log(WINDS))), rng)
    upwind = np.array([*weather.wind, 0.0])
    x, y, z = (nose - float(rng.uniform(4.0, 12.0)) * upwind / np.linalg.norm(upwind)).tolist()
    place: Vector = (x, y, z)
    ground = world.site.spec.ground_z
    steady = leak_concentration(GasLeak(place, 1.0), weather, ground, nose[None, :], 1e6)[0]
    around = Surroundings(world.site, weather)
    around.add(GasLeak(place, float(rng.uniform(*NEAR_LIMIT) / steady)), -1e6)
    (watch,) = (w for w in standard_watches(world, around, number) if w.name == "gas")
    return sum(
        detection.kind is EventKind.ALL_CLEAR
        for now in range(STANDS)
        for detection in watch.update(float(now), pose)
    )


def _wind(speed: float, rng: np.random.Generator) -> Weather:
    direction = float(rng.uniform(0, math.tau))
    return Weather(wind=(speed * math.cos(direction), speed * math.sin(direction)))


def main(arguments: Sequence[str] | None = None) -> None:
    """Run all leaks with all reactions, and print the number of false all-clears."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--site", default="umad", help="name of the site")
    parser.add_argument("--leaks", type=int, default=640, help="leaks with each reaction")
    parser.add_argument("--near-limit", type=int, default=100, help="leaks near the limits")
    parser.add_argument("--first", type=int, default=0, help="number of the first leak")
    parser.add_argument("--drives", type=int, default=20, help="random drives")
    parser.add_argument(
        "--duration", type=float, default=300.0, help="least duration of a drive in seconds"
    )
    options = parser.parse_args(arguments)
    navigator = open_site(options.site).navigator
    begun = time.process_time()
    false = 0
    with World(navigator.site, navigator.robot) as world:
        drives = random_drives(navigator, world, options.drives, options.duration)
        tracks = [[pose for _, pose in track[:: round(1 / STEP)]] for track in drives]
        numbers = range(options.first, options.first + options.leaks)
        for reaction in REACTIONS:
            leaks = Leaks()
            for number in numbers:
                watch_leak(world, tracks[number % len(tracks)], reaction, number, leaks)
            print(f"{reaction}: {leaks}", flush=True)
            false += leaks.false
        for number in range(options.first, options.first + options.near_limit):
            near = count_false_near_limit(world, tracks[number % len(tracks)], number)
            if near:
                print(f"  {near} false all-clears near the limits, leak {number}")
            false += near
    hours = options.near_limit * STANDS / 3600
    print(
        f"false all-clears: {false} of {options.leaks} leaks with {len(REACTIONS)} reactions, and "
        f"{options.near_limit} near the limits for {hours:.0f} h; "
        f"{time.process_time() - begun:.0f} s of processor time"
    )


if __name__ == "__main__":
    main()
