"""Base classes of faults: start, end and effect, and fields that a seed draws."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.seeding import draw
from argo_env.site import Site
from argo_env.site.shapes import Element, Vector

if TYPE_CHECKING:  # many modules load the models of faults without running a simulation
    from argo_env.faults.targets import FaultTargets

LATEST = 120.0
"""s, latest start of a fault whose start the seed draws"""


def in_unit(unit: str) -> dict[str, Any]:
    """Return the unit of a field for its JSON Schema; `1` is a share of a whole."""
    return {"unit": unit}


class Sign(NamedTuple):
    """Detection that a fault leads to."""

    event: EventKind
    source: str
    """name of the watch that detects the fault, or `reading`"""
    outlasts: float = 1.0
    """s after the fault's end within which it may still be detected"""


class Fault(Model):
    """A fault. `resolve_for` draws fields that are None, unless None has a meaning of its own."""

    kind: str
    seed: int | None = Field(default=None, ge=0)
    """seed that draws the fields that are not given; None: the run's seed"""

    sign: ClassVar[Sign | None]
    """detection that it leads to; None: it is not detected"""
    needs_world: ClassVar[bool] = False
    """True if it can be detected only with a drive that has a world"""
    adds_up: ClassVar[bool] = False
    """True if its effect is independent of other faults of its kind, and stays when they end"""

    @model_validator(mode="before")
    @classmethod
    def _with_tuples(cls, data: Any) -> Any:
        """Make lists tuples: strict validation of a request's JSON does not do so in a fault."""
        if not isinstance(data, dict):
            return data
        return {name: tuple(v) if isinstance(v, list) else v for name, v in data.items()}

    @model_serializer(mode="wrap")
    def _with_kind(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # Written even if defaults are left out, since a fault can't be parsed without its kind.
        return {"kind": self.kind, **handler(self)}

    @property
    def start_time(self) -> float:
        """Time in s at which it begins."""
        return 0.0

    @property
    def end_time(self) -> float | None:
        """Time in s at which it ends, or None if it never ends."""
        return None

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:  # noqa: ARG003
        """Return the values that the site allows, for fields that name a part of it."""
        return {}

    @classmethod
    def limits_on(cls, site: Site) -> Mapping[str, tuple[Vector, Vector]]:  # noqa: ARG003
        """Return the lowest and highest values that the site allows, for fields with vectors."""
        return {}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        """Return a resolved copy of the fault, in which `rng` has drawn the fields left to chance.

        Raises ArgoError if the site does not have the place, checkpoint or pump of the fault.
        """
        return self

    def site_elements_with_fault(self, site: Site) -> tuple[Element, ...]:
        """Return all elements of the site, as this fault changes them; it must be resolved."""
        return site.elements

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        """Return True if the resolved fault may be the cause of a finding.

        Args:
            place: position of the finding in m; None if it is unknown.
            noticed_from: position of the robot in m; None if the finding has none. If the fault's
                location has to match a position that is None, the result is False.
            site: site of the run.
        """
        return True

    def apply(self, targets: "FaultTargets", now: float) -> None:
        """Apply the fault's effect at time `now` (s).

        Unless `adds_up` is True, it is applied again when another fault of its kind has ended.
        """

    def revert(self, targets: "FaultTargets", now: float) -> None:
        """Revert the fault's effect at time `now` (s).

        Unless `adds_up` is True, this also reverts the effects of other faults of its kind.
        """

    def _copy_with(self, **fields: Any) -> Self:
        return self.model_copy(update=fields)

    def fill_unset(self, **drawn: Any) -> Self:
        """Return the fault with the `drawn` values in those fields that are None."""
        return self._copy_with(
            **{name: v for name, v in drawn.items() if getattr(self, name) is None}
        )


class TimedFault(Fault):
    """A fault that begins during the run, and may end."""

    at: float | None = Field(default=None, ge=0, json_schema_extra=in_unit("s"))
    """s, when it begins; None: the seed draws it, up to 120 s"""
    until: float | None = Field(default=None, gt=0, json_schema_extra=in_unit("s"))
    """s, when it ends; None: it never ends"""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.at is not None and self.until is not None and self.until <= self.at:
            raise ValueError(
                f"it ends at {self.until:g} s, but begins at {self.at:g} s; it must end later"
            )
        return self

    @property
    def start_time(self) -> float:
        return self.at or 0.0

    @property
    def end_time(self) -> float | None:
        return self.until

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        latest = LATEST if self.until is None else min(LATEST, self.until)
        drawn = draw(rng, 0.0, latest, 1)
        return self.fill_unset(at=max(0.0, min(drawn, latest - 0.1)))
