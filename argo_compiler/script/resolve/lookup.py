"""Finds what a script names in the site's catalogue."""

from collections import defaultdict

from rapidfuzz.distance import OSA

from argo_compiler.catalog import Area, Catalog, CheckpointInfo, CheckpointKind, Floor
from argo_compiler.diagnostics import Span
from argo_compiler.listing import listed
from argo_compiler.model import Pose
from argo_compiler.script.syntax.source import Diagnostics
from argo_compiler.script.syntax.spelling import nearest
from argo_compiler.script.syntax.terms import (
    FloorName,
    Name,
    NamedFloor,
    PlaceLocation,
    Quantity,
    Reference,
)

_QUANTITIES = {
    CheckpointKind.PRESSURE_GAUGE: Quantity.VALUE,
    CheckpointKind.VALVE: Quantity.POSITION,
    CheckpointKind.LIQUID_LEVEL_GAUGE: Quantity.LEVEL,
}
_UNSAID_IN_PLACES = frozenset(["the", "a", "an", "in", "at", "to"])
_SAME_PLACE = 0.85
"""share of letters that must agree for a misspelt place"""


class Lookup:
    """The catalogue of one site by number and name. What it does not find is an error."""

    def __init__(self, catalog: Catalog, diagnostics: Diagnostics) -> None:
        self.catalog = catalog
        self.diagnostics = diagnostics
        self._by_number = {c.id: c for c in catalog.checkpoints}
        self._by_name: dict[str, list[CheckpointInfo]] = defaultdict(list)
        for checkpoint in catalog.checkpoints:
            self._by_name[checkpoint.name.lower()].append(checkpoint)
        self._unsaid = _UNSAID_IN_PLACES | set(catalog.site.lower().split())

    def checkpoint(self, reference: Reference) -> CheckpointInfo | None:
        """The checkpoint; number and name must agree where both are given."""
        found = None
        if reference.number is not None:
            found = self._numbered(reference.number, reference.span)
            if found and reference.name and not self._agrees(found, reference.name):
                return None
        elif reference.name:
            found = self._named(reference.name)
        if found and reference.quantity not in (None, _QUANTITIES[found.kind]):
            usual = _QUANTITIES[found.kind]
            message = f"a {found.kind} has no {reference.quantity}; its {usual} will be read"
            self.diagnostics.warning("quantity", message, reference.span, f"write `the {usual}`")
        return found

    def _numbered(self, number: int, span: Span) -> CheckpointInfo | None:
        found = self._by_number.get(number)
        if found is None:
            close = sorted(self._by_number, key=lambda known: (abs(known - number), known))[:3]
            hint = f"the nearest numbers are {listed(f'#{n}' for n in sorted(close))}"
            message = f"there is no checkpoint #{number} on {self.catalog.site}"
            self.diagnostics.error("unknown-checkpoint", message, span, hint if close else None)
        return found

    def _named(self, name: Name) -> CheckpointInfo | None:
        found = self._by_name.get(name.text.lower(), [])
        if len(found) == 1:
            return found[0]
        if found:
            numbers = listed(f"#{c.id}" for c in found)
            message = f"checkpoints {numbers} are all called {name.text}"
            hint = "name the checkpoint by its number"
            self.diagnostics.error("ambiguous-checkpoint", message, name.span, hint)
            return None
        close = nearest(name.text, (c.name for c in self.catalog.checkpoints))
        message = f"there is no {name.text} on {self.catalog.site}"
        hint = f"the nearest names are {listed(close)}"
        self.diagnostics.error("unknown-checkpoint", message, name.span, hint if close else None)
        return None

    def _agrees(self, found: CheckpointInfo, name: Name) -> bool:
        if found.name.lower() == name.text.lower():
            return True
        others = self._by_name.get(name.text.lower(), [])
        if others:
            its = f"{name.text} is checkpoint {listed((f'#{c.id}' for c in others), 'or')}"
        else:
            its = f"there is no {name.text} on {self.catalog.site}"
        message = f"checkpoint #{found.id} is {found.name}, and {its}"
        hint = "correct the number or the name"
        self.diagnostics.error("checkpoint-mismatch", message, name.span, hint)
        return False

    def area(self, number: int, span: Span | None) -> Area | None:
        found = self.catalog.area(number)
        if found is None:
            known = listed(a.number for a in self.catalog.areas)
            message = f"there is no starting area {number} on {self.catalog.site}"
            self.diagnostics.error("unknown-area", message, span, f"the starting areas are {known}")
        return found

    def floor(self, floor: FloorName) -> Floor | None:
        """The floor of this number, or the highest or lowest one."""
        floors = self.catalog.floors
        if floor.number is NamedFloor.TOP and floors:
            return max(floors, key=lambda f: f.z)
        if floor.number is NamedFloor.BOTTOM and floors:
            return min(floors, key=lambda f: f.z)
        found = next((f for f in floors if f.number == floor.number), None)
        if found is None:
            known = listed(f.number for f in floors)
            message = f"there is no floor {floor.number} on {self.catalog.site}"
            hint = f"the floors are {known}, counted from the bottom"
            self.diagnostics.error("unknown-floor", message, floor.span, hint)
        return found

    def place(self, location: PlaceLocation) -> Pose | None:
        """The pose of the named place; small words and the site's own name make no difference."""
        said = self._place_key(location.name)
        places = {self._place_key(place.name): place for place in self.catalog.places}
        if place := places.get(said):
            return place.pose
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
        self.diagnostics.error("unknown-place", message, location.span, hint)
        return None

    def _place_key(self, name: str) -> str:
        return " ".join(word for word in name.lower().split() if word not in self._unsaid)


def _same_place(said: str, known: str) -> bool:
    figures = [[c for c in name if c.isdecimal()] for name in (said, known)]
    return figures[0] == figures[1] and OSA.normalized_similarity(said, known) >= _SAME_PLACE
