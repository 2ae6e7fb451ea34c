"""Files of lines with checksums; if the process is killed, only the last line can be damaged.

Each line is a checksum and an object as JSON. Lines that have been written and synced are never
lost.
"""

import json
import os
import zlib
from collections.abc import Mapping
from typing import Any


def checked_line(data: Mapping[str, Any]) -> bytes:
    """Return the line that stores an object: a checksum, the object as JSON, and a line end."""
    payload = json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(payload), payload)


def checked_object(line: bytes) -> dict[str, Any] | None:
    """Return the object that `checked_line` stored in a line, given without its line end.

    Returns None if the checksum does not match or the line holds no JSON object.
    """
    checksum, _, payload = line.partition(b" ")
    if checksum != b"%08x" % zlib.crc32(payload):
        return None
    try:
        data = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return data if isinstance(data, dict) else None


def write_all(file: int, data: bytes) -> None:
    """Write all data to an open file; an OSError may leave a part of the data written."""
    while data:
        data = data[os.write(file, data) :]


def truncate_if_possible(file: int, size: int) -> None:
    """Truncate an open file to `size` bytes, to remove a line that was written in part.

    If that fails, no error is raised: the damaged line stays, and its checksum does not match.
    """
    try:
        os.ftruncate(file, size)
    except OSError:
        return
