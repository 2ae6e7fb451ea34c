"""Faults that come with a probability: a distribution from a file."""

import math

from pydantic import Field, model_validator

from argo_compiler.base.model import Model
from argo_compiler.files.reading import decode_text, require_size
from argo_env.faults.kinds import AnyFault
from argo_env.faults.reading import MAX_BYTES
from argo_env.files.yaml_file import parse_yaml
from argo_env.seeding import generator

NOTHING = "nothing"
"""what the case is called in which nothing goes wrong"""


class FaultChance(Model):
    """Faults that occur together, and how often."""

    name: str = Field(min_length=1, max_length=100)
    probability: float = Field(gt=0, le=1)
    """of a mission in which just these faults occur"""
    faults: tuple[AnyFault, ...]
    """what goes wrong; what is left out is drawn by the seed"""


class FaultDistribution(Model):
    """What may go wrong in a mission, and how probable each is. In what is left nothing does."""

    chances: tuple[FaultChance, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _probabilities(self) -> "FaultDistribution":
        whole = math.fsum(one.probability for one in self.chances)
        if whole > 1 + 1e-9:
            raise ValueError(f"the probabilities add up to {whole:g}, and may be 1 at most")
        names = [one.name for one in self.chances]
        if len(set(names)) < len(names) or NOTHING in names:
            raise ValueError(f"each chance has a name of its own, which is not `{NOTHING}`")
        return self

    @property
    def nothing(self) -> float:
        """The probability that nothing goes wrong."""
        rest = 1.0 - math.fsum(one.probability for one in self.chances)
        return rest if rest > 1e-9 else 0.0

    def drawn(self, seed: int) -> FaultChance | None:
        """What goes wrong in the world of a seed; None: nothing does."""
        place = float(generator(seed, "which faults").random())
        for chance in self.chances:
            if place < chance.probability:
                return chance
            place -= chance.probability
        return None


def decode_distribution(content: bytes, source_name: str) -> FaultDistribution:
    """Return the distribution in YAML, which messages call `source_name`.

    Raises DiagnosticError if it holds none.
    """
    require_size(content, source_name, "distribution of faults", MAX_BYTES)
    return parse_yaml(
        decode_text(content, source_name, "distribution of faults"),
        source_name,
        FaultDistribution,
        "distributions of faults",
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
    )
