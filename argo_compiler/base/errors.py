"""What goes wrong by the input or the request, in kinds that a program can tell apart.

Every message names the thing, the place and the way out, in no front end's words; the command adds
its own, prints it and exits with status 2. Anything else that is raised is a defect of Argo.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from argo_compiler.base.listing import listed


class Remedy(StrEnum):
    """What can be done about an error, for a front end that says in its own words how."""

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


@dataclass(frozen=True)
class RemedyChoice:
    """The values that a remedy offers to choose from; as text, the words of a hint."""

    remedy: Remedy
    what: str
    """such as `area` or `the site`"""
    values: tuple[str, ...]

    def __str__(self) -> str:
        return f"choose {self.what} {listed(self.values, 'or')}"


class ArgoError(Exception):
    """Bad input or an impossible request: what all the others are kinds of.

    The `remedies` are for front ends; the message makes sense without. `about` is what they need,
    such as the file that the remedy works on.
    """

    code: ClassVar[str] = "error"
    """the kind, as programs and services name it; stable"""

    def __init__(
        self, *message: object, remedies: tuple[Remedy, ...] = (), about: str = ""
    ) -> None:
        super().__init__(*message)
        self.remedies = remedies
        self.about = about


class NotFound(ArgoError):
    """Something is named that is not there: a site, a task, a checkpoint, a file."""

    code = "not-found"


class Invalid(ArgoError):
    """What was given makes no sense, whatever else is there: text, a value, a combination."""

    code = "invalid"


class Unreachable(ArgoError):
    """There is no way to where the robot should go."""

    code = "unreachable"


class Conflict(ArgoError):
    """The request does not fit how things stand now: a file that is there already or in use, a run
    whose mission has changed, an edit that something is in the way of."""

    code = "conflict"


class Unavailable(ArgoError):
    """This machine lacks what it takes: an optional package, a display, room on the disk."""

    code = "unavailable"


def located(error: ArgoError, name: str) -> ArgoError:
    """An error of the same kind whose message begins with the name of what it is about."""
    kinds = (NotFound, Invalid, Unreachable, Conflict, Unavailable)
    kind = next((kind for kind in kinds if isinstance(error, kind)), ArgoError)
    return kind(f"{name}: {error}", remedies=error.remedies, about=error.about)
