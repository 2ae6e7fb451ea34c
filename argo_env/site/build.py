"""Generator of a site's solids from its description.

Everything else about the shape of a site is made from these solids: process equipment, columns,
docking stations, and decks that consist of rectangles, with railings along their free edges.
"""

import math
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Box, Cylinder, Element, Role, Solid, Vector
from argo_env.site.spec import (
    AreaSpec,
    CheckpointSpec,
    FloorSpec,
    PipeSpec,
    PumpSpec,
    Rect,
    SiteSpec,
    VesselSpec,
)
from argo_env.site.stairs import build_flight, flight_end_areas, railing, railing_offset_outward

DOCK_DISTANCE = 0.62  # m from the centre of a docked robot to the face of its station
MOUNT_LENGTH = 0.2  # m from the face of a checkpoint back to what carries it


def build_vessel(vessel: VesselSpec, base_z: float) -> Element:
    """Build a vessel whose heights are above `base_z` (m); a lying one stands on two saddles."""
    x, y, height = vessel.center
    turn: Vector = {
        "x": (0.0, math.pi / 2, 0.0),
        "y": (math.pi / 2, 0.0, 0.0),
        "z": (0.0, 0.0, 0.0),
    }[vessel.axis]
    shell = Cylinder((x, y, base_z + height), vessel.radius, vessel.length, turn)
    if vessel.axis == "z":
        return Element(vessel.name, Role.VESSEL, (shell,), "vessel")
    along = (1.0, 0.0) if vessel.axis == "x" else (0.0, 1.0)
    saddles = tuple(
        Box(
            (x + s * along[0], y + s * along[1], base_z + height / 2 - vessel.radius / 4),
            (
                0.2 if along[0] else 1.4 * vessel.radius,
                0.2 if along[1] else 1.4 * vessel.radius,
                height - vessel.radius / 2,
            ),
        )
        for s in (-0.3 * vessel.length, 0.3 * vessel.length)
    )
    return Element(vessel.name, Role.VESSEL, (shell, *saddles), "vessel")


def build_pipe(pipe: PipeSpec) -> Element:
    """Build a pipe as a row of cylinders, one from each point to the next."""
    solids = []
    for (x0, y0, z0), (x1, y1, z1) in pairwise(pipe.points):
        dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        turn = (0.0, math.acos(dz / length), math.atan2(dy, dx))
        center = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
        # Each cylinder reaches half a radius beyond its points, which closes the corners.
        solids.append(Cylinder(center, pipe.radius, length + pipe.radius, turn))
    return Element(pipe.name, Role.PIPE, tuple(solids), "pipe")


def build_pump(pump: PumpSpec, z: float) -> Element:
    """Build a centrifugal pump and its motor on a skid of 1.2 m by 0.6 m, at height `z` (m)."""
    yaw = math.radians(pump.yaw)
    cos, sin = math.cos(yaw), math.sin(yaw)

    def at(along: float, up: float) -> Vector:
        return pump.center[0] + along * cos, pump.center[1] + along * sin, z + up

    lying = (0.0, math.pi / 2, yaw)
    solids: tuple[Solid, ...] = (
        Box(at(0.0, 0.08), (1.2, 0.6, 0.16), (0.0, 0.0, yaw)),
        Cylinder(at(-0.2, 0.42), 0.22, 0.62, lying),
        Cylinder(at(0.32, 0.42), 0.06, 0.5, lying),
        Cylinder(at(0.42, 0.44), 0.27, 0.18, lying),
        Cylinder(at(0.42, 0.75), 0.07, 0.4),
    )
    return Element(pump.name, Role.PUMP, solids, "pump")


def build_column(number: int, center: tuple[float, float], bottom: float, top: float) -> Element:
    """Build a steel column of 0.2 m by 0.2 m about `center`, from height `bottom` to `top` (m).

    `number` is for its name.
    """
    box = Box((center[0], center[1], (bottom + top) / 2), (0.2, 0.2, top - bottom))
    return Element(f"column {number}", Role.STRUCTURE, (box,), "structure")


def build_dock(area: AreaSpec, ground_z: float) -> Element:
    """Build a starting area's docking station: a cabinet in front of the docked robot, and a sign.

    It stands on the ground, at the height `ground_z` (m).
    """
    x, y, degrees = area.dock
    yaw = math.radians(degrees)

    def at(along: float, up: float) -> Vector:
        return x + along * math.cos(yaw), y + along * math.sin(yaw), ground_z + up

    turn = (0.0, 0.0, yaw)
    solids: tuple[Solid, ...] = (
        Box(at(DOCK_DISTANCE + 0.2, 0.35), (0.4, 0.7, 0.7), turn),
        Box(at(DOCK_DISTANCE + 0.3, 0.9), (0.08, 0.08, 0.4), turn),
        Box(at(DOCK_DISTANCE + 0.2, 1.2), (0.1, 0.5, 0.3), turn),
    )
    return Element(f"docking station {area.number}", Role.DOCK, solids, "dock")


