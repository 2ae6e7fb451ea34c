"""The pictures that the robot takes, each with where its camera was and how it draws."""

from io import BytesIO

from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from PIL import Image
from scipy.spatial.transform import Rotation

from argo_env.recording.messages import WORLD, set_rotation, set_vector, timestamp
from argo_env.recording.topic_writer import TopicWriter
from argo_env.world.world import Shot

CAMERA = "camera"
"""the optical frame of the camera: x to the right in the picture, y down, z into it"""
_QUALITY = 90  # of JPEG: a tenth of the size of a PNG with the camera's noise


def write_shot(writer: TopicWriter, shot: Shot, t: float) -> None:
    """Writes a picture that was taken at time t (s)."""
    x, y, z = shot.position.tolist()
    qx, qy, qz, qw = Rotation.from_matrix(shot.rotation).as_quat().tolist()
    place = FrameTransform(timestamp=timestamp(t), parent_frame_id=WORLD, child_frame_id=CAMERA)
    set_vector(place.translation, (x, y, z))
    set_rotation(place.rotation, (qx, qy, qz, qw))
    writer.put("/tf_camera", FrameTransforms(transforms=[place]), t)
    writer.put("/camera/calibration", _calibration(shot, t), t)
    file = BytesIO()
    Image.fromarray(shot.pixels).save(file, "JPEG", quality=_QUALITY)
    picture = CompressedImage(
        timestamp=timestamp(t), frame_id=CAMERA, data=file.getvalue(), format="jpeg"
    )
    writer.put("/camera/image", picture, t)


def _calibration(shot: Shot, t: float) -> CameraCalibration:
    height, width, _ = shot.pixels.shape
    f, u, v = shot.focal, (width - 1) / 2, (height - 1) / 2
    return CameraCalibration(
        timestamp=timestamp(t),
        frame_id=CAMERA,
        width=width,
        height=height,
        K=[f, 0.0, u, 0.0, f, v, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[f, 0.0, u, 0.0, 0.0, f, v, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
