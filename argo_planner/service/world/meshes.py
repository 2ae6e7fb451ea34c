"""Meshes for the planner page: the solids of each floor, the robot and the checkpoints, as GLB."""

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.message import Message
from argo_env.files import resources
from argo_env.planning.opening import OpenedSite
from argo_env.robot.robot_model import Quaternion, RobotModel, Visual, read_model
from argo_env.robot.spec import robot_folder
from argo_env.site.shapes import Box, Element, Role, Solid
from argo_env.site.stairs import THICKNESS, TOE_PLATE
from argo_env.site.storeys import storeys
from argo_env.site.urdf import COLOURS
from argo_planner.service.world.glb import Colour, DrawnNode, Mesh, to_glb

_FORMAT = "1"  # version of the cached meshes: to be changed if a site gets other meshes
_STAIRS: Colour = (0.30, 0.34, 0.40)
"""colour of stairs: darker than the gratings of the decks, so that stairs stand out"""
_THIN = 2 * THICKNESS  # m; the ends of bars up to this thickness are hardly visible
_LARGE = 0.3  # m; the edges of cylinders above this radius are visible from afar
_WIDENING = 1.5  # factor by which coarse rails are thicker, to be visible from afar


class Detail(StrEnum):
    """Level of detail of a floor's mesh.

    FULL: all solids. MEDIUM: all solids; cylinders have fewer sides, thin bars no ends.
    COARSE: no toe plates; rails have three sides, steps two faces.
    """

    FULL = "full"
    MEDIUM = "medium"
    COARSE = "coarse"


_ROUND = {Detail.FULL: 24, Detail.MEDIUM: 12, Detail.COARSE: 8}
"""number of sides of a cylinder, by level of detail"""


@dataclass(frozen=True)
class UnitShape:
    """A shape of size 1 about (0, 0, 0), which is scaled to draw a solid."""

    corners: NDArray[np.float64]
    """shape (n, 3)"""
    triangles: NDArray[np.int64]
    """indices of the corners of each triangle, counter-clockwise from outside, shape (m, 3)"""
    open: bool
    """whether it has no caps, so that its faces are visible from both sides"""


def floor_mesh(site: OpenedSite, floor: int, detail: Detail = Detail.FULL) -> bytes:
    """Return the solids of a floor as GLB in the site's frame, with a node for each role.

    A solid belongs to the floor on whose storey it begins; upright solids that pass through decks
    are cut there. Raises NotFound if there is no such floor.
    """
    site.site.floor(floor)
    name = f"mesh-{_FORMAT}-{floor}-{detail}"

    def make_mesh() -> dict[str, NDArray[np.uint8]]:
        glb = _floor_glb(storeys(site.site)[floor], Message("floor {floor}", floor=floor), detail)
        return {"glb": np.frombuffer(glb, np.uint8)}

    return site.parts.load_or_make(name, make_mesh)["glb"].tobytes()


def robot_mesh(site: OpenedSite) -> bytes:
    """Return the robot with its arm stowed as GLB, with a node for each link.

    A node is in the frame of its parent link; its `extras` describe the joint between them.
    """
    robot = site.robot
    angles = {name: np.deg2rad(angle) for name, angle in robot.arm_stowed.items()}
    return _model_glb(read_model(robot_folder() / robot.urdf), robot.name, angles)


def checkpoint_mesh(kind: CheckpointKind) -> bytes:
    """Return a checkpoint of a kind as GLB, without what is painted on its face.

    The face lies in the plane x = 0 and points along x. The pointer is a separate node.
    """
    name = kind.value.replace(" ", "_")
    return _model_glb(
        read_model(resources.urdf_folder() / "checkpoints" / f"{name}.urdf"), name, {}
    )


def _floor_glb(elements: Iterable[Element], name: str, detail: Detail) -> bytes:
    grouped: dict[tuple[Role, str], list[tuple[UnitShape, Solid]]] = defaultdict(list)
    for element in elements:
        for solid in element.solids:
            shape = _unit_shape(solid, element.role, detail)
            if shape is not None:
                grouped[element.role, element.material].append((shape, solid))
    nodes: dict[str, list[Mesh]] = {}
    for (role, material), parts in grouped.items():
        colour = _STAIRS if role is Role.STAIR else COLOURS[material]
        widening = _WIDENING if role is Role.RAILING and detail is Detail.COARSE else 1.0
        nodes.setdefault(role.value, []).append(_merge(parts, colour, widening))
    return to_glb(name, [DrawnNode(role, meshes) for role, meshes in nodes.items()])


def _unit_shape(solid: Solid, role: Role, detail: Detail) -> UnitShape | None:
    """Return the shape that a solid is drawn with; None: the solid is left out."""
    if not isinstance(solid, Box):
        is_vessel = solid.radius > _LARGE and detail is Detail.COARSE
        return prism(_ROUND[Detail.MEDIUM if is_vessel else detail])
    thickness = sorted(solid.size)[1]
    if detail is Detail.FULL or (thickness > _THIN and role is not Role.STAIR):
        is_toe = role is Role.RAILING and solid.size[1:] == (THICKNESS, TOE_PLATE)
        return None if is_toe and detail is Detail.COARSE else prism(4)
    if detail is Detail.MEDIUM:
        return prism(4) if role is Role.STAIR else prism(4, capped=False)
    return stair_step() if role is Role.STAIR else prism(3, capped=False)


