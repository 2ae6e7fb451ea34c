"""Writing of binary glTF 2.0 (GLB): nodes with triangles in plain colours.

No normals are written; glTF then shades faces flat.
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
"""red, green and blue from 0 to 1, in sRGB"""

_UPRIGHT = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
"""quaternion x, y, z, w that turns z up into y up, as in glTF"""
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_FLOAT, _SHORT, _INT = 5126, 5123, 5125


@dataclass(frozen=True)
class Mesh:
    """Triangles of one colour."""

    corners: NDArray[np.float32]
    """in m, shape (n, 3)"""
    triangles: NDArray[np.int64]
    """indices of the corners of each triangle, shape (m, 3)"""
    colour: Colour
    open: bool = False
    """whether the faces are visible from both sides"""


@dataclass(frozen=True)
class DrawnNode:
    """A named node of the scene, with its meshes."""

    name: str
    meshes: Sequence[Mesh] = ()
    parent: int | None = None
    """index of the node in whose frame this one is; None: the site's frame"""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m"""
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    """quaternion x, y, z, w"""
    extras: Mapping[str, Any] = field(default_factory=dict)
    """further data of the node (glTF `extras`)"""


def to_glb(root_name: str, nodes: Sequence[DrawnNode]) -> bytes:
    """Return the nodes as a GLB file, below a node named `root_name` that turns z up into y up."""
    parts = _DocumentParts()
    children: list[list[int]] = [[] for _ in nodes]
    top: list[int] = []
    for index, node in enumerate(nodes):
        (top if node.parent is None else children[node.parent]).append(index + 1)
    gltf_nodes = [{"name": root_name, "rotation": _UPRIGHT, "children": top}]
    gltf_nodes += [parts.add_node(node, below) for node, below in zip(nodes, children, strict=True)]
    document = {
        "asset": {"version": "2.0", "generator": "argo"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{k: v for k, v in node.items() if v not in ([], {})} for node in gltf_nodes],
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


class _DocumentParts:
    """The lists of a glTF document while it is built."""

    def __init__(self) -> None:
        self.content = bytearray()
        self.meshes: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []

    def add_node(self, node: DrawnNode, children: list[int]) -> dict[str, Any]:
        """Add the meshes of a node to the document; return the node as glTF, without adding it."""
        gltf_node: dict[str, Any] = {
            "name": node.name,
            "translation": node.position,
            "rotation": node.rotation,
            "children": children,
            "extras": dict(node.extras),
        }
        if node.meshes:
            primitives = [self._primitive(mesh) for mesh in node.meshes]
            self.meshes.append({"name": node.name, "primitives": primitives})
            gltf_node["mesh"] = len(self.meshes) - 1
        return gltf_node

    def _primitive(self, mesh: Mesh) -> dict[str, Any]:
        corners = np.ascontiguousarray(mesh.corners, dtype="<f4")
        kind, dtype = (_SHORT, "<u2") if len(corners) <= 0xFFFF else (_INT, "<u4")
        indices = np.ascontiguousarray(mesh.triangles.ravel(), dtype=dtype)
        positions = self._accessor(corners.tobytes(), len(corners), "VEC3", _FLOAT, _ARRAY_BUFFER)
        self.accessors[positions] |= {
            "min": corners.min(axis=0).tolist(),
            "max": corners.max(axis=0).tolist(),
        }
        index_accessor = self._accessor(
            indices.tobytes(), len(indices), "SCALAR", kind, _ELEMENT_BUFFER
        )
        return {
            "attributes": {"POSITION": positions},
            "indices": index_accessor,
            "material": self._material(mesh),
        }

    def _accessor(
        self, content: bytes, count: int, element_type: str, component_type: int, target: int
    ) -> int:
        """Add data for a buffer target, with an accessor of `count` elements; return its index."""
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
            {
                "bufferView": view,
                "componentType": component_type,
                "count": count,
                "type": element_type,
            }
        )
        return len(self.accessors) - 1

    def _material(self, mesh: Mesh) -> int:
        """Return the index of a mesh's material, which is added if it is new."""
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


def _linear(value: float) -> float:
    """Return the linear value of an sRGB component (IEC 61966-2-1), as glTF needs it."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
