"""The way to a goal from wherever the robot is: seconds to go, and where to next."""

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
AHEAD = 0.8  # m, how far ahead the waypoint is at most
_KEPT = 64  # ways; one takes 12 bytes for each state of the lattice


@dataclass(frozen=True)
class Waypoint:
    """Where to go next."""

    x: float
    y: float
    z: float
    yaw: float
    """rad, the heading that the robot should have there"""
    seconds: float
    """to the goal from where the robot is, at the planning speeds"""


class Guide:
    """Knows the ways of one site. Holds its goals, and the ways to those that were asked for."""

    def __init__(self, navigator: Navigator) -> None:
        """Raises ArgoError if there is no place on the site to start from."""
        lattice = navigator.lattice
        self._lattice = lattice
        self._turn_rate = navigator.robot.turn_rate_radians
        self._speed = navigator.robot.speed
        self._back = lattice.costs.T.tocsr()
        self._cells = np.unique(lattice.cell)
        self._poses = lattice.poses()
        positions = lattice.surface.positions()[self._cells]
        self._tree = cKDTree(positions)
        self._headings = 2 * math.pi * np.arange(lattice.state_of.shape[1])
        self._headings /= lattice.state_of.shape[1]
        found = {f.number: navigator.turning_poses(f.number) for f in navigator.site.spec.floors}
        self._places = {
            number: part[self._near(part) >= 0] for number, part in found.items() if len(part)
        }
        if not self._places:
            name = navigator.site.name
            raise Unreachable(
                f"site {name} has no place where the robot has room to turn all round"
            )
        self._to = lru_cache(maxsize=_KEPT)(self._search)

    @property
    def floors(self) -> tuple[int, ...]:
        """The floors where the robot can start and arrive."""
        return tuple(self._places)

    def goals(self, floors: tuple[int, ...]) -> NDArray[np.float64]:
        """Places (x, y, z) that may be goals on these floors, always the same ones; (n, 3)."""
        parts = []
        for floor in floors:
            places = self._places[floor]
            chosen = generator(0, "goals", floor).permutation(len(places))[:GOALS]
            parts.append(places[np.sort(chosen), :3])
        return np.concatenate(parts)

    def starts(
        self, goal: tuple[float, float, float], floors: tuple[int, ...], nearest: float, most: float
    ) -> NDArray[np.float64]:
        """Places (x, y, z) on these floors with between `nearest` and `most` s to the goal, if
        there are any; else those with the least above that. Shape (n, 3)."""
        places = np.concatenate([self._places[floor] for floor in floors])[:, :3]
        seconds, _ = self._to(goal)
        cells = self._cells[self._tree.query(places)[1]]
        states = self._lattice.state_of[cells]
        togo = np.where(states >= 0, seconds[states], np.inf).min(axis=1)
        fit = (togo >= nearest) & (togo <= most)
        if not fit.any():
            above = np.where(togo >= nearest, togo, np.inf)
            fit = above == above.min()
        return np.asarray(places[fit])

    def look(self, goal: tuple[float, float, float], pose: BodyPose) -> Waypoint:
        """Where to go next from a pose. Where no state of the lattice is near, as beside the
        walkway, the nearest one counts."""
        lattice = self._lattice
        seconds, following = self._to(goal)
        away, nearest = self._tree.query((pose.x, pose.y, pose.z))
        states = lattice.state_of[self._cells[nearest]]
        turns = np.abs((pose.yaw - self._headings + math.pi) % (2 * math.pi) - math.pi)
        costs = np.where(states >= 0, seconds[states], np.inf) + turns / self._turn_rate
        best = int(np.argmin(costs))
        togo = float(costs[best]) + float(away) / self._speed
        x, y, z, yaw = self._ahead(int(states[best]), following, pose)
        return Waypoint(x, y, z, yaw, togo)

    def _ahead(
        self, state: int, following: NDArray[np.int32], pose: BodyPose
    ) -> tuple[float, float, float, float]:
        """The place on the way where it turns next, at most AHEAD from the robot."""
        poses, cell, heading = self._poses, self._lattice.cell, self._lattice.heading
        # Turns on the spot come first: then the way goes on as the last of them leaves it.
        while (then := following.item(state)) >= 0 and cell[then] == cell[state]:
            state = then
        straight = heading[state]
        while (then := following.item(state)) >= 0 and heading[then] == straight:
            state = then
            if math.hypot(poses.item(state, 0) - pose.x, poses.item(state, 1) - pose.y) >= AHEAD:
                break
        x, y, z, yaw = poses[state].tolist()
        return x, y, z, wrap(yaw)

    def _search(
        self, goal: tuple[float, float, float]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Seconds to the goal from every state, and the state after each on the way there."""
        cell = self._cells[self._tree.query(goal)[1]]
        states = self._lattice.state_of[cell]
        seconds, after, _ = dijkstra(
            self._back,
            indices=states[states >= 0],
            return_predecessors=True,
            min_only=True,
        )
        return seconds, after

    def _near(self, places: NDArray[np.float64]) -> NDArray[np.int64]:
        """The nearest cell of each place, -1 where there is none within 10 cm."""
        away, nearest = self._tree.query(places[:, :3])
        return np.where(away <= 0.1, nearest, -1)
