"""Pictures of the robot's camera in a recording: where they were taken, and what they show."""

from collections import defaultdict
from io import BytesIO

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from PIL import Image
from scipy.spatial.transform import Rotation

from argo_env.drives.kinematic import KinematicDrive
from argo_env.recording.files import recording_to
from argo_env.robot.pose import BodyPose
from argo_env.run.rig import Rig
from argo_env.world.world import World
from tests.argo_env.recording.conftest import SPEC

pytest.importorskip("cv2")


@pytest.fixture(scope="module")
def taken(yard, tmp_path_factory):
    """The middle of gauge 1 (m), and the messages that tell of the pictures taken of it."""
    from argo_env.sensing.vision.sensor import CameraSensor

    file = tmp_path_factory.mktemp("shots") / "run.mcap"
    site, robot = yard.site, yard.robot
    start = yard.snap(site.docks[1])
    view = yard.plan_to_view(start, 1).end
    with World(site, robot) as world:
        drive = KinematicDrive(world, robot)
        drive.place(BodyPose(view.x, view.y, view.z, view.yaw))
        world.show_value(1, 3.0)
        sensor = CameraSensor(world, 1)
        with recording_to(file) as recorder:
            recorder.on_begin(Rig(world, yard, drive, sensor), SPEC)
            sensor.measure(1, drive.pose)
            recorder.on_step(4.2, None)
    messages = defaultdict(list)
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        topics = ("/camera/image", "/camera/calibration", "/tf_camera")
        for _, channel, message, said in reader.iter_decoded_messages(topics):
            messages[channel.topic].append((message.log_time, said))
    return np.array(site.checkpoint(1).position), messages


def test_pictures_are_recorded_when_they_are_taken(taken) -> None:
    _, messages = taken
    assert len(messages["/camera/image"]) >= 1
    counts = {topic: len(rows) for topic, rows in messages.items()}
    assert len(set(counts.values())) == 1, counts
    for time, message in messages["/camera/image"]:
        stamp = message.timestamp.seconds, message.timestamp.nanos
        assert (time, *stamp) == (4_200_000_000, 4, 200_000_000)
        assert (message.format, message.frame_id) == ("jpeg", "camera")
        with Image.open(BytesIO(message.data)) as picture:
            assert np.asarray(picture).std() > 20.0, "there is something in it"


def test_calibration_and_transform_lead_to_the_gauge_in_the_picture(taken) -> None:
    gauge, messages = taken
    for (_, image), (_, calibration), (_, frames) in zip(
        messages["/camera/image"], messages["/camera/calibration"], messages["/tf_camera"],
        strict=True,
    ):  # fmt: skip
        (transform,) = frames.transforms
        assert (transform.parent_frame_id, transform.child_frame_id) == ("world", "camera")
        t, q = transform.translation, transform.rotation
        rotation = Rotation.from_quat([q.x, q.y, q.z, q.w])
        assert rotation.apply([0.0, 1.0, 0.0])[2] < 0.2, "y points down, or level"
        column, row, depth = np.array(calibration.P).reshape(3, 4) @ [
            *rotation.inv().apply(gauge - [t.x, t.y, t.z]), 1.0
        ]  # fmt: skip
        assert depth > 0
        with Image.open(BytesIO(image.data)) as picture:
            pixels = np.asarray(picture.convert("L")).astype(float)
        assert (calibration.height, calibration.width) == pixels.shape
        column, row = round(column / depth), round(row / depth)
        radius = round(0.06 * calibration.K[0] / depth)
        face = pixels[row - radius : row + radius, column - radius : column + radius]
        # The drawn face has ink on it; the sky around the gauge has not.
        assert face.size > 0.5 * (2 * radius) ** 2
        assert face.mean() < np.percentile(pixels, 95) - 5.0
