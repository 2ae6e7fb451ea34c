"""The form of isar's mission definition, as version 1.34 of its API reads it."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

FRAME = "asset"
"""isar's name for the frame of the plant, which is the site's; `robot` is isar's default"""
IMAGE = "Image"


class Part(BaseModel):
    """isar takes no notice of fields that it does not know; here they are kept, to warn of them."""

    # Looked for in each mission that is read, and mostly not there.
    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False, defer_build=True)


class Position(Part):
    """A point, m."""

    x: float
    y: float
    z: float
    frame_name: str = "robot"


class Orientation(Part):
    """A unit quaternion."""

    x: float
    y: float
    z: float
    w: float
    frame_name: str = "robot"


class RobotPose(Part):
    """Where the robot stands."""

    position: Position
    orientation: Orientation
    frame_name: str = "robot"


class IsarInspection(Part):
    """What is recorded, and of which point."""

    type: str = IMAGE
    inspection_target: Position
    inspection_description: str | None = None
    duration: float | None = None
    """s, of videos and sounds"""


class TaskDefinition(Part):
    """One inspection, or the way home."""

    id: str | None = None
    type: Literal["inspection", "return_to_home"] = "inspection"
    pose: RobotPose
    inspection: IsarInspection | None = None
    tag: str | None = None
    """of the equipment that is inspected"""
    zoom: dict[str, Any] | None = None


class MissionDefinition(Part):
    """The body of a request to isar's `/schedule/start-mission`."""

    id: str | None = None
    name: str | None = None
    tasks: tuple[TaskDefinition, ...]
    start_pose: RobotPose | None = None
