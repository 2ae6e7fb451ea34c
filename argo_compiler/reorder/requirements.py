"""What is asked of an order beside what its mission says."""

import re
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.model import Model

_PART = re.compile(r"\s*(\d+(?:\.\d+)?)\s*(h|hours?|min|minutes?|'|s|seconds?)?(?![^\W\d])")
_SECONDS = {"h": 3600.0, "m": 60.0, "'": 60.0, "s": 1.0}


def parse_seconds(text: str) -> float:
    """Seconds of `20 min`, `1 h 30 min`, `90 s` or `90`. Raises ArgoError if it is no duration."""
    total, at = 0.0, 0
    scale = 2 * _SECONDS["h"]
    text = text.strip()
    if text.startswith("-"):
        raise Invalid(f"`{text}` must be above 0: write `20 min`, `1 h 30 min` or `90 s`")
    while at < len(text):
        part = _PART.match(text, at)
        factor = _SECONDS[(part.group(2) or "s")[0]] if part else scale
        if part is None or factor >= scale:  # larger units come first, each once
            raise Invalid(f"`{text}` is no duration: write `20 min`, `1 h 30 min` or `90 s`")
        total, at, scale = total + float(part.group(1)) * factor, part.end(), factor
    if not text:
        raise Invalid("a duration is missing: write `20 min`, `1 h 30 min` or `90 s`")
    return total


def _seconds(value: object) -> object:
    if not isinstance(value, str):
        return value
    try:
        return parse_seconds(value)
    except ArgoError as error:
        raise ValueError(str(error)) from None


Seconds = Annotated[float, BeforeValidator(_seconds), Field(ge=0.0, le=1e7)]
"""s, up to 115 days: longer than any mission, and short enough to be reckoned in whole units"""
What = Annotated[int, Field(strict=True, ge=1)] | Annotated[str, Field(min_length=1)]
"""The number of a checkpoint, or the name of a task or group."""


def _distinct(sequence: tuple[What, ...]) -> tuple[What, ...]:
    if len(set(map(str, sequence))) < len(sequence):
        listed = ", ".join(map(str, sequence))
        raise ValueError(f"`{listed}` names something twice: nothing comes before itself")
    return sequence


Sequence = Annotated[tuple[What, ...], Field(min_length=2), AfterValidator(_distinct)]


class Priority(Model):
    """Something that may be left out."""

    what: What
    priority: int = Field(default=1, ge=1, le=1_000_000)
    """what it is worth, of a group each of its tasks: as much as possible is won in sum"""


class RequiredWindow(Model):
    """When something is to be done, as a hard window of its task: counted from the mission's start,
    begun at the place not before `earliest`, and ended by `latest`."""

    what: What
    earliest: Seconds = 0.0
    latest: Annotated[Seconds, Field(gt=0.0)] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> "RequiredWindow":
        if self.latest is not None and self.latest <= self.earliest:
            raise ValueError(f"latest {self.latest:g} s is not after earliest {self.earliest:g} s")
        return self


class Likelihood(Model):
    """How likely it is that a task goes on to another one by its conditions."""

    task: str
    target: str
    probability: float = Field(ge=0.0, le=1.0)


class Requirements(Model):
    """What an order has to keep to beside its mission."""

    budget: Seconds | None = Field(default=None, gt=0.0)
    """s in which the mission has to be over. With it, all that is not `mandatory` may be left out,
    with the priorities of the tasks"""
    keep_order: bool = False
    """whether nothing changes places, even if the mission allows any order"""
    mandatory: tuple[What, ...] = ()
    """not left out, whatever the mission says"""
    optional: tuple[Priority, ...] = ()
    """may be left out, whatever the mission says"""
    before: tuple[Sequence, ...] = ()
    """sequences in which each comes before all that follow, whichever of them are left out"""
    windows: tuple[RequiredWindow, ...] = ()
    """in the place of those that the mission's tasks have"""
    likelihoods: tuple[Likelihood, ...] = ()
    """where all conditional ways of a task have one, its ways are reckoned on average, not in the
    worst case"""
