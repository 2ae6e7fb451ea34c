"""From a site's description to its solids, the one generator that all else is made from; and decks
out of rectangles, with the free edges where a railing belongs."""

from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np
from numpy.typing import NDArray

from argo_env.site.equipment import (
    build_column,
    build_dock,
    build_mount,
    build_pipe,
    build_pump,
    build_vessel,
)
from argo_env.site.shapes import Box, Element, Role, Solid
from argo_env.site.spec import FloorSpec, Rect, SiteSpec
from argo_env.site.stairs import build_flight, mouths, outside, railing

_EPSILON = 1e-6


@dataclass(frozen=True)
class RimEdge:
    """A straight piece of a deck's rim, from `start` to `end` (m); `outward` is its unit normal."""

    start: tuple[float, float]
    end: tuple[float, float]
    outward: tuple[float, float]


@dataclass(frozen=True)
class Deck:
    """A deck cut at all its coordinates: `plan[i, j]` says whether the field x[i]..x[i+1],
    y[j]..y[j+1] is plated."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    plan: NDArray[np.bool_]

    @staticmethod
    def from_rectangles(
        plates: tuple[Rect, ...], openings: tuple[Rect, ...], cuts: tuple[Rect, ...] = ()
    ) -> "Deck":
        """The union of `plates` less the union of `openings`; edges are also cut along `cuts`."""
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
        """The plated area as rectangles that do not overlap: runs along x, merged along y."""
        rectangles: list[Rect] = []
        open_runs: dict[tuple[int, int], int] = {}
        for j in range(len(self.y) - 1):
            runs = _runs(self.plan[:, j])
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

    def free_edges(self, gaps: tuple[Rect, ...]) -> list[RimEdge]:
        """The rim of the deck, without the pieces that lie in one of the `gaps`."""
        padded = np.pad(self.plan, 1)
        edges: list[RimEdge] = []
        for axis, lines, across in ((0, self.x, self.y), (1, self.y, self.x)):
            plan = padded if axis == 0 else padded.T
            for line in range(len(lines)):
                before, after = plan[line, 1:-1], plan[line + 1, 1:-1]
                for sign, rim in ((1.0, before & ~after), (-1.0, after & ~before)):
                    at = float(lines[line])
                    kept = rim & ~_in_gaps(at, across, gaps, axis)
                    for first, last in _runs(kept):
                        a, b = float(across[first]), float(across[last])
                        if axis == 0:
                            edges.append(RimEdge((at, a), (at, b), (sign, 0.0)))
                        else:
                            edges.append(RimEdge((a, at), (b, at), (0.0, sign)))
        return edges


def _coordinates(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.unique(np.round(values, 6))


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Stretches of true as (first, one past the last)."""
    steps = np.diff(np.pad(flags.astype(np.int8), 1))
    return list(
        zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True)
    )


def _in_gaps(
    at: float, across: NDArray[np.float64], gaps: tuple[Rect, ...], axis: int
) -> NDArray[np.bool_]:
    """Which pieces of the line at coordinate `at` lie inside a gap."""
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
    """All elements of the site, with unique names, in the order of the description."""
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
    elements += [build_mount(c, floor.z) for c in floor.checkpoints]
    return elements


def _plated(
    name: str,
    walkways: tuple[Rect, ...],
    openings: tuple[Rect, ...],
    z: float,
    gaps: tuple[Rect, ...],
    railed: bool,
) -> list[Element]:
    """A deck at height `z` with its railings; without them it is a slab on the ground."""
    deck = Deck.from_rectangles(walkways, openings, gaps if railed else ())
    thickness = DECK_THICKNESS if railed else SLAB_THICKNESS
    plates: list[Solid] = [
        Box(((x0 + x1) / 2, (y0 + y1) / 2, z - thickness / 2), (x1 - x0, y1 - y0, thickness))
        for x0, y0, x1, y1 in deck.plates()
    ]
    if not railed:
        return [Element(f"{name} slab", Role.DECK, tuple(plates), "concrete")]
    width, depth = BEAM
    for edge in deck.free_edges(()):
        (x0, y0), (x1, y1), (nx, ny) = edge.start, edge.end, edge.outward
        # The beam lies under the rim, inside the deck's outline.
        center = (
            (x0 + x1) / 2 - nx * width / 2,
            (y0 + y1) / 2 - ny * width / 2,
            z - thickness - depth / 2,
        )
        plates.append(Box(center, (abs(x1 - x0) or width, abs(y1 - y0) or width, depth)))
    elements = [Element(f"{name} deck", Role.DECK, tuple(plates), "grating")]
    for number, edge in enumerate(deck.free_edges(gaps), start=1):
        solids = railing(edge.start, edge.end, z, outside(edge.outward))
        elements.append(Element(f"{name} railing {number}", Role.RAILING, solids, "railing"))
    return elements


def _stair_mouths(spec: SiteSpec) -> list[tuple[float, Rect]]:
    """Height and area of every place where a flight joins a deck."""
    return [
        mouth
        for tower in spec.towers
        for floor in spec.floors[:-1]
        for flight in tower.flights
        for mouth in mouths(flight, floor.z)
    ]


def _near(gaps: list[tuple[float, Rect]], z: float) -> tuple[Rect, ...]:
    return tuple(rect for height, rect in gaps if abs(height - z) < 0.05)
