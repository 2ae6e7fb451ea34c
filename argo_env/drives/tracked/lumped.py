"""Model of the robot in which all links that do not move against the body are one part.

The arm is stowed while the robot drives and the tracks are bolted on, so the physics needs three
rigid parts only, the body and two flippers. This halves the time of a step of the physics.
"""

from collections.abc import Mapping
from math import radians
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Matrix = NDArray[np.float64]


def lump_links(
    urdf: Path, arm: Mapping[str, float], moving: tuple[str, ...], mass_scale: float
) -> str:
    """Return the robot's URDF, as text, with only the joints named in `moving` left.

    All other joints are fixed at the angles of `arm` (deg), or 0, and their links become part of
    the link that carries them. All masses are multiplied by `mass_scale`.
    """
    source = ET.parse(urdf).getroot()
    links = {link.get("name", ""): link for link in source.findall("link")}
    joints = {_ref(joint, "child"): joint for joint in source.findall("joint")}
    members: dict[str, list[tuple[str, Matrix]]] = {}
    for name in links:
        carrier, pose = _carried(name, joints, arm, moving)
        members.setdefault(carrier, []).append((name, pose))
    robot = ET.Element("robot", name=source.get("name", "robot"))
    for carrier, parts in members.items():
        link = ET.SubElement(robot, "link", name=carrier)
        _add_inertia(link, [(links[name], pose) for name, pose in parts], mass_scale)
        for name, pose in parts:
            for collision in links[name].findall("collision"):
                copy = ET.SubElement(link, "collision")
                _add_origin(copy, pose @ _pose(collision))
                geometry = collision.find("geometry")
                assert geometry is not None
                copy.append(geometry)
    for carrier in members:
        if carrier in joints:
            robot.append(joints[carrier])
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode")


def _carried(
    name: str, joints: Mapping[str, ET.Element], arm: Mapping[str, float], moving: tuple[str, ...]
) -> tuple[str, Matrix]:
    """Return the link that the link `name` becomes part of, and its pose there, shape (4, 4).

    `joints` are the joints by their child links; the others are as for `lump_links`.
    """
    pose = np.eye(4)
    while name in joints and joints[name].get("name") not in moving:
        joint = joints[name]
        turn = np.eye(4)
        angle = radians(arm.get(joint.get("name", ""), 0.0))
        turn[:3, :3] = Rotation.from_rotvec(angle * _vector(joint.find("axis"), "xyz")).as_matrix()
        pose = _pose(joint) @ turn @ pose
        name = _ref(joint, "parent")
    return name, pose


def _add_inertia(
    link: ET.Element, parts: list[tuple[ET.Element, Matrix]], mass_scale: float
) -> None:
    """Add to a link one rigid body with the masses of some links.

    Args:
        link: link to add the body to.
        parts: links that become part of it, each with its pose in `link`, shape (4, 4).
        mass_scale: factor by which all masses are multiplied.
    """
    masses, centers, tensors = [], [], []
    for part, pose in parts:
        inertial = part.find("inertial")
        mass = inertial.find("mass") if inertial is not None else None
        tensor = inertial.find("inertia") if inertial is not None else None
        if inertial is None or mass is None or tensor is None:
            continue
        frame = pose @ _pose(inertial)
        xx, xy, xz, yy, yz, zz = (
            float(tensor.get(key, "0")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        masses.append(float(mass.get("value", "0")))
        centers.append(frame[:3, 3])
        tensors.append(frame[:3, :3] @ own @ frame[:3, :3].T)
    total = sum(masses)
    center = sum((m * c for m, c in zip(masses, centers, strict=True)), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for m, c, tensor_ in zip(masses, centers, tensors, strict=True):
        arm = c - center
        inertia += tensor_ + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    inertial = ET.SubElement(link, "inertial")
    frame = np.eye(4)
    frame[:3, 3] = center
    _add_origin(inertial, frame)
    ET.SubElement(inertial, "mass", value=repr(float(mass_scale * total)))
    # PyBullet turns a body's frame into its principal axes. So the products of inertia, here a
    # twentieth of the moments, are left out.
    names = ("ixx", "iyy", "izz")
    moments = {key: repr(float(mass_scale * inertia[k, k])) for k, key in enumerate(names)}
    ET.SubElement(inertial, "inertia", moments | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))


def _add_origin(element: ET.Element, pose: Matrix) -> None:
    rpy = Rotation.from_matrix(pose[:3, :3]).as_euler("xyz")
    xyz = " ".join(f"{v:.9g}" for v in pose[:3, 3])
    ET.SubElement(element, "origin", xyz=xyz, rpy=" ".join(f"{v:.9g}" for v in rpy))


def _pose(element: ET.Element) -> Matrix:
    """Return the pose in the `origin` of a URDF element as a matrix, shape (4, 4), lengths in m.

    Without an origin it is the identity.
    """
    origin = element.find("origin")
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", _vector(origin, "rpy")).as_matrix()
    pose[:3, 3] = _vector(origin, "xyz")
    return pose


def _vector(element: ET.Element | None, key: str) -> Matrix:
    words = (element.get(key) if element is not None else None) or "0 0 0"
    return np.array([float(word) for word in words.split()])


def _ref(joint: ET.Element, tag: str) -> str:
    found = joint.find(tag)
    assert found is not None
    return found.get("link", "")
