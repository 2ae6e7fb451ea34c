"""The robot's URDF as recordings need it: its links' looks, and where the joints put them."""

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
    """A solid of a link's looks: a box of edges `size` (m), or a cylinder or ball whose bounding
    box has them, in the link's frame."""

    shape: str
    """`box`, `cylinder` or `sphere`"""
    size: Vector
    position: Vector
    rotation: Quaternion
    colour: Colour


@dataclass(frozen=True)
class Joint:
    """Where a link is on the link that carries it (m), and about or along what it moves."""

    name: str
    kind: str
    """as in URDF: `fixed`, `revolute`, `continuous` or `prismatic`"""
    parent: str
    child: str
    position: Vector
    rotation: Quaternion
    axis: Vector

    @property
    def moves(self) -> bool:
        return self.kind != "fixed"

    def at(self, value: float) -> tuple[Vector, Quaternion]:
        """The child's place in the parent's frame with the joint at a position (rad or m)."""
        if self.kind == "prismatic":
            along = rotate(self.rotation, scale(self.axis, value))
            return add(self.position, along), self.rotation
        sin, cos = math.sin(value / 2), math.cos(value / 2)
        return self.position, multiply(self.rotation, (*scale(self.axis, sin), cos))


@dataclass(frozen=True)
class RobotModel:
    """Links with their looks, and joints, in the order of the URDF."""

    text: str
    """the URDF document"""
    looks: Mapping[str, Sequence[Visual]]
    """by link; meshes are left out"""
    joints: tuple[Joint, ...]


def read_model(path: Path) -> RobotModel:
    """The model that a URDF file describes."""
    text = path.read_text(encoding="utf-8")
    robot = ET.fromstring(text)
    colours = {
        material.attrib["name"]: _colour(material)
        for material in robot.findall("material")
        if material.find("color") is not None
    }
    looks = {
        link.attrib["name"]: tuple(
            look for visual in link.findall("visual") if (look := _look(visual, colours))
        )
        for link in robot.findall("link")
    }
    return RobotModel(text, looks, tuple(_joint(joint) for joint in robot.findall("joint")))


def from_rpy(rpy: Vector) -> Quaternion:
    """Roll, pitch and yaw (rad, fixed axes) as a quaternion."""
    roll, pitch, yaw = (angle / 2 for angle in rpy)
    x = (math.sin(roll), 0.0, 0.0, math.cos(roll))
    y = (0.0, math.sin(pitch), 0.0, math.cos(pitch))
    z = (0.0, 0.0, math.sin(yaw), math.cos(yaw))
    return multiply(multiply(z, y), x)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """The turn `b`, then the turn `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(q: Quaternion, v: Vector) -> Vector:
    """The vector, turned."""
    x, y, z, w = q
    rx, ry, rz, _ = multiply(multiply(q, (*v, 0.0)), (-x, -y, -z, w))
    return rx, ry, rz


def add(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def scale(v: Vector, factor: float) -> Vector:
    """A vector, `factor` times as long."""
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


def _look(visual: ET.Element, colours: Mapping[str, Colour]) -> Visual | None:
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
                across = 2 * float(shape.attrib["radius"])
                size = (across, across, float(shape.attrib["length"]))
            case "sphere":
                across = 2 * float(shape.attrib["radius"])
                size = (across, across, across)
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
