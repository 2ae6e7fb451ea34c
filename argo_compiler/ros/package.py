"""The ROS package of the messages, `argo_mission_msgs`, which comes with Argo."""

from importlib.resources import files

PACKAGE = "argo_mission_msgs"
SPECIFICATION = f"{PACKAGE}/msg/MissionSpecification"


def message_package() -> dict[str, bytes]:
    """The files of the package by their path in it; catkin and colcon build it as it is."""
    root = files(__package__) / PACKAGE
    messages = {f"msg/{file.name}": file.read_bytes() for file in (root / "msg").iterdir()}
    described = {name: (root / name).read_bytes() for name in ("CMakeLists.txt", "package.xml")}
    return described | dict(sorted(messages.items()))


def definitions() -> dict[str, str]:
    """The text of each message's definition by its full name."""
    return {
        f"{PACKAGE}/{path.removesuffix('.msg')}": content.decode("utf-8")
        for path, content in message_package().items()
        if path.endswith(".msg")
    }
