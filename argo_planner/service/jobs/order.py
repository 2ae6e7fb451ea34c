"""The search for a mission's best order."""

from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.route.stop import SearchProgress
from argo_env.planning.opening import open_site
from argo_env.run.record import Reordering
from argo_planner.service.processes.work import Tell
from argo_planner.use_cases.importing import ImportedMission
from argo_planner.use_cases.no_order import why_none
from argo_planner.use_cases.routing import suggest_order, too_long


class OrderProgress(Model):
    """How far a search is."""

    time: float
    """s since the search began"""
    best: float | None
    """s that the best order so far takes; None: there is none yet"""
    bound: float
    """s that no order of the same tasks takes less than"""


class OrderFound(Model):
    """What came of a search."""

    reordering: Reordering | None = None
    """the order, how long it takes and whether it is proven; None: there is none, see `why_none`"""
    left_out: tuple[str, ...] = ()
    """tasks that are left out"""
    reasons: tuple[str, ...] = ()
    """how the order was found, and why something is left out"""
    why_none: str | None = None
    warning: str | None = None
    """what is not met all the same once the mission is driven in this order"""
    mission: Mission | None = None
    """in the new order"""


def search_order(
    site: str, mission: Mission, requirements: Requirements, time_limit: float, tell: Tell
) -> OrderFound:
    """Searches for the best order for at most the time (s); tells its progress.

    Raises ArgoError as `suggest_order` does.
    """
    opened = open_site(site)

    def heard(progress: SearchProgress, unit: float) -> None:
        best = None if progress.cost is None else progress.cost * unit
        tell(OrderProgress(time=progress.time, best=best, bound=progress.bound * unit))

    imported = ImportedMission(mission, "the mission", (), ())
    found = suggest_order(imported, opened, requirements, time_limit=time_limit, heard=heard)
    if why := why_none(found):
        return OrderFound(why_none=str(why), reasons=found.suggestion.reasons)
    ordered = found.mission
    dropped = found.planned.visits
    left_out = tuple(
        dropped.chain.name(dropped.task_units[visit].entry) for visit in found.suggestion.dropped
    )
    return OrderFound(
        reordering=found.reordering,
        left_out=left_out,
        reasons=(*found.planned.reasons, *found.suggestion.reasons),
        warning=too_long(ordered, opened),
        mission=ordered,
    )