def build_bracket(checkpoint: CheckpointSpec, floor_z: float) -> Element:
    """Build the bracket that joins a checkpoint to the pipe or vessel behind it.

    `floor_z` is the height (m) of the checkpoint's floor.
    """
    x, y, height = checkpoint.position
    yaw = math.radians(checkpoint.yaw)
    back = (MOUNT_LENGTH + 0.06) / 2
    center = (x - back * math.cos(yaw), y - back * math.sin(yaw), floor_z + height)
    box = Box(center, (MOUNT_LENGTH - 0.06, 0.04, 0.04), (0.0, 0.0, yaw))
    return Element(f"mount of {checkpoint.name}", Role.STRUCTURE, (box,), "structure")


_EPSILON = 1e-6


@dataclass(frozen=True)
class RimEdge:
    """Straight piece of a deck's rim, from `start` to `end` (m); `outward` is its unit normal."""

    start: tuple[float, float]
    end: tuple[float, float]
    outward: tuple[float, float]


@dataclass(frozen=True)
class Deck:
    """Deck as a grid that is cut at all coordinates of its rectangles.

    `plated[i, j]` is true if a plate covers the field from x[i] to x[i+1] and from y[j] to y[j+1].
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    plated: NDArray[np.bool_]

    @staticmethod
    def from_rectangles(
        plates: tuple[Rect, ...], openings: tuple[Rect, ...], cuts: tuple[Rect, ...] = ()
    ) -> "Deck":
        """Return the deck that covers the union of `plates` less that of `openings`.

        `cuts` cover and remove nothing: they only split the grid, so that a piece of the rim can
        end where a cut does.
        """
        everything = np.array(plates + openings + cuts)
        x, y = _coordinates(everything[:, [0, 2]]), _coordinates(everything[:, [1, 3]])
        middle_x, middle_y = np.meshgrid((x[:-1] + x[1:]) / 2, (y[:-1] + y[1:]) / 2, indexing="ij")

        def covered(rectangles: tuple[Rect, ...]) -> NDArray[np.bool_]:
            inside = np.zeros(middle_x.shape, dtype=bool)
            for x0, y0, x1, y1 in rectangles:
                inside |= (middle_x > x0) & (middle_x < x1) & (middle_y > y0) & (middle_y < y1)
            return inside

        return Deck(x, y, covered(plates) & ~covered(openings))

    def plates(self) -> list[Rect]:
        """Return the plated area as disjoint rectangles: runs along x, merged along y."""
        rectangles: list[Rect] = []
        open_runs: dict[tuple[int, int], int] = {}
        for j in range(len(self.y) - 1):
            runs = _runs(self.plated[:, j])
            for run in [r for r in open_runs if r not in runs]:
                rectangles.append(self._rectangle(run, open_runs.pop(run), j))
            for run in runs:
                open_runs.setdefault(run, j)
        for run, first in open_runs.items():
            rectangles.append(self._rectangle(run, first, len(self.y) - 1))
        return rectangles

    def _rectangle(self, run: tuple[int, int], first: int, last: int) -> Rect:
        return (
            float(self.x[run[0]]),
            float(self.y[first]),
            float(self.x[run[1]]),
            float(self.y[last]),
        )

    def edges_outside_gaps(self, gaps: tuple[Rect, ...]) -> list[RimEdge]:
        """Return the pieces of the deck's rim, also around its openings, that are in no gap."""
        padded = np.pad(self.plated, 1)
        edges: list[RimEdge] = []
        for axis, lines, across in ((0, self.x, self.y), (1, self.y, self.x)):
            fields = padded if axis == 0 else padded.T
            for line in range(len(lines)):
                before, after = fields[line, 1:-1], fields[line + 1, 1:-1]
                for sign, rim in ((1.0, before & ~after), (-1.0, after & ~before)):
                    at = float(lines[line])
                    free = rim & ~_in_gaps(at, across, gaps, axis)
                    for first, last in _runs(free):
                        a, b = float(across[first]), float(across[last])
                        if axis == 0:
                            edges.append(RimEdge((at, a), (at, b), (sign, 0.0)))
                        else:
                            edges.append(RimEdge((a, at), (b, at), (0.0, sign)))
        return edges


