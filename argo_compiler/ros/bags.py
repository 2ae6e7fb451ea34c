"""Missions in bags: ROS 1 bags, rosbag2 folders, and the files of their storages."""

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Any

from argo_compiler.base.errors import Invalid
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.loading import FileError
from argo_compiler.il import Mission
from argo_compiler.ros.compression import (
    TooLargeError,
    check_mcap_chunks,
    check_metadata,
    check_ros1_chunks,
)
from argo_compiler.ros.messages import Received, from_message, refuse, to_message
from argo_compiler.ros.package import SPECIFICATION
from argo_compiler.ros.recognition import MAGIC, MCAP, ROS1, SQLITE, beginning, first_bytes
from argo_compiler.ros.types import RosTypes, ros1_types, ros2_types

TOPIC = "/mission"
STAMP = 1_000_000_000
"""ns; when the only message was published. Fixed, so that equal missions make equal bags; not 0,
which ROS 1 takes for unset."""

MAX_BYTES = 50_000_000
"""of a message, as of a mission's file"""

_UNPACK = "unpack it first: rosbag decompress, or ros2 bag convert"
_MAX_MESSAGES = 1000
"""that may repeat the same mission"""
_SHOWN = 8
"""topics that a message lists"""


class Storage(StrEnum):
    """What holds the messages of a rosbag2."""

    SQLITE3 = "sqlite3"
    MCAP = "mcap"


def to_ros1_bag(mission: Mission) -> bytes:
    """A ROS 1 bag (format 2.0) with the mission on /mission, latched.

    Raises ArgoError where `rosbags` is not installed, DiagnosticError as `to_message` does.
    """
    types = ros1_types()
    content = types.encode(to_message(mission, types))
    from rosbags.rosbag1 import Writer

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.bag"
        with Writer(path) as writer:
            connection = writer.add_connection(
                TOPIC, SPECIFICATION, typestore=types.store, callerid="/argo", latching=1
            )
            writer.write(connection, STAMP, content)
        return path.read_bytes()


def to_ros2_bag(mission: Mission, storage: Storage = Storage.SQLITE3) -> dict[str, bytes]:
    """The files of a rosbag2 folder (metadata version 8) with the mission on /mission, transient
    local and reliable. Raises as `to_ros1_bag`."""
    types = ros2_types()
    content = types.encode(to_message(mission, types))
    from rosbags.rosbag2 import StoragePlugin, Writer

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission"
        with Writer(path, version=8, storage_plugin=StoragePlugin[storage.name]) as writer:
            connection = writer.add_connection(
                TOPIC, SPECIFICATION, typestore=types.store, offered_qos_profiles=[_latched()]
            )
            writer.write(connection, STAMP, content)
        return {file.name: file.read_bytes() for file in sorted(path.iterdir())}


def _latched() -> Any:
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    forever = QosTime(9_223_372_036, 854_775_807)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL,
        deadline=forever,
        lifespan=forever,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=forever,
        avoid_ros_namespace_conventions=False,
    )


def read_bag(path: Path, source_name: str | None = None) -> Received:
    """The mission on the topic /mission of a ROS 1 bag, a rosbag2 folder, or one of its files.

    The same mission may be there several times, as it is when a latched topic is recorded.
    Messages call the bag `source_name`, or else by its path.

    Raises:
        DiagnosticError: the file is no such bag, or holds no mission or different ones.
        ArgoError: `rosbags` is not installed.
    """
    name = str(path) if source_name is None else source_name
    is_folder = os.path.isdir(path)
    if is_folder and not os.path.isfile(path / "metadata.yaml"):
        hint = "name the script, mission or bag in it; a rosbag2 folder has a metadata.yaml"
        refuse(name, "file.directory", "is a directory", hint)
    try:
        first = b"" if is_folder else beginning(path)
    except FileError as error:
        refuse(name, f"file.{error.problem}", error.message, error.hint)
    if not is_folder and not first.startswith(MAGIC):
        refuse(name, "ros.not-a-bag", "is no bag", "name a ROS 1 bag or a rosbag2 folder")
    types = ros1_types() if first.startswith(ROS1) else ros2_types()
    # rosbags raises whatever the broken bytes lead to: errors of its own, of SQLite, of struct, of
    # YAML, of the decompressors, KeyError, AssertionError.
    try:
        with _open(path, first) as reader:
            content = _read(name, reader, types)
        message = types.decode(content)
    except DiagnosticError:
        raise
    except TooLargeError as error:
        refuse(name, "ros.compressed", f"is not unpacked: {error}", _UNPACK)
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        refuse(
            name, "ros.broken-bag", f"can't be read as a bag: {reason}", "record or copy it anew"
        )
    return from_message(message, types, name)


