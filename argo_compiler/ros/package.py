"""ROS package of the messages, `argo_mission_msgs`, which is shipped with Argo."""

from importlib.resources import files

PACKAGE = "argo_mission_msgs"
SPECIFICATION = f"{PACKAGE}/msg/MissionSpecification"


def message_package() -> dict[str, bytes]:
    """Return the package's files by their path in it; catkin and colcon can build it unchanged."""
    root = files(__package__) / PACKAGE
    messages = {f"msg/{file.name}": file.read_bytes() for file in (root / "msg").iterdir()}
    build_files = {name: (root / name).read_bytes() for name in ("CMakeLists.txt", "package.xml")}
    return build_files | dict(sorted(messages.items()))


def message_definitions() -> dict[str, str]:
    """Return the text of each message's definition by the message's full name."""
    return {
        f"{PACKAGE}/{path.removesuffix('.msg')}": content.decode("utf-8")
        for path, content in message_package().items()
        if path.endswith(".msg")
    }
