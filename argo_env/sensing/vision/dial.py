"""A dial gauge: a red needle over a round scale of 270 degrees."""

import math

import numpy as np

from argo_compiler.base.catalog import CheckpointKind
from argo_env.sensing.vision.faces import FACES
from argo_env.sensing.vision.instrument import Indicator, Instrument, grid, turned

_ALONG = np.linspace(0.010, 0.050, 21)  # m, of the needle that is looked at

DIAL = Instrument(
    kind=CheckpointKind.PRESSURE_GAUGE,
    shape=FACES[CheckpointKind.PRESSURE_GAUGE],
    rolled=True,
    hidden_radius=0.0,
    extent=0.08,
    outlines=((0.065, 0.065), (0.0575, 0.0575)),
    body=((-0.003, 0.069), (-0.010, 0.075), (-0.026, 0.075), (-0.043, 0.075), (-0.060, 0.075)),
    indicator=Indicator(
        body=grid(0.0, np.array([-0.0015, 0.0, 0.0015]), _ALONG),
        beside=grid(0.0, np.array([-0.010, -0.008, 0.008, 0.010]), _ALONG),
        low=math.radians(-135),
        high=math.radians(135),
        move=turned,
    ),
)
