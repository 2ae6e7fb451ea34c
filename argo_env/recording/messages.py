"""Foxglove's messages from Argo's data."""

from collections.abc import Iterable

from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose as PoseMessage
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion as QuaternionMessage
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp

from argo_compiler.base.model import Pose
from argo_env.recording.writer import nanoseconds
from argo_env.robot.pose import BodyPose
from argo_env.robot.robot_model import Colour, Quaternion, from_rpy
from argo_env.site.shapes import Vector

WORLD = "world"
"""the frame of the site"""
BASE = "base_link"
"""the robot's frame: its origin on the ground between the tracks, x forwards, z up"""


def timestamp(t: float) -> Timestamp:
    """The time t (s)."""
    return set_time(Timestamp(), t)


def set_time(message: Timestamp, t: float) -> Timestamp:
    """The same message, with the time t (s)."""
    message.seconds, message.nanos = divmod(nanoseconds(t), 1_000_000_000)
    return message


def vector(v: Vector) -> Vector3:
    """A vector (m)."""
    return Vector3(x=v[0], y=v[1], z=v[2])


def pose(position: Vector, rotation: Quaternion) -> PoseMessage:
    """A position (m) and an attitude."""
    message = PoseMessage()
    set_vector(message.position, position)
    set_rotation(message.orientation, rotation)
    return message


def set_vector(message: Vector3, v: Vector) -> None:
    """Puts a vector (m) into a message."""
    message.x, message.y, message.z = v


def set_rotation(message: QuaternionMessage, q: Quaternion) -> None:
    """Puts an attitude into a message."""
    message.x, message.y, message.z, message.w = q


def attitude(body: BodyPose) -> Quaternion:
    """The attitude of the robot's body."""
    return from_rpy((body.roll, body.pitch, body.yaw))


def colour(c: Colour) -> Color:
    """A colour."""
    return Color(r=c[0], g=c[1], b=c[2], a=c[3])


def point(v: Vector) -> Point3:
    """A point (m)."""
    return Point3(x=v[0], y=v[1], z=v[2])


def path(poses: Iterable[Pose], t: float) -> PosesInFrame:
    """A way through poses of the site."""
    return PosesInFrame(
        timestamp=timestamp(t),
        frame_id=WORLD,
        poses=[pose((p.x, p.y, p.z), from_rpy((0.0, 0.0, p.yaw))) for p in poses],
    )


def log(text: str, level: "Log.Level.ValueType", name: str, t: float) -> Log:
    """A line of the log, told by the part called `name`."""
    return Log(timestamp=timestamp(t), level=level, message=text, name=name)
