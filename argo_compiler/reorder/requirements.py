"""Requirements of an order that are not part of its mission."""

import re
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model

_PART = re.compile(r"\s*(\d+(?:\.\d+)?)\s*(h|hours?|min|minutes?|'|s|seconds?)?(?![^\W\d])")
_CLOCK = re.compile(r"(?:(\d+):)?(\d+):([0-5]\d)")
_SECONDS = {"h": 3600.0, "m": 60.0, "'": 60.0, "s": 1.0}


def parse_seconds(text: str) -> float:
    """Parse a duration such as `20 min`, `1 h 30 min`, `00:12:30`, `90 s` or `90`, in s.

    Raises Invalid for other texts, and for `12:30`, which has two meanings, as in scripts.
    """
    total, at = 0.0, 0
    scale = 2 * _SECONDS["h"]
    text = text.strip()
    if text.startswith("-"):
        raise Invalid(
            Message("`{text}` must be above 0: write `20 min`, `1 h 30 min` or `90 s`", text=text)
        )
    if clock := _CLOCK.fullmatch(text):
        hours, first, last = (int(part or 0) for part in clock.groups())
        if clock.group(1) is None:
            raise Invalid(
                Message(
                    "`{text}` can be read as {first} min {last} s or as {first} h {last} min: "
                    "write one of these",
                    text=text,
                    first=first,
                    last=last,
                )
            )
        if first < 60:
            return 3600.0 * hours + 60.0 * first + last
    while at < len(text):
        part = _PART.match(text, at)
        factor = _SECONDS[(part.group(2) or "s")[0]] if part else scale
        if part is None or factor >= scale:  # larger units come first, each once
            raise Invalid(
                Message(
                    "`{text}` is not a duration: write `20 min`, `1 h 30 min` or `90 s`", text=text
                )
            )
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
"""s, up to 115 days: longer than any mission, and short enough to be counted in whole units"""
MissionPart = Annotated[int, Field(strict=True, ge=1)] | Annotated[str, Field(min_length=1)]
"""number of a checkpoint, or name of a task or group"""


def _distinct(sequence: tuple[MissionPart, ...]) -> tuple[MissionPart, ...]:
    if len(set(map(str, sequence))) < len(sequence):
        listed = Listing(map(str, sequence))
        raise ValueError(f"`{listed}` names something twice: nothing comes before itself")
    return sequence


Sequence = Annotated[tuple[MissionPart, ...], Field(min_length=2), AfterValidator(_distinct)]


class Priority(Model):
    """Part of a mission that may be left out, with its priority."""

    what: MissionPart
    priority: int = Field(default=1, ge=1, le=1_000_000)
    """worth of the part, or of each task of a group; an order gets the largest possible sum"""


class RequiredWindow(Model):
    """Hard time window of a part of a mission, in s from the mission's start.

    Its action does not start before `earliest`, and has ended by `latest`.
    """

    what: MissionPart
    earliest: Seconds = 0.0
    latest: Annotated[Seconds, Field(gt=0.0)] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> "RequiredWindow":
        if self.latest is not None and self.latest <= self.earliest:
            raise ValueError(f"latest {self.latest:g} s is not after earliest {self.earliest:g} s")
        return self


class Likelihood(Model):
    """Probability of a conditional transition from one task to another."""

    task: str
    target: str
    probability: float = Field(ge=0.0, le=1.0)


class Requirements(Model):
    """Requirements that an order has to meet in addition to its mission."""

    budget: Seconds | None = Field(default=None, gt=0.0)
    """s within which the mission has to end. With a budget, all parts that are not `mandatory` may
    be left out, by the priorities of the tasks"""
    keep_order: bool = False
    """whether the written order is kept, even if the mission allows any order"""
    mandatory: tuple[MissionPart, ...] = ()
    """parts that must not be left out, even if the mission makes them optional"""
    optional: tuple[Priority, ...] = ()
    """parts that may be left out, even if the mission makes them mandatory"""
    before: tuple[Sequence, ...] = ()
    """sequences: each part comes before all later ones, even if some parts are left out"""
    windows: tuple[RequiredWindow, ...] = ()
    """windows that replace those of the mission's tasks"""
    likelihoods: tuple[Likelihood, ...] = ()
    """probabilities of transitions; a task whose conditional transitions all have one counts with
    its mean cost instead of the worst case"""
