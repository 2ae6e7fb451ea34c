"""Navigation: the walkable surface, the robot's moves on it, and the fastest paths."""

from argo_env.navigation.blockage import Blockage
from argo_env.navigation.navigator import Navigator
from argo_env.navigation.path import Motion, Path

__all__ = ["Blockage", "Motion", "Navigator", "Path"]
