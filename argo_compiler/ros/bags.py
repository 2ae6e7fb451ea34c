"""Reading and writing of missions in ROS 1 bags, rosbag2 folders, and single storage files."""

import os
import re
import sqlite3
import struct
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Any

from argo_compiler.base.errors import Invalid
from argo_compiler.base.limited_process import LimitExceeded, call_limited, limits_for_size
from argo_compiler.base.message import Listing, Message
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.loading import (
    FileError,
    is_own_open_file,
    is_pipe,
    read_bytes,
    size_on_disk,
)
from argo_compiler.files.mission_file import MAX_BYTES
from argo_compiler.il import Mission
from argo_compiler.ros.compression import (
    TooLargeError,
    require_readable_metadata,
    require_small_mcap_chunks,
    require_small_ros1_chunks,
)
from argo_compiler.ros.messages import Received, from_message, raise_error, to_message
from argo_compiler.ros.package import SPECIFICATION
from argo_compiler.ros.recognition import (
    MAGIC,
    MCAP,
    ROS1,
    SQLITE,
    first_bytes_if_readable,
    read_first_bytes,
)
from argo_compiler.ros.types import RosTypes, ros1_types, ros2_types

TOPIC = "/mission"
STAMP = 1_000_000_000
"""Time in ns at which the only message was published.

The time is fixed so that equal missions give equal bags; it is not 0, which means unset in ROS 1.
"""

_UNPACK = Message("unpack it first: rosbag decompress, or ros2 bag convert")
_OF_PYTHON = (
    ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError, TypeError,
    UnicodeError, struct.error,
)  # fmt: skip
"""errors whose texts are for programmers"""
_MAX_COPIED_BYTES = 1_000_000_000
"""Largest size of a bag that has to be copied before it is read, such as `/dev/stdin`."""
_MAX_LISTED_TOPICS = 8
"""Number of topics that an error lists."""
_MODULES = ("rosbags.rosbag1", "rosbags.rosbag2")
_CALCULATED = re.compile(r"\b(virtual|as)\b", re.IGNORECASE)
"""words in the definition of a table whose content is calculated; recorders write neither"""


class Storage(StrEnum):
    """Storage format of a rosbag2."""

    SQLITE3 = "sqlite3"
    MCAP = "mcap"


def to_ros1_bag(mission: Mission) -> bytes:
    """Return a ROS 1 bag (format 2.0) with the mission on the latched topic /mission.

    Raises ArgoError if `rosbags` is not installed, and DiagnosticError as `to_message` does.
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
    """Return the files of a rosbag2 folder with the mission on the topic /mission.

    The metadata have version 8; the topic is transient local and reliable. Raises the same errors
    as `to_ros1_bag`.
    """
    types = ros2_types()
    content = types.encode(to_message(mission, types))
    from rosbags.rosbag2 import StoragePlugin, Writer

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission"
        with Writer(path, version=8, storage_plugin=StoragePlugin[storage.name]) as writer:
            connection = writer.add_connection(
                TOPIC, SPECIFICATION, typestore=types.store, offered_qos_profiles=[_latched_qos()]
            )
            writer.write(connection, STAMP, content)
        return {file.name: file.read_bytes() for file in sorted(path.iterdir())}


def _latched_qos() -> Any:
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
    """Return the mission on the topic /mission of a ROS 1 bag, a rosbag2 folder, or its file.

    The bag may contain the same mission several times, as happens when a latched topic is recorded.
    Messages call the bag `source_name`, or by its path if that is None. It is read in a process
    with limits of time and memory.

    Raises:
        DiagnosticError: The file is not such a bag, or contains no mission or different missions,
            or exceeds the limits.
        ArgoError: `rosbags` is not installed.
    """
    name = str(path) if source_name is None else source_name
    if not is_pipe(path):
        _first_bytes(path, name)  # what is no bag needs no process
    if is_own_open_file(path):
        return decode_bag(read_bytes(path, "bag", _MAX_COPIED_BYTES), name)
    limits = limits_for_size(size_on_disk(path))
    try:
        return call_limited(limits, _MODULES, read_bag_here, path, name)
    except LimitExceeded as error:
        raise_error(
            name,
            "file.beyond-limits",
            Message("the file {error}", error=error),
            Message("is it the right file, and whole? If it is, record {topic} alone", topic=TOPIC),
        )


def read_bag_here(path: Path, name: str) -> Received:
    """Return the mission of a bag, as `read_bag`, but in this process and without its limits."""
    first = _first_bytes(path, name)
    types = ros1_types() if first.startswith(ROS1) else ros2_types()
    # For broken bytes, rosbags raises errors of many types: its own, those of SQLite, struct, YAML
    # and the decompressors, KeyError, AssertionError.
    try:
        with _open_reader(path, first) as reader:
            content = _read_message(name, reader, types)
        message = types.decode(content)
    except (DiagnosticError, MemoryError):
        raise
    except TooLargeError as error:
        raise_error(
            name,
            "ros.compressed",
            Message("the bag is not unpacked: {error}", error=error),
            _UNPACK,
        )
    except Exception as error:
        raise_error(
            name,
            "ros.broken-bag",
            Message("the file can't be read as a bag: {reason}", reason=_reason(error)),
            Message("record or copy it again"),
        )
    return from_message(message, types, name)


def _reason(error: Exception) -> str:
    """Return why a bag can't be read; a text of Python, which helps nobody, is replaced."""
    text = " ".join(str(error).split())[:200].replace("; please report issue", "")
    is_from_python = isinstance(error, _OF_PYTHON) or isinstance(error.__cause__, _OF_PYTHON)
    if not text or is_from_python or re.search(r"\w+Error\(", text):
        return Message("a part of it is damaged, or is not that of a bag")
    return text


