"""The messages as Python objects and as bytes: made by `rosbags` from their definitions."""

from collections.abc import Iterator
from enum import Enum
from functools import cache
from typing import Any, TypeVar

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.ros.package import PACKAGE, SPECIFICATION, definitions

E = TypeVar("E", bound=Enum)


class RosTypes:
    """The messages of one version of ROS, 1 or 2."""

    def __init__(self, version: int) -> None:
        try:
            from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        except ImportError:
            raise Unavailable(
                f"ROS messages and bags need rosbags: {install_line('ros')}"
            ) from None
        self.version = version
        self.store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_JAZZY)
        for name, text in definitions().items():
            self.store.register(get_types_from_msg(text, name))

    def new(self, message: str, /, **fields: Any) -> Any:
        """A message of `argo_mission_msgs`; fields that are not given are 0 or empty."""
        return self._make(f"{PACKAGE}/msg/{message}", fields)

    def fields(self, message: str) -> Iterator[tuple[str, str]]:
        """The fields of a message, each with its type."""
        for name, (_, detail) in self.store.fielddefs[f"{PACKAGE}/msg/{message}"][1]:
            yield name, str(detail[0])

    def pose(self, x: float, y: float, z: float, qz: float, qw: float) -> Any:
        """A geometry_msgs/Pose, turned about z only."""
        return self._make(
            "geometry_msgs/msg/Pose",
            {
                "position": self._make("geometry_msgs/msg/Point", {"x": x, "y": y, "z": z}),
                "orientation": self._make("geometry_msgs/msg/Quaternion", {"z": qz, "w": qw}),
            },
        )

    def joint_state(
        self,
        names: tuple[str, ...] = (),
        positions: tuple[float, ...] = (),
        velocities: tuple[float, ...] = (),
        efforts: tuple[float, ...] = (),
    ) -> Any:
        """A sensor_msgs/JointState without a header."""
        import numpy as np

        values = {"position": positions, "velocity": velocities, "effort": efforts}
        arrays = {name: np.array(given, dtype=np.float64) for name, given in values.items()}
        return self._make("sensor_msgs/msg/JointState", {"name": list(names), **arrays})

    def numbers(self, message: str, values: type[E], prefix: str = "") -> dict[E, int]:
        """The constants that a message has for the members of an enumeration."""
        return {v: self.constant(message, prefix + v.name) for v in values}

    def constant(self, message: str, name: str) -> int:
        """A constant of a message, by its name there."""
        return int(getattr(self.store.types[f"{PACKAGE}/msg/{message}"], name))

    def encode(self, mission: Any) -> bytes:
        """A MissionSpecification as bytes: CDR in ROS 2."""
        serialize = self.store.serialize_ros1 if self.version == 1 else self.store.serialize_cdr
        return bytes(serialize(mission, SPECIFICATION))

    def decode(self, content: bytes) -> Any:
        """A MissionSpecification from bytes. What is raised for bytes that are none is up to
        rosbags."""
        if self.version == 1:
            return self.store.deserialize_ros1(content, SPECIFICATION)
        return self.store.deserialize_cdr(content, SPECIFICATION)

    def digest(self) -> str:
        """By which ROS compares definitions: the MD5 sum in ROS 1, the type hash in ROS 2."""
        if self.version == 1:
            return self.store.generate_msgdef(SPECIFICATION)[1]
        return self.store.hash_rihs01(SPECIFICATION)

    def _make(self, typename: str, fields: dict[str, Any]) -> Any:
        described = self.store.fielddefs[typename][1]
        return self.store.types[typename](
            *(fields[name] if name in fields else self._default(desc) for name, desc in described)
        )

    def _default(self, description: Any) -> Any:
        import numpy as np
        from rosbags.interfaces import Nodetype

        kind, detail = description
        if kind is Nodetype.NAME:
            return self._make(detail, {})
        if kind is Nodetype.BASE:
            name = detail[0]
            return {"string": "", "bool": False, "float64": 0.0}.get(name, 0)
        element_kind, element = detail[0]
        if element_kind is Nodetype.BASE and element[0] != "string":
            return np.empty(0, dtype=element[0])
        return []


@cache
def ros1_types() -> RosTypes:
    """The messages of ROS 1. Raises ArgoError where `rosbags` is not installed."""
    return RosTypes(1)


@cache
def ros2_types() -> RosTypes:
    """The messages of ROS 2. Raises ArgoError where `rosbags` is not installed."""
    return RosTypes(2)
