"""Fault: the lens of the camera fogs up, so that readings become noisy."""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from argo_compiler.il import EventKind
from argo_env.faults.fault import Sign, TimedFault
from argo_env.faults.targets import FaultTargets
from argo_env.site import Site


class FoggedLens(TimedFault):
    """Fog on the camera's lens, from `at` until `until`."""

    sign: ClassVar[Sign] = Sign(EventKind.DYSFUNCTION, "camera")
    kind: Literal["fogged_lens"] = "fogged_lens"
    density: float | None = Field(default=None, gt=0, le=1)
    """0 to 1; None: the seed draws it"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        density = round(float(rng.uniform(0.2, 1.0)), 2)
        return super().resolve_for(site, rng).fill_unset(density=density)

    def apply(self, targets: FaultTargets, now: float) -> None:  # noqa: ARG002
        targets.sensor.noise = 0.2 * (self.density or 0.0)

    def revert(self, targets: FaultTargets, now: float) -> None:  # noqa: ARG002
        targets.sensor.noise = targets.sensor.usual_noise
