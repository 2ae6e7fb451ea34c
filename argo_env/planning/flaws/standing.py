"""Where on a site the robot can stand, and to which of it the docking stations lead."""

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

_LEVEL = 0.02  # m between a place on a deck and the deck's height


@dataclass(frozen=True)
class Standing:
    """All states in which the robot stands safely, whether reached or not, and for each the part
    of them that can be reached from it and back."""

    site: Site
    lattice: Lattice
    part: NDArray[np.int32]
    docks: dict[int, int | None]
    """the state in each docking station; None where the robot can't stand"""

    @staticmethod
    def of(navigator: Navigator) -> "Standing":
        lattice = build_lattice(navigator.surface, navigator.robot)
        docks = {
            n: nearest_state(lattice, pose) for n, pose in sorted(navigator.site.docks.items())
        }
        return Standing(navigator.site, lattice, label_strong_components(lattice.costs), docks)

    @property
    def first_dock(self) -> int | None:
        """The first docking station in which the robot can stand."""
        return next((number for number, state in self.docks.items() if state is not None), None)

    @cached_property
    def reached(self) -> NDArray[np.bool_]:
        """Of each state, whether the first docking station leads there and back."""
        if self.first_dock is None:
            return np.zeros(self.lattice.size, dtype=bool)
        return np.asarray(self.part == self.part[self.docks[self.first_dock]])

    @cached_property
    def places(self) -> NDArray[np.float64]:
        """x, y and z (m) of the states, shape (n, 3)."""
        return self.lattice.poses()[:, :3]

    def on(self, floor: FloorSpec) -> NDArray[np.bool_]:
        """Of each state, whether it is on a floor's deck."""
        x, y, z = self.places.T
        inside = np.zeros(len(z), dtype=bool)
        for x0, y0, x1, y1 in floor.walkways.values():
            inside |= (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1)
        return np.asarray(inside & (np.abs(z - floor.z) <= _LEVEL))

    def nearest_reached(self, x: float, y: float, z: float) -> NDArray[np.float64] | None:
        """The reached place nearest to a point, and as high as it within a step."""
        level = self.reached & (np.abs(self.places[:, 2] - z) <= self.lattice.robot.max_step)
        found = self.places[level]
        if not len(found):
            return None
        nearest: NDArray[np.float64] = found[np.argmin(np.hypot(found[:, 0] - x, found[:, 1] - y))]
        return nearest
