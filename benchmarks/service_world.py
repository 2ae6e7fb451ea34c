"""How large the world is that the planning service gives to a page, and how long it takes to make.

    python -m benchmarks.service_world
    python -m benchmarks.service_world --site generated:floors=5,seed=1

Prints, for each site, the size (kB, and as sent compressed) and the time (s) of the description,
the meshes of all floors in each detail, the maps of all floors and headings, and previews; the
first time, and again. Nothing is taken from the cache on disk the first time.
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
from argo_planner.service.world.description import describe
from argo_planner.service.world.meshes import Detail, floor_mesh, robot_mesh
from argo_planner.service.world.obstacles import Obstacle, with_obstacles
from argo_planner.service.world.previews import preview_mission
from argo_planner.service.world.standing import standing_map

LARGE = "generated:floors=12,size=40x40,checkpoints=500,seed=7"
TASKS = 40


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table for each site."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--site", action="append", help="a site (umad and a large one)")
    sites = parser.parse_args(arguments).site or ["umad", LARGE]
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ARGO_CACHE_DIR"] = folder
        for reference in sites:
            measure(reference)


def measure(reference: str) -> None:
    """Prints the table of a site."""
    started = time.perf_counter()
    site = open_site(reference).prepare()
    print(f"{reference}: opened in {time.perf_counter() - started:.1f} s")
    floors = [floor.number for floor in site.site.spec.floors]
    crates = obstacles(site, floors)
    mission = a_mission(site)
    show("description", lambda: [describe(site).model_dump_json().encode()])
    for detail in Detail:
        show(f"meshes, {detail}", lambda d=detail: [floor_mesh(site, f, d) for f in floors])
    show("mesh of the robot", lambda: [robot_mesh(site)])
    show("maps", lambda: maps(site, floors))
    show("three obstacles", lambda: [with_obstacles(site, crates).name.encode()])
    show("maps with them", lambda: maps(site, floors, crates))
    show("description with them", lambda: [describe(site, crates).model_dump_json().encode()])
    show(f"preview of {TASKS} tasks", lambda: [preview(site, mission)])
    show("preview with obstacles", lambda: [preview(site, mission, crates)])


def show(what: str, make: Callable[[], Iterable[bytes]]) -> None:
    """A line: how large the parts are, and how long they take the first time and again."""
    times = []
    for _ in range(2):
        started = time.perf_counter()
        parts = list(make())
        times.append(time.perf_counter() - started)
    sizes, packed = map(len, parts), (len(zlib.compress(part)) for part in parts)
    print(
        f"  {what:24} {len(parts):3} parts {sum(sizes) / 1e3:9.1f} kB {sum(packed) / 1e3:8.1f} kB"
        f" compressed {times[0]:7.3f} s, again {times[1]:7.3f} s"
    )


def maps(
    site: OpenedSite, floors: Sequence[int], crates: Sequence[Obstacle] = ()
) -> Iterable[bytes]:
    """Those of all floors and headings."""
    return (
        standing_map(site, floor, heading, crates).to_bytes()
        for floor in floors
        for heading in range(HEADINGS)
    )


def preview(site: OpenedSite, mission: Mission, crates: Sequence[Obstacle] = ()) -> bytes:
    """The preview of a mission as it is sent."""
    return preview_mission(site, mission, crates).model_dump_json().encode()


def obstacles(site: OpenedSite, floors: Sequence[int]) -> tuple[Obstacle, ...]:
    """A crate on each of the three lowest floors."""
    made = []
    for floor in floors[:3]:
        places = site.navigator.turning_poses(floor)
        x, y, z, _ = places[len(places) // 2].tolist()
        pose = Pose(x=x, y=y, z=z, yaw=0.5)
        made.append(Obstacle(id=str(floor), pose=pose, size=(0.6, 0.4, 0.5)))
    return tuple(made)


def a_mission(site: OpenedSite) -> Mission:
    """Measurements at checkpoints from all over the site, one after the other."""
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
