"""A site on paper: what a mission needs of a world, without physics or pictures."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from argo_env.robot.spec import RobotSpec
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Vector
from argo_env.world.placement import AS_PLANNED, Placement, displaced
from argo_env.world.world import Touch


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
        """The checkpoint where it really is; NotFound if there is no such checkpoint."""
        planned = self.site.checkpoint(checkpoint_id)
        return displaced(planned, self._placements.get(checkpoint_id, AS_PLANNED))

    def touches(self) -> tuple[Touch, ...]:
        """None, ever."""
        return ()

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """The name of the first element on the straight line; None if clear."""
        way = np.array(target) - np.array(origin)
        length = float(np.linalg.norm(way))
        direction = way / length if length else np.array([0.0, 0.0, 1.0])
        rays = self.site.rays
        _, (solid,) = rays.first(np.array(origin), direction[None, :], length, inside=True)
        return None if solid < 0 else rays.elements[solid].name
