"""Whether a site can be driven: what must hold of every site before missions run on it."""

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.stages import stage_items
from argo_env.navigation.navigator import Navigator
from argo_env.planning.patrols import patrol


def unserved_floors(navigator: Navigator) -> list[int]:
    """The floors that can't be patrolled on ways that the docking stations lead to and back."""
    floors = stage_items("looking for patrols of all floors", navigator.site.spec.floors)
    return [f.number for f in floors if not _patrolled(navigator, f.number)]


def _patrolled(navigator: Navigator, floor: int) -> bool:
    try:
        patrol(navigator, floor)
    except ArgoError:
        return False
    return True


def unseen_checkpoints(navigator: Navigator) -> list[int]:
    """The checkpoints that can be read from nowhere that the docking stations lead to and back."""
    checkpoints = stage_items("looking for views of all checkpoints", navigator.site.checkpoints)
    return [c.id for c in checkpoints if not navigator.can_view(c.id)]
