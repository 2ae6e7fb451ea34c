"""All kinds of faults, and what a file of faults may say.

A new kind is a class in one of the files beside this, and is listed here; its words for the page
are in `argo_planner/page/src/texts/run.ts`.
"""

from collections.abc import Sequence
from typing import Annotated, get_args

from pydantic import Field

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Model
from argo_env.faults.checkpoints import AbnormalValue, DisplacedCheckpoint
from argo_env.faults.fault import Fault
from argo_env.faults.plant import AbnormalPump, GasLeakFault, HotSpotFault, PlatformAlarm
from argo_env.faults.robot import (
    ConnectionLoss,
    DriveDysfunction,
    EmergencyStop,
    LowBattery,
    SensorDysfunction,
    WornBattery,
)
from argo_env.faults.walkway import BlockedStairs, Brick, MissingPlate
from argo_env.seeding import generator
from argo_env.site import Site

AnyFault = Annotated[
    AbnormalValue
    | DisplacedCheckpoint
    | GasLeakFault
    | HotSpotFault
    | AbnormalPump
    | PlatformAlarm
    | Brick
    | MissingPlate
    | BlockedStairs
    | LowBattery
    | WornBattery
    | ConnectionLoss
    | EmergencyStop
    | SensorDysfunction
    | DriveDysfunction,
    Field(discriminator="kind"),
]
"""any fault: this union is the list of the kinds"""

KINDS: dict[str, type[Fault]] = {
    str(model.model_fields["kind"].default): model for model in get_args(get_args(AnyFault)[0])
}
"""The kinds of faults by name."""


class FaultFile(Model):
    """A file of faults."""

    faults: tuple[AnyFault, ...]
    """what goes wrong; each by its `kind`, and what is left out is drawn by the seed"""


def settle(faults: Sequence[AnyFault], site: Site, seed: int) -> tuple[AnyFault, ...]:
    """The faults with all that was left out drawn: each by its own seed, or by the run's.

    Raises ArgoError, with the place in the list, for what the site does not have.
    """
    return tuple(_settled(fault, number, site, seed) for number, fault in enumerate(faults))


def settle_one(fault: AnyFault, number: int, site: Site, seed: int) -> AnyFault:
    """The fault as `settle` would have it at that place of a list."""
    own = seed if fault.seed is None else fault.seed
    rng = generator(own, "fault", fault.kind, number if fault.seed is None else 0)
    return fault.settled(site, rng)


def misfits(faults: Sequence[AnyFault], site: Site, seed: int) -> dict[int, str]:
    """What the site does not have of each fault, by its number in the list."""
    found = {}
    for number, fault in enumerate(faults):
        try:
            _settled(fault, number, site, seed)
        except ArgoError as error:
            found[number] = str(error)
    return found


def _settled(fault: AnyFault, number: int, site: Site, seed: int) -> AnyFault:
    try:
        return settle_one(fault, number, site, seed)
    except ArgoError as error:
        raise type(error)(f"faults[{number}] ({fault.kind}): {error}") from None


def changed_site(site: Site, faults: Sequence[AnyFault]) -> Site:
    """The site as it really is with settled faults: bricks lie on it, and plates are missing."""
    for fault in faults:
        site = site.with_elements(fault.changed(site))
    return site
