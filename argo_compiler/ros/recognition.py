"""Recognition of bags by their names and first bytes, without importing their readers."""

import os
from pathlib import Path

from argo_compiler.files.loading import FileError, open_file

ROS1 = b"#ROSBAG V"
MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
MAGIC = (ROS1, MCAP, SQLITE)
"""First bytes of the files that contain a bag or a part of a bag."""


def is_bag(path: Path) -> bool:
    """Return True if the path is to be read as a bag: any folder, or a file that looks like one."""
    return os.path.isdir(path) or is_bag_content(path.name, first_bytes_if_readable(path))


def is_bag_content(name: str, content: bytes) -> bool:
    """Return True if a file is to be read as a bag, by its suffix or its first bytes."""
    return Path(name).suffix.lower() in {".bag", ".mcap", ".db3"} or content.startswith(MAGIC)


def first_bytes_if_readable(path: Path) -> bytes:
    """Return the first bytes of a file; empty if the path can't be read or is not a file."""
    if not os.path.isfile(path):  # bytes that are read from a pipe are lost for the next reader
        return b""
    try:
        return read_first_bytes(path)
    except FileError:
        return b""  # a later attempt to read the whole file reports the error


def read_first_bytes(path: Path) -> bytes:
    """Return the first bytes of a file, enough for `MAGIC`. Raises FileError on failure."""
    with open_file(path, "bag") as file:
        return file.read(16)
