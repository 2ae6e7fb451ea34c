"""Limits for the size of compressed parts of a bag, checked before the bag is read.

rosbags unpacks a chunk in one step without a limit; a few kilobytes may become terabytes.
"""

import bz2
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

from argo_compiler.base.message import Message
from argo_compiler.files.yaml_text import load_yaml

MAX_CHUNK_BYTES = 100_000_000
"""Largest size of an unpacked chunk; recorders start a new chunk after a few megabytes."""
MAX_METADATA_BYTES = 1_000_000
MAX_VERSION = 9
"""Newest version of the metadata of rosbag2 that rosbags reads."""


class TooLargeError(Exception):
    """Raised when a compressed part is too large, or might be; the message names the part."""


def require_small_ros1_chunks(reader: Any, connections: set[int]) -> None:
    """Raise TooLargeError if a chunk with messages of these connections is too large unpacked."""
    for info in reader.chunk_infos:
        chunk = reader.chunks[info.pos]
        if connections.isdisjoint(info.connection_counts):
            continue
        reader.bio.seek(chunk.datapos)
        _check(chunk.decompressor.__module__, reader.bio.read(chunk.datasize))


def require_small_mcap_chunks(path: Path) -> None:
    """Raise TooLargeError if a chunk of an MCAP file is too large when it is unpacked.

    A file that is cut off is not an error here; a broken chunk raises its unpacker's error.
    """
    with path.open("rb") as file:
        file.seek(8)
        size = path.stat().st_size
        while len(header := file.read(9)) == 9:
            record, length = struct.unpack("<BQ", header)
            end = file.tell() + length
            if end > size:
                return
            if record == 0x06:  # a chunk: times, unpacked size, checksum, compression, content
                content = file.read(length)
                (name_length,) = struct.unpack_from("<I", content, 28)
                name = content[32 : 32 + name_length].decode("ascii", "replace")
                _check(name, content[32 + name_length + 8 :])
            file.seek(end)


def require_readable_metadata(folder: Path) -> None:
    """Raise TooLargeError if a rosbag2 folder is compressed by file or by message.

    The size of the unpacked data is unknown then. Raises ValueError if its metadata.yaml has no
    metadata of a bag, or those of another version.
    """
    path = folder / "metadata.yaml"
    if path.stat().st_size > MAX_METADATA_BYTES:
        raise TooLargeError(
            Message(
                "its metadata.yaml is larger than {max_metadata_bytes} kB",
                max_metadata_bytes=MAX_METADATA_BYTES // 1000,
            )
        )
    data = load_yaml(path.read_text(encoding="utf-8"), str(path))
    bag = data.get("rosbag2_bagfile_information") if isinstance(data, dict) else None
    if not isinstance(bag, dict):
        raise ValueError("its metadata.yaml has no `rosbag2_bagfile_information`")
    version = bag.get("version")
    if not isinstance(version, int) or version > MAX_VERSION:
        raise ValueError(
            f"the `version` in its metadata.yaml is {str(version)[:40]}, and those up to "
            f"{MAX_VERSION} can be read"
        )
    mode = str(bag.get("compression_mode") or "none").lower()
    if mode != "none":
        raise TooLargeError(Message("it is compressed by {mode}", mode=mode))


def _check(compression: str, content: bytes) -> None:
    decompress = _bounded_decompressor(compression)
    if decompress and len(decompress(content, MAX_CHUNK_BYTES + 1)) > MAX_CHUNK_BYTES:
        raise TooLargeError(
            Message(
                "a chunk has more than {max_chunk_bytes} MB",
                max_chunk_bytes=MAX_CHUNK_BYTES // 1000000,
            )
        )


def _bounded_decompressor(compression: str) -> Callable[[bytes, int], bytes] | None:
    """Return a function that unpacks bytes and cuts off at a size; None: unknown compression."""
    if "bz2" in compression:
        return bz2.BZ2Decompressor().decompress
    if "lz4" in compression:
        from lz4.frame import LZ4FrameDecompressor

        decompress: Callable[[bytes, int], bytes] = LZ4FrameDecompressor().decompress
        return decompress
    if "zstd" in compression:
        from backports.zstd import ZstdDecompressor

        return ZstdDecompressor().decompress
    return None
