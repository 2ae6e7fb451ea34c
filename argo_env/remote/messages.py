"""What Argo and a robot that is somewhere else tell each other. Times are s of the UNIX clock."""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from argo_compiler.base.model import Model, Pose
from argo_compiler.il import EventKind, Task


class StartOrder(Model):
    """Carry out the action of a task. An id that is known already is not begun again: if that
    action has ended, its end is told once more."""

    type: Literal["start"] = "start"
    id: str
    """of the action; none is given twice"""
    task: Task
    not_before: float | None = None
    """s, before which the robot does not begin at the place, but stands there"""


class CancelOrder(Model):
    """Stop the action, clean up, and tell its end. Means nothing to a robot that does not do it."""

    type: Literal["cancel"] = "cancel"
    id: str


class RobotState(Model):
    """How the robot stands now. Told several times a second; the newest one counts."""

    type: Literal["state"] = "state"
    pose: Pose
    """of its origin, on the ground between its tracks"""
    pitch: float = 0.0
    """rad, positive with the front down"""
    charge: float | None = Field(default=None, ge=0, le=1)
    """of the battery; None: not known"""
    charging: bool = False
    action: str | None = None
    """the id of the action that is under way"""
    known: tuple[str, ...] = ()
    """the ids of the actions that it has not forgotten, those that have ended among them"""


class EndReport(Model):
    """An action has ended."""

    type: Literal["ended"] = "ended"
    id: str
    outcome: Literal["done", "failed", "stopped"]
    """`stopped`: it was cancelled, and has cleaned up"""
    value: float | None = None
    """what a MEASURE has read, in the checkpoint's unit"""
    distance: float | None = Field(default=None, ge=0)
    """m that it was read from; None: not known"""
    confidence: float = Field(default=1.0, ge=0, le=1)
    unreadable: bool = False
    """`failed`: whether it looked at the checkpoint, and could not read a value"""
    reason: str = ""
    """`failed`: why, for people"""


class FoundReport(Model):
    """The robot has noticed something."""

    type: Literal["found"] = "found"
    event: EventKind
    detail: str = ""
    place: tuple[float, float, float] | None = None
    """m; None: not known"""


Order = Annotated[StartOrder | CancelOrder, Field(discriminator="type")]
"""what Argo tells the robot"""
Report = Annotated[RobotState | EndReport | FoundReport, Field(discriminator="type")]
"""what the robot tells Argo"""

ORDERS: TypeAdapter[StartOrder | CancelOrder] = TypeAdapter(Order)
REPORTS: TypeAdapter[RobotState | EndReport | FoundReport] = TypeAdapter(Report)


class Envelope(Model):
    """One message on the link, in either direction."""

    sender: str
    """the session of who sends it: a word that a process takes when it begins, and no other has"""
    to: str | None = None
    """the session that it is meant for; None: the other one was not heard yet"""
    sent: int = Field(ge=1)
    """counts the envelopes of the session"""
    number: int | None = Field(default=None, ge=1)
    """counts what is repeated until it is acknowledged, from 1 for each session that it is meant
    for; None: it is not"""
    heard: int = Field(default=0, ge=0)
    """the last number that was taken from that session, in order"""
    body: dict[str, Any] | None = None
    """an order or a report; None: it only acknowledges"""


def message_schemas() -> dict[str, Any]:
    """The JSON schemas: of the envelope, and of its body in both directions."""
    return {
        "envelope": Envelope.model_json_schema(),
        "order": ORDERS.json_schema(),
        "report": REPORTS.json_schema(),
    }
