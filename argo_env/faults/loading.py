"""Loading of faults and of distributions of faults from YAML, with the lines of errors.

A distribution has sets of faults, each with a probability.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field, model_validator

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.json_places import JsonPath
from argo_compiler.files.loading import decode_text, read_bytes, require_size
from argo_env.faults.kinds import AnyFault, FaultFile, find_site_errors
from argo_env.files.yaml_file import error_at_paths, parse_yaml
from argo_env.seeding import generator
from argo_env.site import Site

MAX_BYTES = 10_000_000
"""limit for a file of faults; a fault needs a few hundred bytes"""


@dataclass(frozen=True)
class FaultText:
    """Faults, with the text that they were parsed from."""

    faults: tuple[AnyFault, ...]
    text: str
    source_name: str
    """name of the text in messages, such as its path"""

    def require_fit(self, site: Site, seed: int) -> None:
        """Raise DiagnosticError, with the lines, if these faults do not fit the site.

        `seed` is the run's.
        """
        if errors := find_site_errors(self.faults, site, seed):
            places: dict[JsonPath, str] = {("faults", k): error for k, error in errors.items()}
            raise error_at_paths(self.text, self.source_name, "faults.not-on-site", places)


def read_faults(path: Path) -> tuple[AnyFault, ...]:
    """Return the faults in a YAML file.

    Raises:
        ArgoError: the file can't be read.
        DiagnosticError: its content is not a list of faults.
    """
    return decode_faults(read_bytes(path, Message("file of faults"), MAX_BYTES), str(path)).faults


def decode_faults(content: bytes, source_name: str) -> FaultText:
    """Return the faults in the content of a YAML file, with the text that they are parsed from.

    Args:
        content: bytes of the file.
        source_name: name of the file in messages, such as its path.

    Raises:
        ArgoError: the content is too large or no text.
        DiagnosticError: the content is not a list of faults.
    """
    require_size(content, source_name, Message("file of faults"), MAX_BYTES)
    text = decode_text(content, source_name, Message("file of faults"))
    file = parse_yaml(
        text,
        source_name,
        FaultFile,
        "faults",
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
        no_field={
            "at": Message("a fault of this kind is there from the start: remove it"),
            "until": Message("a fault of this kind is there from the start, and stays: remove it"),
        },
    )
    return FaultText(file.faults, text, source_name)


NOTHING = "nothing"
"""name of the case without faults"""


class FaultChance(Model):
    """A set of faults that occur together, and its probability."""

    name: str = Field(min_length=1, max_length=100)
    probability: float = Field(gt=0, le=1)
    """of a mission with exactly these faults"""
    faults: tuple[AnyFault, ...]
    """faults; the seed draws the fields that are not given"""


class FaultDistribution(Model):
    """Distribution of sets of faults; the remaining probability is of a mission without faults."""

    chances: tuple[FaultChance, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _probabilities(self) -> "FaultDistribution":
        total = math.fsum(chance.probability for chance in self.chances)
        if total > 1 + 1e-9:
            raise ValueError(f"the probabilities add up to {total:g}, but may be 1 at most")
        names = [chance.name for chance in self.chances]
        if len(set(names)) < len(names) or NOTHING in names:
            raise ValueError(f"each entry of `chances` needs another `name`, and not `{NOTHING}`")
        return self

    @property
    def fault_free_probability(self) -> float:
        """Probability of a mission without faults."""
        rest = 1.0 - math.fsum(chance.probability for chance in self.chances)
        return rest if rest > 1e-9 else 0.0

    def draw(self, seed: int) -> FaultChance | None:
        """Return the set of faults that a seed draws by the probabilities; None means no faults."""
        number = float(generator(seed, "which faults").random())
        for chance in self.chances:
            if number < chance.probability:
                return chance
            number -= chance.probability
        return None


def decode_distribution(content: bytes, source_name: str) -> FaultDistribution:
    """Return the distribution of faults in the content of a YAML file.

    Args:
        content: bytes of the file.
        source_name: name of the file in messages, such as its path.

    Raises:
        ArgoError: the content is too large or no text.
        DiagnosticError: the content is not a distribution.
    """
    require_size(content, source_name, Message("distribution of faults"), MAX_BYTES)
    return parse_yaml(
        decode_text(content, source_name, Message("distribution of faults")),
        source_name,
        FaultDistribution,
        Message("distributions of faults"),
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
    )
