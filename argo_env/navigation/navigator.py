"""The navigator: paths from pose to pose and to where a checkpoint can be read."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, Unreachable
from argo_compiler.base.model import Pose
from argo_env.files.parts import NO_CACHE, Parts
from argo_env.navigation.closed_areas import Blockage, close, closed_cells, turns_over
from argo_env.navigation.graphs import against, search
from argo_env.navigation.lattice import (
    DRIVING_LEVEL,
    LEVEL,
    Lattice,
    build_lattice,
    connected_part,
    lattice_arrays,
    lattice_of,
)
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.raster import Grid
from argo_env.navigation.regions import find_cuts, make_partition, repartition
from argo_env.navigation.routes import Routes
from argo_env.navigation.smoothing import FlatMap, smooth
from argo_env.navigation.stencil import HEADINGS, heading_angle
from argo_env.navigation.surface import Surface, find_surface, surface_arrays
from argo_env.navigation.views import find_views
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site


def times_to(lattice: Lattice, goals: NDArray[np.int64]) -> NDArray[np.float32]:
    """The time (s) of the cheapest way from every state to each of `goals`, shape (goals, states);
    inf where there is none."""
    back = against(lattice.costs)
    back.indices, back.indptr = back.indices.astype(np.int32), back.indptr.astype(np.int32)
    times = np.empty((len(goals), lattice.size), dtype=np.float32)
    for row, goal in enumerate(goals.tolist()):
        (costs,), (following,) = search(back, np.array([goal]))
        times[row] = _along(lattice, costs, following.astype(np.int64))
    return times


def _along(
    lattice: Lattice, costs: NDArray[np.float64], following: NDArray[np.int64]
) -> NDArray[np.float64]:
    """The time (s) from each state along the states that follow, given what the ways cost."""
    states = np.arange(lattice.size)
    there = np.isfinite(costs)
    on = there & (following >= 0)
    after = np.where(on, following, states)
    times = np.zeros(lattice.size)
    times[on] = lattice.seconds(costs[on] - costs[after[on]], states[on], after[on])
    # Each round doubles how many moves are added up, until all lead to the goal.
    while (after != after[after]).any():
        times += times[after]
        after = after[after]
    return np.where(there, times, np.inf)


SNAP_DISTANCE = 0.5  # m that a wanted pose may be away from one where the robot can stand

Views = tuple[NDArray[np.int64], NDArray[np.float64]]
"""States of the lattice from which a checkpoint is seen, and what each costs as a goal, in s."""


class Navigator:
    """Finds the fastest paths on a site. Holds the site's lattice, what it knows of the ways, and
    the paths that it planned last."""

    def __init__(
        self, site: Site, robot: RobotSpec, parts: Parts = NO_CACHE, remembered: int = 0
    ) -> None:
        """What takes long to find is looked up in `parts`, and kept there. The last `remembered`
        paths are not planned again."""
        self.site = site
        self.robot = robot
        self.parts = parts
        self.blockages: tuple[Blockage, ...] = ()
        self._found_views: dict[tuple[int, float], Views] = {}
        self._viewing_states: dict[int, int] = {}
        self._flat_maps: dict[float, FlatMap] = {}
        self._path = lru_cache(remembered)(self._find_path)
        self._path_to_view = lru_cache(remembered)(self._find_path_to_view)

    def avoiding(self, blockages: Sequence[Blockage], site: Site | None = None) -> "Navigator":
        """A navigator of the same site that also keeps clear of `blockages`. Where these stand for
        solids that `site` has besides, checkpoints are not seen through them.

        Raster and surface are shared. Docks and checkpoints may be out of reach then: the paths
        there raise Unreachable. A robot that stands where it may no longer be starts from the
        nearest place where it may.
        """
        if not blockages and site is None:
            return self
        other = Navigator(site or self.site, self.robot)
        other.blockages = (*self.blockages, *blockages)
        other.surface = self.surface
        other.lattice = close(self.lattice, blockages)
        changed = np.diff(other.lattice.costs.indptr) != np.diff(self.lattice.costs.indptr)
        partition = repartition(self._routes.partition, other.lattice, changed)
        other._routes = Routes(other.lattice, partition)
        return other

    def take_over(self, other: "Navigator") -> None:
        """Takes over what a navigator of the same site and robot has found."""
        if "surface" in other.__dict__:
            self.surface = other.surface
            self.parts.store("surface", surface_arrays(self.surface))
        if "lattice" in other.__dict__:
            self.lattice = other.lattice
            self.parts.store("lattice", lattice_arrays(self.lattice))

    def prepare(self) -> None:
        """Finds out now what all queries share, so that no later call takes the time for it."""
        self._routes.prepare()

    @cached_property
    def surface(self) -> Surface:
        """All walkable cells of the site."""
        grid = Grid.over(self.site.spec.ground)
        arrays = self.parts.load_or_make(
            "surface",
            lambda: surface_arrays(
                find_surface(
                    self.site.elements, grid, self.robot.driving_height, self.robot.max_step
                )
            ),
        )
        return Surface(grid, **arrays)

    @cached_property
    def lattice(self) -> Lattice:
        """The states that can be reached from the docking stations and lead back to them.

        Raises ArgoError if the robot can't stand in a docking station, or not all are connected.
        """
        arrays = self.parts.load_or_make("lattice", lambda: lattice_arrays(self._build_lattice()))
        return lattice_of(self.surface, self.robot, arrays)

    def _build_lattice(self) -> Lattice:
        everything = build_lattice(self.surface, self.robot)
        docks = {n: nearest_state(everything, p) for n, p in self.site.docks.items()}
        for number, state in docks.items():
            if state is None:
                raise Invalid(
                    f"site {self.site.name}: the robot can't stand in docking station {number}"
                )
        first, *others = [s for s in docks.values() if s is not None]
        lattice = connected_part(everything, first)
        for state in others:
            if lattice.state_of[everything.cell[state], everything.heading[state]] < 0:
                raise Invalid(
                    f"site {self.site.name}: there is no way from one docking station to another"
                )
        return lattice

    def snap(self, pose: Pose) -> Pose:
        """The pose nearest to `pose` that the robot can take; its heading stays.

        Raises Unreachable if there is none within SNAP_DISTANCE.
        """
        (place,) = _poses(self.lattice, [self.state_at(pose)])
        return place.model_copy(update={"yaw": pose.yaw})

    def plan(self, start: Pose, goal: Pose) -> Path:
        """The fastest path from pose to pose.

        The end is on the lattice, within SNAP_DISTANCE of the goal (5 cm where there is room), and
        turned as the goal asks where there is room to turn. Raises Unreachable.
        """
        return self._path(start, goal)

    def _find_path(self, start: Pose, goal: Pose) -> Path:
        source = self.state_at(start)
        target = self.state_at(goal)
        states = self._routes.find(source, (np.array([target]), np.zeros(1)))
        if states is None:
            raise self._no_way(start, f"({goal.x:.2f}, {goal.y:.2f}, {goal.z:.2f})")
        path = self._smoothed(states, start)
        return self._with_final_turn(path, goal.yaw)

    def plan_to_view(self, start: Pose, checkpoint_id: int, turned: float = 0.0) -> Path:
        """The path to the best place to read the checkpoint from: near in time, and a good view.
        Its face may be taken to be `turned` (rad) against the plan.

        Raises Unreachable if there is no such place, NotFound if there is no such checkpoint.
        """
        return self._path_to_view(start, checkpoint_id, turned)

    def _find_path_to_view(self, start: Pose, checkpoint_id: int, turned: float) -> Path:
        return self._smoothed(self._way_to_view(start, checkpoint_id, turned), start)

    def travel_times(self, places: Sequence[Pose | int]) -> NDArray[np.float64]:
        """Seconds from each of `places` to each other, shape (n, n): row from, column to. A place
        is a pose or the id of a checkpoint.

        A time is what the cheapest way from state to state of the lattice takes, corners not cut:
        a few per cent more than the path that `plan` gives. A checkpoint stands for one pose,
        whatever comes before or after it: where `plan_to_view` leads from the docking station of
        the lowest number. Where there is no way the time is inf; from a place to itself it is 0.

        Raises Unreachable for a pose where the robot can't stand and a checkpoint that it
        can't see, NotFound if there is no such checkpoint.
        """
        return self._routes.times(self._states(places))

    def travel_times_from(self, start: Pose, places: Sequence[Pose | int]) -> NDArray[np.float64]:
        """Seconds from `start` to each of `places`, shape (n,): as `travel_times` has them, and
        errors likewise."""
        return np.asarray(self._routes.times(self._states([start, *places]), 1)[0, 1:])

    def travel_times_to(self, places: Sequence[Pose | int]) -> NDArray[np.float32]:
        """Seconds to each of `places` from every state of the lattice, shape (n, states), inf where
        there is no way; errors as for `travel_times`. Of ways that are equally cheap it may count
        another one than `travel_times` does, which takes hardly more or less."""
        return times_to(self.lattice, self._states(places))

    def state_at(self, pose: Pose) -> int:
        """The number of the lattice's state that ways from `pose` begin with. Raises Unreachable
        if the robot can't stand there."""
        state = nearest_state(self.lattice, pose)
        if state is None:
            raise Unreachable(
                f"there is no place that the robot can reach within {SNAP_DISTANCE} m of "
                f"({pose.x:.2f}, {pose.y:.2f}, {pose.z:.2f})"
            )
        return state

    def viewing_pose(self, checkpoint_id: int) -> Pose:
        """The pose that `travel_times` counts with for a checkpoint.

        Raises Unreachable if it can't be seen, NotFound if there is no such checkpoint.
        """
        return _poses(self.lattice, [self._viewing_state(checkpoint_id)])[0]

    def can_view(self, checkpoint_id: int) -> bool:
        """Whether the checkpoint can be read from anywhere on the lattice."""
        return len(self._views(checkpoint_id)[0]) > 0

    def _viewing_state(self, checkpoint_id: int) -> int:
        if checkpoint_id not in self._viewing_states:
            self._viewing_states[checkpoint_id] = self._find_viewing_state(checkpoint_id)
        return self._viewing_states[checkpoint_id]

    def _find_viewing_state(self, checkpoint_id: int) -> int:
        states, costs = self._views(checkpoint_id)
        total = self._from_first_dock[states] + costs
        if not np.isfinite(total.min(initial=np.inf)):
            # Says why.
            return self._way_to_view(self._first_dock, checkpoint_id)[-1]
        return int(states[int(np.argmin(total))])

    @cached_property
    def _first_dock(self) -> Pose:
        return self.site.docks[min(self.site.docks)]

    @cached_property
    def _from_first_dock(self) -> NDArray[np.float64]:
        arrays = self.parts.load_or_make(
            "first-dock",
            lambda: {"costs": self._routes.costs_from(self.state_at(self._first_dock))},
        )
        return arrays["costs"]

    def turning_places(self, floor: int) -> NDArray[np.float64]:
        """Poses (x, y, z, yaw) on a floor's deck in each of which the robot can turn all round.
        NotFound if there is no such floor."""
        floor_z = self.site.floor(floor).z
        places = self._turning_places
        return places[np.abs(places[:, 2] - floor_z) <= 0.01]

    @cached_property
    def _turning_places(self) -> NDArray[np.float64]:
        """Those of all floors."""
        source, target = self.lattice.costs.tocoo().coords
        here = self.lattice.cell[source]
        turns = np.bincount(here[here == self.lattice.cell[target]], minlength=self.surface.size)
        # Both ways from each heading, if none is missing.
        cells = np.flatnonzero(turns == 2 * HEADINGS)
        return np.column_stack([self.surface.positions()[cells], np.zeros(len(cells))])

    def _states(self, places: Sequence[Pose | int]) -> NDArray[np.int64]:
        states = [
            self.state_at(p) if isinstance(p, Pose) else self._viewing_state(p) for p in places
        ]
        return np.array(states, dtype=np.int64)

    def _no_way(self, start: Pose, goal: str) -> Unreachable:
        reasons = ", ".join(dict.fromkeys(b.reason for b in self.blockages))
        return Unreachable(
            f"there is no way from ({start.x:.2f}, {start.y:.2f}, {start.z:.2f}) to {goal}"
            + (f" that avoids what is closed: {reasons}" if reasons else "")
        )

    def _way_to_view(self, start: Pose, checkpoint_id: int, turned: float = 0.0) -> list[int]:
        goals = self._views(checkpoint_id, turned)
        if not len(goals[0]):
            checkpoint = self.site.checkpoint(checkpoint_id)
            raise Unreachable(
                f"checkpoint {checkpoint_id} ({checkpoint.name}) can't be seen from anywhere that"
                " the robot can reach"
            )
        states = self._routes.find(self.state_at(start), goals)
        if states is None:
            raise self._no_way(start, f"a view of checkpoint {checkpoint_id}")
        return states

    @cached_property
    def _routes(self) -> Routes:
        cuts = find_cuts(self.lattice, [f.z for f in self.site.spec.floors])
        return Routes(self.lattice, make_partition(self.lattice, cuts, self.parts), self.parts)

    def _views(self, checkpoint_id: int, turned: float = 0.0) -> Views:
        key = checkpoint_id, turned
        if key not in self._found_views:
            planned = self.site.checkpoint(checkpoint_id)
            face = replace(planned, yaw=planned.yaw + turned)
            self._found_views[key] = find_views(self.site, face, self.lattice)
        return self._found_views[key]

    def _flat_map(self, z: float) -> FlatMap:
        z = round(z, 3)
        if z not in self._flat_maps:
            self._flat_maps[z] = self._make_flat_map(z)
        return self._flat_maps[z]

    def _make_flat_map(self, z: float) -> FlatMap:
        cells = FlatMap.at(self.surface, z)
        if not self.blockages:
            return cells
        free = cells.free.copy()
        closed = closed_cells(self.surface, self.blockages)
        closed &= np.abs(self.surface.z - z) <= DRIVING_LEVEL
        free[self.surface.i[closed], self.surface.j[closed]] = False
        return FlatMap(cells.grid, free, cells.rims)

    def _smoothed(self, states: list[int], start: Pose) -> Path:
        path = _to_path(self.lattice, states)
        if path.start.yaw != start.yaw:
            here = path.start.model_copy(update={"yaw": start.yaw})
            turn = Motion(here, path.start, turn=wrap(path.start.yaw - start.yaw))
            if turns_over(here, turn.turn, self.blockages, self.robot):
                raise self._no_way(start, f"({path.end.x:.2f}, {path.end.y:.2f}, {path.end.z:.2f})")
            path = Path(here, (turn, *path.motions) if abs(turn.turn) > 1e-9 else path.motions)
        return smooth(path, self._flat_map, self.robot)

    def _with_final_turn(self, path: Path, yaw: float) -> Path:
        angle = wrap(yaw - path.end.yaw)
        if abs(angle) < 1e-9:
            return path
        end = path.end.model_copy(update={"yaw": yaw})
        if not self._flat_map(end.z).clear_turn(path.end, angle, self.robot.footprint):
            return path
        motions = merge((*path.motions, Motion(path.end, end, turn=angle)))
        return Path(path.start, tuple(motions))


