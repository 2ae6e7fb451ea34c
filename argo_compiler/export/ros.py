"""Exporters for ROS bags and for the ROS package of their messages.

The content is made in `argo_compiler.ros`.
"""

from argo_compiler.export.exporter import Exporter
from argo_compiler.ros import Storage, message_package, to_ros1_bag, to_ros2_bag

ROS_EXPORTERS: dict[str, Exporter] = {
    "ros1-bag": Exporter("ROS 1 bag", (".bag",), lambda given: to_ros1_bag(given.mission)),
    "ros2-bag": Exporter(
        "ROS 2 bag, SQLite storage", (), lambda given: to_ros2_bag(given.mission, Storage.SQLITE3)
    ),
    "ros2-mcap": Exporter(
        "ROS 2 bag, MCAP storage", (), lambda given: to_ros2_bag(given.mission, Storage.MCAP)
    ),
    "ros-package": Exporter(
        "ROS package of the messages, the same for every mission",
        (),
        lambda _: message_package(),
    ),
}