def _first_bytes(path: Path, name: str) -> bytes:
    """Return the first bytes of a bag's file; none of a rosbag2 folder.

    Raises DiagnosticError, which calls the file `name`, for what can't be read or is no bag.
    """
    is_folder = os.path.isdir(path)
    if is_folder and not os.path.isfile(path / "metadata.yaml"):
        hint = Message(
            "choose the script, mission or bag in it; a rosbag2 folder has a metadata.yaml"
        )
        raise_error(name, "file.directory", Message("the path is a directory"), hint)
    try:
        first = b"" if is_folder else read_first_bytes(path)
    except FileError as error:
        raise_error(
            name,
            f"file.{error.problem}",
            Message("the file {message}", message=error.message),
            error.hint,
        )
    if not is_folder and not first.startswith(MAGIC):
        raise_error(
            name,
            "ros.not-a-bag",
            Message("the file is not a bag"),
            Message("choose a ROS 1 bag or a rosbag2 folder"),
        )
    return first


def decode_bag(content: bytes | Mapping[str, bytes], source_name: str) -> Received:
    """Return the mission in a bag's bytes, or in the files of a rosbag2 folder by their names.

    Raises the same errors as `read_bag`, and Invalid for names that lead out of the folder.
    """
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(content, bytes):
            path = Path(folder) / f"bag{suffix_by_first_bytes(content[:16])}"
            path.write_bytes(content)
            return read_bag(path, source_name)
        for name, part in content.items():
            if Path(name).name != name or name in {"", ".", ".."} or "\0" in name:
                raise Invalid(
                    Message(
                        "{source_name}: `{name}` is not a valid file name in a rosbag2 folder",
                        source_name=source_name,
                        name=name,
                    )
                )
            (Path(folder) / name).write_bytes(part)
        return read_bag(Path(folder), source_name)


def suffix_by_first_bytes(first: bytes) -> str:
    """Return the suffix by which rosbags recognizes the storage of a file with these bytes."""
    if first.startswith(ROS1):
        return ".bag"
    return ".db3" if first.startswith(SQLITE) else ".mcap"


