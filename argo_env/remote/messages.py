"""Messages between Argo and a remote robot. Times are in s of the UNIX clock."""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from argo_compiler.base.model import Model, Pose
from argo_compiler.il import EventKind, Task


class StartOrder(Model):
    """Order to execute the action of a task.

    An action whose id the robot knows already is not started again; if it has ended, the robot
    reports its end once more.
    """

    type: Literal["start"] = "start"
    id: str
    """unique id of the action"""
    task: Task
    not_before: float | None = None
    """time in s before which the robot must not begin the action itself: it drives to where the
    action takes place and waits there; None: it need not wait"""


class CancelOrder(Model):
    """Order to stop the action, clean up and report its end.

    It has no effect if the action is not under way.
    """

    type: Literal["cancel"] = "cancel"
    id: str


class RobotState(Model):
    """Report of the robot's current state, sent several times a second; the newest one counts."""

    type: Literal["state"] = "state"
    pose: Pose
    """pose of the robot's origin, on the ground between its tracks"""
    pitch: float = 0.0
    """rad, positive with the front down"""
    charge: float | None = Field(default=None, ge=0, le=1)
    """charge of the battery, 0 to 1; None if not known"""
    charging: bool = False
    action: str | None = None
    """id of the action that is under way"""
    known: tuple[str, ...] = ()
    """ids of the actions that the robot still remembers, including ended ones"""


class EndReport(Model):
    """Report that an action has ended."""

    type: Literal["ended"] = "ended"
    id: str
    outcome: Literal["done", "failed", "stopped"]
    """`stopped`: the action was cancelled, and the robot has cleaned up"""
    value: float | None = None
    """value that a MEASURE has read, in the checkpoint's unit"""
    distance: float | None = Field(default=None, ge=0)
    """distance in m from which the value was read; None if not known"""
    confidence: float = Field(default=1.0, ge=0, le=1)
    unreadable: bool = False
    """`failed`: true if the robot looked at the checkpoint but could not read a value"""
    unreachable: bool = False
    """`failed`: true if the robot could not get to a pose from which it measures the checkpoint"""
    reason: str = ""
    """`failed`: the reason, as a text for people"""


class FoundReport(Model):
    """Report of an event that the robot has noticed."""

    type: Literal["found"] = "found"
    event: EventKind
    detail: str = ""
    place: tuple[float, float, float] | None = None
    """x, y and z of the event in m; None if not known"""


Order = Annotated[StartOrder | CancelOrder, Field(discriminator="type")]
"""message from Argo to the robot"""
Report = Annotated[RobotState | EndReport | FoundReport, Field(discriminator="type")]
"""message from the robot to Argo"""

ORDERS: TypeAdapter[StartOrder | CancelOrder] = TypeAdapter(Order)
REPORTS: TypeAdapter[RobotState | EndReport | FoundReport] = TypeAdapter(Report)


class Envelope(Model):
    """Unit that the link carries, in either direction: a message or only an acknowledgement."""

    sender: str
    """session of the sender: a word that its process chose when it started, unlike any other"""
    to: str | None = None
    """session of the receiver; None if nothing was received from it yet"""
    sent: int = Field(ge=1)
    """number of the envelope, among all that the session has sent"""
    number: int | None = Field(default=None, ge=1)
    """number of a message that is repeated until it is acknowledged, from 1 for each receiving
    session; None if the envelope is not repeated"""
    heard: int = Field(default=0, ge=0)
    """last `number` that was received in order from the session `to`"""
    body: dict[str, Any] | None = None
    """an order or a report; None if the envelope only acknowledges"""


def message_schemas() -> dict[str, Any]:
    """Return the JSON schemas of the envelope, and of its body in both directions."""
    return {
        "envelope": Envelope.model_json_schema(),
        "order": ORDERS.json_schema(),
        "report": REPORTS.json_schema(),
    }
