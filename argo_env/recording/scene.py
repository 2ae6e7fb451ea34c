"""Scenes for Foxglove's 3D panel: the site by floors, the robot, checkpoints and findings."""

from collections.abc import Iterable, Mapping, Sequence

from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive

from argo_env.recording.messages import (
    WORLD,
    make_colour,
    make_pose,
    make_timestamp,
    make_vector,
)
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

_FACE = (0.16, 0.16, 0.02)  # m, size of the disc that marks a checkpoint
_LABEL_HEIGHT = 0.18  # m above the face
_LABEL_SIZE = 0.12  # m, height of the text
_BALL = 0.2  # m, diameter of the ball that marks a finding
_BOX_HEIGHT = 0.05  # m, height of the box that marks a closed part of the surface
_TRANSLUCENT: Colour = (0.85, 0.15, 0.12, 0.4)
_UNREAD: Colour = (0.55, 0.57, 0.60, 1.0)
_NORMAL: Colour = (0.15, 0.65, 0.25, 1.0)
_ABNORMAL: Colour = (0.85, 0.15, 0.12, 1.0)
_INK: Colour = (0.05, 0.05, 0.05, 1.0)


def site_scenes(site: Site, t: float) -> dict[int, SceneUpdate]:
    """Return the scene of the site's elements on each floor, by the floor's number."""
    return {
        number: SceneUpdate(entities=[_element(e, t) for e in elements])
        for number, elements in storeys(site).items()
    }


def robot_scene(model: RobotModel, t: float) -> SceneUpdate:
    """Return the scene of the robot's links, each in its own frame, with which it moves."""
    return SceneUpdate(
        entities=[
            _entity(link, link, solids, t, locked=True) for link, solids in model.visuals.items()
        ]
    )


def checkpoint_scene(
    checkpoints: Iterable[SiteCheckpoint], readings: Mapping[int, Reading], t: float
) -> SceneUpdate:
    """Return the scene of checkpoints with their last readings, which are given by checkpoint id.

    A checkpoint without a reading is grey, one with a normal reading green, any other red.
    """
    return SceneUpdate(entities=[_checkpoint(c, readings.get(c.id), t) for c in checkpoints])


def finding_scene(anomalies: Sequence[Anomaly], t: float) -> SceneUpdate:
    """Return the scene of anomalies, at the positions that are known of them.

    An anomaly with a position of its own has a ball and a label there, and a box on the part of the
    surface that it closes. If only the robot's position is known, when it noticed or was told the
    anomaly, there is a label at that position. Anomalies without any position are left out.
    """
    return SceneUpdate(
        entities=[
            _finding(f"finding {number}", anomaly, position, t)
            for number, anomaly in enumerate(anomalies, start=1)
            if (position := anomaly.place or anomaly.noticed_from) is not None
        ]
    )


def _finding(id: str, anomaly: Anomaly, position: Vector, t: float) -> SceneEntity:
    level: Quaternion = (0.0, 0.0, 0.0, 1.0)
    text = anomaly.kind.replace("_", " ") + (f": {anomaly.detail}" if anomaly.detail else "")
    visuals = [Visual("sphere", (_BALL, _BALL, _BALL), position, level, _ABNORMAL)]
    if anomaly.place is None:
        text, visuals = (
            f"{'reported' if anomaly.is_reported_from_outside else 'noticed from'} here: {text}",
            [],
        )
    if anomaly.extent is not None:
        x0, y0, x1, y1 = anomaly.extent
        middle = ((x0 + x1) / 2, (y0 + y1) / 2, position[2])
        visuals.append(Visual("box", (x1 - x0, y1 - y0, _BOX_HEIGHT), middle, level, _TRANSLUCENT))
    entity = _entity(id, WORLD, visuals, t)
    entity.texts.append(_label(position, text))
    return entity


def _label(position: Vector, text: str) -> TextPrimitive:
    """Return a text above the position."""
    x, y, z = position
    return TextPrimitive(
        pose=make_pose((x, y, z + _LABEL_HEIGHT), (0.0, 0.0, 0.0, 1.0)),
        billboard=True,
        font_size=_LABEL_SIZE,
        color=make_colour(_INK),
        text=text,
    )


def _element(element: Element, t: float) -> SceneEntity:
    red, green, blue = COLOURS[element.material]
    visuals = [_visual(solid, (red, green, blue, 1.0)) for solid in element.solids]
    return _entity(element.name, WORLD, visuals, t)


def _visual(solid: Solid, colour: Colour) -> Visual:
    if isinstance(solid, Box):
        return Visual("box", solid.size, solid.center, from_rpy(solid.rpy), colour)
    diameter = 2 * solid.radius
    size = (diameter, diameter, solid.length)
    return Visual("cylinder", size, solid.center, from_rpy(solid.rpy), colour)


def _entity(
    id: str, frame: str, visuals: Iterable[Visual], t: float, locked: bool = False
) -> SceneEntity:
    """Return an entity of visuals in a frame; with `locked` it moves with the frame."""
    entity = SceneEntity(timestamp=make_timestamp(t), frame_id=frame, id=id, frame_locked=locked)
    for visual in visuals:
        pose, size, colour = (
            make_pose(visual.position, visual.rotation), make_vector(visual.size),
            make_colour(visual.colour),
        )  # fmt: skip
        match visual.shape:
            case "box":
                entity.cubes.append(CubePrimitive(pose=pose, size=size, color=colour))
            case "sphere":
                entity.spheres.append(SpherePrimitive(pose=pose, size=size, color=colour))
            case _:
                entity.cylinders.append(
                    CylinderPrimitive(
                        pose=pose, size=size, color=colour, bottom_scale=1.0, top_scale=1.0
                    )
                )
    return entity


def _checkpoint(checkpoint: SiteCheckpoint, reading: Reading | None, t: float) -> SceneEntity:
    text, colour = f"#{checkpoint.id} {checkpoint.name}", _UNREAD
    if reading is not None:
        text += f": {reading.value:.4g} {reading.unit}"
        colour = _NORMAL if reading.normal else _ABNORMAL
    # The face looks along x of the checkpoint's frame; the axis of a cylinder is z.
    turned = multiply(from_rpy((0.0, 0.0, checkpoint.yaw)), from_rpy((0.0, 1.5707963267948966, 0)))
    face = Visual("cylinder", _FACE, checkpoint.position, turned, colour)
    entity = _entity(f"checkpoint {checkpoint.id}", WORLD, [face], t)
    entity.texts.append(_label(checkpoint.position, text))
    return entity
