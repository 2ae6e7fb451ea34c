"""Times of path queries and of travel-time matrices: `python -m benchmarks.paths`.

Times are CPU seconds of this process, which other processes disturb less than wall time. Caches and
hyperthreads are shared all the same, so run it on a quiet machine.
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
from argo_env.planning.generated import generate_navigator
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.site.family import TEST_SEEDS, Family, parse_family

LARGE = str(Family(floors=12, size=(30, 20), checkpoints=500, seed=TEST_SEEDS))

Query = tuple[Pose, Pose | int]


def cpu_seconds(work: Callable[[], object]) -> float:
    """Call `work`, and return the CPU time of this process (s) that it took."""
    started = time.process_time()
    work()
    return time.process_time() - started


def memory_text() -> str:
    """Return the peak memory of this process so far, as text."""
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB at most so far"


def answer_query(navigator: Navigator, query: Query) -> object:
    """Return the path of a query, to a pose or to a pose that has the checkpoint in view."""
    start, goal = query
    if isinstance(goal, Pose):
        return navigator.plan(start, goal)
    return navigator.plan_to_view(start, goal)


def measure_queries(navigator: Navigator, name: str, queries: Iterable[Query]) -> None:
    """Print a line with the times of the queries, each made twice; `name` is its title."""
    first, again = [], []
    for query in queries:
        first.append(cpu_seconds(partial(answer_query, navigator, query)))
        again.append(cpu_seconds(partial(answer_query, navigator, query)))
    print(f"  {name:<42} {percentiles_text(first)}; again {percentiles_text(again)}")


def percentiles_text(seconds: list[float]) -> str:
    """Return median, 95th percentile and maximum of times (s) as text, in ms."""
    return "/".join(f"{1e3 * t:.1f}" for t in np.percentile(seconds, [50, 95, 100])) + " ms"


def poses_of_states(navigator: Navigator, states: np.ndarray) -> list[Pose]:
    """Return the poses of states of the lattice."""
    return [
        Pose(x=x, y=y, z=z, yaw=yaw)
        for x, y, z, yaw in navigator.lattice.state_poses(states).tolist()
    ]


def measure_paths(name: str, count: int) -> Navigator:
    """Print the times of single paths on a site, and return its navigator."""
    site, robot = open_site(name).site, load_robot()
    navigator = Navigator(site, robot)
    elapsed = cpu_seconds(lambda: navigator.lattice)
    states, moves = navigator.lattice.size, navigator.lattice.costs.nnz
    print(f"{name}: lattice of {states} states and {moves} moves built in {elapsed:.1f} s", end="")
    elapsed = cpu_seconds(navigator.prepare)
    print(f", paths between portals and landmarks in {elapsed:.1f} s; {memory_text()}")
    random = np.random.default_rng(1)
    z = navigator.lattice.state_poses()[:, 2]
    floors = [np.flatnonzero(np.abs(z - floor.z) < 0.1) for floor in site.spec.floors]
    anywhere = poses_of_states(navigator, random.integers(navigator.lattice.size, size=2 * count))
    ids = [c.id for c in site.checkpoints]
    views = [navigator.viewing_pose(id) for id in ids]
    legs = [(start, id) for start in (*site.docks.values(), *views) for id in random.choice(ids, 6)]
    spread = poses_of_states(
        navigator,
        np.array([random.choice(floors[k]) for k in random.integers(len(floors), size=2 * count)]),
    )
    on_the_ground = poses_of_states(navigator, random.choice(floors[0], size=2 * count))
    print("Single paths, median/95th percentile/worst, first and again:")
    measure_queries(navigator, "from docks and checkpoints to checkpoints", legs)
    measure_queries(navigator, "random poses, floors drawn evenly", pair_poses_into_queries(spread))
    measure_queries(
        navigator, "random states (most lie on open ground)", pair_poses_into_queries(anywhere)
    )
    measure_queries(
        navigator, "random poses, both on the ground floor", pair_poses_into_queries(on_the_ground)
    )
    compare_travel_times(navigator, random, min(12, count))
    for _ in range(2):
        elapsed = cpu_seconds(lambda: navigator.turning_poses(1))
        print(f"  positions to turn at on the ground floor: {1e3 * elapsed:.1f} ms")
    dock, goal = site.docks[1], ids[min(7, len(ids) - 1)]
    brick = brick_on_longest_motion(navigator.plan_to_view(dock, goal))
    elapsed = cpu_seconds(lambda: navigator.with_added_blockages([brick]).plan_to_view(dock, goal))
    print(f"  avoiding a blockage, and the first path round it: {1e3 * elapsed:.0f} ms")
    return navigator


def pair_poses_into_queries(poses: list[Pose]) -> list[Query]:
    """Return queries from each pose at an even index to the pose after it."""
    return list(zip(poses[::2], poses[1::2], strict=True))


def compare_travel_times(navigator: Navigator, random: np.random.Generator, count: int) -> None:
    """Print ratios of travel times between `count` random states to two other figures.

    The other figures are the durations of smoothed paths, and the costs of one search over the
    whole lattice.
    """
    states = random.integers(navigator.lattice.size, size=count)
    poses = poses_of_states(navigator, states)
    times = navigator.travel_times(poses)
    durations = [[navigator.plan(a, b).duration(navigator.robot) for b in poses] for a in poses]
    different = ~np.eye(len(poses), dtype=bool)
    ratio = (times / np.maximum(durations, 1e-9))[different]
    print(
        f"  travel times over the durations of smoothed paths: median {np.median(ratio):.3f}, "
        f"{ratio.min():.3f} to {ratio.max():.3f}"
    )
    costs = dijkstra(navigator.lattice.costs, indices=states)[:, states]
    ratios = _range_text(costs[different] / times[different])
    print(f"  costs of the lattice over travel times: {ratios} (expected: 1 to 1.2)")


def _range_text(values: np.ndarray) -> str:
    return f"{values.min():.3f} to {values.max():.3f}"


def brick_on_longest_motion(path: Path) -> Blockage:
    """Return a brick, 0.8 m along x by 0.4 m along y, in the middle of a path's longest motion."""
    middle = max(path.motions, key=lambda motion: motion.length).pose_at(0.5)
    x, y = middle.x, middle.y
    return Blockage((x - 0.4, y - 0.2, x + 0.4, y + 0.2), middle.z, "a brick")


