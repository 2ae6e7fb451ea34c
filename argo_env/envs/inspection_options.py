"""What the caller of Inspect-v0 may ask for, and the faults that are drawn."""

from typing import Annotated, cast

import numpy as np
from pydantic import Field, StrictInt

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Model
from argo_env.drives.route import RouteDrive
from argo_env.faults.kinds import KINDS, AnyFault, settle
from argo_env.faults.robot import EmergencyStop
from argo_env.seeding import draw
from argo_env.site import Site

MOST_FAULTS = 8
_Count = Annotated[int, Field(ge=0, le=MOST_FAULTS, strict=True)]


class InspectOptions(Model):
    """What `reset(options=...)` of Inspect-v0 may say."""

    scenario: str | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: _Count | tuple[AnyFault, ...] | None = None
    seed: int | None = Field(default=None, ge=0, strict=True)

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


def draw_faults(
    count: int, drive: str, site: Site, rng: np.random.Generator
) -> tuple[AnyFault, ...]:
    """Up to `count` faults of different kinds, of those that the drive can find and the site
    can have."""
    paper = drive == RouteDrive.name
    kinds = [
        kind
        for kind, model in KINDS.items()
        if not (model.needs_world and paper) and _fits(kind, site)
    ]
    drawn = [kinds[k] for k in rng.permutation(len(kinds))[:count]]
    return tuple(_fault(kind, rng) for kind in drawn)


def _fits(kind: str, site: Site) -> bool:
    """Whether the site has what such a fault needs, such as a pump or stairs."""
    try:
        settle([cast("AnyFault", KINDS[kind].model_validate({}))], site, 0)
    except ArgoError:
        return False
    return True


def _fault(kind: str, rng: np.random.Generator) -> AnyFault:
    """A fault of that kind, what matters drawn by the run's seed; someone releases an emergency
    stop after a minute."""
    if kind == "emergency_stop":
        at = draw(rng, 0.0, 600.0, 1)
        return EmergencyStop(at=at, until=at + 60.0)
    return cast("AnyFault", KINDS[kind].model_validate({}))
