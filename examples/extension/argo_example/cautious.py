"""Drive that moves as the kinematic one, but at 60 % of its speed."""

from argo_env.drives.kinematic import KinematicDrive
from argo_env.navigation import Path
from argo_env.robot.spec import RobotSpec
from argo_env.world.world import World

SHARE = 0.6
"""share of the planned speed"""


class CautiousDrive(KinematicDrive):
    """Drive for sites with people: it exceeds 60 % of the planned speed nowhere on the flat."""

    name = "cautious"

    def __init__(self, world: World, robot: RobotSpec) -> None:
        super().__init__(world, robot)
        self._own_speed = robot.speed

    def follow(self, path: Path, velocity: float | None) -> None:
        """Start to follow `path` at 60 % of `velocity` (m/s), or of the robot's own speed."""
        planned = self._own_speed if velocity is None else velocity
        super().follow(path, SHARE * planned)


def make_drive(world: World, robot: RobotSpec, friction: float) -> CautiousDrive:  # noqa: ARG001
    """Return the drive for a run; `friction` is a factor of the usual one."""
    return CautiousDrive(world, robot)
