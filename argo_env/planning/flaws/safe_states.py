"""States in which the robot can stand on a site, and those that it reaches from the docks."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation import Navigator
from argo_env.navigation.graphs import label_strong_components
from argo_env.navigation.lattice import Lattice, build_lattice
from argo_env.navigation.navigator import nearest_state
from argo_env.site import Site
from argo_env.site.spec import FloorSpec

_LEVEL = 0.02  # m, largest distance of a state on a deck from the deck's height


@dataclass(frozen=True)
class SafeStates:
    """All states of a site's lattice in which the robot stands safely, reachable or not."""

    site: Site
    lattice: Lattice
    part: NDArray[np.int32]
    """number of the strongly connected component of each state: states that reach each other"""
    docks: dict[int, int | None]
    """state at each docking station; None: the robot can't stand there"""

    @staticmethod
    def from_navigator(navigator: Navigator) -> "SafeStates":
        """Compute the states on the navigator's site; its own lattice has only reachable ones."""
        lattice = build_lattice(navigator.surface, navigator.robot)
        docks = {
            n: nearest_state(lattice, pose) for n, pose in sorted(navigator.site.docks.items())
        }
        return SafeStates(navigator.site, lattice, label_strong_components(lattice.costs), docks)

    @property
    def lowest_usable_dock_number(self) -> int | None:
        """Lowest number of a station at which the robot can stand; None if there is none."""
        return next((number for number, state in self.docks.items() if state is not None), None)

    @cached_property
    def reached(self) -> NDArray[np.bool_]:
        """Mask of the states reached from the first usable dock and back; all False without one."""
        if self.lowest_usable_dock_number is None:
            return np.zeros(self.lattice.size, dtype=bool)
        return np.asarray(self.part == self.part[self.docks[self.lowest_usable_dock_number]])

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Positions x, y and z (m) of the states, shape (n, 3)."""
        return self.lattice.state_poses()[:, :3]

    def is_on_floor(self, floor: FloorSpec) -> NDArray[np.bool_]:
        """Return a mask of the states on the deck of a floor, reached or not."""
        x, y, z = self.positions.T
        inside = np.zeros(len(z), dtype=bool)
        for x0, y0, x1, y1 in floor.walkways.values():
            inside |= (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)
        return np.asarray(inside & (np.abs(z - floor.z) <= _LEVEL))

    def nearest_reached(self, x: float, y: float, z: float) -> NDArray[np.float64] | None:
        """Return the position (x, y, z in m) of the reached state nearest to a point.

        Nearness is horizontal, among the states at most one step's height above or below the point.
        Returns None if there are none.
        """
        level = self.reached & (np.abs(self.positions[:, 2] - z) <= self.lattice.robot.max_step)
        positions = self.positions[level]
        if not len(positions):
            return None
        distances = np.hypot(positions[:, 0] - x, positions[:, 1] - y)
        nearest: NDArray[np.float64] = positions[np.argmin(distances)]
        return nearest
