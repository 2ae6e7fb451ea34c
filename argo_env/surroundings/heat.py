"""Temperatures of the site's surfaces.

A surface absorbs sunlight in proportion to the cosine of the angle between its normal n and the sun
s (Lambert), so it is g max(0, n·s) warmer than the air, with a gain g for each material. The gains
are a choice of this project: a painted vessel that faces the sun in a clear sky is 25 K warmer than
the air. The motor of a running pump is 40 K warmer than the air.
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
"""K by which a surface that faces the sun is warmer than the air"""
OWN_HEAT: dict[Role, float] = {Role.PUMP: 40.0}
"""K by which running machines are warmer than the air"""
SKY_DEFICIT = 25.0
"""K by which the sky is colder than the air"""


def surface_temperatures(
    roles: list[Role | None], normals: NDArray[np.float64], weather: Weather
) -> NDArray[np.float64]:
    """Return the temperatures (°C) of surfaces with these roles and outward normals, shape (n, 3).

    A role of None is the sky.
    """
    facing = np.maximum(normals @ np.array(weather.sun), 0.0)
    gain = np.array([0.0 if r is None else SUN_GAIN[r] for r in roles])
    own = np.array([-SKY_DEFICIT if r is None else OWN_HEAT.get(r, 0.0) for r in roles])
    return np.asarray(weather.temperature + own + gain * facing)


def highest_temperature_without_fault(role: Role | None, air: float) -> float:
    """Return the highest temperature (°C) that surfaces with a role have without a fault.

    `air` (°C) is the temperature of the air. A role of None is the sky, for which it is `air`.
    """
    return air if role is None else air + SUN_GAIN[role] + OWN_HEAT.get(role, 0.0)
