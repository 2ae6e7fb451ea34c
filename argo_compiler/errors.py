"""What goes wrong by the input or the request, in kinds that a program can tell apart.

Every message names the thing, the place and the way out; the command prints it and exits with
status 2. Anything else that is raised is a defect of Argo.
"""

from typing import ClassVar


class ArgoError(Exception):
    """Bad input or an impossible request: what all the others are kinds of."""

    code: ClassVar[str] = "error"
    """the kind, as programs and services name it; stable"""


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
