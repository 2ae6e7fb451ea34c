"""Families of generated sites: the parameters that define a site, and their text form."""

from collections.abc import Callable
from enum import StrEnum
from typing import Any

from pydantic import Field, ValidationError, field_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_env.files.yaml_messages import error_message

PREFIX = "generated:"
TEST_SEEDS = 1_000_000
"""Smallest seed for testing; smaller ones are for training."""
_SIZE = (12, 40)  # m, least and most of each edge


class Stairs(StrEnum):
    """Stair towers of a site; with both there are two independent paths from floor to floor."""

    STRAIGHT = "straight"
    """flights one above the other, on the west side"""
    DOG_LEG = "dog-leg"
    """flights that turn back at a half landing, on the east side"""
    BOTH = "both"


class Family(Model):
    """Parameters that define a generated site; equal parameters always give the same site.

    Seeds below TEST_SEEDS are for training, the others for testing.
    """

    floors: int = Field(3, ge=1, le=12)
    size: tuple[int, int] = (20, 14)
    """m from west to east and from south to north, of the decks"""
    stairs: Stairs = Stairs.BOTH
    clutter: float = Field(0.5, ge=0, le=1)
    """amount of vessels, pumps, pipes, barriers and platforms, from 0 (none) to 1"""
    checkpoints: int = Field(20, ge=0, le=500)
    """number of checkpoints on all floors together"""
    seed: int = Field(0, ge=0)

    @field_validator("size")
    @classmethod
    def _buildable(cls, size: tuple[int, int]) -> tuple[int, int]:
        least, most = _SIZE
        if not all(least <= edge <= most for edge in size):
            raise ValueError(
                "both lengths in `size`, from west to east and from south to north, have to be "
                f"{least} to {most} m"
            )
        return size

    @property
    def for_testing(self) -> bool:
        """True if the seed is TEST_SEEDS or higher: the site is for tests, not for training."""
        return self.seed >= TEST_SEEDS

    def __str__(self) -> str:
        width, depth = self.size
        return (
            f"{PREFIX}floors={self.floors},size={width}x{depth},stairs={self.stairs},"
            f"clutter={self.clutter:g},checkpoints={self.checkpoints},seed={self.seed}"
        )


def is_generated_name(name: str) -> bool:
    """Return True if a site's name begins as those of generated sites do, valid or not."""
    return name.startswith(PREFIX)


def parse_family(text: str) -> Family:
    """Return the parameters that a text such as `generated:floors=3,size=20x14,seed=7` gives.

    Those that it leaves out have their defaults. Raises ArgoError if the text is not valid; the
    message lists all parameters.
    """
    given: dict[str, Any] = {}
    for part in text.removeprefix(PREFIX).split(","):
        if not part.strip():
            continue
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or key not in Family.model_fields:
            raise _error(
                text, Message("`{strip}` is not one of its parameters", strip=part.strip())
            )
        if key in given:
            raise _error(text, Message("{key} is given twice", key=key))
        try:
            given[key] = _READERS[key](value)
        except ValueError:
            raise _error(text, Message("{key} can't be `{value}`", key=key, value=value)) from None
    try:
        return Family.model_validate(given)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        raise _error(text, error_message(fault, fault["loc"])) from None


def _size(text: str) -> tuple[int, int]:
    width, depth = text.split("x")
    return int(width), int(depth)


_READERS: dict[str, Callable[[str], Any]] = {
    "floors": int,
    "size": _size,
    "stairs": Stairs,
    "clutter": float,
    "checkpoints": int,
    "seed": int,
}


def _error(text: str, message: str) -> Invalid:
    least, most = _SIZE
    return Invalid(
        Message(
            "site `{text}`: {message}; write {prefix}floors=1..12,size=WxD ({least} to "
            "{most} m),stairs={stairs},clutter=0..1,checkpoints=0..500,seed=N, in any "
            "order, each of them optional",
            text=text,
            message=message,
            prefix=PREFIX,
            least=least,
            most=most,
            stairs="|".join(Stairs),
        )
    )
