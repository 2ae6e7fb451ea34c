"""Finds what a script names in the site's catalogue."""

from collections import defaultdict
from collections.abc import Collection, Iterable
from copy import copy
from typing import Literal, NoReturn

from argo_compiler.base.catalog import Area, Catalog, CheckpointInfo, CheckpointKind, Floor, Place
from argo_compiler.base.listing import listed
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Span
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.sentences.tree.nouns import Kind, Quantity
from argo_compiler.script.sentences.tree.places import (
    AreaLocation,
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    NamedFloor,
    PlaceLocation,
)
from argo_compiler.script.sentences.words.language import place_key
from argo_compiler.script.sentences.words.spelling import nearest

_QUANTITIES = {
    CheckpointKind.PRESSURE_GAUGE: (Quantity.PRESSURE,),
    CheckpointKind.VALVE: (Quantity.POSITION,),
    CheckpointKind.LIQUID_LEVEL_GAUGE: (Quantity.LEVEL,),
}
_GAUGES = (CheckpointKind.PRESSURE_GAUGE, CheckpointKind.LIQUID_LEVEL_GAUGE)
_UNSAID_IN_PLACES = frozenset(["the", "a", "an", "in", "at", "to"])
_SAME_PLACE = 0.85
"""share of letters that must agree for a misspelt place"""


