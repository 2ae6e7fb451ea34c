"""Writes a mission as a mission protocol, in the canonical form.

What the script language means if nothing is said is left out, and places, areas and patrols stand
as a person would write them; the rest stands in the exact forms. Reading the script gives the
mission again, so that formatting it once more changes nothing.
"""

import re

from argo_compiler.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Afterwards, Mission, Mode, Order, Reaction, Response
from argo_compiler.model import Pose
from argo_compiler.script.write.sayable import require_sayable
from argo_compiler.script.write.steps import Steps, unwritable, write_steps
from argo_compiler.script.write.tasks import Places
from argo_compiler.script.write.text import (
    UnwritableError,
    duration,
    point,
    quote,
    statement,
    wrapped,
)

_TITLE = re.compile(r"Mission Protocol(?: #\d+)?")
_PLAIN = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9#.,:;/()%'-]| (?=[^ ])){0,300}")
_RESPONSES = {
    Response.REPORT: "report",
    Response.PAUSE: "pause",
    Response.RETURN: "return to the docking station",
    Response.ABORT: "abort the mission",
}
SAID = frozenset(["event", "response", "pose", "area", "until", "afterwards", "priority", "source"])
"""the fields of a reaction that a script can say"""


def format_script(mission: Mission, catalog: Catalog) -> str:
    """The mission as a protocol that `import_script` reads back to the same mission.

    The mission is one that `check` finds no error in. Raises DiagnosticError if the script
    language can't say it: the diagnostics name the tasks, and what of them.
    """
    places = Places(catalog)
    steps = write_steps(mission, catalog, places)
    diagnostics = list(steps.diagnostics)
    header: list[str] = []
    reactions: list[str] = []
    try:
        header = _header(mission, catalog, steps)
    except UnwritableError as error:
        diagnostics.append(unwritable("the header", "", None, error))
    for reaction in mission.reactions:
        try:
            reactions += statement(_reaction(reaction, places))
        except UnwritableError as error:
            what = f"the reaction to {reaction.event}"
            diagnostics.append(
                unwritable(what, subject_of("reactions", reaction.event), reaction.source, error)
            )
    if diagnostics:
        raise DiagnosticError("mission", diagnostics)
    parts = [header, steps.lines, steps.rounds, reactions]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def _header(mission: Mission, catalog: Catalog, steps: Steps) -> list[str]:
    """The title, and the fields that differ from what is meant without a line."""
    lines = []
    if _TITLE.fullmatch(mission.designation):
        lines.append(mission.designation)
    else:
        lines += ["Mission Protocol", *_field("Designation", mission.designation)]
    if mission.site != catalog.site:
        lines += wrapped(f"Site: {quote(mission.site)}")
    if mission.mode is not Mode.AUTONOMOUS:
        lines.append(f"Mode: {mission.mode}")
    if mission.max_duration is not None:
        lines.append(f"Maximum duration: {duration(mission.max_duration)}")
    if mission.order is not Order.PRECISE:
        lines.append(f"Order: {mission.order}")
    texts = {
        "Anomaly specification": mission.anomaly_specification,
        "Real-time reporting": mission.real_time_reporting,
        "After-mission report": mission.after_mission_report,
    }
    for label, text in texts.items():
        if text:
            lines += _field(label, text)
    if mission.start_area != steps.start_area:
        lines.append(f"Start area: {_area(mission.start_area)}, as planned")
    elif not steps.starts:
        lines.append("Start area: none")
    if mission.end_area != steps.end_area:
        lines.append(f"End area: {_area(mission.end_area)}, as planned")
    if mission.dock != default_dock(mission, catalog):
        lines.append(f"Dock: {'none' if mission.dock is None else point(mission.dock)}")
    if mission.current is not None:
        lines += wrapped(f"Current: {quote(mission.current)}")
    if mission.left_out:
        names = ",\n".join(map(quote, mission.left_out))
        lines += wrapped(f"Left out: {names}")
    return lines


def _field(label: str, text: str) -> list[str]:
    said = text if _PLAIN.fullmatch(text) else quote(text)
    return wrapped(f"{label}: {said}")


def _area(number: int | None) -> str:
    return "none" if number is None else str(number)


def default_dock(mission: Mission, catalog: Catalog) -> Pose | None:
    """The dock of a protocol that names none: that of the end area, else of the start area."""
    for number in (mission.end_area, mission.start_area):
        area = None if number is None else catalog.area(number)
        if area is not None:
            return area.dock
    return None


def _reaction(reaction: Reaction, places: Places) -> str:
    require_sayable(reaction, SAID)
    pose = reaction.pose
    clauses = [f"On {_event(reaction.event)}:"]
    if reaction.response is not Response.SAFE_AREA:
        clauses[0] += f" {_RESPONSES[reaction.response]}"
        if reaction.area is not None:
            clauses[0] += _in_area(reaction, places)
        elif pose is not None:
            clauses.append(f"at {point(pose)}")
    elif pose is None:
        raise UnwritableError("it has no pose")
    elif reaction.area is not None:
        raise UnwritableError("a safe area has no number: its `area`")
    else:
        clauses[0] += f" go to {places.location(pose)}"
    if reaction.until is not None:
        clauses.append(f"until {_event(reaction.until)}")
    if reaction.afterwards is not Afterwards.END:
        clauses.append(f"afterwards {reaction.afterwards}")
    if reaction.priority is not None:
        clauses.append(f"priority {reaction.priority}")
    return ",\n".join(clauses)


def _in_area(reaction: Reaction, places: Places) -> str:
    """The area in whose docking station a return ends."""
    area = reaction.area
    if reaction.response is not Response.RETURN or area is None or area < 0:
        raise UnwritableError("only a return leads to the docking station of an area: its `area`")
    if places.dock(area) != reaction.pose:
        raise UnwritableError(f"its pose is not that of the docking station in area {area}: `area`")
    return f" in starting area {area}"


def _event(event: str) -> str:
    return event.replace("_", " ")
