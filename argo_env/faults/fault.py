"""What all faults have in common: when they are there, and how the seed draws what is left out."""

from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.seeding import draw
from argo_env.site import Site
from argo_env.site.shapes import Element, Vector

if TYPE_CHECKING:  # the models of faults are read by much that runs no simulation
    from argo_env.faults.targets import FaultTargets

LATEST = 120.0
"""s, up to which the seed draws the time of a fault that has none"""


class Sign(NamedTuple):
    """What a fault shows as."""

    event: EventKind
    source: str
    """the name of the watch that finds it, or `reading`"""
    outlasts: float = 1.0
    """s after the fault's end in which it may still be found"""


class Fault(Model):
    """Something that goes wrong. Fields that are None are drawn by the seed."""

    kind: str
    seed: int | None = Field(default=None, ge=0)
    """draws what is left out; None: the run's seed"""

    sign: ClassVar[Sign | None]
    """as what it is found; None: nothing finds it"""
    needs_world: ClassVar[bool] = False
    """whether only a drive with a world has anything that shows it"""
    adds_up: ClassVar[bool] = False
    """whether its effect is its own, and stays when another fault of its kind ends"""

    @model_serializer(mode="wrap")
    def _with_kind(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # Also where defaults are left out: without it nobody knows what it is.
        return {"kind": self.kind, **handler(self)}

    @property
    def begins(self) -> float:
        """When it begins (s)."""
        return 0.0

    @property
    def ends(self) -> float | None:
        """When it ends (s); None: never."""
        return None

    def settled(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        """The same fault, with all that was left out drawn.

        Raises ArgoError if the site has no such place, checkpoint or pump.
        """
        return self

    def changed(self, site: Site) -> tuple[Element, ...]:
        """The site's elements as they are with this fault."""
        return site.elements

    def is_at(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        """Return whether the settled fault may be what was found at a place of the site, or was
        noticed from one; both are in m, and None where the finding tells none.
        """
        return True

    def begin(self, targets: "FaultTargets", now: float) -> None:
        """Takes effect at time `now` (s).

        One that does not add up does so again each time that another one of its kind has ended.
        """

    def end(self, targets: "FaultTargets", now: float) -> None:
        """Takes the effect back; one that does not add up, that of all of its kind."""

    def _with(self, **fields: Any) -> Self:
        return self.model_copy(update=fields)

    def _filled(self, **drawn: Any) -> Self:
        """The same fault, with what was `drawn` for the fields that are None."""
        return self._with(**{name: v for name, v in drawn.items() if getattr(self, name) is None})


class TimedFault(Fault):
    """A fault that begins during the run, and may end."""

    at: float | None = Field(default=None, ge=0)
    """s, when it begins; None: the seed draws it, up to 120 s"""
    until: float | None = Field(default=None, gt=0)
    """s, when it ends; None: it stays"""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.at is not None and self.until is not None and self.until <= self.at:
            raise ValueError(f"it ends at {self.until:g} s, before it begins at {self.at:g} s")
        return self

    @property
    def begins(self) -> float:
        return self.at or 0.0

    @property
    def ends(self) -> float | None:
        return self.until

    def settled(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        latest = LATEST if self.until is None else min(LATEST, self.until)
        drawn = draw(rng, 0.0, latest, 1)
        return self._filled(at=max(0.0, min(drawn, latest - 0.1)))
