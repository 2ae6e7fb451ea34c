"""Requirements: what a rate must be, such as `success >= 0.98`."""

import re
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model
from argo_env.evaluation.statistics import QUANTITIES

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow

_FORM = re.compile(r"\s*([a-z_ ]+?)\s*(>=|<=)\s*([0-9.]+)\s*(%?)\s*")


class RateRequirement(Model):
    """How often something must, or may, be so."""

    quantity: str
    at_least: bool
    share: float = Field(gt=0, lt=1)

    @model_validator(mode="after")
    def _known(self) -> "RateRequirement":
        if self.quantity not in QUANTITIES:
            known = ", ".join(QUANTITIES)
            raise ValueError(f"nothing is known of `{self.quantity}`; there are: {known}")
        return self

    def __str__(self) -> str:
        return f"{self.quantity} {'>=' if self.at_least else '<='} {self.share:g}"

    def holds(self, row: "RunRow") -> bool | None:
        """Whether it is so in the run, None if the run does not count. One that could not be
        carried out counts against the requirement."""
        if not row.carried_out:
            return not self.at_least
        return QUANTITIES[self.quantity](row)


def parse_requirement(text: str) -> RateRequirement:
    """A requirement as people write it: `success >= 0.98`, `contact <= 1 %`. Raises Invalid."""
    found = _FORM.fullmatch(text)
    if found is None:
        raise Invalid(
            f"requirement `{text}`: write it as `success >= 0.98`, with one of: "
            f"{', '.join(QUANTITIES)}"
        )
    name, sign, number, percent = found.groups()
    if name not in QUANTITIES:
        known = ", ".join(QUANTITIES)
        raise Invalid(f"requirement `{text}`: nothing is known of `{name}`; there are: {known}")
    try:
        share = float(number) / (100.0 if percent else 1.0)
    except ValueError:
        raise Invalid(f"requirement `{text}`: {number} is no number") from None
    if not 0 < share < 1:
        raise Invalid(
            f"requirement `{text}`: give a share between 0 and 1; that something is always or "
            "never so can't be shown by any number of runs"
        )
    return RateRequirement(quantity=name, at_least=sign == ">=", share=share)
