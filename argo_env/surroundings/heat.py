"""Heat: how warm the surfaces of the site are.

A surface takes up the sun by the cosine of its angle to it (Lambert), so its excess over the air is
g max(0, n·s) with a gain g for each material. The gains are our choice: a painted vessel that faces
a clear sky's sun is 25 K warmer than the air. A running pump's motor is 40 K warmer than the air.
"""

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Role
from argo_env.surroundings.surroundings import Weather

SUN_GAIN: dict[Role, float] = {
    Role.GROUND: 20.0,
    Role.DECK: 15.0,
    Role.STAIR: 15.0,
    Role.RAILING: 15.0,
    Role.VESSEL: 25.0,
    Role.PIPE: 25.0,
    Role.PUMP: 5.0,
    Role.STRUCTURE: 15.0,
    Role.DOCK: 15.0,
}
"""K, of a surface that faces the sun"""
OWN_HEAT: dict[Role, float] = {Role.PUMP: 40.0}
"""K over the air, of what runs"""
SKY_DEFICIT = 25.0
"""K that the sky is colder than the air"""


def temperatures(
    roles: list[Role | None], normals: NDArray[np.float64], weather: Weather
) -> NDArray[np.float64]:
    """°C of surfaces with the given roles (None: the sky) and outward normals, shape (n, 3)."""
    facing = np.maximum(normals @ np.array(weather.sun), 0.0)
    gain = np.array([0.0 if r is None else SUN_GAIN[r] for r in roles])
    own = np.array([-SKY_DEFICIT if r is None else OWN_HEAT.get(r, 0.0) for r in roles])
    return np.asarray(weather.temperature + own + gain * facing)


def warmest(role: Role | None, air: float) -> float:
    """°C that a sound surface can have at most when the air has `air` °C."""
    return air if role is None else air + SUN_GAIN[role] + OWN_HEAT.get(role, 0.0)
