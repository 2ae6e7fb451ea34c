"""How the canonical script says a mission's header."""

import re

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.il import Mission, Mode, Order
from argo_compiler.script.write.steps import StepsSaid
from argo_compiler.script.write.text import duration, point, quote

_TITLE = re.compile(r"Mission Protocol(?: #[1-9][0-9]{0,5})?")
_PLAIN = re.compile(r"[A-Z][a-z]+(?: [a-z]+| #?[0-9]{1,4})*")


def header_lines(mission: Mission, catalog: Catalog, steps: StepsSaid) -> list[str]:
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
    if mission.dock != default_dock(mission, catalog):
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


def default_dock(mission: Mission, catalog: Catalog) -> Pose | None:
    """The dock of a script that names none: that of the end area, else of the start area."""
    for number in (mission.end_area, mission.start_area):
        area = None if number is None else catalog.area(number)
        if area is not None:
            return area.dock
    return None
