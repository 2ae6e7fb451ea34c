"""What a page draws: the solids of each floor, the robot, and the checkpoints, as GLB."""

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.catalog import CheckpointKind
from argo_env.files import resources
from argo_env.planning.opening import OpenedSite
from argo_env.robot.robot_model import Quaternion, RobotModel, Visual, read_model
from argo_env.robot.spec import robot_folder
from argo_env.site.shapes import Box, Element, Role, Solid
from argo_env.site.stairs import THICKNESS, TOE_PLATE
from argo_env.site.storeys import storeys
from argo_env.site.urdf import COLOURS
from argo_planner.service.world.glb import Colour, DrawnNode, Mesh, to_glb

_FORM = "1"  # of what is kept on disk: another one for other meshes of the same site
_STAIRS: Colour = (0.30, 0.34, 0.40)
"""darker than the gratings of the decks, so that stairs are seen on them"""
_THIN = 2 * THICKNESS  # m across, up to which the ends of a bar are not seen
_LARGE = 0.3  # m, radius above which corners of a cylinder are seen from afar
_WIDER = 1.5  # times that coarse rails are as thick, so that they are seen from afar


class Detail(StrEnum):
    """How much of a floor a mesh has.

    FULL: all solids. MEDIUM: all solids, round ones with fewer sides, thin bars without ends.
    COARSE: without toe plates, rails in three sides, steps in two faces.
    """

    FULL = "full"
    MEDIUM = "medium"
    COARSE = "coarse"


_ROUND = {Detail.FULL: 24, Detail.MEDIUM: 12, Detail.COARSE: 8}
"""sides of a cylinder"""


@dataclass(frozen=True)
class UnitShape:
    """A shape of size 1 about (0, 0, 0), with which solids are drawn: corners, shape (n, 3), and
    triangles, counter-clockwise seen from outside."""

    corners: NDArray[np.float64]
    triangles: NDArray[np.int64]
    open: bool
    """whether it has no caps, so that its faces are seen from both sides"""


def floor_mesh(site: OpenedSite, floor: int, detail: Detail = Detail.FULL) -> bytes:
    """The solids of a floor as GLB, in the site's frame, one node for each role of elements.

    A solid belongs to the floor on whose storey it begins; upright ones that pass through decks
    are cut there. NotFound if there is no such floor.
    """
    site.site.floor(floor)
    name = f"mesh-{_FORM}-{floor}-{detail}"

    def make() -> dict[str, NDArray[np.uint8]]:
        made = _floor(storeys(site.site)[floor], f"floor {floor}", detail)
        return {"glb": np.frombuffer(made, np.uint8)}

    return site.parts.load_or_make(name, make)["glb"].tobytes()


def robot_mesh(site: OpenedSite) -> bytes:
    """The robot as GLB, its arm stowed: one node for each link, in the frame of the link that
    carries it, with the joint between them in `extras`."""
    robot = site.robot
    angles = {name: np.deg2rad(angle) for name, angle in robot.arm_stowed.items()}
    return _model(read_model(robot_folder() / robot.urdf), robot.name, angles)


def checkpoint_mesh(kind: CheckpointKind) -> bytes:
    """A checkpoint of a kind as GLB, its face in the plane x = 0 and looking along x, without what
    is painted on it. Its pointer is a node of its own."""
    name = kind.value.replace(" ", "_")
    return _model(read_model(resources.urdf() / "checkpoints" / f"{name}.urdf"), name, {})


def _floor(elements: Iterable[Element], name: str, detail: Detail) -> bytes:
    gathered: dict[tuple[Role, str], list[tuple[UnitShape, Solid]]] = defaultdict(list)
    for element in elements:
        for solid in element.solids:
            template = _template(solid, element.role, detail)
            if template is not None:
                gathered[element.role, element.material].append((template, solid))
    nodes: dict[str, list[Mesh]] = {}
    for (role, material), parts in gathered.items():
        colour = _STAIRS if role is Role.STAIR else COLOURS[material]
        wider = _WIDER if role is Role.RAILING and detail is Detail.COARSE else 1.0
        nodes.setdefault(role.value, []).append(_merged(parts, colour, wider))
    return to_glb(name, [DrawnNode(role, meshes) for role, meshes in nodes.items()])


