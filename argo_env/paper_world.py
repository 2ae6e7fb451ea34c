"""A site on paper: what a mission needs of a world, without physics or pictures."""

from collections.abc import Mapping
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.spec import RobotSpec
from argo_env.sensing.vision.placement import AS_PLANNED, Placement, displaced
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Box, Solid, Vector, crossing
from argo_env.world import Touch


class AnyWorld(Protocol):
    """What carrying out a mission asks of the world, in PyBullet or on paper."""

    @property
    def site(self) -> Site: ...

    @property
    def robot(self) -> RobotSpec: ...

    def move_arm(self, joints: Mapping[str, float]) -> None:
        """Puts the arm's joints to positions in degrees."""
        ...

    def touches(self) -> tuple[Touch, ...]:
        """Where the robot touches what it must not."""
        ...

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """Makes a checkpoint show a value in its unit."""
        ...

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """The name of the first thing on the straight line; None if clear."""
        ...

    def displace(self, checkpoint_id: int, placement: Placement) -> None:
        """Puts a checkpoint elsewhere than planned."""
        ...

    def in_place(self, checkpoint_id: int) -> SiteCheckpoint:
        """The checkpoint where it really is."""
        ...


class PaperWorld:
    """A world in which nothing moves and nothing is touched; lines of sight are those of planning.

    It has no robot in it and no bodies of checkpoints, so these hide nothing.
    """

    def __init__(self, site: Site, robot: RobotSpec) -> None:
        self.site = site
        self.robot = robot
        self._placements: dict[int, Placement] = {}

    def move_arm(self, joints: Mapping[str, float]) -> None:
        """There is no arm to move."""

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """There is no dial that could show it."""

    def displace(self, checkpoint_id: int, placement: Placement) -> None:
        """Puts a checkpoint elsewhere than planned."""
        self._placements[checkpoint_id] = placement

    def in_place(self, checkpoint_id: int) -> SiteCheckpoint:
        """The checkpoint where it really is; KeyError if there is no such checkpoint."""
        planned = self.site.checkpoint(checkpoint_id)
        return displaced(planned, self._placements.get(checkpoint_id, AS_PLANNED))

    def touches(self) -> tuple[Touch, ...]:
        """None, ever."""
        return ()

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """The name of the first element on the straight line; None if clear."""
        a, b = np.array(origin), np.array(target)
        names, solids, centers, radii = self._solids
        # Those whose sphere the line does not even touch need no closer look.
        along = np.clip(((centers - a) @ (b - a)) / max(float((b - a) @ (b - a)), 1e-12), 0.0, 1.0)
        away = np.linalg.norm(centers - a - along[:, None] * (b - a), axis=1)
        first, found = np.inf, None
        for k in np.flatnonzero(away <= radii).tolist():
            entry, leave = crossing(solids[k], a[None, :], b - a)
            if entry[0] <= 1.0 and leave[0] >= 0.0 and entry[0] < first:
                first, found = float(entry[0]), names[k]
        return found

    @cached_property
    def _solids(
        self,
    ) -> tuple[list[str], list[Solid], NDArray[np.float64], NDArray[np.float64]]:
        """All solids of the site: their elements' names, they themselves, their middles (m, shape
        (n, 3)) and the radii of spheres around them (m)."""
        parts = [(e.name, s) for e in self.site.elements for s in e.solids]
        sizes = [
            s.size if isinstance(s, Box) else (2 * s.radius, 2 * s.radius, s.length)
            for _, s in parts
        ]
        return (
            [name for name, _ in parts],
            [solid for _, solid in parts],
            np.array([solid.center for _, solid in parts]),
            np.linalg.norm(np.array(sizes), axis=1) / 2 + 1e-9,
        )
