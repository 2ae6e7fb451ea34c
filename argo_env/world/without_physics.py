"""World without physics or pictures, and the interface that runs need of any world."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from argo_env.robot.spec import RobotSpec
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Vector
from argo_env.world.placement import AS_PLANNED, Placement, displaced_checkpoint
from argo_env.world.world import Touch


class AnyWorld(Protocol):
    """Interface of a world in which a mission is run, in PyBullet or without physics."""

    @property
    def site(self) -> Site: ...

    @property
    def robot(self) -> RobotSpec: ...

    def set_arm_degrees(self, joints: Mapping[str, float]) -> None:
        """Set the arm's joints to positions in degrees."""
        ...

    def touches(self) -> tuple[Touch, ...]:
        """Return the robot's contacts, except of its tracks and flippers with walkable ground."""
        ...

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """Make a checkpoint show a value in its unit."""
        ...

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """Return the name of the first obstacle between two points (m); None if there is none."""
        ...

    def set_displacement(self, checkpoint_id: int, placement: Placement) -> None:
        """Set the displacement of a checkpoint from its planned pose, instead of an earlier one."""
        ...

    def actual_checkpoint(self, checkpoint_id: int) -> SiteCheckpoint:
        """Return the checkpoint with its actual pose; raises NotFound if there is none."""
        ...


class WorldWithoutPhysics:
    """World in which nothing moves and nothing is touched; it holds displaced checkpoints.

    Lines of sight are those of planning. There are no bodies of the robot and of checkpoints, so
    these hide nothing.
    """

    def __init__(self, site: Site, robot: RobotSpec) -> None:
        self.site = site
        self.robot = robot
        self._placements: dict[int, Placement] = {}

    def set_arm_degrees(self, joints: Mapping[str, float]) -> None:
        """Do nothing: this world has no arm."""

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """Do nothing: this world has no instruments."""

    def set_displacement(self, checkpoint_id: int, placement: Placement) -> None:
        """Set the displacement of a checkpoint from its planned pose, instead of an earlier one.

        This does not check that there is such a checkpoint.
        """
        self._placements[checkpoint_id] = placement

    def actual_checkpoint(self, checkpoint_id: int) -> SiteCheckpoint:
        """Return the checkpoint with its actual pose.

        Raises NotFound if there is no such checkpoint.
        """
        planned = self.site.checkpoint(checkpoint_id)
        return displaced_checkpoint(planned, self._placements.get(checkpoint_id, AS_PLANNED))

    def touches(self) -> tuple[Touch, ...]:
        """Return an empty tuple: this world has no bodies."""
        return ()

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """Return the name of the first element between two points (m); None if there is none."""
        line = np.array(target) - np.array(origin)
        length = float(np.linalg.norm(line))
        direction = line / length if length else np.array([0.0, 0.0, 1.0])
        rays = self.site.rays
        _, (solid,) = rays.first_hits(
            np.array(origin), direction[None, :], length, include_solids_around_origin=True
        )
        return None if solid < 0 else rays.elements[solid].name
