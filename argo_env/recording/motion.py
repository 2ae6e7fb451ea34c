"""Topics of the robot's motion and of its pictures.

Motion: the transforms of all its frames, its pose and its joints. Each picture has the pose and the
calibration of its camera.
"""

from collections.abc import Callable
from io import BytesIO

from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from PIL import Image
from scipy.spatial.transform import Rotation

from argo_env.recording.messages import (
    BASE,
    WORLD,
    attitude,
    make_timestamp,
    set_rotation,
    set_time,
    set_vector,
)
from argo_env.recording.topic_writer import TopicWriter
from argo_env.robot.pose import BodyPose
from argo_env.robot.robot_model import Joint, Quaternion, RobotModel
from argo_env.site.shapes import Vector
from argo_env.world.world import Shot

LIMB_PERIOD = 1.0
"""longest time in s between two messages with the joints, even if none has moved"""

JointPositions = Callable[[list[str]], list[float]]
"""function that returns the positions (rad or m) of the robot's joints with these names"""


class MotionTopics:
    """Writer of the poses of the robot and its joints; it holds its messages to reuse them."""

    def __init__(
        self, writer: TopicWriter, model: RobotModel, joint_positions: JointPositions
    ) -> None:
        self._writer = writer
        self._joint_positions = joint_positions
        self._moving = [joint for joint in model.joints if joint.is_movable]
        self._names = [joint.name for joint in self._moving]
        self._values: list[float] | None = None
        self._limbs_due = 0.0
        self._fixed = [joint for joint in model.joints if not joint.is_movable]
        self._base = FrameTransforms(
            transforms=[FrameTransform(parent_frame_id=WORLD, child_frame_id=BASE)]
        )
        self._limb_frames = FrameTransforms(
            transforms=[_transform(joint, *joint.child_pose(0.0)) for joint in self._moving]
        )
        self._pose = PoseInFrame(frame_id=WORLD)
        self._joints = JointStates()
        for name in self._names:
            self._joints.joints.add(name=name)

    def write_fixed_transforms(self, t: float) -> None:
        """Write the transforms of the fixed joints, at the time t (s)."""
        static = FrameTransforms(
            transforms=[_transform(joint, *joint.child_pose(0.0)) for joint in self._fixed]
        )
        for transform in static.transforms:
            set_time(transform.timestamp, t)
        self._writer.put("/tf_static", static, t)

    def write_sample(self, body: BodyPose, t: float) -> None:
        """Write the robot's pose `body` and the positions of its movable joints at the time t (s).

        The joints are written only if one has moved, or `LIMB_PERIOD` has passed, since they were
        last written.
        """
        position, rotation = (body.x, body.y, body.z), attitude(body)
        base = self._base.transforms[0]
        set_time(base.timestamp, t)
        set_vector(base.translation, position)
        set_rotation(base.rotation, rotation)
        self._writer.put("/tf", self._base, t)
        set_time(self._pose.timestamp, t)
        set_vector(self._pose.pose.position, position)
        set_rotation(self._pose.pose.orientation, rotation)
        self._writer.put("/pose", self._pose, t)
        values = self._joint_positions(self._names)
        if values != self._values or t >= self._limbs_due - 1e-9:
            self._write_limbs(values, t)
            self._values, self._limbs_due = values, t + LIMB_PERIOD

    def _write_limbs(self, values: list[float], t: float) -> None:
        transforms, states = self._limb_frames.transforms, self._joints.joints
        for joint, value, transform, state in zip(
            self._moving, values, transforms, states, strict=True
        ):
            position, rotation = joint.child_pose(value)
            set_time(transform.timestamp, t)
            set_vector(transform.translation, position)
            set_rotation(transform.rotation, rotation)
            state.position = value
        self._writer.put("/tf_limbs", self._limb_frames, t)
        set_time(self._joints.timestamp, t)
        self._writer.put("/joints", self._joints, t)


def _transform(joint: Joint, position: Vector, rotation: Quaternion) -> FrameTransform:
    transform = FrameTransform(parent_frame_id=joint.parent, child_frame_id=joint.child)
    set_vector(transform.translation, position)
    set_rotation(transform.rotation, rotation)
    return transform


CAMERA = "camera"
"""optical frame of the camera: x to the right in the picture, y down, z into it"""
_QUALITY = 90  # of JPEG: a tenth of the size of a PNG with the camera's noise


def write_shot(writer: TopicWriter, shot: Shot, t: float) -> None:
    """Write a picture that was taken at the time t (s), with its camera's pose and calibration."""
    x, y, z = shot.position.tolist()
    qx, qy, qz, qw = Rotation.from_matrix(shot.rotation).as_quat().tolist()
    camera_frame = FrameTransform(
        timestamp=make_timestamp(t), parent_frame_id=WORLD, child_frame_id=CAMERA
    )
    set_vector(camera_frame.translation, (x, y, z))
    set_rotation(camera_frame.rotation, (qx, qy, qz, qw))
    writer.put("/tf_camera", FrameTransforms(transforms=[camera_frame]), t)
    writer.put("/camera/calibration", _calibration(shot, t), t)
    file = BytesIO()
    Image.fromarray(shot.pixels).save(file, "JPEG", quality=_QUALITY)
    picture = CompressedImage(
        timestamp=make_timestamp(t), frame_id=CAMERA, data=file.getvalue(), format="jpeg"
    )
    writer.put("/camera/image", picture, t)


def _calibration(shot: Shot, t: float) -> CameraCalibration:
    height, width, _ = shot.pixels.shape
    f, u, v = shot.focal, (width - 1) / 2, (height - 1) / 2
    return CameraCalibration(
        timestamp=make_timestamp(t),
        frame_id=CAMERA,
        width=width,
        height=height,
        K=[f, 0.0, u, 0.0, f, v, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[f, 0.0, u, 0.0, 0.0, f, v, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
