"""Writes a mission as a script, in the canonical form.

What the script language means if nothing is said is left out, and places, areas and patrols stand
as a person would write them; the rest stands in the exact forms. Reading the script gives the
mission again, so that formatting it once more changes nothing.
"""

import re

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Mission, Mode, Order
from argo_compiler.script.write.conditions import reaction_said
from argo_compiler.script.write.steps import Said, StepsSaid, unwritable, write_steps
from argo_compiler.script.write.text import (
    Places,
    UnwritableError,
    capital,
    duration,
    paragraph,
    point,
    quote,
    wrapped,
)

_TITLE = re.compile(r"Mission Protocol(?: #[1-9][0-9]{0,5})?")
_PLAIN = re.compile(r"[A-Z][a-z]+(?: [a-z]+| #?[0-9]{1,4})*")


def format_script(mission: Mission, catalog: Catalog) -> str:
    """The mission as a script that `import_script` reads back to the same mission.

    The mission is one that `check` finds no error in. Raises DiagnosticError if the script
    language can't say it: the diagnostics name the tasks, and what of them.
    """
    header, steps, reactions = parts_said(mission, catalog)
    lines = [line for field in header for line in wrapped(field)]
    parts = [lines, lines_of(steps), lines_of(reactions)]
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def lines_of(said: list[Said]) -> list[str]:
    """The lines of steps or of other sentences."""
    lines: list[str] = []
    for one in said:
        opening = "" if one.number is None else f"{one.number}. "
        lines += paragraph(opening, one.sentences)
    return lines


def parts_said(mission: Mission, catalog: Catalog) -> tuple[list[str], list[Said], list[Said]]:
    """What is said in the header, of the steps and of the reactions; raises as `format_script`."""
    places = Places(catalog)
    steps = write_steps(mission, catalog, places)
    diagnostics = list(steps.diagnostics)
    reactions: list[Said] = []
    for reaction in mission.reactions:
        subject = subject_of("reactions", reaction.event)
        try:
            sentence = capital(reaction_said(reaction, places))
        except UnwritableError as error:
            what = f"the reaction to {reaction.event}"
            diagnostics.append(unwritable(what, subject, reaction.source, error))
        else:
            reactions.append(Said(subject, (sentence,), source=reaction.source))
    if diagnostics:
        raise DiagnosticError("mission", diagnostics)
    return _header_lines(mission, catalog, steps), steps.said, [*steps.orders, *reactions]


# ---- the header


def _header_lines(mission: Mission, catalog: Catalog, steps: StepsSaid) -> list[str]:
    """The title, and the fields that differ from what is meant without a line; in each line, breaks
    where it may be broken."""
    lines = []
    if _TITLE.fullmatch(mission.designation):
        lines.append(mission.designation)
    else:
        lines += ["Mission Protocol", _field("Designation", mission.designation)]
    if mission.site != catalog.site:
        lines.append(f"Site: {quote(mission.site)}")
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
    lines += [_field(label, text) for label, text in texts.items() if text]
    if mission.start_area != steps.start_area:
        lines.append(f"Start area: {_area(mission.start_area)}, as planned")
    elif not steps.starts:
        lines.append("Start area: none")
    if mission.end_area != steps.end_area:
        lines.append(f"End area: {_area(mission.end_area)}, as planned")
    if mission.dock != _default_dock(mission, catalog):
        lines.append(f"Dock: {'none' if mission.dock is None else point(mission.dock)}")
    if mission.current is not None:
        lines.append(f"Current: {quote(mission.current)}")
    if mission.left_out:
        names = ",\n".join(map(quote, mission.left_out))
        lines.append(f"Left out: {names}")
    return lines


def _field(label: str, text: str) -> str:
    return f"{label}: {text if _PLAIN.fullmatch(text) and len(text) < 80 else quote(text)}"


def _area(number: int | None) -> str:
    return "none" if number is None else str(number)


def _default_dock(mission: Mission, catalog: Catalog) -> Pose | None:
    """The dock of a script that names none: that of the end area, else of the start area."""
    for number in (mission.end_area, mission.start_area):
        area = None if number is None else catalog.area(number)
        if area is not None:
            return area.dock
    return None
