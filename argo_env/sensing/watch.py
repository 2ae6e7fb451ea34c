"""Detections that the robot makes by itself during a run, and the interfaces of its watches."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from argo_compiler.il import EventKind
from argo_env.robot.pose import BodyPose
from argo_env.site.shapes import Vector


@dataclass(frozen=True)
class Detection:
    """Something that a watch has detected in its signals."""

    kind: EventKind
    detail: str
    """one phrase for the report, such as `gas, 840 ppm, near pump P-301`"""
    place: Vector | None = None
    """m, estimated position of the cause; None if the signal has no direction or distance"""
    confidence: float = 1.0
    """0 to 1"""
    noticed_from: Vector | None = None
    """m, position of the robot, if it helps to locate a cause whose `place` is unknown"""


class Watch(Protocol):
    """Part of perception that looks for one kind of detection in signals, at a fixed period."""

    name: str
    period: float
    """s between two updates"""

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        """Read the signals at time `now` (s) with the robot at `pose`; return new detections.

        The watch reports each thing once, and again only after it has been gone.
        """
        ...


@dataclass(frozen=True)
class ReportedDetection:
    """A detection reported before a run was interrupted, and the robot's pose at the report."""

    kind: EventKind
    pose: BodyPose


@runtime_checkable
class SkippableWatch(Watch, Protocol):
    """A watch that knows when its updates have no effect until a fault begins or ends."""

    def can_skip_updates(self, lowest_charge: float, highest_charge: float) -> bool:
        """Return True if no update detects or changes anything until a fault begins or ends.

        Until then, the charge of the battery stays between `lowest_charge` and `highest_charge` (0
        to 1).
        """
        ...


@runtime_checkable
class RestorableWatch(Watch, Protocol):
    """A watch whose detections can't be recognized by their position after a run is resumed."""

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:
        """Set a new watch to the state of the one that made these reports, oldest first.

        The resumed run continues at time `now` (s).
        """
        ...
