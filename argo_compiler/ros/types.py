"""Messages as Python objects and as bytes; `rosbags` makes their types from the definitions."""

from collections.abc import Iterator
from enum import Enum
from functools import cache
from typing import Any, TypeVar

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.base.message import Message
from argo_compiler.ros.package import PACKAGE, SPECIFICATION, message_definitions

E = TypeVar("E", bound=Enum)


class RosTypes:
    """Message types of one version of ROS, 1 or 2."""

    def __init__(self, version: int) -> None:
        try:
            from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        except ImportError:
            raise Unavailable(
                Message(
                    "ROS messages and bags need rosbags: {install_line}",
                    install_line=install_line("ros"),
                )
            ) from None
        self.version = version
        self.store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_JAZZY)
        for name, text in message_definitions().items():
            self.store.register(get_types_from_msg(text, name))

    def new(self, message: str, /, **fields: Any) -> Any:
        """Return a new message of `argo_mission_msgs`; omitted fields are 0 or empty."""
        return self._make(f"{PACKAGE}/msg/{message}", fields)

    def fields(self, message: str) -> Iterator[tuple[str, str]]:
        """Yield the name and the type of each field of a message."""
        for name, (_, detail) in self.store.fielddefs[f"{PACKAGE}/msg/{message}"][1]:
            yield name, str(detail[0])

    def pose(self, x: float, y: float, z: float, qz: float, qw: float) -> Any:
        """Return a geometry_msgs/Pose with a rotation about z."""
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
        """Return a sensor_msgs/JointState without a header."""
        import numpy as np

        values = {"position": positions, "velocity": velocities, "effort": efforts}
        arrays = {name: np.array(numbers, dtype=np.float64) for name, numbers in values.items()}
        return self._make("sensor_msgs/msg/JointState", {"name": list(names), **arrays})

    def enum_constants(self, message: str, enumeration: type[E], prefix: str = "") -> dict[E, int]:
        """Return the message's constants for an enumeration: `prefix` and the member's name."""
        return {m: self.constant(message, prefix + m.name) for m in enumeration}

    def constant(self, message: str, name: str) -> int:
        """Return the value of the constant `name` in the definition of a message."""
        return int(getattr(self.store.types[f"{PACKAGE}/msg/{message}"], name))

    def encode(self, mission: Any) -> bytes:
        """Return a MissionSpecification as bytes, encoded for the ROS version (ROS 2: CDR)."""
        serialize = self.store.serialize_ros1 if self.version == 1 else self.store.serialize_cdr
        return bytes(serialize(mission, SPECIFICATION))

    def decode(self, content: bytes) -> Any:
        """Return the MissionSpecification in the bytes.

        For other bytes, rosbags raises exceptions of many types.
        """
        if self.version == 1:
            return self.store.deserialize_ros1(content, SPECIFICATION)
        return self.store.deserialize_cdr(content, SPECIFICATION)

    def digest(self) -> str:
        """Return the digest by which ROS compares definitions of MissionSpecification.

        It is the MD5 sum in ROS 1 and the type hash in ROS 2.
        """
        if self.version == 1:
            return self.store.generate_msgdef(SPECIFICATION)[1]
        return self.store.hash_rihs01(SPECIFICATION)

    def _make(self, typename: str, fields: dict[str, Any]) -> Any:
        field_types = self.store.fielddefs[typename][1]
        return self.store.types[typename](
            *(fields[name] if name in fields else self._default(t) for name, t in field_types)
        )

    def _default(self, field_type: Any) -> Any:
        import numpy as np
        from rosbags.interfaces import Nodetype

        kind, detail = field_type
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
    """Return the message types of ROS 1. Raises ArgoError if `rosbags` is not installed."""
    return RosTypes(1)


@cache
def ros2_types() -> RosTypes:
    """Return the message types of ROS 2. Raises ArgoError if `rosbags` is not installed."""
    return RosTypes(2)
