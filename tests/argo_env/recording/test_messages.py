"""Messages of a recording, decoded with the libraries of the formats' authors."""

import json
import math
from collections import Counter, defaultdict
from io import BytesIO
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from PIL import Image
from scipy.spatial.transform import Rotation

from argo_compiler.il import EventKind
from argo_env.drives.kinematic import KinematicDrive
from argo_env.faults.checkpoints import DisplacedCheckpoint
from argo_env.faults.walkway import Brick
from argo_env.recording.files import recording_to
from argo_env.recording.scene import finding_scene
from argo_env.robot.pose import BodyPose
from argo_env.run.record import Anomaly
from argo_env.run.run_setup import RunSetup
from argo_env.site.shapes import Box
from argo_env.site.urdf import COLOURS
from argo_env.world.world import World
from tests.argo_env.recording.conftest import SPEC

pytestmark = pytest.mark.physics

FOXGLOVE = {
    "/tf": "FrameTransforms",
    "/tf_limbs": "FrameTransforms",
    "/tf_static": "FrameTransforms",
    "/pose": "PoseInFrame",
    "/joints": "JointStates",
    "/path": "PosesInFrame",
    "/site/floor_1": "SceneUpdate",
    "/robot": "SceneUpdate",
    "/checkpoints": "SceneUpdate",
    "/findings/markers": "SceneUpdate",
    "/log": "Log",
}
OWN = {
    "/mission": "MissionState",
    "/trace": "TraceStep",
    "/tasks": "TaskRun",
    "/readings": "Reading",
    "/findings": "Anomaly",
    "/battery": "BatteryState",
}


@pytest.fixture(scope="module")
def messages(recorded):
    """Return schema, channel, message and decoded content of all messages, by topic."""
    rows = defaultdict(list)
    with recorded.file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages():
            if channel.message_encoding == "protobuf":
                decoder = DecoderFactory().decoder_for(channel.message_encoding, schema)
                content = decoder(message.data)
            else:
                content = json.loads(message.data)
            rows[channel.topic].append((schema, channel, message, content))
    return rows


@pytest.fixture(scope="module")
def contents(messages):
    """Return the times (s) and decoded contents of all messages, by topic."""
    return {
        topic: [(message.log_time / 1e9, content) for _, _, message, content in rows]
        for topic, rows in messages.items()
    }


def test_topics_have_foxgloves_schemas(messages) -> None:
    forms = {t: (f"foxglove.{name}", "protobuf", "protobuf") for t, name in FOXGLOVE.items()}
    forms |= {t: (f"argo.{name}", "jsonschema", "json") for t, name in OWN.items()}
    for topic, form in forms.items():
        for schema, channel, _, _ in messages[topic]:
            assert (schema.name, schema.encoding, channel.message_encoding) == form
    assert forms.keys() <= messages.keys()


def test_json_messages_satisfy_their_schema(messages) -> None:
    for rows in messages.values():
        for schema, _, _, value in rows:
            if schema.encoding == "jsonschema":
                strict = forbid_more(json.loads(schema.data))
                jsonschema.validate(value, strict)
                require_plain(strict)


def forbid_more(schema):
    """Return the schema with fields that it does not name forbidden."""
    if schema["type"] == "object":
        fields = {name: forbid_more(field) for name, field in schema["properties"].items()}
        return schema | {"properties": fields, "additionalProperties": False}
    return schema | ({"items": forbid_more(schema["items"])} if "items" in schema else {})


def require_plain(schema) -> None:
    """Fail for references and alternatives, which Foxglove's open-source version can't parse."""
    assert not {"$ref", "anyOf", "oneOf", "allOf", "prefixItems"} & schema.keys()
    assert schema["type"] in {"object", "array", "boolean", "integer", "number", "string"}
    for part in (*schema.get("properties", {}).values(), *filter(None, [schema.get("items")])):
        require_plain(part)


