"""Recognition of bags by their names and first bytes, without what reads them."""

import os
from pathlib import Path

from argo_compiler.files.loading import FileError, open_file

ROS1 = b"#ROSBAG V"
MCAP = b"\x89MCAP0\r\n"
SQLITE = b"SQLite format 3\0"
MAGIC = (ROS1, MCAP, SQLITE)
"""first bytes of the files that hold a bag, or a part of one"""


def is_bag(path: Path) -> bool:
    """Return True if the path is meant as a bag: a folder, a bag's first bytes, or its suffix."""
    return os.path.isdir(path) or is_bag_content(path.name, first_bytes(path))


def is_bag_content(name: str, content: bytes) -> bool:
    """Return True if a file is meant as a bag, by its name or its first bytes."""
    return Path(name).suffix.lower() in {".bag", ".mcap", ".db3"} or content.startswith(MAGIC)


def first_bytes(path: Path) -> bytes:
    """Return the first bytes of a file; none of what can't be read, or is no file."""
    if not os.path.isfile(path):  # what is read of a pipe is gone
        return b""
    try:
        return beginning(path)
    except FileError:
        return b""  # reading it in earnest says what is wrong


def beginning(path: Path) -> bytes:
    """Return enough of a file to tell what it is. Raises FileError if it can't be read."""
    with open_file(path, "bag") as file:
        return file.read(16)