def _template(solid: Solid, role: Role, detail: Detail) -> UnitShape | None:
    """What a solid is drawn with; None: it is left out."""
    if not isinstance(solid, Box):
        vessel = solid.radius > _LARGE and detail is Detail.COARSE
        return prism(_ROUND[Detail.MEDIUM if vessel else detail])
    thickness = sorted(solid.size)[1]
    if detail is Detail.FULL or (thickness > _THIN and role is not Role.STAIR):
        is_toe = role is Role.RAILING and solid.size[1:] == (THICKNESS, TOE_PLATE)
        return None if is_toe and detail is Detail.COARSE else prism(4)
    if detail is Detail.MEDIUM:
        return prism(4) if role is Role.STAIR else prism(4, capped=False)
    return step() if role is Role.STAIR else prism(3, capped=False)


def _merged(parts: list[tuple[UnitShape, Solid]], colour: Colour, wider: float) -> Mesh:
    """All parts as one mesh."""
    corners, triangles, count = [], [], 0
    for template, solid in parts:
        size, turn = _along_z(solid, template)
        if template.open and template is not step():
            size[:2] *= wider
        corners.append(template.corners * size @ turn.T + np.array(solid.center))
        triangles.append(template.triangles + count)
        count += len(template.corners)
    is_open = any(template.open for template, _ in parts)
    return Mesh(np.vstack(corners).astype(np.float32), np.vstack(triangles), colour, is_open)


def _along_z(solid: Solid, template: UnitShape) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Size and axes of a solid; open bars have their length along the last axis."""
    if not isinstance(solid, Box):
        across = 2 * solid.radius
        return np.array([across, across, solid.length]), solid.rotation()
    size, turn = np.array(solid.size), solid.rotation()
    if not template.open or template is step():
        return size, turn
    longest = int(np.argmax(size))
    order = [(longest + 1) % 3, (longest + 2) % 3, longest]
    return size[order], turn[:, order]


def _model(model: RobotModel, name: str, angles: dict[str, float]) -> bytes:
    """A model with its joints at the `angles` (rad), 0 where none is given."""
    carried = {joint.child: joint for joint in model.joints}
    order: list[str] = []

    def add(link: str) -> None:
        if link not in order:
            if link in carried:
                add(carried[link].parent)
            order.append(link)

    for link in model.visuals:
        add(link)
    nodes = []
    for link in order:
        meshes = [_look(look) for look in model.visuals.get(link, ())]
        joint = carried.get(link)
        if joint is None:
            nodes.append(DrawnNode(link, meshes))
            continue
        position, rotation = joint.child_pose(angles.get(joint.name, 0.0))
        data = {"joint": joint.name, "kind": joint.kind, "axis": joint.axis}
        told = data if joint.is_movable else {}
        parent = order.index(joint.parent)
        nodes.append(DrawnNode(link, meshes, parent, position, rotation, told))
    return to_glb(name, nodes)


def _look(look: Visual) -> Mesh:
    template = {"box": prism(4), "sphere": ball()}.get(look.shape, prism(16))
    corners = template.corners * np.array(look.size) @ _matrix(look.rotation).T
    corners += np.array(look.position)
    return Mesh(corners.astype(np.float32), template.triangles, look.colour[:3])


def _matrix(q: Quaternion) -> NDArray[np.float64]:
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
    """A prism along z about a circle of diameter 1; with four sides a box."""
    turn = 2 * math.pi / sides
    angles = turn * (np.arange(sides) + 0.5) - (math.pi / 2 if sides == 3 else 0.0)
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) / 2
    if sides <= 4:  # fills the box around it
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
def ball(sides: int = 12) -> UnitShape:
    """A ball of diameter 1."""
    rings = sides // 2
    corners = [(0.0, 0.0, -0.5)]
    for r in range(1, rings):
        across, z = math.sin(math.pi * r / rings) / 2, -math.cos(math.pi * r / rings) / 2
        for k in range(sides):
            angle = 2 * math.pi * k / sides
            corners.append((across * math.cos(angle), across * math.sin(angle), z))
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
def step() -> UnitShape:
    """The upper face of a box and the riser below its front, -x: an open step of 4 triangles."""
    corners = np.array(
        [
            (-0.5, -0.5, 0.5), (0.5, -0.5, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 0.5),
            (-0.5, -0.5, -0.5), (-0.5, 0.5, -0.5),
        ]
    )  # fmt: skip
    triangles = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 5), (0, 5, 4)])
    return UnitShape(corners, triangles, True)
