"""Checks of a mission's header against its tasks and the site."""

from collections.abc import Iterator

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.base.message import Listing, Message
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.il import Mission

_SHOWN = 12  # omitted tasks that a message names


def check_header(mission: Mission, catalog: Catalog | None) -> Iterator[Diagnostic]:
    """Yield the diagnostics of a mission's site, areas, current task and omitted tasks."""
    if mission.current is not None and mission.task(mission.current) is None:
        yield diagnostic_of(
            "il.unknown-current",
            Message(
                "the current task '{current}' is not a task of the mission", current=mission.current
            ),
            "name a task or leave it out: only the planner uses it",
            "current",
        )
    if omitted := mission.omitted_task_names:
        more = len(omitted) - _SHOWN
        yield diagnostic_of(
            "il.left-out",
            Message("left out when the order was chosen: {names}", names=Listing(omitted[:_SHOWN]))
            + (Message(" and {more} more", more=more) if more > 0 else ""),
            "they are not done: allow more time and choose the order again, or plan them in "
            "another mission",
            "left_out",
        )
    if catalog is None:
        return
    if mission.site and mission.site != catalog.site:
        choice = RemedyChoice(Remedy.CHOOSE_SITE, Message("the site"), (mission.site,))
        yield diagnostic_of(
            "il.other-site",
            Message(
                "the mission was planned for site `{site}`, not for `{site_2}`",
                site=mission.site,
                site_2=catalog.site,
            ),
            str(choice),
            "site",
            choice=choice,
        )
        return
    for field, area in (("start_area", mission.start_area), ("end_area", mission.end_area)):
        if area is not None and catalog.area(area) is None:
            known = tuple(a.number for a in catalog.areas) or Message("none")
            yield diagnostic_of(
                "il.unknown-area",
                Message("site {site} has no starting area {area}", site=catalog.site, area=area),
                Message("there are: {known}", known=known),
                field,
            )