class Lookup:
    """The catalogue of one site by number and name, and which docking stations the mission starts
    and ends at, if that is said. What it does not find is an error."""

    def __init__(
        self,
        catalog: Catalog,
        diagnostics: Diagnostics,
        start_area: int | None,
        end_area: int | None,
    ) -> None:
        self.catalog = catalog
        self.diagnostics = diagnostics
        self.start_area = start_area
        self.end_area = end_area
        self.by_number = {c.id: c for c in catalog.checkpoints}
        self._by_identifier: dict[str, list[CheckpointInfo]] = defaultdict(list)
        for checkpoint in catalog.checkpoints:
            name = checkpoint.name.lower()
            self._by_identifier[name.removeprefix(checkpoint.kind).strip()].append(checkpoint)
        self._lowest: dict[int | NamedFloor, Span] = {}
        """where the ground floor is named, and where the first one is"""
        self._unsaid = _UNSAID_IN_PLACES | set(catalog.site.lower().split())

    def anew(self, diagnostics: Diagnostics) -> "Lookup":
        """Return a lookup in the same catalogue that reports to others, as if nothing had been
        looked up so far."""
        other = copy(self)
        other.diagnostics = diagnostics
        other._lowest = {}
        return other

    def check_quantity(
        self, checkpoint: CheckpointInfo, quantity: Quantity | None, span: Span
    ) -> None:
        """Warns where a script asks for something that the checkpoint does not show."""
        usual = _QUANTITIES[checkpoint.kind]
        if quantity not in (None, Quantity.VALUE, *usual):
            message = f"a {checkpoint.kind} has no {quantity}; its {usual[0]} is read"
            self.diagnostics.warning("quantity", message, span, f"write `the {usual[0]}`")

    def of_kind(self, kind: Kind, floors: Collection[int]) -> list[CheckpointInfo]:
        """All checkpoints of a kind, on these floors or, without any, on all."""
        return [
            c
            for c in self.catalog.checkpoints
            if agrees(c, kind) and (not floors or c.floor in floors)
        ]

    def called(self, identifier: str, kind: Kind | None) -> list[CheckpointInfo]:
        """All checkpoints with this identifier, of the kind if one is said."""
        found = self._by_identifier.get(identifier.lower(), [])
        return [c for c in found if kind is None or agrees(c, kind)]

    def identified(self, identifier: str, kind: Kind | None, span: Span) -> CheckpointInfo:
        """The checkpoint of a kind with this identifier."""
        found = self.called(identifier, kind)
        if len(found) == 1:
            return found[0]
        name = f"{kind or 'checkpoint'} {identifier.upper()}"
        if found:
            hint = "write the checkpoint's number, or by its full name"
            self.refuse_readings(name, map(told, found), span, hint)
        close = nearest(name, (c.name for c in self.catalog.checkpoints))
        message = f"there is no {name} on {self.catalog.site}"
        hint = f"the nearest names are {listed(close)}"
        self.diagnostics.refuse("unknown-checkpoint", message, span, hint if close else None)

    def refuse_readings(
        self, name: str, readings: Iterable[str], span: Span, hint: str
    ) -> NoReturn:
        """Asks which checkpoint is meant by a name. Raises RefusedError."""
        message = f"`{name}` can be read as {listed(readings, 'or')}"
        self.diagnostics.refuse("ambiguous-checkpoint", message, span, hint)

    def numbered(self, number: int, span: Span) -> CheckpointInfo:
        if number in self.by_number:
            return self.by_number[number]
        close = sorted(self.by_number, key=lambda known: (abs(known - number), known))[:3]
        hint = f"the nearest numbers are {listed(f'#{n}' for n in sorted(close))}"
        message = f"there is no checkpoint #{number} on {self.catalog.site}"
        self.diagnostics.refuse("unknown-checkpoint", message, span, hint if close else None)

    def area(self, number: int, span: Span | None) -> Area:
        found = self.catalog.area(number)
        if found is not None:
            return found
        message = f"there is no starting area {number} on {self.catalog.site}"
        hint = f"the starting areas are {listed(str(a.number) for a in self.catalog.areas)}"
        self.diagnostics.refuse("unknown-area", message, span, hint)

    def floor(self, floor: FloorName) -> Floor:
        """The floor of this number, or the highest or lowest one."""
        floors = self.catalog.floors
        self._require_one_count(floor)
        if floor.number is NamedFloor.TOP and floors:
            return max(floors, key=lambda f: f.z)
        if isinstance(floor.number, NamedFloor) and floors:
            return min(floors, key=lambda f: f.z)
        for found in floors:
            if found.number == floor.number:
                return found
        message = f"there is no floor {floor.number} on {self.catalog.site}"
        known = listed(str(f.number) for f in floors)
        hint = f"the floors are {known}, counted from the bottom"
        self.diagnostics.refuse("unknown-floor", message, floor.span, hint)

    def _require_one_count(self, floor: FloorName) -> None:
        """That the first floor is not told from the ground floor: many count from above that."""
        if floor.number not in (1, NamedFloor.GROUND):
            return
        self._lowest.setdefault(floor.number, floor.span)
        if len(self._lowest) > 1:
            message = "this script names the ground floor and the first floor: these can be "
            message += "the same, or two floors"
            hint = "floors are counted from 1 at the bottom (German `Stock` as well): write "
            hint += "`floor 2` for the one above the ground floor"
            self.diagnostics.refuse("ambiguous-floor", message, floor.span, hint)

    def numbers(self, floors: Iterable[FloorName]) -> list[int]:
        """The numbers of floors."""
        return [floor.number for floor in self.diagnostics.each(self.floor, floors)]

    def place(self, location: PlaceLocation) -> Pose:
        """The pose of the named place; small words and the site's own name make no difference."""
        said = self._place_key(location.name)
        places: dict[str, Place] = {}
        for place in self.catalog.places:
            key = self._place_key(place.name)
            other = places.setdefault(key, place)
            if other is not place and key == said:
                message = f"`{location.name}` may be the place `{other.name}` or `{place.name}`"
                hint = "write its coordinates, or rename one of them in the site"
                self.diagnostics.refuse("ambiguous-place", message, location.span, hint)
        if found := places.get(said):
            return found.pose
        alike = [key for key in places if _same_place(said, key)]
        if len(alike) == 1:
            place = places[alike[0]]
            message = f"read `{location.name}` as `{place.name}`"
            self.diagnostics.warning("respelled", message, location.span)
            return place.pose
        message = f"there is no place `{location.name}` on {self.catalog.site}"
        known = [place.name for place in self.catalog.places]
        known += [f"starting area {area.number}" for area in self.catalog.areas]
        hint = f"the places are {listed([*known, 'the docking station'])}"
        self.diagnostics.refuse("unknown-place", message, location.span, hint)

    def _place_key(self, name: str) -> str:
        return place_key(name, self._unsaid)

    # ---- where locations lie

    def locate(
        self, location: Location, which: Literal["start", "end"]
    ) -> tuple[Pose, Area | None]:
        """The pose of the location, and its starting area if it lies in one."""
        match location:
            case Coordinates():
                return self.point(location), None
            case PlaceLocation():
                return self.place(location), None
            case AreaLocation():
                area = self.area(location.area, location.span)
            case DockLocation():
                area = self._docking_area(location, which)
        return area.dock, area

    def point(self, point: Coordinates) -> Pose:
        """The pose of a point in the site's frame; its height must be said."""
        z = point.z
        if point.floor is not None:
            floor = self.floor(point.floor)
            if z is not None and z != floor.z:
                message = f"floor {floor.number} is at z = {floor.z:g} m, not at {z:g} m"
                hint = "remove the height or the floor"
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
            known = listed((f"{flag} {area.number}" for area in self.catalog.areas), "or")
            message = "this does not say which docking station"
            hint = f"add `in starting area 1`, or give {known}"
            self.diagnostics.refuse("area-choice", message, dock.span, hint)
        if which == "end" and option is not None and option != named:
            message = f"the mission has to end in starting area {option}, not {named}"
            hint = f"remove {flag} (or `End area:`), or the area in this line"
            self.diagnostics.refuse("area-conflict", message, dock.span, hint)
        return self.area(named, dock.span)


def told(checkpoint: CheckpointInfo) -> str:
    """`pressure gauge 1 (#4)`"""
    return f"{checkpoint.name} (#{checkpoint.id})"


def agrees(checkpoint: CheckpointInfo, kind: Kind) -> bool:
    """Whether a checkpoint is of a kind."""
    if kind is Kind.GAUGE:
        return checkpoint.kind in _GAUGES
    return kind is Kind.CHECKPOINT or checkpoint.kind.value == kind.value


def _same_place(said: str, known: str) -> bool:
    from rapidfuzz.distance import OSA  # imported late: most scripts misspell no place

    figures = [[c for c in name if c.isdecimal()] for name in (said, known)]
    return figures[0] == figures[1] and OSA.normalized_similarity(said, known) >= _SAME_PLACE
