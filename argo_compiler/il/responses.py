"""Responses of reactions: Argo's own, and the extension point of those of installed packages.

A response of a package is a name for fields of a reaction: a function of the reaction's event
returns them, among them one of Argo's own responses. Fields that are given besides the name replace
those. So a mission that was read has Argo's own responses only, which all checks, exports and
proofs know.
"""

from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.extensions import ExtensionPoint, function_problem
from argo_compiler.base.message import Message
from argo_compiler.il.events import EventKind


class Response(StrEnum):
    """Response of a reaction. Each of them reports the event first."""

    REPORT = "report"
    """nothing else; the mission is not affected"""
    PAUSE = "pause"
    """stop and stand still"""
    RETURN = "return"
    """drive to the mission's `dock`"""
    SAFE_AREA = "safe_area"
    """drive to the reaction's `pose`"""
    ABORT = "abort"
    """end the mission where the robot stands"""

    @property
    def drives(self) -> bool:
        """True if the robot drives to a pose."""
        return self in (Response.RETURN, Response.SAFE_AREA)


_OWN = tuple(Response)
_EVENTS = tuple(EventKind)

RESPONSES: ExtensionPoint[Callable[[EventKind], Mapping[str, object]]] = ExtensionPoint(
    "argo.responses", "response", {}, function_problem, reserved=_OWN
)
"""responses of installed packages by name"""


def expand_response(fields: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the fields of a reaction with Argo's own response in place of a package's.

    Returns them unchanged if no package offers the response. Raises ValueError if a package's
    can't be used, or returns what is no reaction.
    """
    name, event = fields.get("response"), fields.get("event")
    if not isinstance(name, str) or name in _OWN or name not in RESPONSES:
        return fields
    if event not in _EVENTS:
        return {**fields, "response": Response.REPORT}  # its event is refused
    try:
        made = RESPONSES[name](EventKind(event))
    except ArgoError as error:
        raise ValueError(str(error)) from None
    except Exception as error:  # another package may raise anything
        raise ValueError(f"{_title(name)} has failed ({type(error).__name__}: {error})") from error
    if not isinstance(made, Mapping) or made.get("response") not in _OWN:
        raise ValueError(
            f"{_title(name)} has to return fields of a reaction, with `response` {', '.join(_OWN)}"
        )
    return {**made, **{k: v for k, v in fields.items() if k != "response"}}


def _title(name: str) -> str:
    return Message(
        "the response `{name}` of {package_of}", name=name, package_of=RESPONSES.package_of(name)
    )
