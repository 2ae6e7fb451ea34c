"""What the header of a protocol says about where the mission starts and ends."""

from dataclasses import dataclass

from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.base.listing import listed
from argo_compiler.diagnostics import Span
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.places import Coordinates
from argo_compiler.script.syntax.tree.script import AreaChosen, Areas, ScriptHeader

_REMEDIES = {"start": Remedy.CHOOSE_START, "end": Remedy.CHOOSE_END}


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
    header: ScriptHeader, diagnostics: Diagnostics, start_area: int | None, end_area: int | None
) -> HeaderValues:
    """The choices; the options must be among what it offers."""
    if header.areas_open is not None:
        if start_area is None:
            _left_open("start", header.areas_open.span, diagnostics)
        if end_area is None:
            _left_open("end", header.areas_open.span, diagnostics)
    return HeaderValues(
        start=_choice("start", header.start_area, header.initial_position, start_area, diagnostics),
        end=_choice("end", header.end_area, header.end_of_mission, end_area, diagnostics),
        dock_said=header.dock_said,
        dock=header.dock,
    )


def _left_open(which: str, span: Span, diagnostics: Diagnostics) -> None:
    message = f"the script leaves the {which} to the preparation"
    hint = "choose a starting area for it"
    diagnostics.error("area-choice", message, span, hint, (_REMEDIES[which],))


def _choice(
    which: str,
    header: AreaChosen | None,
    cell: Areas | None,
    option: int | None,
    diagnostics: Diagnostics,
) -> AreaChoice:
    """The area of the mission's start or end: that of the option or of the header line, else the
    only one that the cell offers."""
    remedies = (_REMEDIES[which],)
    if header is not None:
        if option is not None and option != header.area:
            message = f"--{which}-area {option} contradicts the script"
            hint = f"leave --{which}-area out, or take this line out of the script"
            diagnostics.error("area-conflict", message, header.span, hint)
        return AreaChoice(header.area, header.span, header.as_planned, said=True)
    if cell is None:
        return AreaChoice(option, said=option is not None)
    offered, span = sorted(set(cell.areas)), cell.span
    numbers = tuple(map(str, offered))
    choice = RemedyChoice(_REMEDIES[which], "area", numbers)
    if option is not None and offered and option not in offered:
        message = f"the {which} in area {option} is not what the script offers"
        diagnostics.error("area-not-offered", message, span, str(choice), remedies, choice)
    elif option is None and len(offered) > 1:
        areas = listed(numbers, "or")
        message = f"the script leaves the {which} to the preparation: starting area {areas}"
        diagnostics.error("area-choice", message, span, str(choice), remedies, choice)
    elif option is None and not offered:
        message = f"this names no starting area for the mission's {which}"
        diagnostics.error("no-area", message, span, "write, say, `starting area 1`", remedies)
    chosen = option if option in offered or not offered else None
    area = chosen if chosen is not None else next(iter(offered), None)
    return AreaChoice(area, span, said=True)
