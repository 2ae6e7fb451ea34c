"""What faults change of the site is drawn where it really is."""

from types import SimpleNamespace

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from argo_env.faults.checkpoints import DisplacedCheckpoint
from argo_env.faults.walkway import Brick
from tests.argo_env.recording.conftest import SPEC

BRICK = Brick(floor=1, place=(6.2, 2.5), size=(0.3, 0.2, 0.1), yaw=30.0)
MOVED = DisplacedCheckpoint(checkpoint=3, at=10.0, until=20.0, offset=(0.0, 0.05, 0.02), turn=90.0)


@pytest.fixture(scope="module")
def drawn(record_run, yard, tmp_path_factory):
    """The scenes of a run with the faults, with their times (s), and where gauge 3 was planned."""
    file = tmp_path_factory.mktemp("faults") / "run.mcap"
    record_run(file, SPEC.model_copy(update={"faults": (BRICK, MOVED)}))
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        said = [
            (channel.topic, message.log_time / 1e9, scene)
            for _, channel, message, scene in reader.iter_decoded_messages(
                ("/site/floor_1", "/checkpoints")
            )
        ]
    return SimpleNamespace(
        site=[scene for topic, _, scene in said if topic == "/site/floor_1"],
        checkpoints=[(t, scene) for topic, t, scene in said if topic == "/checkpoints"],
        planned=yard.site.checkpoint(3).position,
    )


def test_a_brick_lies_where_it_is(drawn) -> None:
    (scene,) = drawn.site
    (cube,) = next(e for e in scene.entities if e.id == "brick").cubes
    place, size = cube.pose.position, cube.size
    assert (place.x, place.y, place.z) == pytest.approx((6.2, 2.5, 0.07))
    assert (size.x, size.y, size.z) == pytest.approx((0.3, 0.2, 0.1))


def test_a_checkpoint_is_drawn_where_it_was_moved_to(drawn) -> None:
    x, y, z = drawn.planned
    moved = (x, y + 0.05, z + 0.02)
    for t, scene in drawn.checkpoints:
        entity = next(e for e in scene.entities if e.id == "checkpoint 3")
        place = entity.cylinders[0].pose.position
        there = moved if 10.05 < t < 19.95 else drawn.planned
        if min(abs(t - 10.0), abs(t - 20.0)) > 0.2:
            assert (place.x, place.y, place.z) == pytest.approx(there)
    times = [t for t, _ in drawn.checkpoints]
    for change in (10.0, 20.0):
        assert min(abs(t - change) for t in times) <= 0.2, "it is told at once"
    assert any(10.05 < t < 19.95 for t in times)
