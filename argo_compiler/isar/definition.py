"""Models of isar's mission definition, as version 1.34 of its API reads it."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

FRAME = "asset"
"""isar's name for the frame of the plant, which is the site's frame; isar's default is `robot`."""
IMAGE = "Image"


class Part(BaseModel):
    """Base of the models; keeps fields that isar does not know, so that Argo can report them.

    isar itself ignores such fields.
    """

    # Building is deferred, as most missions are not isar's and do not need the models.
    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False, defer_build=True)


class Position(Part):
    """Point in m."""

    x: float
    y: float
    z: float
    frame_name: str = "robot"


class Orientation(Part):
    """Orientation as a unit quaternion."""

    x: float
    y: float
    z: float
    w: float
    frame_name: str = "robot"


class RobotPose(Part):
    """Pose of the robot."""

    position: Position
    orientation: Orientation
    frame_name: str = "robot"


class IsarInspection(Part):
    """Kind and target point of an inspection."""

    type: str = IMAGE
    inspection_target: Position
    inspection_description: str | None = None
    duration: float | None = None
    """duration in s of a video or a sound recording"""


class TaskDefinition(Part):
    """Task of a mission: one inspection, or the return to the home pose."""

    id: str | None = None
    type: Literal["inspection", "return_to_home"] = "inspection"
    pose: RobotPose
    inspection: IsarInspection | None = None
    tag: str | None = None
    """tag of the equipment that is inspected"""
    zoom: dict[str, Any] | None = None


class MissionDefinition(Part):
    """Body of a request to isar's `/schedule/start-mission`."""

    id: str | None = None
    name: str | None = None
    tasks: tuple[TaskDefinition, ...]
    start_pose: RobotPose | None = None
