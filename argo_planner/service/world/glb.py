"""glTF 2.0 in its binary form: nodes with triangles in plain colours.

No normals are written, which glTF takes as flat faces.
"""

import json
import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Colour = tuple[float, float, float]
"""red, green and blue from 0 to 1, as screens show them"""

_UPRIGHT = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
"""turns z up into y up, as glTF has it"""
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_FLOAT, _SHORT, _INT = 5126, 5123, 5125


@dataclass(frozen=True)
class Mesh:
    """Triangles of one colour: corners in m, shape (n, 3), and three of them for each triangle."""

    corners: NDArray[np.float32]
    triangles: NDArray[np.int64]
    colour: Colour
    open: bool = False
    """whether its faces are seen from both sides"""


@dataclass(frozen=True)
class DrawnNode:
    """A named thing in the frame of the node `parent`, by its number; None: in the site's."""

    name: str
    meshes: Sequence[Mesh] = ()
    parent: int | None = None
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m"""
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """quaternion x, y, z, w"""
    extras: Mapping[str, Any] = field(default_factory=dict)
    """what else is told of it"""


def to_glb(root: str, nodes: Sequence[DrawnNode]) -> bytes:
    """The nodes as one file, under a node of the name `root` that turns z up into glTF's y up."""
    parts = _Parts()
    children: list[list[int]] = [[] for _ in nodes]
    top: list[int] = []
    for number, node in enumerate(nodes):
        (top if node.parent is None else children[node.parent]).append(number + 1)
    made = [{"name": root, "rotation": _UPRIGHT, "children": top}]
    made += [parts.node(node, below) for node, below in zip(nodes, children, strict=True)]
    document = {
        "asset": {"version": "2.0", "generator": "argo"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{k: v for k, v in node.items() if v not in ([], {})} for node in made],
        "meshes": parts.meshes,
        "materials": parts.materials,
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{"byteLength": len(parts.content)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    content = bytes(parts.content)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(content), 0x004E4942) + content
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


class _Parts:
    """The lists of a document while it is put together."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []

    def node(self, node: DrawnNode, children: list[int]) -> dict[str, Any]:
        made: dict[str, Any] = {
            "name": node.name,
            "translation": node.position,
            "rotation": node.rotation,
            "children": children,
            "extras": dict(node.extras),
        }
        if node.meshes:
            primitives = [self._primitive(mesh) for mesh in node.meshes]
            self.meshes.append({"name": node.name, "primitives": primitives})
            made["mesh"] = len(self.meshes) - 1
        return made

    def _primitive(self, mesh: Mesh) -> dict[str, Any]:
        corners = np.ascontiguousarray(mesh.corners, dtype="<f4")
        kind, dtype = (_SHORT, "<u2") if len(corners) <= 0xFFFF else (_INT, "<u4")
        numbers = np.ascontiguousarray(mesh.triangles.ravel(), dtype=dtype)
        place = self._accessor(corners.tobytes(), len(corners), "VEC3", _FLOAT, _ARRAY_BUFFER)
        self.accessors[place] |= {
            "min": corners.min(axis=0).tolist(),
            "max": corners.max(axis=0).tolist(),
        }
        order = self._accessor(numbers.tobytes(), len(numbers), "SCALAR", kind, _ELEMENT_BUFFER)
        return {
            "attributes": {"POSITION": place},
            "indices": order,
            "material": self._material(mesh),
        }

    def _accessor(self, content: bytes, count: int, form: str, kind: int, target: int) -> int:
        self.content += b"\0" * (-len(self.content) % 4)
        self.views.append(
            {
                "buffer": 0,
                "byteOffset": len(self.content),
                "byteLength": len(content),
                "target": target,
            }
        )
        self.content += content + b"\0" * (-len(content) % 4)
        view = len(self.views) - 1
        self.accessors.append(
            {"bufferView": view, "componentType": kind, "count": count, "type": form}
        )
        return len(self.accessors) - 1

    def _material(self, mesh: Mesh) -> int:
        material = {
            "pbrMetallicRoughness": {
                "baseColorFactor": [*(round(_linear(c), 5) for c in mesh.colour), 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.9,
            },
            "doubleSided": mesh.open,
        }
        if material not in self.materials:
            self.materials.append(material)
        return self.materials.index(material)


def _linear(shown: float) -> float:
    """The amount of light of what a screen shows (sRGB), as glTF counts it."""
    return shown / 12.92 if shown <= 0.04045 else ((shown + 0.055) / 1.055) ** 2.4
