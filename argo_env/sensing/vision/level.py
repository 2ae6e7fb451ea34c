"""A liquid level gauge: a red float in a glass beside a scale of 240 mm."""

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.catalog import CheckpointKind
from argo_env.sensing.vision.faces import FACES
from argo_env.sensing.vision.instrument import Indicator, Instrument, grid

_ACROSS = np.linspace(-0.012, 0.012, 7)  # m, of the float that is looked at


def _lifted(points: NDArray[np.float64], heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points moved up by heights (m), shape (m, n, 3)."""
    return np.asarray(points[None] + heights[:, None, None] * np.array([0.0, 0.0, 1.0]))


LEVEL = Instrument(
    kind=CheckpointKind.LIQUID_LEVEL_GAUGE,
    shape=FACES[CheckpointKind.LIQUID_LEVEL_GAUGE],
    rolled=False,
    hidden_radius=0.0,
    extent=0.17,
    outlines=((0.039, 0.154), (0.019, 0.135), (0.045, 0.160)),
    body=((-0.005, 0.045), (-0.023, 0.045), (-0.041, 0.045), (-0.060, 0.045)),
    indicator=Indicator(
        body=grid(0.0, _ACROSS, np.linspace(-0.006, 0.006, 7)),
        beside=grid(0.0, _ACROSS, np.array([-0.015, -0.013, 0.013, 0.015])),
        low=-0.12,
        high=0.12,
        move=_lifted,
    ),
)
