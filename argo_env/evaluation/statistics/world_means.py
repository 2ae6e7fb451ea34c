"""Means of the runs of one world, which depend on each other and count as one."""

from collections import defaultdict
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray


def world_means(values: Iterable[tuple[int, float | tuple[float, ...]]]) -> NDArray[np.float64]:
    """Return the mean in each world of what runs, or pairs of them, have come to.

    Each value, or tuple of values, comes with its world's seed; the worlds are in the order in
    which they first come.
    """
    worlds: dict[int, list[float | tuple[float, ...]]] = defaultdict(list)
    for seed, value in values:
        worlds[seed].append(value)
    return np.array([np.mean(found, axis=0) for found in worlds.values()])


def weighted_world_means(
    values: Iterable[tuple[int, str, float | None]], weights: Mapping[str, float]
) -> dict[int, float]:
    """Return by seed the weighted mean over the cases that count in a world.

    Each value comes with the seed and the case; None counts for nothing. Worlds in which a case is
    missing, or none counts, are left out.
    """
    worlds: dict[int, dict[str, float | None]] = defaultdict(dict)
    for seed, case, value in values:
        worlds[seed][case] = value
    means = {}
    for seed, found in worlds.items():
        counting = {case: value for case, value in found.items() if value is not None}
        whole = sum(weights[case] for case in counting)
        if len(found) == len(weights) and whole:
            means[seed] = sum(weights[case] * v for case, v in counting.items()) / whole
    return means
