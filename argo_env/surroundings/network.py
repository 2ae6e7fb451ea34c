"""The wireless network: where there is a signal."""

from dataclasses import dataclass

from argo_env.robot.pose import BodyPose
from argo_env.site import Site
from argo_env.site.spec import Rect


@dataclass(frozen=True)
class Shadow:
    """A part of the site without a signal; what is None does not limit it."""

    rect: Rect | None = None
    floor: int | None = None

    def holds(self, pose: BodyPose, site: Site) -> bool:
        """Whether a robot at `pose` is in it."""
        if self.floor is not None and site.floor_at(pose.z) != self.floor:
            return False
        if self.rect is None:
            return True
        x0, y0, x1, y1 = self.rect
        return x0 <= pose.x <= x1 and y0 <= pose.y <= y1


class RadioNetwork:
    """The network of a site. Holds the shadows that are there now."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self.shadows: list[Shadow] = []

    def connected(self, pose: BodyPose) -> bool:
        """Whether a robot at `pose` has a connection."""
        return not any(shadow.holds(pose, self._site) for shadow in self.shadows)