@contextmanager
def _open_reader(path: Path, first: bytes) -> Iterator[Any]:
    if first.startswith(ROS1):
        from rosbags.rosbag1 import Reader as Ros1Reader

        with Ros1Reader(path) as reader:
            connections = {c.id for c in reader.connections if c.topic == TOPIC}
            require_small_ros1_chunks(reader, connections)
            yield reader
    else:
        from rosbags.rosbag2 import Reader as Ros2Reader

        if os.path.isdir(path):
            require_readable_metadata(path)
        for file in path.glob("*") if os.path.isdir(path) else [path]:
            if not os.path.isfile(file) and not os.path.isdir(file):
                raise ValueError(f"`{file.name}` in it is not a file")
            start = first_bytes_if_readable(file)
            if start.startswith(MCAP):
                require_small_mcap_chunks(file)
            elif start.startswith(SQLITE):
                _require_whole_database(file)
                _require_plain_tables(file)
        with Ros2Reader(path) as reader:
            yield reader


def _require_whole_database(file: Path) -> None:
    """Raise ValueError if an SQLite file is shorter than it says.

    SQLite itself notices this or not, depending on its version and on what is missing.
    """
    with open(file, "rb") as opened:
        header = opened.read(100)
    page_size, changes, pages, changes_at_size = struct.unpack(">16xH6xII60xI4x", header)
    is_size_known = changes == changes_at_size
    if is_size_known and os.path.getsize(file) < pages * (65536 if page_size == 1 else page_size):
        raise ValueError("its end is missing")


def _require_plain_tables(file: Path) -> None:
    """Raise ValueError if an SQLite file has other parts than tables that hold their content.

    The content of a view or a generated column is calculated, and may be without end.
    """
    database = sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro&immutable=1", uri=True)
    with closing(database):
        for kind, name, definition in database.execute("SELECT type, name, sql FROM sqlite_master"):
            if kind not in ("table", "index") or _CALCULATED.search(definition or ""):
                raise ValueError(f"the content of its {kind} {name} is calculated, not recorded")


def _read_message(name: str, reader: Any, types: RosTypes) -> bytes:
    """Return the bytes of the message on /mission, which may be repeated but must not differ.

    Messages for people call the bag `name`.
    """
    connections = [c for c in reader.connections if c.topic == TOPIC]
    if not connections:
        topics = sorted({c.topic for c in reader.connections})
        more = ", ..." if len(topics) > _MAX_LISTED_TOPICS else ""
        listed = (
            Message("only {names}{more}", names=Listing(topics[:_MAX_LISTED_TOPICS]), more=more)
            if topics
            else Message("no topic at all")
        )
        raise_error(
            name,
            "ros.no-mission",
            Message("the bag has no topic {topic}, {listed}", topic=TOPIC, listed=listed),
            Message("record {topic}", topic=TOPIC),
        )
    for connection in connections:
        if connection.msgtype != SPECIFICATION:
            raise_error(
                name,
                "ros.wrong-type",
                Message(
                    "the bag has messages of the type {msgtype} on {topic}",
                    msgtype=connection.msgtype,
                    topic=TOPIC,
                ),
                Message("the type of a mission is {specification}", specification=SPECIFICATION),
            )
        # Bags from before ROS 2 Iron, and single MCAP files, have no type hash.
        if connection.digest and connection.digest != types.digest():
            raise_error(
                name,
                "ros.other-definitions",
                Message(
                    "the bag was written with other definitions of {specification}: {digest}",
                    specification=SPECIFICATION,
                    digest=connection.digest,
                ),
                Message(
                    "this Argo uses {digest}: build its ros-package and record again",
                    digest=types.digest(),
                ),
            )
    contents: set[bytes] = set()
    for _, _, raw in reader.messages(connections=connections):
        if len(raw) > MAX_BYTES:
            raise_error(
                name,
                "file.too-large",
                Message(
                    "the bag has a message larger than {max_bytes} MB",
                    max_bytes=MAX_BYTES // 1000000,
                ),
                Message("a mission is far smaller: is this the right bag?"),
            )
        contents.add(bytes(raw))
        if len(contents) > 1:
            raise_error(
                name,
                "ros.several-missions",
                Message("the bag contains more than one mission on {topic}", topic=TOPIC),
                Message("keep one of them: rosbag filter, or ros2 bag convert"),
            )
    if not contents:
        raise_error(
            name,
            "ros.no-mission",
            Message("the bag has no message on {topic}", topic=TOPIC),
            Message("record {topic} again", topic=TOPIC),
        )
    return contents.pop()
