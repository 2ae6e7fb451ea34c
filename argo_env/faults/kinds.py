"""All kinds of faults, the model of a file of faults, and functions that resolve lists of faults.

A new kind of Argo is a class in another module of this package, and is listed here; its names for
the page are in `argo_planner/page/src/texts/run.ts`. Installed packages offer further kinds.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import Field, SerializeAsAny, ValidatorFunctionWrapHandler, WrapValidator

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.extensions import ExtensionPoint
from argo_compiler.base.message import Message
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

_OwnFault = Annotated[
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
"""Any fault of Argo; this union is the list of its kinds."""

KINDS: dict[str, type[Fault]] = {
    str(model.model_fields["kind"].default): model for model in get_args(get_args(_OwnFault)[0])
}
"""Argo's kinds of faults by name."""


def _find_problem(name: str, item: object) -> str | None:
    if not (isinstance(item, type) and issubclass(item, Fault)):
        return Message("is no subclass of `argo_env.faults.fault.Fault`")
    if item.model_fields["kind"].default != name:
        return Message('has no field `kind: Literal["{name}"] = "{name}"`', name=name)
    return None if hasattr(item, "sign") else Message("does not define `sign`")


FAULTS: ExtensionPoint[type[Fault]] = ExtensionPoint("argo.faults", "fault", KINDS, _find_problem)
"""All kinds of faults by name."""


def _validate(value: Any, validate_own: ValidatorFunctionWrapHandler) -> Fault:
    """Return the fault in `value`, of Argo's kinds or of an installed package's."""
    kind = value.kind if isinstance(value, Fault) else None
    if isinstance(value, dict):
        kind = value.get("kind")
    if not isinstance(kind, str) or kind in KINDS or kind not in FAULTS:
        fault: Fault = validate_own(value)
        return fault
    try:
        model = FAULTS[kind]
    except ArgoError as error:
        raise ValueError(str(error)) from None
    return model.model_validate(value)


if TYPE_CHECKING:
    AnyFault = Fault
else:  # so that JSON Schemas have the fields of all of Argo's kinds
    AnyFault = Annotated[_OwnFault, WrapValidator(_validate), SerializeAsAny()]
"""Any fault, also one of a kind that an installed package offers."""


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
        raise type(error)(
            Message(
                "faults[{number}] ({kind}): {error}", number=number, kind=fault.kind, error=error
            )
        ) from None


def site_with_faults(site: Site, faults: Sequence[AnyFault]) -> Site:
    """Return the site with the changes of resolved faults, such as added bricks, made in a copy."""
    for fault in faults:
        site = site.replacing_elements(fault.site_elements_with_fault(site))
    return site
