"""Decks out of rectangles: the plates, and the free edges where a railing belongs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.site.spec import Rect

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
