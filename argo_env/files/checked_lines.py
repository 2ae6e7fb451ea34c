"""Files of lines with checksums, which a process that is killed leaves whole but for the last one.

Each line is a checksum and an object as JSON. What has been written and synced stays.
"""

import json
import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def checked_line(data: Mapping[str, Any]) -> bytes:
    """The object as a line with its checksum and line end."""
    payload = json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(payload), payload)


def checked_object(line: bytes) -> dict[str, Any] | None:
    """The object in a line without its line end; None if the checksum does not fit."""
    checksum, _, payload = line.partition(b" ")
    if checksum != b"%08x" % zlib.crc32(payload):
        return None
    try:
        data = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return data if isinstance(data, dict) else None


def write_all(file: int, data: bytes) -> None:
    """Writes to an open file. Raises OSError; a part may have been written then."""
    while data:
        data = data[os.write(file, data) :]


def cut_off(file: int, size: int) -> None:
    """Takes back what was written of a line beyond the size (bytes), if the disk lets us; else it
    is a torn one."""
    try:
        os.ftruncate(file, size)
    except OSError:
        return


def sync_folder(folder: Path) -> None:
    """So that the names of the files in it are on disk as well. Raises OSError."""
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
