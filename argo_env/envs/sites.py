"""Sites that are ready to drive on, kept from episode to episode."""

from functools import lru_cache

from argo_compiler.model import Pose
from argo_env.navigation import Navigator, Path
from argo_env.robot.spec import RobotSpec, load_robot
from argo_env.site import Site, load_site

_KEPT = 8  # a navigator holds some 100 MB
_PATHS = 1024  # of a site; episodes go the same ways again and again


class RememberingNavigator(Navigator):
    """Plans each path once. What `avoiding` gives is a plain navigator."""

    def __init__(self, site: Site, robot: RobotSpec) -> None:
        super().__init__(site, robot)
        self._path = lru_cache(maxsize=_PATHS)(super().plan)
        self._path_to_view = lru_cache(maxsize=_PATHS)(super().plan_to_view)

    def plan(self, start: Pose, goal: Pose) -> Path:
        """See Navigator."""
        return self._path(start, goal)

    def plan_to_view(self, start: Pose, checkpoint_id: int, turned: float = 0.0) -> Path:
        """See Navigator."""
        return self._path_to_view(start, checkpoint_id, turned)


@lru_cache(maxsize=_KEPT)
def navigator_of(scenario: str) -> Navigator:
    """The navigator of the site of that name, or of the one that a file describes.

    Raises ArgoError if there is no such site or the robot can't drive there.
    """
    navigator = RememberingNavigator(load_site(scenario), load_robot())
    navigator.prepare()
    return navigator
