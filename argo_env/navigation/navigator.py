"""The navigator: paths from pose to pose and to where a checkpoint can be read."""

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

from argo_compiler.errors import ArgoError
from argo_compiler.model import Pose
from argo_env.navigation.lattice import LEVEL, Lattice, build_lattice, connected_part
from argo_env.navigation.path import Motion, Path, merge, wrap
from argo_env.navigation.raster import Grid
from argo_env.navigation.smoothing import FlatMap, smooth
from argo_env.navigation.stencil import HEADINGS
from argo_env.navigation.surface import Surface, find_surface
from argo_env.navigation.views import find_views
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site

SNAP_DISTANCE = 0.5  # m that a wanted pose may be away from one where the robot can stand
_TREES = 64  # shortest-path trees that are kept


class UnreachableError(ArgoError):
    """There is no way to where the robot should go; the message says what and why."""


class Navigator:
    """Finds the fastest paths on a site. Holds the site's lattice and a cache of search trees."""

    def __init__(self, site: Site, robot: RobotSpec) -> None:
        self.site = site
        self.robot = robot
        # The cache belongs to this object, not to the class, and goes with it.
        self._tree = lru_cache(maxsize=_TREES)(self._search)
        self._views = lru_cache(maxsize=None)(self._find_views)
        self._flat_map = lru_cache(maxsize=None)(self._make_flat_map)

    def prepare(self) -> None:
        """Builds surface and lattice now, so that no later call takes the time for it."""
        _ = self.lattice

    @cached_property
    def surface(self) -> Surface:
        """All walkable cells of the site."""
        grid = Grid.over(self.site.spec.ground)
        return find_surface(
            self.site.elements, grid, self.robot.driving_height, self.robot.max_step
        )

    @cached_property
    def lattice(self) -> Lattice:
        """The states that can be reached from the docking stations and lead back to them.

        Raises ArgoError if the robot can't stand in a docking station, or not all are connected.
        """
        everything = build_lattice(self.surface, self.robot)
        docks = {n: _nearest(everything, p) for n, p in self.site.docks.items()}
        for number, state in docks.items():
            if state is None:
                raise ArgoError(
                    f"site {self.site.name}: the robot can't stand in docking station {number}"
                )
        first, *others = [s for s in docks.values() if s is not None]
        lattice = connected_part(everything, first)
        for state in others:
            if lattice.state_of[everything.cell[state], everything.heading[state]] < 0:
                raise ArgoError(
                    f"site {self.site.name}: there is no way from one docking station to another"
                )
        return lattice

    @cached_property
    def _poses(self) -> NDArray[np.float64]:
        return self.lattice.poses()

    def snap(self, pose: Pose) -> Pose:
        """The pose nearest to `pose` that the robot can take; its heading stays.

        Raises UnreachableError if there is none within SNAP_DISTANCE.
        """
        x, y, z, _ = self._poses[self._state_at(pose)].tolist()
        return Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=pose.yaw)

    def plan(self, start: Pose, goal: Pose) -> Path:
        """The fastest path from pose to pose.

        The end is on the lattice, within SNAP_DISTANCE of the goal (5 cm where there is room), and
        turned as the goal asks where there is room to turn. Raises UnreachableError.
        """
        source = self._state_at(start)
        target = self._state_at(goal)
        path = self._smoothed(source, target, start)
        return self._with_final_turn(path, goal.yaw)

    def plan_to_view(self, start: Pose, checkpoint_id: int) -> Path:
        """The path to the best place to read the checkpoint from: near in time, and a good view.

        Raises UnreachableError if there is no such place, KeyError if there is no such checkpoint.
        """
        states, costs = self._views(checkpoint_id)
        if not len(states):
            checkpoint = self.site.checkpoint(checkpoint_id)
            raise UnreachableError(
                f"checkpoint {checkpoint_id} ({checkpoint.name}) can't be seen from anywhere that"
                " the robot can reach"
            )
        source = self._state_at(start)
        seconds, _ = self._tree(source)
        best = states[int(np.argmin(seconds[states] + costs))]
        return self._smoothed(source, int(best), start)

    def turning_places(self, floor: int) -> NDArray[np.float64]:
        """Poses (x, y, z, yaw) on a floor's deck in each of which the robot can turn all round."""
        floor_z = next(f.z for f in self.site.spec.floors if f.number == floor)
        source, target = self.lattice.costs.tocoo().coords
        here = self.lattice.cell[source]
        turns = np.bincount(here[here == self.lattice.cell[target]], minlength=self.surface.size)
        # Both ways from each heading, if none is missing.
        free = (turns == 2 * HEADINGS) & (np.abs(self.surface.z - floor_z) <= 0.01)
        cells = np.flatnonzero(free)
        return np.column_stack([self.surface.positions()[cells], np.zeros(len(cells))])

    def _state_at(self, pose: Pose) -> int:
        state = _nearest(self.lattice, pose)
        if state is None:
            raise UnreachableError(
                f"there is no place that the robot can reach within {SNAP_DISTANCE} m of "
                f"({pose.x:.2f}, {pose.y:.2f}, {pose.z:.2f})"
            )
        return state

    def _search(self, source: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """The cost in s from `source` to every state, and the state before each on the way."""
        seconds, before = dijkstra(
            self.lattice.costs, indices=np.array([source]), return_predecessors=True
        )
        return seconds[0], before[0]

    def _find_views(self, checkpoint_id: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        return find_views(self.site, self.site.checkpoint(checkpoint_id), self.lattice)

    def _make_flat_map(self, z: float) -> FlatMap:
        return FlatMap.at(self.surface, z)

    def _smoothed(self, source: int, target: int, start: Pose) -> Path:
        _, before = self._tree(source)
        states = [target]
        while states[-1] != source:
            states.append(int(before[states[-1]]))
        path = _to_path(self.lattice, self._poses, states[::-1])
        if path.start.yaw != start.yaw:
            here = path.start.model_copy(update={"yaw": start.yaw})
            turn = Motion(here, path.start, turn=wrap(path.start.yaw - start.yaw))
            path = Path(here, (turn, *path.motions) if abs(turn.turn) > 1e-9 else path.motions)
        return smooth(path, lambda z: self._flat_map(round(z, 3)), self.robot)

    def _with_final_turn(self, path: Path, yaw: float) -> Path:
        angle = wrap(yaw - path.end.yaw)
        if abs(angle) < 1e-9:
            return path
        end = path.end.model_copy(update={"yaw": yaw})
        poses = np.array(
            [
                [end.x, end.y, path.end.yaw + share * angle]
                for share in np.linspace(0.0, 1.0, 2 + math.ceil(abs(angle) / 0.1))
            ]
        )
        if not self._flat_map(round(end.z, 3)).clear(poses, self.robot.footprint):
            return path
        motions = merge((*path.motions, Motion(path.end, end, turn=angle)))
        return Path(path.start, tuple(motions))


def _nearest(lattice: Lattice, pose: Pose) -> int | None:
    """The state nearest to the pose, first by place, then by heading; None if all are far."""
    positions = lattice.surface.positions()
    step = np.hypot(positions[:, 0] - pose.x, positions[:, 1] - pose.y)
    step += np.abs(positions[:, 2] - pose.z)
    near = np.flatnonzero(step <= SNAP_DISTANCE)
    heading = round(pose.yaw / (2 * math.pi / HEADINGS)) % HEADINGS
    aside = [min(k, HEADINGS - k) for k in ((h - heading) % HEADINGS for h in range(HEADINGS))]
    cost = step[near, None] + 0.05 * np.array(aside)[None, :]
    cost = np.where(lattice.state_of[near] >= 0, cost, np.inf)
    if not cost.size or not np.isfinite(cost.min()):
        return None
    cell, turned = np.unravel_index(int(np.argmin(cost)), cost.shape)
    return int(lattice.state_of[near[cell], turned])


def _to_path(lattice: Lattice, poses: NDArray[np.float64], states: Sequence[int]) -> Path:
    """The motions through lattice states, joined where they go on alike."""
    corners = [
        Pose(x=round(x, 6), y=round(y, 6), z=round(z, 6), yaw=wrap(yaw))
        for x, y, z, yaw in poses[list(states)].tolist()
    ]
    motions = []
    for k, (a, b) in enumerate(pairwise(corners)):
        if a.yaw != b.yaw:
            motions.append(Motion(a, b, turn=wrap(b.yaw - a.yaw)))
            continue
        ahead = (b.x - a.x) * math.cos(a.yaw) + (b.y - a.y) * math.sin(a.yaw)
        rise = float(lattice.rise[states[k]] + lattice.rise[states[k + 1]]) / 2
        motions.append(Motion(a, b, gear=1 if ahead > 0 else -1, on_stairs=abs(rise) > LEVEL))
    return Path(corners[0], tuple(merge(motions)))
