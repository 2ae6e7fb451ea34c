"""Checks that every site must pass before missions run on it."""

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.stages import stage_items
from argo_env.navigation.navigator import Navigator
from argo_env.planning.patrols import patrol


def unpatrolled_floors(navigator: Navigator) -> list[int]:
    """Return the floors without a patrol that can be reached from the docking stations and back."""
    floors = stage_items("looking for patrols of all floors", navigator.site.spec.floors)
    return [f.number for f in floors if not _has_patrol(navigator, f.number)]


def _has_patrol(navigator: Navigator, floor: int) -> bool:
    try:
        patrol(navigator, floor)
    except ArgoError:
        return False
    return True


def unseen_checkpoints(navigator: Navigator) -> list[int]:
    """Return the ids of checkpoints without a viewing pose that the docking stations lead to.

    A pose counts only if the robot can also return from it.
    """
    checkpoints = stage_items("looking for views of all checkpoints", navigator.site.checkpoints)
    return [c.id for c in checkpoints if not navigator.can_view(c.id)]
