"""Missions that are put in their best order before they are compiled or run."""

from dataclasses import replace

from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import Conflict
from argo_env.formatting import clock
from argo_env.planning.opening import OpenedSite
from argo_env.run.record import Reordering
from argo_planner.terminal.words import said_elsewhere
from argo_planner.use_cases.importing import ImportedMission
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.routing import suggest_order


def optimise_shown(
    imported: ImportedMission, site: OpenedSite
) -> tuple[ImportedMission, Reordering]:
    """The mission in its best order, and what is said of it. Shows how much time that saves.

    Raises ArgoError if its order can't be changed, or there is none that meets all that it asks
    for.
    """
    found = suggest_order(imported, site)
    try:
        require_order(found, imported.source_name)
    except Conflict as error:
        raise Conflict(said_elsewhere(error, imported.source_name)) from None
    done = found.reordering
    order = ", ".join(done.order)
    text = (
        f"Order: {order}\nPredicted: {clock(done.duration)}, as written "
        f"{clock(done.written_duration)}{'; no order is better' if done.proven else ''}"
    )
    Console(highlight=False).print(escape(text), soft_wrap=True)
    return replace(imported, mission=found.mission), done
