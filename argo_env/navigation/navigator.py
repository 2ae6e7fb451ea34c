"""The navigator, which finds paths from pose to pose and to where a checkpoint can be read."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, Unreachable
from argo_compiler.base.memoization import thread_safe_cached_property
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Pose
from argo_env.files.parts import NO_CACHE, Parts
from argo_env.navigation.closed_areas import (
    Blockage,
    closed_cells,
    turn_touches_blockage,
    with_states_closed,
)
from argo_env.navigation.graphs import reverse_graph, shortest_path_trees
from argo_env.navigation.lattice import (
    DRIVING_LEVEL,
    LEVEL,
    Lattice,
    build_lattice,
    connected_sublattice,
    lattice_arrays,
    lattice_from_arrays,
)
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.path_search import PathSearch
from argo_env.navigation.raster import Grid
from argo_env.navigation.regions import find_cut_heights, make_partition, repartition
from argo_env.navigation.smoothing import FlatMap, smooth
from argo_env.navigation.stencil import HEADINGS, heading_angle
from argo_env.navigation.surface import Surface, find_surface, surface_arrays
from argo_env.navigation.views import find_view_states_and_costs
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site


def times_to_goals(lattice: Lattice, goals: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the time (s) of the cheapest path from each state to each goal, shape (goals, states).

    The time is inf where there is no path.
    """
    back = reverse_graph(lattice.costs)
    back.indices, back.indptr = back.indices.astype(np.int32), back.indptr.astype(np.int32)
    times = np.empty((len(goals), lattice.size), dtype=np.float32)
    for row, goal in enumerate(goals.tolist()):
        (costs,), (following,) = shortest_path_trees(back, np.array([goal]))
        times[row] = _times_along(lattice, costs, following.astype(np.int64))
    return times


