"""Random generators: one seed for a run, an independent stream for each purpose."""

import zlib

import numpy as np


def generator(seed: int, *purpose: str | int) -> np.random.Generator:
    """Return the random generator for a purpose, such as `generator(7, "gas sensor")`.

    Streams of different purposes are independent: a further draw from one does not change the
    others.
    """
    key = [zlib.crc32(str(part).encode()) for part in purpose]
    return np.random.default_rng([seed, *key])


def draw(rng: np.random.Generator, low: float, high: float, decimals: int) -> float:
    """Draw a number uniformly from `low` to `high`, and round it to `decimals` places.

    If that leads out of the range, it is rounded to the fewest places that do not.
    """
    drawn = float(rng.uniform(low, high))
    rounded = (round(drawn, digits) for digits in range(decimals, 17))
    return next((value for value in rounded if low <= value <= high), drawn)
