"""Concentration of gas around a leak.

The gas escapes from a point at a steady rate Q (m³/s) from a start on, is carried by the wind u
along x, and is mixed by eddies with the diffusivity K. The advection-diffusion equation with
constant u and K has the exact solution

    c(r, t) = Q / (8 π K r) [ e^((x-r) u / 2K) erfc((r - u t) / 2√(K t))
                            + e^((x+r) u / 2K) erfc((r + u t) / 2√(K t)) ]

which tends to Q / (4 π K r) e^((x-r) u / 2K) (Carslaw and Jaeger, Conduction of Heat in Solids,
2nd ed., 10.4 and 10.7). The ground reflects the gas: a second source of the same rate lies below
the ground, at the same distance from it. Decks are gratings and let the gas through; other solids
do not affect it.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

from argo_env.surroundings.surroundings import GasLeak, Release, Weather

DENSITY = 0.668
"""kg/m³, of methane at 20 °C and 1013 hPa"""
_ORIFICE = 0.05  # m: nearer than this to the leak the concentration does not increase


def concentration(
    release: Release, weather: Weather, ground_z: float, points: NDArray[np.float64], now: float
) -> NDArray[np.float64]:
    """Return the concentration of a release's gas at `points` (m), shape (n, 3), in ppm.

    `now` (s) is the time, `ground_z` (m) the height of the ground. Gas that escaped before the end
    of the release continues to disperse after it.
    """
    result = leak_concentration(release.leak, weather, ground_z, points, now - release.start)
    if release.end is not None:
        result -= leak_concentration(release.leak, weather, ground_z, points, now - release.end)
    return np.clip(result, 0.0, 1e6)


def leak_concentration(
    leak: GasLeak, weather: Weather, ground_z: float, points: NDArray[np.float64], age: float
) -> NDArray[np.float64]:
    """Return the concentration in ppm at `points` (m) from a leak that began `age` seconds ago.

    The leak has not stopped. The concentration is 0 if `age` is 0 or less.
    """
    if age <= 0.0:
        return np.zeros(len(points))
    x, y, z = leak.place
    mirrored = (x, y, 2 * ground_z - z)
    sources = [
        _unit_concentration(points - np.array(position), weather, age)
        for position in (leak.place, mirrored)
    ]
    return np.asarray(1e6 * leak.rate / DENSITY * (sources[0] + sources[1]))


def _unit_concentration(
    offset: NDArray[np.float64], weather: Weather, t: float
) -> NDArray[np.float64]:
    """Return the share of gas at `offset` (m) from a source of 1 m³/s that began `t` seconds ago.

    The source has not stopped. Points nearer to it than _ORIFICE count as that far from it.
    """
    k = weather.diffusivity
    wind = np.array([*weather.wind, 0.0])
    u = float(np.linalg.norm(wind))
    r = np.maximum(np.linalg.norm(offset, axis=1), _ORIFICE)
    along = offset @ wind  # u x
    root = 2 * np.sqrt(k * t)
    near = np.exp(np.minimum(along - u * r, 0.0) / (2 * k)) * scipy.special.erfc((r - u * t) / root)
    # Compute e^(a) erfc(b) as erfcx(b) e^(a - b²), whose exponent is never positive.
    exponent = along / (2 * k) - (r**2 + (u * t) ** 2) / (4 * k * t)
    far = np.exp(np.minimum(exponent, 0.0)) * scipy.special.erfcx((r + u * t) / root)
    return np.asarray((near + far) / (8 * np.pi * k * r))
