"""Makes places, floors and steps."""

from math import inf, pi

from argo_compiler.script.sentences.building.part import Make, RulePart, Signed, single, whole
from argo_compiler.script.sentences.tree.places import (
    AreaLocation,
    Coordinates,
    DockLocation,
    FloorName,
    Location,
    NamedFloor,
    PlaceLocation,
    Steps,
)
from argo_compiler.script.sentences.words.word import Word

_RADIANS = pi / 180
_MOST_FLOORS = 100
"""of a range; no site has more"""


def _area(part: RulePart) -> AreaLocation:
    """`starting area 1`, `starting area 1, not 2`."""
    area, *others = (whole(part, w.value) for w in part.every(Word) if w.type == "NUMBER")
    if area in others:
        part.error("several-places", "this area is named and excluded", "remove one of the two")
    for other in others:
        message = f"excluding area {other} has no effect, because area {area} is named"
        part.diagnostics.warning("no-effect", message, part.span)
    return AreaLocation(span=part.span, area=area)


def _dock(part: RulePart) -> DockLocation:
    """`the docking station in starting area 1`, `dock 1`."""
    area = part.first(AreaLocation)
    if (word := part.word("NUMBER")) is not None:
        area = AreaLocation(span=part.span, area=whole(part, word.value))
    return DockLocation(span=part.span, area=area)


def _place(part: RulePart) -> PlaceLocation:
    word = part.word("PLACE", "STRING")
    name = str(word.value) if word else " ".join(part.said.split())
    return PlaceLocation(span=part.span, name=name)


def _floors(part: RulePart) -> tuple[FloorName, ...]:
    found: list[FloorName] = []
    for word in part.every(Word):
        number: int | NamedFloor | None = None
        if word.type == "NUMBER":
            number = whole(part, word.value)
        elif word.type == "ORDINAL":
            number = word.value
        elif word.type == "FLOOR_NAME":
            number = NamedFloor(word.value)
        if number is not None:
            found.append(FloorName(span=part.text.span(word.start, word.end), number=number))
    if part.has("UPTO", "DASH") and len(found) == 2:
        return _range_of_floors(part, *found)
    floor = part.word("FLOOR")
    plural = floor is not None and bool(floor.value)
    if len(found) > 1 and not part.has("ORDINAL") and not plural:
        said = " and ".join(str(one.number) for one in found)
        hint = f"write `floors {said}`, or name the other thing: `checkpoint 4`"
        part.error("ambiguous-floor", f"it is not clear whether `{said}` are both floors", hint)
    return tuple(found)


def _range_of_floors(part: RulePart, first: FloorName, last: FloorName) -> tuple[FloorName, ...]:
    """`floors 1 to 4`"""
    between = range(int(first.number), int(last.number) + 1)
    if not 1 < len(between) <= _MOST_FLOORS:
        hint = "write the lower floor first: `floors 1 to 4`"
        part.error("empty-range", f"`{part.said}` is not a range of floors", hint)
        return first, last
    return tuple(FloorName(span=part.span, number=number) for number in between)


def _coordinates(part: RulePart) -> Coordinates:
    values = [s.value for s in part.every(Signed)]
    (only, *more) = part.every(Signed)
    if only.listed and not more:
        values = [float(n) for n in only.listed]
    if len(values) not in (2, 3) or not all(-inf < value < inf for value in values):
        hint = "write `(12.5, 3, 2.5)`"
        part.error("coordinates", "coordinates must be two or three numbers", hint)
        values = [0.0, 0.0]
    x, y, *z = values
    poses = part.every(dict)
    heights = [*z, *(p["z"] for p in poses if "z" in p)]
    yaws = [p["yaw"] for p in poses if "yaw" in p]
    floors = [floor for c in part.children if isinstance(c, tuple) for floor in c]
    for many, what in ((heights, "heights"), (yaws, "headings"), (floors, "floors")):
        if len(many) > 1:
            hint = "remove all but one of them"
            part.error("coordinates", f"these coordinates have {len(many)} {what}", hint)
    return Coordinates(
        span=part.span,
        x=x,
        y=y,
        z=heights[0] if heights else None,
        yaw=yaws[0] if yaws else 0.0,
        floor=floors[0] if floors else None,
    )


def _heading(part: RulePart) -> dict[str, float]:
    if word := part.word("QUANTITY"):
        figure, unit = word.value
        if unit != "deg":
            hint = "write `heading 90 degrees` or `heading 1.5 rad`"
            part.error("unit", f"a heading is an angle, not a number of {unit}", hint)
        if not figure.value < inf:
            part.error("number", "this heading is too large a number", "write a smaller number")
            return {"yaw": 0.0}
        return {"yaw": (-1 if part.has("MINUS") else 1) * figure.value * _RADIANS}
    value = single(part)
    return {"yaw": value if part.has("RAD") else value * _RADIANS}


def _steps(part: RulePart) -> Steps:
    points: list[int | str] = []
    for word in part.every(Word):
        if word.type == "NUMBER":
            points.append(whole(part, word.value))
        elif word.type == "STRING":
            points.append(word.value)
    if part.has("NEXT_STEP"):
        return Steps(span=part.span, points=(1,), ahead=True)
    return Steps(span=part.span, points=tuple(points), through=part.has("TO", "UPTO", "DASH"))


def _places(part: RulePart) -> list[Location | FloorName]:
    found: list[Location | FloorName] = []
    for child in part.children:
        if not isinstance(child, Word):
            found += child if isinstance(child, tuple) else [child]
    return found


RULES: dict[str, Make] = {
    "area": _area,
    "dock": _dock,
    "place": _place,
    "floors": _floors,
    "on_floors": lambda part: part.joined(tuple),
    "coordinates": _coordinates,
    "height": lambda part: {"z": single(part)},
    "heading": _heading,
    "location": lambda part: part.children[-1],
    "steps": _steps,
    "end_steps": _steps,
    "places": _places,
}
