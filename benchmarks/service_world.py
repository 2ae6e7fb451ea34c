"""Size and time of the world data that the planning service sends to a page.

    python -m benchmarks.service_world
    python -m benchmarks.service_world --site generated:floors=5,seed=1

Prints for each site the size (kB, also compressed) and the time (s) of the description, the meshes
of all floors in each detail, the maps of all floors and headings, and previews. Each is made twice;
the first time, nothing is in the cache on disk.
"""

import argparse
import os
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable, Sequence

from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission, Task, Transition
from argo_env.navigation.stencil import HEADINGS
from argo_env.planning import open_site
from argo_env.planning.opening import OpenedSite
from argo_planner.service.world.description import describe_world
from argo_planner.service.world.meshes import Detail, floor_mesh, robot_mesh
from argo_planner.service.world.obstacles import Obstacle, with_obstacles
from argo_planner.service.world.previews import preview_mission
from argo_planner.service.world.standing_map import standing_map

LARGE = "generated:floors=12,size=40x40,checkpoints=500,seed=7"
TASKS = 40


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table for each site."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--site", action="append", help="a site; default: umad and a large one")
    sites = parser.parse_args(arguments).site or ["umad", LARGE]
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ARGO_CACHE_DIR"] = folder
        for reference in sites:
            measure_site(reference)


def measure_site(reference: str) -> None:
    """Print the table of a site."""
    started = time.perf_counter()
    site = open_site(reference).prepare()
    print(f"{reference}: opened in {time.perf_counter() - started:.1f} s")
    floors = [floor.number for floor in site.site.spec.floors]
    crates = make_crates(site, floors)
    mission = make_mission(site)
    print_line("description", lambda: [describe_world(site).model_dump_json().encode()])
    for detail in Detail:
        print_line(f"meshes, {detail}", lambda d=detail: [floor_mesh(site, f, d) for f in floors])
    print_line("mesh of the robot", lambda: [robot_mesh(site)])
    print_line("maps", lambda: make_maps(site, floors))
    print_line("three obstacles", lambda: [with_obstacles(site, crates).name.encode()])
    print_line("maps with them", lambda: make_maps(site, floors, crates))
    print_line(
        "description with them", lambda: [describe_world(site, crates).model_dump_json().encode()]
    )
    print_line(f"preview of {TASKS} tasks", lambda: [make_preview(site, mission)])
    print_line("preview with obstacles", lambda: [make_preview(site, mission, crates)])


def print_line(name: str, make: Callable[[], Iterable[bytes]]) -> None:
    """Make some world data twice, and print a line with its sizes (kB) and both times (s)."""
    times = []
    for _ in range(2):
        started = time.perf_counter()
        parts = list(make())
        times.append(time.perf_counter() - started)
    sizes, packed = map(len, parts), (len(zlib.compress(part)) for part in parts)
    print(
        f"  {name:24} {len(parts):3} parts {sum(sizes) / 1e3:9.1f} kB {sum(packed) / 1e3:8.1f} kB"
        f" compressed {times[0]:7.3f} s, again {times[1]:7.3f} s"
    )


def make_maps(
    site: OpenedSite, floors: Sequence[int], crates: Sequence[Obstacle] = ()
) -> Iterable[bytes]:
    """Yield the maps of where the robot can stand, of all floors and headings."""
    return (
        standing_map(site, floor, heading, crates).to_bytes()
        for floor in floors
        for heading in range(HEADINGS)
    )


def make_preview(site: OpenedSite, mission: Mission, crates: Sequence[Obstacle] = ()) -> bytes:
    """Return the preview of a mission as it is sent."""
    return preview_mission(site, mission, crates).model_dump_json().encode()


def make_crates(site: OpenedSite, floors: Sequence[int]) -> tuple[Obstacle, ...]:
    """Return a crate on each of the first three floors."""
    crates = []
    for floor in floors[:3]:
        positions = site.navigator.turning_poses(floor)
        x, y, z, _ = positions[len(positions) // 2].tolist()
        pose = Pose(x=x, y=y, z=z, yaw=0.5)
        crates.append(Obstacle(id=str(floor), pose=pose, size=(0.6, 0.4, 0.5)))
    return tuple(crates)


def make_mission(site: OpenedSite) -> Mission:
    """Return a mission of measurements at checkpoints from all over the site, in sequence."""
    checkpoints = site.site.checkpoints
    chosen = [checkpoints[k * len(checkpoints) // TASKS] for k in range(TASKS)]
    return Mission(
        tasks=tuple(
            Task(
                name=f"T{k}",
                action=Action.MEASURE,
                object_id=str(checkpoint.id),
                transitions=(Transition(target=f"T{k + 1}"),) if k + 1 < TASKS else (),
            )
            for k, checkpoint in enumerate(chosen)
        )
    )


if __name__ == "__main__":
    main()
