"""Guide to a goal from any pose: the travel time, and the next point of the path."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from argo_compiler.base.errors import Unreachable
from argo_env.navigation import Navigator
from argo_env.navigation.path import wrap
from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator

GOALS = 6  # on each floor
LOOKAHEAD = 0.8  # m from the robot to the waypoint at most
_CACHED_GOALS = 64  # goals whose paths are cached; one takes 12 bytes for each state of the lattice


@dataclass(frozen=True)
class Waypoint:
    """Next point of the path to a goal."""

    x: float
    y: float
    z: float
    yaw: float
    """heading (rad) that the robot should have there"""
    seconds: float
    """travel time (s) from the robot to the goal at planning speeds"""


class Guide:
    """Guide for one site, which holds its possible goals and caches the paths to those in use."""

    def __init__(self, navigator: Navigator) -> None:
        """Collect the positions to start from; raise Unreachable if the site has none."""
        lattice = navigator.lattice
        self._lattice = lattice
        self._turn_rate = navigator.robot.turn_rate_radians
        self._speed = navigator.robot.speed
        self._back = lattice.costs.T.tocsr()
        self._cells = np.unique(lattice.cell)
        self._poses = lattice.state_poses()
        positions = lattice.surface.cell_positions()[self._cells]
        self._tree = cKDTree(positions)
        self._headings = 2 * math.pi * np.arange(lattice.state_of.shape[1])
        self._headings /= lattice.state_of.shape[1]
        turning_poses = {
            f.number: navigator.turning_poses(f.number) for f in navigator.site.spec.floors
        }
        self._positions = {
            number: poses[self._nearest_cells(poses) >= 0]
            for number, poses in turning_poses.items()
            if len(poses)
        }
        if not self._positions:
            name = navigator.site.name
            raise Unreachable(
                f"site {name} has no position where the robot has room to turn on the spot"
            )
        self._paths_to = lru_cache(maxsize=_CACHED_GOALS)(self._search)

    @property
    def floors(self) -> tuple[int, ...]:
        """Numbers of the floors on which the robot can start and arrive."""
        return tuple(self._positions)

    def goal_positions(self, floors: tuple[int, ...]) -> NDArray[np.float64]:
        """Return the possible goals (x, y, z in m) on these floors, at least one, shape (n, 3).

        There are at most GOALS on each floor, the same ones each time.
        """
        parts = []
        for floor in floors:
            positions = self._positions[floor]
            chosen = generator(0, "goals", floor).permutation(len(positions))[:GOALS]
            parts.append(positions[np.sort(chosen), :3])
        return np.concatenate(parts)

    def start_positions_or_nearest(
        self,
        goal: tuple[float, float, float],
        floors: tuple[int, ...],
        least_seconds: float,
        most_seconds: float,
    ) -> NDArray[np.float64]:
        """Return all possible start positions (x, y, z in m) on these floors, shape (n, 3).

        Their travel times to the goal are from `least_seconds` to `most_seconds`. If there are
        none, those with the next higher time are returned.
        """
        positions = np.concatenate([self._positions[floor] for floor in floors])[:, :3]
        seconds, _ = self._paths_to(goal)
        cells = self._cells[self._tree.query(positions)[1]]
        states = self._lattice.state_of[cells]
        time_to_goal = np.where(states >= 0, seconds[states], np.inf).min(axis=1)
        suitable = (time_to_goal >= least_seconds) & (time_to_goal <= most_seconds)
        if not suitable.any():
            above = np.where(time_to_goal >= least_seconds, time_to_goal, np.inf)
            suitable = above == above.min()
        return np.asarray(positions[suitable])

    def next_waypoint(self, goal: tuple[float, float, float], pose: BodyPose) -> Waypoint:
        """Return the next point of the path from a pose to the goal.

        The path begins at the state of the lattice nearest to the pose, however far away it is: the
        robot may be beside the walkway.
        """
        lattice = self._lattice
        seconds, following = self._paths_to(goal)
        distance, nearest = self._tree.query((pose.x, pose.y, pose.z))
        states = lattice.state_of[self._cells[nearest]]
        turns = np.abs((pose.yaw - self._headings + math.pi) % (2 * math.pi) - math.pi)
        costs = np.where(states >= 0, seconds[states], np.inf) + turns / self._turn_rate
        best = int(np.argmin(costs))
        time_to_goal = float(costs[best]) + float(distance) / self._speed
        x, y, z, yaw = self._next_point(int(states[best]), following, pose)
        return Waypoint(x, y, z, yaw, time_to_goal)

    def _next_point(
        self, state: int, following: NDArray[np.int32], pose: BodyPose
    ) -> tuple[float, float, float, float]:
        """Return the pose where the path turns next, about LOOKAHEAD from the robot at most."""
        poses, cell, heading = self._poses, self._lattice.cell, self._lattice.heading
        # Turns on the spot come first; the path continues with the heading after the last of them.
        while (successor := following.item(state)) >= 0 and cell[successor] == cell[state]:
            state = successor
        straight = heading[state]
        while (successor := following.item(state)) >= 0 and heading[successor] == straight:
            state = successor
            if (
                math.hypot(poses.item(state, 0) - pose.x, poses.item(state, 1) - pose.y)
                >= LOOKAHEAD
            ):
                break
        x, y, z, yaw = poses[state].tolist()
        return x, y, z, wrap(yaw)

    def _search(
        self, goal: tuple[float, float, float]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Return the travel time (s) from each state to the goal, and the state that follows it."""
        cell = self._cells[self._tree.query(goal)[1]]
        states = self._lattice.state_of[cell]
        seconds, after, _ = dijkstra(
            self._back,
            indices=states[states >= 0],
            return_predecessors=True,
            min_only=True,
        )
        return seconds, after

    def _nearest_cells(self, positions: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the cell nearest to each position, -1 if none is within 10 cm."""
        distance, nearest = self._tree.query(positions[:, :3])
        return np.where(distance <= 0.1, nearest, -1)
