"""Missions as ROS messages and bags, for ROS 1 and ROS 2, without a ROS installation.

`argo_mission_msgs/` is the ROS package of the messages; its files describe the meaning of each
field.
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "Received",
    "RosTypes",
    "Storage",
    "decode_bag",
    "from_message",
    "is_bag",
    "is_bag_content",
    "message_package",
    "read_bag",
    "ros1_types",
    "ros2_types",
    "to_message",
    "to_ros1_bag",
    "to_ros2_bag",
]

if TYPE_CHECKING:
    from argo_compiler.ros.bags import (
        Storage,
        decode_bag,
        read_bag,
        to_ros1_bag,
        to_ros2_bag,
    )
    from argo_compiler.ros.messages import Received, from_message, to_message
    from argo_compiler.ros.package import message_package
    from argo_compiler.ros.recognition import is_bag, is_bag_content
    from argo_compiler.ros.types import RosTypes, ros1_types, ros2_types
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "bags": [
                "Storage",
                "decode_bag",
                "read_bag",
                "to_ros1_bag",
                "to_ros2_bag",
            ],
            "messages": ["Received", "from_message", "to_message"],
            "package": ["message_package"],
            "recognition": ["is_bag", "is_bag_content"],
            "types": ["RosTypes", "ros1_types", "ros2_types"],
        },
    )
