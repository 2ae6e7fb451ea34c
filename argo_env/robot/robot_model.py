"""Robot model from a URDF file: the visual solids of its links, and its joints."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from argo_env.site.shapes import Vector

Quaternion = tuple[float, float, float, float]
"""x, y, z, w"""

Colour = tuple[float, float, float, float]
"""red, green, blue and opacity from 0 to 1"""

_GREY: Colour = (0.6, 0.6, 0.6, 1.0)


@dataclass(frozen=True)
class Visual:
    """Visual solid of a link, in the link's frame: a box, cylinder or sphere.

    `size` has the edges of the box (m), or of the bounding box of the cylinder or sphere.
    """

    shape: str
    """`box`, `cylinder` or `sphere`"""
    size: Vector
    position: Vector
    rotation: Quaternion
    colour: Colour


@dataclass(frozen=True)
class Joint:
    """Joint between a child link and its parent link.

    Position (m) and rotation are those of the child in the parent's frame at the joint's zero; the
    child turns about the axis or slides along it.
    """

    name: str
    kind: str
    """as in URDF: `fixed`, `revolute`, `continuous` or `prismatic`"""
    parent: str
    child: str
    position: Vector
    rotation: Quaternion
    axis: Vector

    @property
    def is_movable(self) -> bool:
        return self.kind != "fixed"

    def child_pose(self, value: float) -> tuple[Vector, Quaternion]:
        """Return the child's position and rotation in the parent's frame.

        `value` is the position of the joint, in rad, or m if it is prismatic.
        """
        if self.kind == "prismatic":
            shift = rotate(self.rotation, scale(self.axis, value))
            return add_vectors(self.position, shift), self.rotation
        sin, cos = math.sin(value / 2), math.cos(value / 2)
        return self.position, multiply(self.rotation, (*scale(self.axis, sin), cos))


@dataclass(frozen=True)
class RobotModel:
    """Robot model: links with their visual solids, and joints, in the order of the URDF."""

    text: str
    """the URDF document"""
    visuals: Mapping[str, Sequence[Visual]]
    """visual solids by the link's name; meshes are left out"""
    joints: tuple[Joint, ...]


def read_model(path: Path) -> RobotModel:
    """Return the model that a URDF file describes."""
    text = path.read_text(encoding="utf-8")
    robot = ET.fromstring(text)
    colours = {
        material.attrib["name"]: _colour(material)
        for material in robot.findall("material")
        if material.find("color") is not None
    }
    visuals = {
        link.attrib["name"]: tuple(
            solid for visual in link.findall("visual") if (solid := _visual(visual, colours))
        )
        for link in robot.findall("link")
    }
    return RobotModel(text, visuals, tuple(_joint(joint) for joint in robot.findall("joint")))


def from_rpy(rpy: Vector) -> Quaternion:
    """Convert roll, pitch and yaw (rad, about fixed axes, in this order) to a quaternion."""
    roll, pitch, yaw = (angle / 2 for angle in rpy)
    x = (math.sin(roll), 0.0, 0.0, math.cos(roll))
    y = (0.0, math.sin(pitch), 0.0, math.cos(pitch))
    z = (0.0, 0.0, math.sin(yaw), math.cos(yaw))
    return multiply(multiply(z, y), x)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the product of two quaternions: the rotation that applies `b` first, then `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Return the vector `v`, rotated by the quaternion `q`."""
    x, y, z, w = q
    rx, ry, rz, _ = multiply(multiply(q, (*v, 0.0)), (-x, -y, -z, w))
    return rx, ry, rz


def add_vectors(a: Vector, b: Vector) -> Vector:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def scale(v: Vector, factor: float) -> Vector:
    """Return the vector multiplied by a factor."""
    return v[0] * factor, v[1] * factor, v[2] * factor


def _joint(joint: ET.Element) -> Joint:
    axis = joint.find("axis")
    position, rotation = _origin(joint)
    return Joint(
        joint.attrib["name"],
        joint.attrib["type"],
        _link(joint, "parent"),
        _link(joint, "child"),
        position,
        rotation,
        (1.0, 0.0, 0.0) if axis is None else _vector(axis.attrib["xyz"]),
    )


def _link(joint: ET.Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.attrib["link"]


def _visual(visual: ET.Element, colours: Mapping[str, Colour]) -> Visual | None:
    position, rotation = _origin(visual)
    material = visual.find("material")
    colour = _GREY
    if material is not None:
        own = material.find("color") is not None
        colour = _colour(material) if own else colours.get(material.attrib["name"], _GREY)
    for shape in visual.iterfind("geometry/*"):
        match shape.tag:
            case "box":
                size = _vector(shape.attrib["size"])
            case "cylinder":
                diameter = 2 * float(shape.attrib["radius"])
                size = (diameter, diameter, float(shape.attrib["length"]))
            case "sphere":
                diameter = 2 * float(shape.attrib["radius"])
                size = (diameter, diameter, diameter)
            case _:
                return None
        return Visual(shape.tag, size, position, rotation, colour)
    return None


def _origin(element: ET.Element) -> tuple[Vector, Quaternion]:
    origin = element.find("origin")
    if origin is None:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    return _vector(origin.get("xyz", "0 0 0")), from_rpy(_vector(origin.get("rpy", "0 0 0")))


def _colour(material: ET.Element) -> Colour:
    element = material.find("color")
    words = "0.6 0.6 0.6 1" if element is None else element.attrib["rgba"]
    red, green, blue, opacity = map(float, words.split())
    return red, green, blue, opacity


def _vector(words: str) -> Vector:
    x, y, z = map(float, words.split())
    return x, y, z
