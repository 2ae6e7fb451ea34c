"""How long paths and travel times take: `python -m benchmarks.paths`.

Times are CPU seconds of this process, so that other processes disturb them less; caches and
hyperthreads are still shared, so run it on a quiet machine.
"""

import argparse
import resource
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial

import numpy as np
from scipy.sparse.csgraph import dijkstra

from argo_compiler.base.model import Pose
from argo_env.navigation import Blockage, Navigator, Path
from argo_env.planning.generated import generate
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.site.family import TEST_SEEDS, Family, parse_family

LARGE = str(Family(floors=12, size=(30, 20), checkpoints=500, seed=TEST_SEEDS))

Query = tuple[Pose, Pose | int]


def timed(work: Callable[[], object]) -> float:
    """CPU seconds that the work takes."""
    started = time.process_time()
    work()
    return time.process_time() - started


def memory() -> str:
    """The most memory that this process has had so far."""
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB at most so far"


def plan(navigator: Navigator, query: Query) -> object:
    """The path that a query asks for."""
    start, goal = query
    if isinstance(goal, Pose):
        return navigator.plan(start, goal)
    return navigator.plan_to_view(start, goal)


def measure_queries(navigator: Navigator, name: str, queries: Iterable[Query]) -> None:
    """Prints how long the queries take when asked for the first and for the second time."""
    first, again = [], []
    for query in queries:
        first.append(timed(partial(plan, navigator, query)))
        again.append(timed(partial(plan, navigator, query)))
    print(f"  {name:<42} {summary(first)}; again {summary(again)}")


def summary(seconds: list[float]) -> str:
    """Median, 95th percentile and worst, in ms."""
    return "/".join(f"{1e3 * t:.1f}" for t in np.percentile(seconds, [50, 95, 100])) + " ms"


def poses(navigator: Navigator, states: np.ndarray) -> list[Pose]:
    """The poses of states of the lattice."""
    return [
        Pose(x=x, y=y, z=z, yaw=yaw) for x, y, z, yaw in navigator.lattice.poses(states).tolist()
    ]


def measure_paths(name: str, count: int) -> Navigator:
    """Print what single paths on a site take."""
    site, robot = open_site(name).site, load_robot()
    navigator = Navigator(site, robot)
    took = timed(lambda: navigator.lattice)
    states, moves = navigator.lattice.size, navigator.lattice.costs.nnz
    print(f"{name}: lattice of {states} states and {moves} moves built in {took:.1f} s", end="")
    print(
        f", ways between its portals and landmarks in {timed(navigator.prepare):.1f} s; {memory()}"
    )
    random = np.random.default_rng(1)
    z = navigator.lattice.poses()[:, 2]
    floors = [np.flatnonzero(np.abs(z - floor.z) < 0.1) for floor in site.spec.floors]
    anywhere = poses(navigator, random.integers(navigator.lattice.size, size=2 * count))
    ids = [c.id for c in site.checkpoints]
    views = [navigator.viewing_pose(id) for id in ids]
    legs = [(start, id) for start in (*site.docks.values(), *views) for id in random.choice(ids, 6)]
    spread = poses(
        navigator,
        np.array([random.choice(floors[k]) for k in random.integers(len(floors), size=2 * count)]),
    )
    on_the_ground = poses(navigator, random.choice(floors[0], size=2 * count))
    print("Single paths, median/95th percentile/worst, cold and again:")
    measure_queries(navigator, "from docks and checkpoints to checkpoints", legs)
    measure_queries(navigator, "random poses, floors drawn evenly", pairs(spread))
    measure_queries(navigator, "random states (most lie on open ground)", pairs(anywhere))
    measure_queries(navigator, "random poses, both on the ground floor", pairs(on_the_ground))
    compare(navigator, random, min(12, count))
    for _ in range(2):
        took = timed(lambda: navigator.turning_poses(1))
        print(f"  places to turn on the ground floor: {1e3 * took:.1f} ms")
    dock, goal = site.docks[1], ids[min(7, len(ids) - 1)]
    brick = brick_on(navigator.plan_to_view(dock, goal))
    took = timed(lambda: navigator.with_blockages([brick]).plan_to_view(dock, goal))
    print(f"  avoiding a blockage, and the first path round it: {1e3 * took:.0f} ms")
    return navigator


def pairs(places: list[Pose]) -> list[Query]:
    """Every second pose as a start, the one after it as its goal."""
    return list(zip(places[::2], places[1::2], strict=True))


def compare(navigator: Navigator, random: np.random.Generator, count: int) -> None:
    """Print how far travel times between `count` poses are from those of one search over the whole
    lattice, and from the durations of the paths."""
    states = random.integers(navigator.lattice.size, size=count)
    places = poses(navigator, states)
    found = navigator.travel_times(places)
    paths = [[navigator.plan(a, b).duration(navigator.robot) for b in places] for a in places]
    apart = ~np.eye(len(places), dtype=bool)
    ratio = (found / np.maximum(paths, 1e-9))[apart]
    print(
        f"  travel times over the durations of smoothed paths: median {np.median(ratio):.3f}, "
        f"{ratio.min():.3f} to {ratio.max():.3f}"
    )
    costs = dijkstra(navigator.lattice.costs, indices=states)[:, states]
    print(f"  least and most of costs over times: {_range(costs[apart] / found[apart])} (1 to 1.2)")


def _range(values: np.ndarray) -> str:
    return f"{values.min():.3f} to {values.max():.3f}"


def brick_on(path: Path) -> Blockage:
    """Return a rectangle of 0.8 m by 0.4 m in the middle of the longest drive of a path."""
    middle = max(path.motions, key=lambda motion: motion.length).pose_at(0.5)
    x, y = middle.x, middle.y
    return Blockage((x - 0.4, y - 0.2, x + 0.4, y + 0.2), middle.z, "a brick")


def matrices(known: Navigator, name: str) -> None:
    """Print what travel times between all checkpoints take, on a known and on a large site."""
    fresh = Navigator(known.site, known.robot)
    fresh.prepare()
    ids = [c.id for c in fresh.site.checkpoints]
    first = timed(lambda: fresh.travel_times(ids))
    again = timed(lambda: fresh.travel_times(ids))
    print(
        f"Travel times of {len(ids)} checkpoints on {fresh.site.name}: {first:.2f} s, "
        f"again {again:.2f} s"
    )
    print(f"{name}:")
    started = time.process_time()
    large = generate(parse_family(name))
    print(f"  drawn and checked in {time.process_time() - started:.1f} s; {memory()}")
    ids = [c.id for c in large.site.checkpoints]
    print(f"  {large.lattice.size} states, {large.lattice.costs.nnz} moves")
    print(f"  ways between its portals and landmarks in {timed(large.prepare):.1f} s; {memory()}")
    took = timed(lambda: large.travel_times(ids))
    print(f"  travel times of {len(ids)} checkpoints: {took:.1f} s; {memory()}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all of it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--pairs", type=int, default=100, help="of poses of each kind")
    parser.add_argument("--site", default="umad", help="on which single paths are planned")
    parser.add_argument("--large", default=LARGE, help="a generated site with many")
    given = parser.parse_args(arguments)
    matrices(measure_paths(given.site, given.pairs), given.large)


if __name__ == "__main__":
    main()
