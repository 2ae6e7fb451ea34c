"""Option `--optimise`: the best order before a mission is compiled or run."""

from dataclasses import replace

from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import Conflict
from argo_env.formatting import min_sec_text
from argo_env.planning.opening import OpenedSite
from argo_env.run.record import Reordering
from argo_planner.terminal.words import error_text_with_route_commands
from argo_planner.use_cases.importing import ImportedMission
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.routing import suggest_order


def optimise_and_show(
    imported: ImportedMission, site: OpenedSite
) -> tuple[ImportedMission, Reordering]:
    """Return the mission in its best order, and a description of the change; print both durations.

    Raises:
        ArgoError: The order can't be changed, or no order meets all requirements of the mission.
    """
    found = suggest_order(imported, site)
    try:
        require_order(found, imported.source_name)
    except Conflict as error:
        raise Conflict(error_text_with_route_commands(error, imported.source_name)) from None
    reordering = found.reordering
    order = ", ".join(reordering.order)
    text = (
        f"Order: {order}\nPredicted: {min_sec_text(reordering.duration)}, as written "
        f"{min_sec_text(reordering.written_duration)}"
        f"{'; no order is better' if reordering.proven else ''}"
    )
    Console(highlight=False).print(escape(text), soft_wrap=True)
    return replace(imported, mission=found.mission), reordering