def decode_bag(content: bytes | Mapping[str, bytes], source_name: str) -> Received:
    """The same of a bag's bytes, or of the files of a rosbag2 folder by their names. Raises as
    `read_bag`, and Invalid for names that lead out of the folder."""
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(content, bytes):
            # The suffix matters to rosbags: it picks the storage.
            first = content[: len(SQLITE)]
            suffix = ".bag" if first.startswith(ROS1) else ".mcap"
            suffix = ".db3" if first.startswith(SQLITE) else suffix
            path = Path(folder) / f"bag{suffix}"
            path.write_bytes(content)
            return read_bag(path, source_name)
        for name, part in content.items():
            if Path(name).name != name or name in {"", ".", ".."} or "\0" in name:
                raise Invalid(f"{source_name}: `{name}` is no name of a file in a rosbag2 folder")
            (Path(folder) / name).write_bytes(part)
        return read_bag(Path(folder), source_name)


@contextmanager
def _open(path: Path, first: bytes) -> Iterator[Any]:
    if first.startswith(ROS1):
        from rosbags.rosbag1 import Reader as Ros1Reader

        with Ros1Reader(path) as reader:
            wanted = {c.id for c in reader.connections if c.topic == TOPIC}
            check_ros1_chunks(reader, wanted)
            yield reader
    else:
        from rosbags.rosbag2 import Reader as Ros2Reader

        if os.path.isdir(path):
            check_metadata(path)
        for file in path.glob("*") if os.path.isdir(path) else [path]:
            if first_bytes(file).startswith(MCAP):
                check_mcap_chunks(file)
        with Ros2Reader(path) as reader:
            yield reader


def _read(name: str, reader: Any, types: RosTypes) -> bytes:
    connections = [c for c in reader.connections if c.topic == TOPIC]
    if not connections:
        topics = sorted({c.topic for c in reader.connections})
        more = ", ..." if len(topics) > _SHOWN else ""
        listed = f"only {', '.join(topics[:_SHOWN])}{more}" if topics else "no topic at all"
        refuse(name, "ros.no-mission", f"has no topic {TOPIC}, {listed}", f"record {TOPIC}")
    for connection in connections:
        if connection.msgtype != SPECIFICATION:
            refuse(
                name,
                "ros.wrong-type",
                f"has messages of the type {connection.msgtype} on {TOPIC}",
                f"a mission is a {SPECIFICATION}",
            )
        # Bags from before ROS 2 Iron, and MCAP files by themselves, hold no type hash.
        if connection.digest and connection.digest != types.digest():
            refuse(
                name,
                "ros.other-definitions",
                f"was written with other definitions of {SPECIFICATION}: {connection.digest}",
                f"this Argo's are {types.digest()}: build its ros-package and record anew",
            )
    found: set[bytes] = set()
    for count, (_, _, raw) in enumerate(reader.messages(connections=connections), 1):
        if len(raw) > MAX_BYTES:
            refuse(
                name,
                "file.too-large",
                f"has a message larger than {MAX_BYTES // 1_000_000} MB",
                "a mission is far smaller: is this the right bag?",
            )
        found.add(bytes(raw))
        if len(found) > 1 or count > _MAX_MESSAGES:
            refuse(
                name,
                "ros.several-missions",
                f"holds more than one mission on {TOPIC}",
                "keep one of them: rosbag filter, or ros2 bag convert",
            )
    if not found:
        refuse(name, "ros.no-mission", f"has no message on {TOPIC}", f"record {TOPIC} again")
    return found.pop()
