"""Where a script's locations lie: poses on the site."""

from typing import Literal

from argo_compiler.base.catalog import Area
from argo_compiler.base.listing import listed
from argo_compiler.base.model import Pose
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.places import (
    AreaLocation,
    Coordinates,
    DockLocation,
    Location,
    PlaceLocation,
)


class Locator:
    """Finds poses; knows which docking stations the mission starts and ends at, if that is said."""

    def __init__(
        self, lookup: Lookup, diagnostics: Diagnostics, start_area: int | None, end_area: int | None
    ) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics
        self.start_area = start_area
        self.end_area = end_area

    def locate(
        self, location: Location, which: Literal["start", "end"]
    ) -> tuple[Pose, Area | None]:
        """The pose of the location, and its starting area if it lies in one."""
        match location:
            case Coordinates():
                return self.point(location), None
            case PlaceLocation():
                return self.lookup.place(location), None
            case AreaLocation():
                area = self.lookup.area(location.area, location.span)
            case DockLocation():
                area = self._docking_area(location, which)
        return area.dock, area

    def point(self, point: Coordinates) -> Pose:
        """The pose of a point in the site's frame; its height must be said."""
        z = point.z
        if point.floor is not None:
            floor = self.lookup.floor(point.floor)
            if z is not None and z != floor.z:
                message = f"floor {floor.number} lies at z = {floor.z:g} m, not at {z:g} m"
                hint = "leave the height or the floor out"
                self.diagnostics.refuse("height", message, point.span, hint)
            z = floor.z
        if z is None:
            hint = "write a third number or a floor: `(12.5, 3, 2.5)`, `(12.5, 3) on floor 2`"
            self.diagnostics.refuse("height", "these coordinates have no height", point.span, hint)
        return Pose(x=point.x, y=point.y, z=z, yaw=point.yaw)

    def _docking_area(self, dock: DockLocation, which: Literal["start", "end"]) -> Area:
        option = self.start_area if which == "start" else self.end_area
        named = dock.area.area if dock.area else option
        flag = f"--{which}-area"
        if named is None:
            known = listed((f"{flag} {area.number}" for area in self.lookup.catalog.areas), "or")
            message = "this does not say which docking station"
            hint = f"add `in starting area 1`, or give {known}"
            self.diagnostics.refuse("area-choice", message, dock.span, hint)
        if which == "end" and option is not None and option != named:
            message = f"the mission is to end in starting area {option}, not {named}"
            hint = f"leave {flag} (or `End area:`) out, or take the area out of this line"
            self.diagnostics.refuse("area-conflict", message, dock.span, hint)
        return self.lookup.area(named, dock.span)
