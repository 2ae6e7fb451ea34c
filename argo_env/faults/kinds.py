"""All kinds of faults, the model of a file of faults, and functions that resolve lists of faults.

A new kind is a class in another module of this package, and is listed here; its names for the page
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
"""Any fault; this union is the list of all kinds."""

KINDS: dict[str, type[Fault]] = {
    str(model.model_fields["kind"].default): model for model in get_args(get_args(AnyFault)[0])
}
"""The kinds of faults by name."""


class FaultFile(Model):
    """A file of faults."""

    faults: tuple[AnyFault, ...]
    """faults, each with its `kind`; the seed draws the fields that are not given"""


def resolve_faults(faults: Sequence[AnyFault], site: Site, seed: int) -> tuple[AnyFault, ...]:
    """Return the faults resolved; the seed of each, or else the run's `seed`, draws its fields.

    Raises ArgoError, with the fault's index in the list, if the site does not have the place,
    checkpoint or pump of a fault.
    """
    return tuple(_resolve_in_list(fault, number, site, seed) for number, fault in enumerate(faults))


def resolve_fault(fault: AnyFault, number: int, site: Site, seed: int) -> AnyFault:
    """Return the resolved fault as `resolve_faults` would, at index `number` of its list."""
    own = seed if fault.seed is None else fault.seed
    rng = generator(own, "fault", fault.kind, number if fault.seed is None else 0)
    return fault.resolve_for(site, rng)


def find_site_errors(faults: Sequence[AnyFault], site: Site, seed: int) -> dict[int, str]:
    """Return the error of each fault that does not fit the site, by its index in the list."""
    errors = {}
    for number, fault in enumerate(faults):
        try:
            _resolve_in_list(fault, number, site, seed)
        except ArgoError as error:
            errors[number] = str(error)
    return errors


def _resolve_in_list(fault: AnyFault, number: int, site: Site, seed: int) -> AnyFault:
    try:
        return resolve_fault(fault, number, site, seed)
    except ArgoError as error:
        raise type(error)(f"faults[{number}] ({fault.kind}): {error}") from None


def site_with_faults(site: Site, faults: Sequence[AnyFault]) -> Site:
    """Return the site with the changes of resolved faults, such as added bricks, made in a copy."""
    for fault in faults:
        site = site.replacing_elements(fault.site_elements_with_fault(site))
    return site