def _coordinates(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.unique(np.round(values, 6))


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the stretches of true flags as (first index, index after the last)."""
    steps = np.diff(np.pad(flags.astype(np.int8), 1))
    return list(
        zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True)
    )


def _in_gaps(
    at: float, across: NDArray[np.float64], gaps: tuple[Rect, ...], axis: int
) -> NDArray[np.bool_]:
    """Return a mask of the pieces of a line that lie inside a gap.

    The line has the coordinate `at` on `axis` (0: x, 1: y); `across` are the borders of its pieces
    on the other axis, in m.
    """
    middle = (across[:-1] + across[1:]) / 2
    inside = np.zeros(len(middle), dtype=bool)
    for gap in gaps:
        near, far = gap[axis], gap[axis + 2]
        low, high = gap[1 - axis], gap[3 - axis]
        if near - _EPSILON <= at <= far + _EPSILON:
            inside |= (middle > low) & (middle < high)
    return inside


DECK_THICKNESS = 0.04  # m
SLAB_THICKNESS = 0.2  # m
BEAM = (0.06, 0.16)  # m, width and depth of the beams along the rim of a deck
GROUND_THICKNESS = 0.5  # m


def build_site(spec: SiteSpec) -> tuple[Element, ...]:
    """Build all elements of the site that a description describes.

    They are, in this order, the ground, floors, stair towers, columns, pipes, vessels and docking
    stations.
    """
    elements: list[Element] = [_ground(spec)]
    gaps = _stair_mouths(spec)
    for floor in spec.floors:
        elements += _floor(floor, gaps)
    for tower in spec.towers:
        for floor in spec.floors[:-1]:
            prefix = f"{tower.name} {floor.number}-{floor.number + 1}"
            for flight in tower.flights:
                elements += build_flight(flight, prefix, floor.z)
            for landing in tower.landings:
                z = floor.z + landing.z
                elements += _plated(
                    f"{prefix} {landing.name}", (landing.rect,), (), z, _near(gaps, z), True
                )
    top = spec.floors[-1].z + spec.storey
    elements += [build_column(n, c, spec.ground_z, top) for n, c in enumerate(spec.columns, 1)]
    elements += [build_pipe(p) for p in spec.pipes]
    elements += [build_vessel(v, 0.0) for v in spec.vessels]
    elements += [build_dock(a, spec.ground_z) for a in spec.areas]
    return tuple(elements)


def _ground(spec: SiteSpec) -> Element:
    x0, y0, x1, y1 = spec.ground
    box = Box(
        ((x0 + x1) / 2, (y0 + y1) / 2, spec.ground_z - GROUND_THICKNESS / 2),
        (x1 - x0, y1 - y0, GROUND_THICKNESS),
    )
    return Element("gravel", Role.GROUND, (box,), "gravel")


def _floor(floor: FloorSpec, gaps: list[tuple[float, Rect]]) -> list[Element]:
    name = f"floor {floor.number}"
    walkways, openings = tuple(floor.walkways.values()), tuple(floor.openings.values())
    free = _near(gaps, floor.z) + tuple(floor.gates.values())
    elements = _plated(name, walkways, openings, floor.z, free, floor.railed)
    for label, line in floor.barriers.items():
        solids = chain.from_iterable(railing(a, b, floor.z, (0.0, 0.0)) for a, b in pairwise(line))
        elements.append(Element(f"{name} {label}", Role.RAILING, tuple(solids), "railing"))
    elements += [build_vessel(v, floor.z) for v in floor.vessels]
    elements += [build_pump(p, floor.z) for p in floor.pumps]
    elements += [build_bracket(c, floor.z) for c in floor.checkpoints]
    return elements


def _plated(
    name: str,
    walkways: tuple[Rect, ...],
    openings: tuple[Rect, ...],
    z: float,
    gaps: tuple[Rect, ...],
    railed: bool,
) -> list[Element]:
    """Build a deck at height `z` (m) with railings, or a slab on the ground if not `railed`."""
    deck = Deck.from_rectangles(walkways, openings, gaps if railed else ())
    thickness = DECK_THICKNESS if railed else SLAB_THICKNESS
    plates: list[Solid] = [
        Box(((x0 + x1) / 2, (y0 + y1) / 2, z - thickness / 2), (x1 - x0, y1 - y0, thickness))
        for x0, y0, x1, y1 in deck.plates()
    ]
    if not railed:
        return [Element(f"{name} slab", Role.DECK, tuple(plates), "concrete")]
    width, depth = BEAM
    for edge in deck.edges_outside_gaps(()):
        (x0, y0), (x1, y1), (nx, ny) = edge.start, edge.end, edge.outward
        # The beam lies under the rim, inside the deck's outline.
        center = (
            (x0 + x1) / 2 - nx * width / 2,
            (y0 + y1) / 2 - ny * width / 2,
            z - thickness - depth / 2,
        )
        plates.append(Box(center, (abs(x1 - x0) or width, abs(y1 - y0) or width, depth)))
    elements = [Element(f"{name} deck", Role.DECK, tuple(plates), "grating")]
    for number, edge in enumerate(deck.edges_outside_gaps(gaps), start=1):
        solids = railing(edge.start, edge.end, z, railing_offset_outward(edge.outward))
        elements.append(Element(f"{name} railing {number}", Role.RAILING, solids, "railing"))
    return elements


def _stair_mouths(spec: SiteSpec) -> list[tuple[float, Rect]]:
    """Return the height (m) and the area of each place where a flight joins a deck."""
    return [
        mouth
        for tower in spec.towers
        for floor in spec.floors[:-1]
        for flight in tower.flights
        for mouth in flight_end_areas(flight, floor.z)
    ]


def _near(gaps: list[tuple[float, Rect]], z: float) -> tuple[Rect, ...]:
    return tuple(rect for height, rect in gaps if abs(height - z) < 0.05)