def test_timestamps_are_simulated_time(contents, recorded) -> None:
    for rows in contents.values():
        times = [t for t, _ in rows]
        assert times == sorted(times)
        assert times[0] >= 0.0
        assert times[-1] <= recorded.record.result.duration
        for t, message in rows:
            if hasattr(message, "timestamp"):
                assert stamp(message) == pytest.approx(t, abs=1e-9)
    assert contents["/tf"][-1][0] == recorded.record.result.duration


def stamp(message) -> float:
    return message.timestamp.seconds + message.timestamp.nanos / 1e9


def test_poses_come_ten_times_a_second_and_are_those_of_the_record(contents, recorded) -> None:
    poses = {round(t, 6): message for t, message in contents["/pose"]}
    assert np.diff(sorted(poses)) == pytest.approx(0.1, abs=1e-6)
    for sample in recorded.record.path:
        pose = poses[sample.t].pose
        assert poses[sample.t].frame_id == "world"
        position = (pose.position.x, pose.position.y, pose.position.z)
        assert position == pytest.approx((sample.x, sample.y, sample.z), abs=1e-4)
        q = pose.orientation
        assert math.hypot(q.x, q.y, q.z, q.w) == pytest.approx(1.0)
        yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y**2 + q.z**2))
        assert math.remainder(yaw - sample.yaw, math.tau) == pytest.approx(0.0, abs=1e-3)


def test_transforms_make_one_tree_with_all_drawn_frames(contents) -> None:
    parents = {}
    for topic in ("/tf", "/tf_limbs", "/tf_static"):
        first = contents[topic][0][1]
        for _, message in contents[topic]:
            assert [t.child_frame_id for t in message.transforms] == [
                t.child_frame_id for t in first.transforms
            ]
        for transform in first.transforms:
            assert transform.child_frame_id not in parents
            parents[transform.child_frame_id] = transform.parent_frame_id
    for frame in parents:
        chain = [frame]
        while chain[-1] in parents:
            chain.append(parents[chain[-1]])
            assert len(chain) <= len(parents) + 1, "a cycle"
        assert chain[-1] == "world"
    drawn = {
        entity.frame_id
        for topic in ("/robot", "/checkpoints", "/site/floor_1")
        for _, message in contents[topic]
        for entity in message.entities
    }
    assert drawn <= parents.keys() | {"world"}
    assert "sensor_head" in drawn


def test_limbs_are_recorded_when_they_move_and_once_a_second(contents) -> None:
    assert len(contents["/joints"]) == len(contents["/tf_limbs"])
    for (before, _), (after, _) in zip(contents["/joints"], contents["/joints"][1:], strict=False):
        assert after - before <= 1.0 + 1e-6
    shoulder = [
        next(j.position for j in message.joints if j.name == "arm_shoulder")
        for _, message in contents["/joints"]
    ]
    assert len(set(shoulder)) >= 2, "the arm is raised to measure"


def test_site_is_drawn_with_all_its_solids(contents, recorded) -> None:
    """Upright solids are cut at the floors, so the volumes of each colour are compared."""
    drawn, expected = Counter(), Counter()
    for topic, rows in contents.items():
        if topic.startswith("/site/"):
            assert [t for t, _ in rows] == [0.0]
            for entity in rows[0][1].entities:
                for cube in entity.cubes:
                    drawn[colour_of(cube)] += cube.size.x * cube.size.y * cube.size.z
                for tube in entity.cylinders:
                    volume = math.pi / 4 * tube.size.x * tube.size.y * tube.size.z
                    drawn[colour_of(tube)] += volume
    for element in recorded.decoded.site.elements:
        key = tuple(round(c, 3) for c in COLOURS[element.material])
        for solid in element.solids:
            expected[key] += (
                math.prod(solid.size)
                if isinstance(solid, Box)
                else math.pi * solid.radius**2 * solid.length
            )
    assert drawn == pytest.approx(expected)


def colour_of(primitive):
    return tuple(round(getattr(primitive.color, c), 3) for c in "rgb")


def test_readings_tasks_and_trace_are_those_of_the_record(contents, recorded) -> None:
    record = recorded.stored
    for topic, models in (
        ("/readings", record.readings), ("/tasks", record.tasks), ("/trace", record.trace),
        ("/findings", record.anomalies),
    ):  # fmt: skip
        assert [message for _, message in contents[topic]] == [
            json.loads(model.model_dump_json(exclude_none=True)) for model in models
        ]


