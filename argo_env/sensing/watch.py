"""What the robot notices by itself while it goes: detections, and what makes them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.site.shapes import Vector


@dataclass(frozen=True)
class Detection:
    """Something found by sensing."""

    kind: EventKind
    detail: str
    """one phrase for the report, such as `gas, 840 ppm, near pump P-301`"""
    place: Vector | None = None
    """m, where the robot believes it is; None where the signal tells no place"""
    confidence: float = 1.0
    """0 to 1"""
    noticed_from: Vector | None = None
    """m, where the robot was, if that says anything about what it knows no place of"""


class Watch(Protocol):
    """Looks at one kind of signal again and again, and says what is new in it."""

    name: str
    period: float
    """s between two looks"""

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        """What has been found at time `now` (s) with the robot at `pose`; each thing is told once,
        and again only after it was gone."""
        ...


@dataclass(frozen=True)
class Told:
    """What a watch has told before the run was resumed, and where the robot was then."""

    kind: EventKind
    pose: BodyPose


@runtime_checkable
class PatientWatch(Watch, Protocol):
    """A watch that can say when it will see nothing new for as long as no fault begins or ends."""

    def sees_nothing_new(self, least: float, most: float) -> bool:
        """Whether no look tells or changes anything until then, the charge of the battery being
        between these two (0 to 1)."""
        ...


@runtime_checkable
class RememberingWatch(Watch, Protocol):
    """A watch whose detections have no place by which they are known again."""

    def remember(self, told: Sequence[Told], now: float) -> None:
        """Goes on at time `now` (s) as the one that has told all these, in this order."""
        ...
