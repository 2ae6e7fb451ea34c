"""Ultrasound in the band about 40 kHz: the hiss of a leak.

A jet's level grows with the mass that escapes, and falls by 6 dB with each doubling of the distance
and by the absorption of the air: L = L1 + 10 lg(rate / 10 g/s) - 20 lg(r / 1 m) - a r. Behind a
solid there is only what is bent around it or thrown back.
"""

import math

from argo_env.surroundings.sources import GasLeak

LEVEL = 90.0
"""dB at 1 m from a leak of 10 g/s; our choice, in the range of leaks that detectors are sold for"""
ABSORPTION = 1.32
"""dB/m at 40 kHz, 20 °C and 50 % relative humidity, by ISO 9613-1"""
SHADOW = 20.0
"""dB that a solid takes away"""


def leak_level(leak: GasLeak, distance: float, shadowed: bool) -> float:
    """dB at `distance` (m) from the leak, in the shadow of a solid or not."""
    r = max(distance, 0.1)
    level = LEVEL + 10 * math.log10(leak.rate / 0.01) - 20 * math.log10(r) - ABSORPTION * r
    return level - SHADOW * shadowed