def _times_along(
    lattice: Lattice, costs: NDArray[np.float64], following: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the time (s) from each state to the goal along the following states.

    The time is inf where there is no path.

    Args:
        lattice: Lattice of the states.
        costs: Cost (s) of the cheapest path from each state to the goal.
        following: Next state on that path, negative at the goal and where there is no path.
    """
    states = np.arange(lattice.size)
    there = np.isfinite(costs)
    on = there & (following >= 0)
    after = np.where(on, following, states)
    times = np.zeros(lattice.size)
    times[on] = lattice.move_times(costs[on] - costs[after[on]], states[on], after[on])
    # Each pass doubles the number of moves that are added up, until all lead to the goal.
    while (after != after[after]).any():
        times += times[after]
        after = after[after]
    return np.where(there, times, np.inf)


SNAP_DISTANCE = 0.5  # m that a requested pose may be away from one where the robot can stand

Views = tuple[NDArray[np.int64], NDArray[np.float64]]
"""states of the lattice from which a checkpoint is seen, and the cost of each as a goal, in s"""


class Navigator:
    """Path planner of a site.

    It holds the site's lattice, what earlier searches have found, and the last planned paths.
    """

    def __init__(
        self, site: Site, robot: RobotSpec, parts: Parts = NO_CACHE, cached_paths: int = 0
    ) -> None:
        """Initialise the navigator; nothing is computed before it is needed.

        Args:
            site: Site to plan on.
            robot: Robot that drives.
            parts: Cache on disk of what takes long to compute.
            cached_paths: Number of latest paths that are not planned again.
        """
        self.site = site
        self.robot = robot
        self.parts = parts
        self.blockages: tuple[Blockage, ...] = ()
        self._cached_views: dict[tuple[int, float], Views] = {}
        self._viewing_states: dict[int, int] = {}
        self._flat_maps: dict[float, FlatMap] = {}
        self._path = lru_cache(cached_paths)(self._find_path)
        self._path_to_view = lru_cache(cached_paths)(self._find_path_to_view)

    def with_added_blockages(
        self, blockages: Sequence[Blockage], site: Site | None = None
    ) -> "Navigator":
        """Return a navigator of the same site that keeps clear of its present and new `blockages`.

        If there are no new blockages and no `site`, it is this navigator itself. If `site` is
        given, it has additional solids, for which the blockages stand, and checkpoints are not seen
        through them. The surface is shared. To plan a path to a dock or checkpoint that has become
        unreachable raises Unreachable. A robot that stands where it may no longer stand starts from
        the nearest pose where it may.
        """
        if not blockages and site is None:
            return self
        other = Navigator(site or self.site, self.robot)
        other.blockages = (*self.blockages, *blockages)
        other.surface = self.surface
        other.lattice = with_states_closed(self.lattice, blockages)
        changed = np.diff(other.lattice.costs.indptr) != np.diff(self.lattice.costs.indptr)
        partition = repartition(self._path_search.partition, other.lattice, changed)
        other._path_search = PathSearch(other.lattice, partition)
        return other

    def adopt_surface_and_lattice(self, other: "Navigator") -> None:
        """Adopt the surface and the lattice that another navigator has computed, and store them.

        It must be one of the same site and robot. What it has not computed yet is left out.
        """
        if "surface" in other.__dict__:
            self.surface = other.surface
            self.parts.store_arrays("surface", surface_arrays(self.surface))
        if "lattice" in other.__dict__:
            self.lattice = other.lattice
            self.parts.store_arrays("lattice", lattice_arrays(self.lattice))

    def prepare(self) -> None:
        """Compute now what all queries share, so that no later call takes the time for it."""
        self._path_search.prepare()

    @thread_safe_cached_property
    def surface(self) -> Surface:
        """All cells of the site that the robot can traverse."""
        grid = Grid.covering(self.site.spec.ground)
        arrays = self.parts.load_or_make(
            "surface",
            lambda: surface_arrays(
                find_surface(
                    self.site.elements, grid, self.robot.driving_height, self.robot.max_step
                )
            ),
        )
        return Surface(grid, **arrays)

    @thread_safe_cached_property
    def lattice(self) -> Lattice:
        """States that can be reached from the docking stations and lead back to them.

        Raises ArgoError if the robot can't stand in a docking station, or not all are connected.
        """
        arrays = self.parts.load_or_make("lattice", lambda: lattice_arrays(self._build_lattice()))
        return lattice_from_arrays(self.surface, self.robot, arrays)

    def _build_lattice(self) -> Lattice:
        all_states = build_lattice(self.surface, self.robot)
        docks = {n: nearest_state(all_states, p) for n, p in self.site.docks.items()}
        for number, state in docks.items():
            if state is None:
                raise Invalid(
                    Message(
                        "site {site}: the robot can't stand in docking station {number}",
                        site=self.site.name,
                        number=number,
                    )
                )
        first, *others = [s for s in docks.values() if s is not None]
        lattice = connected_sublattice(all_states, first)
        for state in others:
            if lattice.state_of[all_states.cell[state], all_states.heading[state]] < 0:
                raise Invalid(
                    Message(
                        "site {site}: there is no path from one docking station to another",
                        site=self.site.name,
                    )
                )
        return lattice

    def snap_keeping_heading(self, pose: Pose) -> Pose:
        """Return `pose` moved to the nearest position at which the robot can stand.

        Its heading stays, though the robot may not be able to stand there with it.

        Raises:
            Unreachable: There is no such position within SNAP_DISTANCE.
        """
        (nearest,) = _poses(self.lattice, [self.state_at(pose)])
        return nearest.model_copy(update={"yaw": pose.yaw})

    def plan(self, start: Pose, goal: Pose) -> Path:
        """Return the path of the lowest cost from pose to pose.

        A move's cost is its time, and a little more in tight spots (`Lattice`). The end is on the
        lattice, within SNAP_DISTANCE of the goal, and within 5 cm where there is room. It has the
        heading of the goal where there is room to turn.

        Raises:
            Unreachable: The robot can't stand at the start or the goal, or there is no path.
        """
        return self._path(start, goal)

    def _find_path(self, start: Pose, goal: Pose) -> Path:
        source = self.state_at(start)
        target = self.state_at(goal)
        states = self._path_search.find_path(source, (np.array([target]), np.zeros(1)))
        if states is None:
            raise self._no_path_error(start, f"({goal.x:.2f}, {goal.y:.2f}, {goal.z:.2f})")
        path = self._smoothed(states, start)
        return self._with_final_turn(path, goal.yaw)

    def plan_to_view(self, start: Pose, checkpoint_id: int, checkpoint_turn: float = 0.0) -> Path:
        """Return the path to the pose from which to read a checkpoint.

        It is the pose with the lowest sum of the cost of the path and of the view: oblique and far
        views cost more (`find_view_states_and_costs`). The checkpoint's face is assumed to be
        turned by `checkpoint_turn` (rad, counter-clockwise from above) from its planned heading.

        Raises:
            Unreachable: There is no such pose, or no path to one.
            NotFound: There is no such checkpoint.
        """
        return self._path_to_view(start, checkpoint_id, checkpoint_turn)

    def views_by_distance(self, pose: Pose, checkpoint_id: int) -> Iterator[Pose]:
        """Yield the poses from which a checkpoint can be read, the nearest to `pose` first.

        They are those of the lattice, in cells of some centimetres, with a few headings each. Of
        several headings in a cell, that nearest to the heading of `pose` comes first. Raises
        NotFound if there is no such checkpoint.
        """
        states, _ = self._views(checkpoint_id)
        rows = self.lattice.state_poses(states)
        distance = np.linalg.norm(rows[:, :3] - (pose.x, pose.y, pose.z), axis=1)
        turn = np.abs((rows[:, 3] - pose.yaw + np.pi) % (2 * np.pi) - np.pi)
        for index in np.lexsort((turn, distance.round(6))).tolist():
            yield _poses(self.lattice, [int(states[index])])[0]

    def _find_path_to_view(self, start: Pose, checkpoint_id: int, checkpoint_turn: float) -> Path:
        return self._smoothed(self._states_to_view(start, checkpoint_id, checkpoint_turn), start)

    def travel_times(self, locations: Sequence[Pose | int]) -> NDArray[np.float64]:
        """Return the seconds from each location to each other, shape (n, n): row from, column to.

        A location is a pose or the id of a checkpoint. A time is that of the cheapest path from
        state to state of the lattice, without cut corners: a few per cent more than the path that
        `plan` returns. A checkpoint stands for one pose, whatever comes before or after it: the end
        of the path of `plan_to_view` from the docking station of the lowest number. The time is inf
        where there is no path, and 0 from a location to itself.

        Raises:
            Unreachable: The robot can't stand at a pose, or can't see a checkpoint.
            NotFound: There is no such checkpoint.
        """
        return self._path_search.travel_times(self._states(locations))

    def travel_times_from(
        self, start: Pose, locations: Sequence[Pose | int]
    ) -> NDArray[np.float64]:
        """Return the seconds from `start` to each of `locations`, shape (n,).

        `travel_times` describes locations, times and errors.
        """
        return np.asarray(
            self._path_search.travel_times(self._states([start, *locations]), 1)[0, 1:]
        )

    def travel_times_to(self, locations: Sequence[Pose | int]) -> NDArray[np.float32]:
        """Return the seconds to each location from every state of the lattice, shape (n, states).

        The time is inf where there is no path. Of paths of equal cost it may use another one than
        `travel_times` does, which takes hardly more or less time. Errors are those of
        `travel_times`.
        """
        return times_to_goals(self.lattice, self._states(locations))

    def state_at(self, pose: Pose) -> int:
        """Return the number of the lattice's state that paths from `pose` begin with.

        Raises:
            Unreachable: The robot can't stand there.
        """
        state = nearest_state(self.lattice, pose)
        if state is None:
            raise Unreachable(
                Message(
                    "there is no place that the robot can reach within {snap_distance} m of "
                    "({x:.2f}, {y:.2f}, {z:.2f})",
                    snap_distance=SNAP_DISTANCE,
                    x=pose.x,
                    y=pose.y,
                    z=pose.z,
                )
            )
        return state

    def viewing_pose(self, checkpoint_id: int) -> Pose:
        """Return the pose that stands for a checkpoint in `travel_times`.

        Raises:
            Unreachable: The checkpoint can't be seen.
            NotFound: There is no such checkpoint.
        """
        return _poses(self.lattice, [self._viewing_state(checkpoint_id)])[0]

    def can_view(self, checkpoint_id: int) -> bool:
        """Return True if the checkpoint can be read from some state of the lattice.

        Raises NotFound if there is no such checkpoint.
        """
        return len(self._views(checkpoint_id)[0]) > 0

    def _viewing_state(self, checkpoint_id: int) -> int:
        if checkpoint_id not in self._viewing_states:
            self._viewing_states[checkpoint_id] = self._find_viewing_state(checkpoint_id)
        return self._viewing_states[checkpoint_id]

    def _find_viewing_state(self, checkpoint_id: int) -> int:
        states, costs = self._views(checkpoint_id)
        total = self._from_first_dock[states] + costs
        if not np.isfinite(total.min(initial=np.inf)):
            # This raises an error that states the reason.
            return self._states_to_view(self._first_dock, checkpoint_id)[-1]
        return int(states[int(np.argmin(total))])

    @thread_safe_cached_property
    def _first_dock(self) -> Pose:
        return self.site.docks[min(self.site.docks)]

    @thread_safe_cached_property
    def _from_first_dock(self) -> NDArray[np.float64]:
        arrays = self.parts.load_or_make(
            "first-dock",
            lambda: {"costs": self._path_search.costs_from(self.state_at(self._first_dock))},
        )
        return arrays["costs"]

    def turning_poses(self, floor: int) -> NDArray[np.float64]:
        """Return all poses (x, y, z, yaw) on a floor's deck at which the robot can turn all round.

        The deck is the floor's plate; poses within 1 cm of its height count. There is one for each
        cell of the grid, with yaw 0. The shape is (n, 4), in m and rad.

        Raises:
            NotFound: There is no such floor.
        """
        floor_z = self.site.floor(floor).z
        poses = self._turning_poses
        return poses[np.abs(poses[:, 2] - floor_z) <= 0.01]

    @thread_safe_cached_property
    def _turning_poses(self) -> NDArray[np.float64]:
        """Poses at which the robot can turn all round, on all floors."""
        source, target = self.lattice.costs.tocoo().coords
        here = self.lattice.cell[source]
        turns = np.bincount(here[here == self.lattice.cell[target]], minlength=self.surface.size)
        # A cell with all turns has two from each heading.
        cells = np.flatnonzero(turns == 2 * HEADINGS)
        return np.column_stack([self.surface.cell_positions()[cells], np.zeros(len(cells))])

    def _states(self, locations: Sequence[Pose | int]) -> NDArray[np.int64]:
        states = [
            self.state_at(p) if isinstance(p, Pose) else self._viewing_state(p) for p in locations
        ]
        return np.array(states, dtype=np.int64)

    def _no_path_error(self, start: Pose, goal: str) -> Unreachable:
        reasons = Listing(dict.fromkeys(b.reason for b in self.blockages))
        return Unreachable(
            Message(
                "there is no path from ({x:.2f}, {y:.2f}, {z:.2f}) to {goal}",
                x=start.x,
                y=start.y,
                z=start.z,
                goal=goal,
            )
            + (
                Message(" that avoids what is closed: {reasons}", reasons=reasons)
                if reasons
                else ""
            )
        )

    def _states_to_view(
        self, start: Pose, checkpoint_id: int, checkpoint_turn: float = 0.0
    ) -> list[int]:
        goals = self._views(checkpoint_id, checkpoint_turn)
        if not len(goals[0]):
            checkpoint = self.site.checkpoint(checkpoint_id)
            raise Unreachable(
                Message(
                    "checkpoint {checkpoint_id} ({checkpoint}) can't be seen from anywhere "
                    "that the robot can reach",
                    checkpoint_id=checkpoint_id,
                    checkpoint=checkpoint.name,
                )
            )
        states = self._path_search.find_path(self.state_at(start), goals)
        if states is None:
            raise self._no_path_error(
                start, Message("a view of checkpoint {checkpoint_id}", checkpoint_id=checkpoint_id)
            )
        return states

    @thread_safe_cached_property
    def _path_search(self) -> PathSearch:
        cuts = find_cut_heights(self.lattice, [f.z for f in self.site.spec.floors])
        return PathSearch(self.lattice, make_partition(self.lattice, cuts, self.parts), self.parts)

    def _views(self, checkpoint_id: int, checkpoint_turn: float = 0.0) -> Views:
        key = checkpoint_id, checkpoint_turn
        if key not in self._cached_views:
            planned = self.site.checkpoint(checkpoint_id)
            face = replace(planned, yaw=planned.yaw + checkpoint_turn)
            self._cached_views[key] = find_view_states_and_costs(self.site, face, self.lattice)
        return self._cached_views[key]

    def _flat_map(self, z: float) -> FlatMap:
        z = round(z, 3)
        if z not in self._flat_maps:
            self._flat_maps[z] = self._make_flat_map(z)
        return self._flat_maps[z]

    def _make_flat_map(self, z: float) -> FlatMap:
        cells = FlatMap.at_height(self.surface, z)
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
            if turn_touches_blockage(here, turn.turn, self.blockages, self.robot):
                raise self._no_path_error(
                    start, f"({path.end.x:.2f}, {path.end.y:.2f}, {path.end.z:.2f})"
                )
            path = Path(here, (turn, *path.motions) if abs(turn.turn) > 1e-9 else path.motions)
        return smooth(path, self._flat_map, self.robot)

    def _with_final_turn(self, path: Path, yaw: float) -> Path:
        angle = wrap(yaw - path.end.yaw)
        if abs(angle) < 1e-9:
            return path
        end = path.end.model_copy(update={"yaw": yaw})
        if not self._flat_map(end.z).is_turn_clear(path.end, angle, self.robot.footprint):
            return path
        motions = merge((*path.motions, Motion(path.end, end, turn=angle)))
        return Path(path.start, tuple(motions))


def nearest_state(lattice: Lattice, pose: Pose) -> int | None:
    """Return the number of the state nearest to a pose; None if none is within SNAP_DISTANCE.

    Each 45 degrees between its heading and that of the pose count as 5 cm of distance.
    """
    surface = lattice.surface
    around = surface.cells_in_square(pose.x, pose.y, SNAP_DISTANCE)
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
    """Return the path through lattice states, with consecutive moves of the same kind merged."""
    numbers = np.array(states)
    poses, heading = lattice.state_poses(numbers), lattice.heading[numbers]
    step, turn = np.diff(poses[:, :2], axis=0), np.diff(heading)
    turn = (turn + HEADINGS // 2) % HEADINGS - HEADINGS // 2
    yaw = poses[:-1, 3]
    ahead = step[:, 0] * np.cos(yaw) + step[:, 1] * np.sin(yaw) > 0
    tilted = np.abs(lattice.rise[numbers[:-1]] + lattice.rise[numbers[1:]]) / 2 > LEVEL
    # The heading only changes in turns, so drives of the same gear and slope can be merged.
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
    """Return the poses of lattice states, their coordinates rounded to 1 µm."""
    rows = lattice.state_poses(np.array(states)).tolist()
    return [
        Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=wrap(yaw)) for x, y, z, yaw in rows
    ]