def measure_matrices(navigator: Navigator, generated_site: str) -> None:
    """Print the times of travel-time matrices on the navigator's site and on a generated site."""
    fresh = Navigator(navigator.site, navigator.robot)
    fresh.prepare()
    ids = [c.id for c in fresh.site.checkpoints]
    first = cpu_seconds(lambda: fresh.travel_times(ids))
    again = cpu_seconds(lambda: fresh.travel_times(ids))
    print(
        f"Travel times of {len(ids)} checkpoints on {fresh.site.name}: {first:.2f} s, "
        f"again {again:.2f} s"
    )
    print(f"{generated_site}:")
    started = time.process_time()
    large = generate_navigator(parse_family(generated_site))
    print(f"  generated and checked in {time.process_time() - started:.1f} s; {memory_text()}")
    ids = [c.id for c in large.site.checkpoints]
    print(f"  {large.lattice.size} states, {large.lattice.costs.nnz} moves")
    elapsed = cpu_seconds(large.prepare)
    print(f"  paths between portals and landmarks in {elapsed:.1f} s; {memory_text()}")
    elapsed = cpu_seconds(lambda: large.travel_times(ids))
    print(f"  travel times of {len(ids)} checkpoints: {elapsed:.1f} s; {memory_text()}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all times."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--pairs", type=int, default=100, help="pairs of poses of each kind")
    parser.add_argument("--site", default="umad", help="site of the single paths")
    parser.add_argument("--large", default=LARGE, help="large generated site for the matrices")
    options = parser.parse_args(arguments)
    measure_matrices(measure_paths(options.site, options.pairs), options.large)


if __name__ == "__main__":
    main()
