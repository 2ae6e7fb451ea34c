"""What the header of a protocol says about where the mission starts and ends."""

from dataclasses import dataclass

from argo_compiler.diagnostics import Span
from argo_compiler.listing import listed
from argo_compiler.script.syntax.nodes import AreaField, AreaHeader, Protocol
from argo_compiler.script.syntax.source import Diagnostics
from argo_compiler.script.syntax.terms import Coordinates


@dataclass(frozen=True)
class AreaChoice:
    """A starting area that is chosen for the mission's start or end."""

    area: int | None
    span: Span | None = None
    as_planned: bool = False
    """the steps stay as they are"""
    said: bool = False
    """that it is this one, or none, was said at all"""


@dataclass(frozen=True)
class HeaderValues:
    """The areas of start and end, and the dock if the header gives it."""

    start: AreaChoice
    end: AreaChoice
    dock_said: bool
    dock: Coordinates | None


def header_values(
    protocol: Protocol, diagnostics: Diagnostics, start_area: int | None, end_area: int | None
) -> HeaderValues:
    """The header's choices; the options must be among what it offers."""
    dock = protocol.dock
    return HeaderValues(
        start=_choice(
            "start", protocol.start_area, protocol.initial_position, start_area, diagnostics
        ),
        end=_choice("end", protocol.end_area, protocol.end_of_mission, end_area, diagnostics),
        dock_said=dock is not None,
        dock=dock.dock if dock else None,
    )


def _choice(
    which: str,
    header: AreaHeader | None,
    cell: AreaField | None,
    option: int | None,
    diagnostics: Diagnostics,
) -> AreaChoice:
    flag = f"--{which}-area"
    if header is not None:
        if option is not None and option != header.area:
            message = f"{flag} {option} contradicts the script"
            hint = f"leave {flag} out, or take this line out of the script"
            diagnostics.error("area-conflict", message, header.span, hint)
        return AreaChoice(header.area, header.span, header.as_planned, said=True)
    offered = sorted({area.value for area in cell.areas}) if cell else []
    if not offered:
        return AreaChoice(option, said=option is not None)
    assert cell is not None
    span = cell.areas[0].span
    choices = listed((f"{flag} {number}" for number in offered), "or")
    if option is not None and option not in offered:
        message = f"{flag} {option} is not what the script offers"
        diagnostics.error("area-not-offered", message, span, f"give {choices}")
    elif option is None and len(offered) > 1:
        areas = listed(offered, "or")
        message = f"the script leaves the {which} to the preparation: starting area {areas}"
        diagnostics.error("area-choice", message, span, f"choose with {choices}")
    return AreaChoice(option if option is not None else offered[0], span, said=True)
