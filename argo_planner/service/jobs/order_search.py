"""Search for a mission's best order (see `use_cases.routing`), as the work of a job."""

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_field
from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.route.stop import SearchProgress
from argo_env.planning.opening import open_site
from argo_env.run.record import Reordering
from argo_planner.service.processes.job_process import ReportProgress
from argo_planner.use_cases.importing import ImportedMission
from argo_planner.use_cases.no_order import missing_order_error
from argo_planner.use_cases.routing import duration_problem, suggest_order


class OrderProgress(Model):
    """Progress of a search."""

    time: float
    """s since the start of the search"""
    best: float | None
    """duration of the best order so far in s; None: there is none yet"""
    bound: float
    """lower bound on the duration of any order of the same tasks, in s"""


class OrderFound(Model):
    """Result of a search."""

    reordering: Reordering | None = None
    """the order, its duration and whether it is proven; None: there is none, see `why_none`"""
    left_out: tuple[str, ...] = ()
    """names of tasks that are left out"""
    reasons: tuple[Text, ...] = ()
    """how the order was found, and why tasks are left out"""
    reasons_wording: tuple[Wording | None, ...] = wording_field("reasons")
    why_none: Text | None = None
    """why there is no order; None: there is one"""
    why_none_wording: Wording | None = wording_field("why_none")
    warning: Text | None = None
    """message that this order exceeds the mission's time limit, by its exact travel times; None: it
    does not, or the mission has no limit"""
    warning_wording: Wording | None = wording_field("warning")
    mission: Mission | None = None
    """the mission in the new order; None: there is no order"""


def search_order(
    site: str,
    mission: Mission,
    requirements: Requirements,
    time_limit: float,
    solvers: tuple[str, ...],
    report: ReportProgress,
) -> OrderFound:
    """Search for the best order of a mission for at most `time_limit` s, and report the progress.

    `site` is a reference that `open_site` takes, and `solvers` are names of solvers of installed
    packages. Raises the errors of both `open_site` and `suggest_order`.
    """
    opened = open_site(site)

    def on_progress(progress: SearchProgress, unit: float) -> None:
        best = None if progress.cost is None else progress.cost * unit
        report(OrderProgress(time=progress.time, best=best, bound=progress.bound * unit))

    imported = ImportedMission(mission, Message("the mission"), (), ())
    found = suggest_order(
        imported,
        opened,
        requirements,
        time_limit=time_limit,
        solvers=solvers,
        on_progress=on_progress,
    )
    if why := missing_order_error(found):
        return OrderFound(why_none=str(why), reasons=found.suggestion.reasons)
    reordered = found.mission
    visits = found.planned.visits
    left_out = tuple(
        visits.chain.name(visits.task_units[visit].entry)
        for visit in found.suggestion.dropped or ()
    )
    return OrderFound(
        reordering=found.reordering,
        left_out=left_out,
        reasons=(*found.planned.reasons, *found.suggestion.reasons),
        warning=duration_problem(reordered, opened),
        mission=reordered,
    )
