"""Requirements on rates, such as `success >= 0.98`."""

import re
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_env.evaluation.quantities import QUANTITIES

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow

_FORM = re.compile(r"\s*([a-z_ ]+?)\s*(>=|<=)\s*([0-9.]+)\s*(%?)\s*")


class RateRequirement(Model):
    """Requirement that a quantity's rate is at least, or at most, a given share."""

    quantity: str
    """name in `QUANTITIES`"""
    at_least: bool
    """True: the rate must be at least the share; False: at most"""
    share: float = Field(gt=0, lt=1)

    @model_validator(mode="after")
    def _known(self) -> "RateRequirement":
        if self.quantity not in QUANTITIES:
            known = Listing(QUANTITIES)
            raise ValueError(f"no quantity `{self.quantity}`; there are: {known}")
        return self

    def __str__(self) -> str:
        return f"{self.quantity} {'>=' if self.at_least else '<='} {self.share:g}"

    def value_or_violation_if_lost(self, row: "RunRow") -> bool | None:
        """Return True if a run has the quantity, such as a contact; None if the run does not count.

        A run that could not be carried out gets the value that counts against the requirement.
        """
        if not row.is_completed:
            return not self.at_least
        return QUANTITIES[self.quantity](row)


def parse_requirement(text: str) -> RateRequirement:
    """Parse a requirement as people write it: `success >= 0.98`, `contact <= 1 %`.

    Raises Invalid if it is no requirement, or if no number of runs can decide it.
    """
    match = _FORM.fullmatch(text)
    if match is None:
        raise Invalid(
            Message(
                "requirement `{text}`: write it as `success >= 0.98`, with one of: {quantities}",
                text=text,
                quantities=Listing(QUANTITIES),
            )
        )
    name, sign, number, percent = match.groups()
    if name not in QUANTITIES:
        known = Listing(QUANTITIES)
        raise Invalid(
            Message(
                "requirement `{text}`: no quantity `{name}`; there are: {known}",
                text=text,
                name=name,
                known=known,
            )
        )
    try:
        share = float(number) / (100.0 if percent else 1.0)
    except ValueError:
        raise Invalid(
            Message("requirement `{text}`: `{number}` is not a number", text=text, number=number)
        ) from None
    if not 0 < share < 1:
        raise Invalid(
            Message(
                "requirement `{text}`: give a share above 0 and below 1; no number of runs "
                "can show that something is always or never the case",
                text=text,
            )
        )
    return RateRequirement(quantity=name, at_least=sign == ">=", share=share)
