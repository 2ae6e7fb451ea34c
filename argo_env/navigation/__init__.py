"""Navigation: the traversable surface, the robot's moves on it, and the fastest paths."""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = ["Blockage", "Motion", "Navigator", "Path"]

if TYPE_CHECKING:
    from argo_env.navigation.closed_areas import Blockage
    from argo_env.navigation.navigator import Navigator
    from argo_env.navigation.path import Motion, Path
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {"closed_areas": ["Blockage"], "navigator": ["Navigator"], "path": ["Motion", "Path"]},
    )