def test_checkpoints_change_colour_when_they_are_read(contents, recorded) -> None:
    updates = [message for _, message in contents["/checkpoints"]]
    assert len(updates) == 1 + len(recorded.record.readings)
    for update in updates:
        assert len(update.entities) == 3, "each message has all, so the last one is enough"
    texts = [{e.id: e.texts[0].text for e in update.entities} for update in updates]
    assert texts[0]["checkpoint 2"] == "#2 gauge 2"
    assert texts[-1]["checkpoint 2"] == "#2 gauge 2: 7.25 bar"
    red, green = (
        next(e for e in updates[-1].entities if e.id == f"checkpoint {k}").cylinders[0].color
        for k in (2, 1)
    )
    assert red.r > 2 * red.g
    assert green.g > 2 * green.r


def test_findings_are_marked_where_they_are(contents, recorded) -> None:
    markers = contents["/findings/markers"][-1][1].entities
    anomalies = recorded.record.anomalies
    placed = [anomaly for anomaly in anomalies if anomaly.place]
    assert len(markers) == len(anomalies) > len(placed) >= 1
    reported = [entity.texts[0].text for entity in markers if not entity.spheres]
    assert reported == ["reported here: gas leak: by hand", "reported here: all clear"]
    for entity, anomaly in zip([m for m in markers if m.spheres], placed, strict=True):
        ball = entity.spheres[0].pose.position
        assert (ball.x, ball.y, ball.z) == pytest.approx(anomaly.place)
        assert anomaly.detail in entity.texts[0].text


def test_a_finding_without_a_position_has_a_label_where_it_was_noticed() -> None:
    leak = Anomaly(
        t=3.0, kind=EventKind.GAS_LEAK, detail="a hiss", source="gas", noticed_from=(1.0, 2.0, 0.0),
        floor=1,
    )  # fmt: skip
    nowhere = Anomaly(t=4.0, kind=EventKind.LOW_BATTERY, detail="24 V", source="battery")
    (entity,) = finding_scene([leak, nowhere], 5.0).entities
    assert not entity.spheres
    assert entity.texts[0].text == "noticed from here: gas leak: a hiss"
    assert (entity.texts[0].pose.position.x, entity.texts[0].pose.position.y) == (1.0, 2.0)


def test_battery_is_that_of_the_path(contents, recorded) -> None:
    charges = {round(t, 6): state["charge"] for t, state in contents["/battery"]}
    for sample in recorded.record.path:
        assert charges[sample.t] == pytest.approx(sample.charge, abs=1e-4)
    assert charges[max(charges)] < charges[0.0]
    assert all(23.0 <= state["voltage"] <= 29.0 for _, state in contents["/battery"])


def test_mission_state_has_reactions_pauses_and_rounds(contents, recorded) -> None:
    states = contents["/mission"]
    assert states[0][0] == 0.0
    reacting = [t for t, state in states if state.get("reaction") == "gas_leak"]
    assert reacting[0] == pytest.approx(22.0)
    assert next(t for t, state in states if state["paused"]) == pytest.approx(50.0)
    assert {round for _, state in states for round in state["rounds"]} == {1, 2}
    last = states[-1][1]
    assert last["outcome"] == recorded.record.result.outcome
    assert last["readings"] == len(recorded.record.readings)
    assert last["abnormal"] == 2
    assert last["done"] == sum(t.outcome == "done" for t in recorded.record.tasks)


def test_log_has_events_and_the_verdict(contents, recorded) -> None:
    lines = [(message.level, message.message) for _, message in contents["/log"]]
    assert (3, "gas leak: by hand") in lines
    # Level 3 is a warning, because there are findings.
    assert lines[-1] == (3, str(recorded.record.headline))
    assert lines[-1][1].startswith("Done, 3 findings: gas leak at 00:22 (answered by reaction")


