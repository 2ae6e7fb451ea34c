"""A quarter-turn valve: a red lever over a plate with a mark for shut and one for open."""

import math

import numpy as np

from argo_compiler.base.catalog import CheckpointKind
from argo_env.sensing.vision.faces import FACES
from argo_env.sensing.vision.instrument import Indicator, Instrument, grid, turned

_ALONG = np.linspace(0.025, 0.150, 26)  # m, of the lever that is looked at
_MIDDLE = -0.004  # m, of its thickness

VALVE = Instrument(
    kind=CheckpointKind.VALVE,
    shape=FACES[CheckpointKind.VALVE],
    rolled=True,
    hidden_radius=0.052,
    extent=0.165,
    outlines=((0.080, 0.080),),
    body=((-0.013, 0.086), (-0.020, 0.086), (-0.040, 0.050), (-0.060, 0.050)),
    indicator=Indicator(
        body=grid(_MIDDLE, np.linspace(-0.008, 0.008, 5), _ALONG),
        beside=grid(_MIDDLE, np.array([-0.026, -0.022, 0.022, 0.026]), _ALONG),
        low=0.0,
        high=math.radians(90),
        move=turned,
    ),
)
