"""Messages in Foxglove's schemas, made from Argo's data."""

from collections.abc import Iterable

from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.Log_pb2 import Log
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
"""frame of the site"""
BASE = "base_link"
"""frame of the robot: its origin is on the ground between the tracks, x forwards, z up"""


def make_timestamp(t: float) -> Timestamp:
    """Return the message for the time t (s)."""
    return set_time(Timestamp(), t)


def set_time(message: Timestamp, t: float) -> Timestamp:
    """Set the message to the time t (s), in place, and return it."""
    message.seconds, message.nanos = divmod(nanoseconds(t), 1_000_000_000)
    return message


def make_vector(v: Vector) -> Vector3:
    """Return the message for a vector, in m."""
    return Vector3(x=v[0], y=v[1], z=v[2])


def make_pose(position: Vector, rotation: Quaternion) -> PoseMessage:
    """Return the message for a position (m) and an attitude (unit quaternion)."""
    message = PoseMessage()
    set_vector(message.position, position)
    set_rotation(message.orientation, rotation)
    return message


def set_vector(message: Vector3, v: Vector) -> None:
    """Set a message to the vector, in m, in place."""
    message.x, message.y, message.z = v


def set_rotation(message: QuaternionMessage, q: Quaternion) -> None:
    """Set a message to the attitude (unit quaternion), in place."""
    message.x, message.y, message.z, message.w = q


def attitude(body: BodyPose) -> Quaternion:
    """Return the attitude of the robot's body as a quaternion x, y, z, w."""
    return from_rpy((body.roll, body.pitch, body.yaw))


def make_colour(c: Colour) -> Color:
    """Return the message for a colour: red, green, blue and opacity, 0 to 1."""
    return Color(r=c[0], g=c[1], b=c[2], a=c[3])


def make_path(poses: Iterable[Pose], t: float) -> PosesInFrame:
    """Return the message for a path through poses on the site, at the time t (s)."""
    return PosesInFrame(
        timestamp=make_timestamp(t),
        frame_id=WORLD,
        poses=[make_pose((p.x, p.y, p.z), from_rpy((0.0, 0.0, p.yaw))) for p in poses],
    )


def make_log(text: str, level: "Log.Level.ValueType", name: str, t: float) -> Log:
    """Return a line of the log; `name` is the part of the run that the line is about."""
    return Log(timestamp=make_timestamp(t), level=level, message=text, name=name)
