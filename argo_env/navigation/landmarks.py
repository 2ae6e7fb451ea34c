"""Landmarks: states whose ways to and from all others are known, and bound all other ways from
below by the triangle inequality (Goldberg and Harrelson, "Computing the shortest path: A* search
meets graph theory", 2005)."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_env.files.parts import NOWHERE, Parts
from argo_env.navigation.graphs import Graph, costs_of

_SIDES, _AWAY = 8, 8  # landmarks at the outermost places, and far away from all others
_ACTIVE = 6  # bounds that one search uses
_WORTH_IT = 100_000  # states; a search through fewer is short, and landmarks take memory
_SHARE = 0.998  # of a bound is used: what single precision rounds must not exceed a move's cost
_NEVER = 1e6  # s that a way counts that there is not


@dataclass(frozen=True)
class Landmarks:
    """Landmarks of a graph with the moves `ahead` in time and `back` against it; `places` are the
    x and y (m) of its states, shape (n, 2).

    The bounds hold as well for a graph that has lost some of the moves.
    """

    ahead: Graph
    back: Graph
    places: NDArray[np.float64]
    parts: Parts = NOWHERE
    name: str = ""
    """of the part with their ways"""

    def bounds(
        self, source: int, ends: NDArray[np.int64], extra: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Of each state a cost (s) that no way from it to one of `ends` is below, where arriving at
        each costs `extra` (s) besides; the best ones near the ways from `source`.

        Along a move, bounds fall by less than its cost. None for a small graph.
        """
        if len(self.places) < _WORTH_IT:
            return None
        onto, away = self._distances
        # A way from the goals on to the landmark, or from the landmark to the goals.
        behind = (onto[:, ends] - extra).max(axis=1).astype(np.float32)
        before = (away[:, ends] + extra).min(axis=1).astype(np.float32)
        with np.errstate(invalid="ignore"):
            worth = np.concatenate([onto[:, source] - behind, before - away[:, source]])
        usable = np.isfinite(np.concatenate([behind, before]))
        worth[~usable] = -np.inf
        best = np.zeros(len(self.places), dtype=np.float32)
        bound = np.empty_like(best)
        for number in np.argsort(-worth, kind="stable")[: min(_ACTIVE, int(usable.sum()))].tolist():
            k = number % len(onto)
            if number == k:
                np.subtract(onto[k], behind[k], out=bound)
            else:
                np.subtract(before[k], away[k], out=bound)
            np.maximum(best, bound, out=best)
        return np.minimum(best, np.float32(_NEVER), out=best).astype(np.float64) * _SHARE

    def prepare(self) -> None:
        """Finds the ways now."""
        if len(self.places) >= _WORTH_IT:
            _ = self._distances

    @cached_property
    def _distances(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The costs (s) from all states to each landmark, and from each landmark to all states,
        shape (landmarks, n)."""
        ways = self.parts.made(self.name, self._find_distances)
        return ways["onto"], ways["away"]

    def _find_distances(self) -> dict[str, NDArray[np.float32]]:
        chosen = _outermost(self.places)
        onto, away = self._to_and_from(chosen)
        nearest = (onto + away).min(axis=0)
        for _ in range(_AWAY):
            nearest[~np.isfinite(nearest)] = -1.0
            more = self._to_and_from([int(np.argmax(nearest))])
            onto, away = np.vstack([onto, more[0]]), np.vstack([away, more[1]])
            nearest = np.minimum(nearest, (more[0] + more[1])[0])
        return {"onto": onto, "away": away}

    def _to_and_from(self, states: list[int]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        onto, away = (costs_of(graph, states) for graph in (self.back, self.ahead))
        return onto.astype(np.float32), away.astype(np.float32)


def _outermost(places: NDArray[np.float64]) -> list[int]:
    """The state that lies farthest in each of some directions, in the middle of those that do."""
    states = []
    for k in range(_SIDES):
        angle = 2 * math.pi * k / _SIDES
        along = places @ np.array([math.cos(angle), math.sin(angle)])
        aside = places @ np.array([-math.sin(angle), math.cos(angle)])
        edge = np.flatnonzero(along > along.max() - 0.15)
        middle = np.abs(aside[edge] - np.median(aside[edge])).round(6)
        states.append(int(edge[np.argmin(middle)]))
    return states
