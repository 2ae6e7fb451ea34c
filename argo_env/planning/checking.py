"""Checks that every site must pass before missions run on it."""

from argo_compiler.base.stages import stage_items
from argo_env.navigation.navigator import Navigator
from argo_env.planning.patrols import find_patrol


def unpatrolled_floors(navigator: Navigator) -> list[int]:
    """Return the numbers of the floors on which the robot can't reach enough poses for a patrol.

    A pose can be reached if the robot gets there from all docking stations and back.
    """
    floors = stage_items("looking for patrols of all floors", navigator.site.spec.floors)
    return [f.number for f in floors if not find_patrol(navigator, f.number)]


def unseen_checkpoints(navigator: Navigator) -> list[int]:
    """Return the ids of the checkpoints that can't be read from any pose that can be reached.

    A pose can be reached if the robot gets there from all docking stations and back.
    """
    checkpoints = stage_items("looking for views of all checkpoints", navigator.site.checkpoints)
    return [c.id for c in checkpoints if not navigator.can_view(c.id)]
