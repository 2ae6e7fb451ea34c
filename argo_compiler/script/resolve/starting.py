"""Start and end of a mission, from its header and its orders."""

import math
from typing import NoReturn

from argo_compiler.base.catalog import Area
from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.base.listing import listed
from argo_compiler.base.model import Pose
from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Do, HomeAhead, dock
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.places import DockLocation
from argo_compiler.script.sentences.tree.script import AreaChosen, Areas, ScriptHeader

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
    dock: bool = False
    """the docking station is meant, but not in which area"""


def area_choices(
    header: ScriptHeader, diagnostics: Diagnostics, start_area: int | None, end_area: int | None
) -> tuple[AreaChoice, AreaChoice]:
    """Return the choices for the start and the end; the options must be among what the header
    offers."""
    for which, option in (("start", start_area), ("end", end_area)):
        if header.areas_open is not None and option is None:
            message = f"the script leaves the {which} open"
            hint, span = "choose a starting area", header.areas_open.span
            diagnostics.error("area-choice", message, span, hint, _REMEDIES[which])
    start = _choice("start", header.start_area, header.initial_position, start_area, diagnostics)
    end = _choice("end", header.end_area, header.end_of_mission, end_area, diagnostics)
    return start, end


def _choice(
    which: str,
    header: AreaChosen | None,
    cell: Areas | None,
    option: int | None,
    diagnostics: Diagnostics,
) -> AreaChoice:
    """The area of the mission's start or end: that of the option or of the header line, else the
    only one that the cell offers."""
    if header is not None:
        if option is not None and option != header.area:
            message = f"--{which}-area {option} contradicts the script"
            hint = f"remove --{which}-area, or this line of the script"
            diagnostics.error("area-conflict", message, header.span, hint)
        return AreaChoice(header.area, header.span, header.as_planned, said=True)
    if cell is None:
        return AreaChoice(option, said=option is not None)
    offered, span = sorted(set(cell.areas)), cell.span
    numbers = tuple(map(str, offered))
    choice = RemedyChoice(_REMEDIES[which], "area", numbers)
    if option is not None and offered and option not in offered:
        message = f"area {option} is not among the areas that the script allows for the {which}"
        diagnostics.error("area-not-offered", message, span, str(choice), choice)
    elif option is None and len(offered) > 1:
        areas = listed(numbers, "or")
        message = f"the script leaves the {which} open: starting area {areas}"
        diagnostics.error("area-choice", message, span, str(choice), choice)
    elif option is None and not offered and which == "end" and cell.dock:
        return AreaChoice(None, span, said=True, dock=True)
    elif option is None and not offered:
        message = f"this names no starting area for the mission's {which}"
        hint = "write, for example, `starting area 1`"
        diagnostics.error("no-area", message, span, hint, choice.remedy)
    chosen = option if option in offered or not offered else None
    area = chosen if chosen is not None else next(iter(offered), None)
    return AreaChoice(area, span, said=True)


