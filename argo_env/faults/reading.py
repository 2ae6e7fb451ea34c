"""Reads faults from YAML, with errors that say where it is wrong; also distributions, of faults
that come with a probability."""

import math
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field, model_validator

from argo_compiler.base.model import Model
from argo_compiler.files.json_places import JsonPath
from argo_compiler.files.loading import decode_text, read_bytes, require_size
from argo_env.faults.kinds import AnyFault, FaultFile, misfits
from argo_env.files.yaml_file import parse_yaml, placed
from argo_env.seeding import generator
from argo_env.site import Site

MAX_BYTES = 10_000_000
"""of a file of faults; one takes some hundred bytes"""


@dataclass(frozen=True)
class FaultText:
    """Faults, with the text that they were read from and what it is called."""

    faults: tuple[AnyFault, ...]
    text: str
    source_name: str

    def require_fit(self, site: Site, seed: int) -> None:
        """Raises DiagnosticError, with the lines, if the site does not have what these faults are
        about. `seed` is the run's."""
        if found := misfits(self.faults, site, seed):
            places: dict[JsonPath, str] = {("faults", k): said for k, said in found.items()}
            raise placed(self.text, self.source_name, "faults.not-on-site", places)


def read_faults(path: Path) -> tuple[AnyFault, ...]:
    """The faults in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it holds no faults.
    """
    return decode_faults(read_bytes(path, "file of faults", MAX_BYTES), str(path)).faults


def decode_faults(content: bytes, source_name: str) -> FaultText:
    """The faults in YAML, which messages call `source_name`. Raises as `read_faults`."""
    require_size(content, source_name, "file of faults", MAX_BYTES)
    text = decode_text(content, source_name, "file of faults")
    found = parse_yaml(
        text,
        source_name,
        FaultFile,
        "faults",
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
        no_field={
            "at": "a fault of this kind is there from the start: remove it",
            "until": "a fault of this kind is there from the start, and stays: remove it",
        },
    )
    return FaultText(found.faults, text, source_name)


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