def nearest_state(lattice: Lattice, pose: Pose) -> int | None:
    """The state nearest to the pose, first by place, then by heading; None if all are far."""
    surface = lattice.surface
    around = surface.near(pose.x, pose.y, SNAP_DISTANCE)
    x, y = surface.grid.centers(surface.i[around], surface.j[around])
    step = np.hypot(x - pose.x, y - pose.y) + np.abs(surface.z[around] - pose.z)
    near, step = around[step <= SNAP_DISTANCE], step[step <= SNAP_DISTANCE]
    heading = round(pose.yaw / (2 * math.pi / HEADINGS)) % HEADINGS
    aside = [min(k, HEADINGS - k) for k in ((h - heading) % HEADINGS for h in range(HEADINGS))]
    cost = step[:, None] + 0.05 * np.array(aside)[None, :]
    cost = np.where(lattice.state_of[near] >= 0, cost, np.inf)
    if not cost.size or not np.isfinite(cost.min()):
        return None
    cell, turned = np.unravel_index(int(np.argmin(cost)), cost.shape)
    return int(lattice.state_of[near[cell], turned])


def _to_path(lattice: Lattice, states: Sequence[int]) -> Path:
    """The motions through lattice states, joined where they go on alike."""
    way = np.array(states)
    poses, heading = lattice.poses(way), lattice.heading[way]
    step, turn = np.diff(poses[:, :2], axis=0), np.diff(heading)
    turn = (turn + HEADINGS // 2) % HEADINGS - HEADINGS // 2
    yaw = poses[:-1, 3]
    ahead = step[:, 0] * np.cos(yaw) + step[:, 1] * np.sin(yaw) > 0
    tilted = np.abs(lattice.rise[way[:-1]] + lattice.rise[way[1:]]) / 2 > LEVEL
    # The heading only changes in turns, so that drives are alike if their gear and slope are.
    kind = np.where(turn != 0, -1, 2 * ahead + tilted)
    ends = [*(np.flatnonzero(np.diff(kind)) + 1).tolist(), len(kind)] if len(kind) else []
    corners = _poses(lattice, [states[k] for k in (0, *ends)])
    motions, first = [], 0
    for (a, b), end in zip(pairwise(corners), ends, strict=True):
        if kind[first] < 0:
            turned = int(turn[first:end].sum()) * heading_angle(1)
            motions.append(Motion(a, b, turn=turned))
        else:
            gear = 1 if ahead[first] else -1
            motions.append(Motion(a, b, gear=gear, on_stairs=bool(tilted[first])))
        first = end
    return Path(corners[0], tuple(motions))


def _poses(lattice: Lattice, states: Sequence[int]) -> list[Pose]:
    """The poses of lattice states."""
    rows = lattice.poses(np.array(states)).tolist()
    return [
        Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=wrap(yaw)) for x, y, z, yaw in rows
    ]
