"""Errors by the input or the request, in kinds that a program can tell apart.

Every message states the thing, the place and the way out, in words of no particular front end; the
command adds its own words, prints them and exits with status 2. Any other exception is a defect of
Argo.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from argo_compiler.base.message import Message, as_message

INCOMPLETE = "incomplete"
"""code of the error of a draft with lines that are left to decide on"""


class Remedy(StrEnum):
    """Remedy for an error; each front end expresses it in its own words."""

    CHECK_MISSION = "check-mission"
    CHOOSE_AREAS = "choose-areas"
    CHOOSE_START = "choose-start"
    CHOOSE_END = "choose-end"
    CHOOSE_SITE = "choose-site"
    CHOOSE_OUTPUT = "choose-output"
    CHOOSE_PLAN = "choose-plan"
    FILM_INSTEAD = "film-instead"
    GIVE_BUDGET = "give-budget"
    SEARCH_LONGER = "search-longer"
    KEEP_JOURNAL = "keep-journal"
    RESUME = "resume"
    RUN_ANEW = "run-anew"
    RECORD = "record"
    REPLACE = "replace"
    REPLAY = "replay"
    SHOW_REST = "show-rest"
    TRUST = "trust"


@dataclass(frozen=True)
class RemedyChoice:
    """Values from which a remedy lets the user choose; as text, the words of a hint."""

    remedy: Remedy
    what: str
    """such as `area` or `the site`"""
    values: tuple[str, ...]

    def __str__(self) -> str:
        return Message("choose {what} {values:or}", what=self.what, values=self.values)


class ArgoError(Exception):
    """Error of bad input or an impossible request; the base class of all kinds.

    The `remedies` are for front ends; the message can be understood without them. `about` is the
    data that they need, such as the file that the remedy works on.
    """

    code: ClassVar[str] = "error"
    """name of the kind for programs and services; it never changes"""

    def __init__(
        self, *message: object, remedies: tuple[Remedy, ...] = (), about: str = ""
    ) -> None:
        super().__init__(*message)
        self.remedies = remedies
        self.about = about


class NotFound(ArgoError):
    """Error of a name of something that does not exist: a site, a task, a checkpoint, a file."""

    code = "not-found"


class Invalid(ArgoError):
    """Error of input that makes no sense in itself: a text, a value, a combination."""

    code = "invalid"


class Unreachable(ArgoError):
    """Error of a pose that the robot should go to, but to which there is no path."""

    code = "unreachable"


class Conflict(ArgoError):
    """Error of a request that does not fit the present state.

    Examples: a file that already exists or is in use, a run whose mission has changed, an edit that
    is blocked by something.
    """

    code = "conflict"


class Unavailable(ArgoError):
    """Error of a resource that this machine lacks: an optional package, a display, disk space."""

    code = "unavailable"


def with_message_prefix(error: ArgoError, prefix: str) -> ArgoError:
    """Return a new error of the same kind whose message begins with `prefix` and a colon.

    `prefix` is the thing that the error is about, such as a file.
    """
    kinds = (NotFound, Invalid, Unreachable, Conflict, Unavailable)
    kind = next((kind for kind in kinds if isinstance(error, kind)), ArgoError)
    message = Message("{prefix}: {error}", prefix=prefix, error=error)
    return kind(message, remedies=error.remedies, about=error.about)


def reason_text(error: Exception) -> Message:
    """Return why something failed in words, without the number that an OSError begins with."""
    return as_message(getattr(error, "strerror", None) or str(error))
