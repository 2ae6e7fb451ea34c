"""What Foxglove's 3D panel draws: the site, floor by floor, the robot, and the checkpoints."""

from collections.abc import Iterable, Mapping, Sequence

from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive

from argo_env.recording.messages import WORLD, colour, pose, timestamp, vector
from argo_env.robot.robot_model import (
    Colour,
    Quaternion,
    RobotModel,
    Visual,
    from_rpy,
    multiply,
)
from argo_env.run.record import Anomaly, Reading
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Box, Element, Solid, Vector
from argo_env.site.storeys import storeys
from argo_env.site.urdf import COLOURS

_FACE = (0.16, 0.16, 0.02)  # m, the disc that marks a checkpoint
_LABEL_HEIGHT = 0.18  # m above the face
_LABEL_SIZE = 0.12  # m, height of the text
_BALL = 0.2  # m, that marks a finding
_CLOSED = 0.05  # m, height of what shows that a part of the surface is closed
_SEEN_THROUGH: Colour = (0.85, 0.15, 0.12, 0.4)
_TO_READ: Colour = (0.55, 0.57, 0.60, 1.0)
_NORMAL: Colour = (0.15, 0.65, 0.25, 1.0)
_ABNORMAL: Colour = (0.85, 0.15, 0.12, 1.0)
_INK: Colour = (0.05, 0.05, 0.05, 1.0)


def site_scenes(site: Site, t: float) -> dict[int, SceneUpdate]:
    """The site's elements for each floor, by its number."""
    return {
        number: SceneUpdate(entities=[_element(e, t) for e in elements])
        for number, elements in storeys(site).items()
    }


def robot_scene(model: RobotModel, t: float) -> SceneUpdate:
    """The robot's links, each in its own frame."""
    return SceneUpdate(
        entities=[
            _entity(link, link, solids, t, locked=True) for link, solids in model.visuals.items()
        ]
    )


def checkpoint_scene(
    checkpoints: Iterable[SiteCheckpoint], readings: Mapping[int, Reading], t: float
) -> SceneUpdate:
    """Checkpoints, with what was read last of each: grey before that, then green or red."""
    return SceneUpdate(entities=[_checkpoint(c, readings.get(c.id), t) for c in checkpoints])


def finding_scene(found: Sequence[Anomaly], t: float) -> SceneUpdate:
    """All that was found and has a place: a ball with a few words, and what is closed by it. Of
    what was only noticed or told of somewhere, the words stand there alone."""
    return SceneUpdate(
        entities=[
            _finding(f"finding {number}", anomaly, at, t)
            for number, anomaly in enumerate(found, start=1)
            if (at := anomaly.place or anomaly.noticed_from) is not None
        ]
    )


def _finding(id: str, anomaly: Anomaly, place: Vector, t: float) -> SceneEntity:
    level: Quaternion = (0.0, 0.0, 0.0, 1.0)
    text = anomaly.kind.replace("_", " ") + (f": {anomaly.detail}" if anomaly.detail else "")
    looks = [Visual("sphere", (_BALL, _BALL, _BALL), place, level, _ABNORMAL)]
    if anomaly.place is None:
        text, looks = f"{'told' if anomaly.is_reported else 'noticed from'} here: {text}", []
    if anomaly.extent is not None:
        x0, y0, x1, y1 = anomaly.extent
        middle = ((x0 + x1) / 2, (y0 + y1) / 2, place[2])
        looks.append(Visual("box", (x1 - x0, y1 - y0, _CLOSED), middle, level, _SEEN_THROUGH))
    entity = _entity(id, WORLD, looks, t)
    entity.texts.append(_label(place, text))
    return entity


def _label(place: Vector, text: str) -> TextPrimitive:
    x, y, z = place
    return TextPrimitive(
        pose=pose((x, y, z + _LABEL_HEIGHT), (0.0, 0.0, 0.0, 1.0)),
        billboard=True,
        font_size=_LABEL_SIZE,
        color=colour(_INK),
        text=text,
    )


def _element(element: Element, t: float) -> SceneEntity:
    red, green, blue = COLOURS[element.material]
    looks = [_look(solid, (red, green, blue, 1.0)) for solid in element.solids]
    return _entity(element.name, WORLD, looks, t)


def _look(solid: Solid, colour: Colour) -> Visual:
    if isinstance(solid, Box):
        return Visual("box", solid.size, solid.center, from_rpy(solid.rpy), colour)
    across = 2 * solid.radius
    size = (across, across, solid.length)
    return Visual("cylinder", size, solid.center, from_rpy(solid.rpy), colour)


def _entity(
    id: str, frame: str, looks: Iterable[Visual], t: float, locked: bool = False
) -> SceneEntity:
    entity = SceneEntity(timestamp=timestamp(t), frame_id=frame, id=id, frame_locked=locked)
    for look in looks:
        place, size, shade = (
            pose(look.position, look.rotation), vector(look.size), colour(look.colour),
        )  # fmt: skip
        match look.shape:
            case "box":
                entity.cubes.append(CubePrimitive(pose=place, size=size, color=shade))
            case "sphere":
                entity.spheres.append(SpherePrimitive(pose=place, size=size, color=shade))
            case _:
                entity.cylinders.append(
                    CylinderPrimitive(
                        pose=place, size=size, color=shade, bottom_scale=1.0, top_scale=1.0
                    )
                )
    return entity


def _checkpoint(checkpoint: SiteCheckpoint, reading: Reading | None, t: float) -> SceneEntity:
    text, shade = f"#{checkpoint.id} {checkpoint.name}", _TO_READ
    if reading is not None:
        text += f": {reading.value:.4g} {reading.unit}"
        shade = _NORMAL if reading.normal else _ABNORMAL
    # The face looks along x of the checkpoint's frame; a cylinder stands along its z.
    turned = multiply(from_rpy((0.0, 0.0, checkpoint.yaw)), from_rpy((0.0, 1.5707963267948966, 0)))
    face = Visual("cylinder", _FACE, checkpoint.position, turned, shade)
    entity = _entity(f"checkpoint {checkpoint.id}", WORLD, [face], t)
    entity.texts.append(_label(checkpoint.position, text))
    return entity