class Starting:
    """The start, the end and the dock of a mission, as far as they are known."""

    def __init__(
        self, context: Context, header: ScriptHeader, wanted: AreaChoice, end: AreaChoice
    ) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.lookup = context.lookup
        self.header = header
        self.wanted = wanted
        """where it is to start"""
        self.end = end
        self.start: Do | None = None
        self.start_at: Span | None = None
        self.start_area = None if wanted.as_planned else wanted.area
        """known before the orders are, if the header says it"""
        self.end_area: int | None = None
        self.dock: Pose | None = None
        self.assumed: Area | None = None
        self.homes: dict[tuple[float, float], Do] = {}
        """drives into docks to which only ways with a condition lead"""

    # ---- the start

    def set(self, order: orders.Start) -> Do:
        """The start that a script sets. Raises RefusedError if there is another one."""
        if self.start_at is not None:
            message = f"the starting point is already set in line {self.start_at.line}"
            self.diagnostics.refuse("second-start", message, order.span, "remove one of the two")
        self.start_at = order.span
        pose, area = None, None
        if order.where is not None:
            pose, area = self.context.lookup.locate(order.where, "start")
        wanted = self.wanted
        other = area is None or area.number != wanted.area
        if wanted.area is not None and not wanted.as_planned and other:
            self._conflict(order.span)
        self.start_area = area.number if area else None
        if order.ends_there:
            self._end_in(area, order.span)
        self.start = Do("START", Action.START, order.span, pose)
        return self.start

    def _end_in(self, area: Area | None, span: Span) -> None:
        """Lets the mission end where it starts."""
        end = self.end
        if area is None or (end.area is not None and end.area != area.number):
            message = "the mission can't end here"
            if area is not None:
                message = f"the mission has to end in starting area {end.area}, not {area.number}"
            hint = "write a separate sentence for the end"
            self.diagnostics.refuse("area-conflict", message, span, hint)
        self.end = AreaChoice(area.number, span, said=True)

    def _conflict(self, span: Span) -> NoReturn:
        wanted = self.wanted
        message = f"the starting area {wanted.area} contradicts the script's starting point"
        hint = "choose none, or remove the starting point from the script"
        remedy: Remedy | None = Remedy.CHOOSE_START
        if wanted.span is not None:
            remedy = None
            message = f"line {wanted.span.line} says that it starts in area {wanted.area}"
            hint = "remove one of the two, or add `as planned` to the header line"
        self.diagnostics.refuse("area-conflict", message, span, hint, remedy)

    def _start_unsaid(self) -> None:
        wanted = self.wanted
        if wanted.area is not None and not wanted.as_planned:
            area = self.lookup.area(wanted.area, wanted.span)
            self.start_area = area.number
            self.start = Do("START", Action.START, wanted.span, area.dock)
        elif self.context.whole and not wanted.said:
            known = tuple(str(area.number) for area in self.lookup.catalog.areas)
            choice = RemedyChoice(Remedy.CHOOSE_START, "area", known)
            hint = f"write `Start in starting area 1`, or {choice}"
            message = "the script sets no starting point"
            self.diagnostics.refuse("no-start", message, None, hint, choice)

    # ---- the end

    def docking_area(self, said: DockLocation) -> Area:
        """The area into whose dock the mission drives at its end: the one that is named, else that
        of the header's end, else that of the start, else the nearest to it, with a warning."""
        option = None if self.end.as_planned else self.end.area
        number = self.start_area if option is None else option
        if said.area is not None:
            number = said.area.area
            if option not in (None, number):
                message = f"the mission has to end in starting area {option}, not {number}"
                hint = "remove the end area that was chosen (or `End area:`), or the one in this "
                hint += "line"
                self.diagnostics.refuse("area-conflict", message, said.span, hint)
        area = self._nearest(said.span) if number is None else self.lookup.area(number, said.span)
        self.end_area = area.number
        return area

    def _nearest(self, span: Span) -> Area:
        """The dock nearest to the start, which is assumed."""
        areas = self.lookup.catalog.areas
        if not areas:
            message = "there is no docking station on this site"
            self.diagnostics.refuse("area-choice", message, span, "name a place instead")
        at = self.start.pose if self.start is not None else None
        area = min(areas, key=lambda a: 0.0 if at is None else _distance(at, a.dock))
        if self.assumed is None:
            self.assumed = area
            where = "nearest to the start" if at is not None else "first one of the site"
            message = "this does not say which docking station; that of starting area "
            message += f"{area.number} is taken, the {where}"
            hint = f"write `the docking station in starting area {area.number}`"
            self.diagnostics.warning("dock-assumed", message, span, hint)
        return area

    def finish(self) -> None:
        """Adds the start and the way into the dock, and finds where home is."""
        context = self.context
        if context.program.first is None and context.whole:
            hint = "add steps such as `Check the checkpoint #14`"
            self.diagnostics.refuse("nothing-to-do", "the script has no task", None, hint)
        if self.start_at is None:
            self._start_unsaid()
        if self.start is not None and not self.start.is_listed:
            context.put([self.start], context.program, None)
        if self.wanted.as_planned:
            self.start_area = self.wanted.area
        end = self.end
        if end.as_planned:
            self.end_area = end.area
        elif context.docked is None or not context.docked.is_listed:
            self._end_docked()
        self._find_dock()

    def _end_docked(self) -> None:
        """Adds the way into the dock in which the header lets the mission end."""
        number = self.start_area if self.end.dock else self.end.area
        span = self.end.span
        if number is not None:
            area = self.lookup.area(number, span)
        elif self.end.dock and span is not None:
            area = self._nearest(span)
        else:
            return
        self.end_area = area.number
        docked = self.context.docked = dock(area.dock, span)
        self.context.put([docked], self.context.program, self.context.program.last)

    def _find_dock(self) -> None:
        if self.header.dock_said:
            point = self.header.dock
            self.dock = self.context.lookup.point(point) if point else None
            return
        for number in (self.end_area, self.start_area):
            area = self.lookup.catalog.area(number) if number is not None else None
            if area is not None:
                self.dock = area.dock
                return

    def home(self, ahead: HomeAhead) -> Do:
        """The drive with which the mission ends where a way leads home."""
        pose = ahead.dock or self.dock
        if pose is None:
            pose = self.dock = self._nearest(ahead.span).dock
        last = self.context.program.last
        if isinstance(last, Do) and last.docks and not last.ways and last.pose == pose:
            return last
        return self.homes.setdefault((pose.x, pose.y), dock(pose, ahead.span))


def _distance(a: Pose, b: Pose) -> float:
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))