def _merge(parts: list[tuple[UnitShape, Solid]], colour: Colour, widening: float) -> Mesh:
    """Return one mesh of solids, each with the shape that it is drawn with.

    The width and depth of bars without end faces are multiplied by `widening`.
    """
    corners, triangles, count = [], [], 0
    for shape, solid in parts:
        size, rotation = _size_and_rotation(solid, shape)
        if shape.open and shape is not stair_step():
            size[:2] *= widening
        corners.append(shape.corners * size @ rotation.T + np.array(solid.center))
        triangles.append(shape.triangles + count)
        count += len(shape.corners)
    is_open = any(shape.open for shape, _ in parts)
    return Mesh(np.vstack(corners).astype(np.float32), np.vstack(triangles), colour, is_open)


def _size_and_rotation(
    solid: Solid, shape: UnitShape
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return size and rotation matrix of a solid; the last axis of an open bar is its length."""
    if not isinstance(solid, Box):
        diameter = 2 * solid.radius
        return np.array([diameter, diameter, solid.length]), solid.rotation()
    size, rotation = np.array(solid.size), solid.rotation()
    if not shape.open or shape is stair_step():
        return size, rotation
    longest = int(np.argmax(size))
    order = [(longest + 1) % 3, (longest + 2) % 3, longest]
    return size[order], rotation[:, order]


def _model_glb(model: RobotModel, name: str, angles: dict[str, float]) -> bytes:
    """Return a model as GLB, with its joints at the `angles` (rad); other joints are at 0."""
    parent_joints = {joint.child: joint for joint in model.joints}
    order: list[str] = []

    def add(link: str) -> None:
        if link not in order:
            if link in parent_joints:
                add(parent_joints[link].parent)
            order.append(link)

    for link in model.visuals:
        add(link)
    nodes = []
    for link in order:
        meshes = [_visual_mesh(visual) for visual in model.visuals.get(link, ())]
        joint = parent_joints.get(link)
        if joint is None:
            nodes.append(DrawnNode(link, meshes))
            continue
        position, rotation = joint.child_pose(angles.get(joint.name, 0.0))
        data = {"joint": joint.name, "kind": joint.kind, "axis": joint.axis}
        extras = data if joint.is_movable else {}
        parent = order.index(joint.parent)
        nodes.append(DrawnNode(link, meshes, parent, position, rotation, extras))
    return to_glb(name, nodes)


def _visual_mesh(visual: Visual) -> Mesh:
    shape = {"box": prism(4), "sphere": sphere()}.get(visual.shape, prism(16))
    corners = shape.corners * np.array(visual.size) @ _matrix(visual.rotation).T
    corners += np.array(visual.position)
    return Mesh(corners.astype(np.float32), shape.triangles, visual.colour[:3])


def _matrix(q: Quaternion) -> NDArray[np.float64]:
    """Return the rotation matrix of a unit quaternion."""
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@lru_cache
def prism(sides: int, capped: bool = True) -> UnitShape:
    """Return a regular prism along z, inscribed in a cylinder of diameter 1 and length 1.

    It is centred at the origin. With three or four sides it is stretched to fill the unit cube;
    four sides make a box. Without caps it has no faces at its ends.
    """
    turn = 2 * math.pi / sides
    angles = turn * (np.arange(sides) + 0.5) - (math.pi / 2 if sides == 3 else 0.0)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) / 2
    if sides <= 4:  # fills the unit square
        low, high = ring.min(axis=0), ring.max(axis=0)
        ring = (ring - low) / (high - low) - 0.5
    low_end = np.column_stack([ring, np.full(sides, -0.5)])
    corners = np.vstack([low_end, low_end + np.array([0.0, 0.0, 1.0])])
    triangles = []
    for k in range(sides):
        n = (k + 1) % sides
        triangles += [(k, n, sides + n), (k, sides + n, sides + k)]
    if capped:
        for k in range(1, sides - 1):
            triangles += [(0, k + 1, k), (sides, sides + k, sides + k + 1)]
    return UnitShape(corners, np.array(triangles), not capped)


@lru_cache
def sphere(sides: int = 12) -> UnitShape:
    """Return a polyhedron for a sphere of diameter 1, with rings of `sides` corners each."""
    rings = sides // 2
    corners = [(0.0, 0.0, -0.5)]
    for r in range(1, rings):
        radius, z = math.sin(math.pi * r / rings) / 2, -math.cos(math.pi * r / rings) / 2
        for k in range(sides):
            angle = 2 * math.pi * k / sides
            corners.append((radius * math.cos(angle), radius * math.sin(angle), z))
    corners.append((0.0, 0.0, 0.5))
    last, triangles = len(corners) - 1, []
    for k in range(sides):
        n = (k + 1) % sides
        triangles += [(0, 1 + n, 1 + k), (last, last - sides + k, last - sides + n)]
        for r in range(rings - 2):
            a, b = 1 + r * sides, 1 + (r + 1) * sides
            triangles += [(a + k, a + n, b + n), (a + k, b + n, b + k)]
    return UnitShape(np.array(corners), np.array(triangles), False)


@lru_cache
def stair_step() -> UnitShape:
    """Return an open step of 4 triangles: the top of a box, and the face at its front, -x."""
    corners = np.array(
        [
            (-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 0.5),
            (-0.5, -0.5, -0.5), (-0.5, 0.5, -0.5),
        ]
    )  # fmt: skip
    triangles = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 5), (0, 5, 4)])
    return UnitShape(corners, triangles, True)