def test_path_begins_where_the_robot_is(contents) -> None:
    poses = {round(t, 6): message.pose.position for t, message in contents["/pose"]}
    assert len(contents["/path"]) >= 5
    for t, path in contents["/path"]:
        assert path.frame_id == "world"
        # The robot has already driven for one step when the path is recorded.
        here, start = poses[round(t, 6)], path.poses[0].position
        assert math.dist((here.x, here.y), (start.x, start.y)) <= 0.1


BRICK = Brick(floor=1, place=(6.2, 2.5), size=(0.3, 0.2, 0.1), yaw=30.0)
MOVED = DisplacedCheckpoint(checkpoint=3, at=10.0, until=20.0, offset=(0.0, 0.05, 0.02), turn=90.0)


@pytest.fixture(scope="module")
def drawn(record_run, yard, tmp_path_factory):
    """Return the scenes of a run with the faults, and the planned position of gauge 3.

    Scenes of checkpoints have their times (s).
    """
    file = tmp_path_factory.mktemp("faults") / "run.mcap"
    record_run(file, SPEC.model_copy(update={"faults": (BRICK, MOVED)}))
    messages = decode_topics(file, "/site/floor_1", "/checkpoints")
    return SimpleNamespace(
        site=[scene for _, scene in messages["/site/floor_1"]],
        checkpoints=[(time / 1e9, scene) for time, scene in messages["/checkpoints"]],
        planned=yard.site.checkpoint(3).position,
    )


def decode_topics(file, *topics):
    """Return the times (ns) and contents of the messages on each of the topics."""
    rows = defaultdict(list)
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, content in reader.iter_decoded_messages(topics):
            rows[channel.topic].append((message.log_time, content))
    return rows


def test_a_brick_lies_where_it_is(drawn) -> None:
    (scene,) = drawn.site
    (cube,) = next(e for e in scene.entities if e.id == "brick").cubes
    position, size = cube.pose.position, cube.size
    assert (position.x, position.y, position.z) == pytest.approx((6.2, 2.5, 0.07))
    assert (size.x, size.y, size.z) == pytest.approx((0.3, 0.2, 0.1))


def test_a_checkpoint_is_drawn_where_it_was_moved_to(drawn) -> None:
    x, y, z = drawn.planned
    moved = (x, y + 0.05, z + 0.02)
    for t, scene in drawn.checkpoints:
        entity = next(e for e in scene.entities if e.id == "checkpoint 3")
        position = entity.cylinders[0].pose.position
        expected = moved if 10.05 < t < 19.95 else drawn.planned
        if min(abs(t - 10.0), abs(t - 20.0)) > 0.2:
            assert (position.x, position.y, position.z) == pytest.approx(expected)
    times = [t for t, _ in drawn.checkpoints]
    for change in (10.0, 20.0):
        assert min(abs(t - change) for t in times) <= 0.2, "the change is recorded at once"
    assert any(10.05 < t < 19.95 for t in times)


pytest.importorskip("cv2")


@pytest.fixture(scope="module")
def taken(yard, tmp_path_factory):
    """Return the centre of gauge 1 (m), and the messages of the pictures taken of it."""
    from argo_env.sensing.vision.sensor import CameraSensor

    file = tmp_path_factory.mktemp("shots") / "run.mcap"
    site, robot = yard.site, yard.robot
    start = yard.snap_keeping_heading(site.docks[1])
    view = yard.plan_to_view(start, 1).end
    with World(site, robot) as world:
        drive = KinematicDrive(world, robot)
        drive.place_robot(BodyPose(view.x, view.y, view.z, view.yaw))
        world.show_value(1, 3.0)
        sensor = CameraSensor(world, 1)
        with recording_to(file) as recorder:
            recorder.on_begin(RunSetup(world, yard, drive, sensor), SPEC)
            sensor.measure(1, drive.pose)
            recorder.on_step(4.2, None)
    messages = decode_topics(file, "/camera/image", "/camera/calibration", "/tf_camera")
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
            assert np.asarray(picture).std() > 20.0, "the picture is not blank"


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
        # The drawn face has ink on it, so it is darker than the sky around the gauge.
        assert face.size > 0.5 * (2 * radius) ** 2
        assert face.mean() < np.percentile(pixels, 95) - 5.0
