"""Whether what a bag has compressed is of a bearable size, found out before it is unpacked.

rosbags unpacks a chunk in one go, whatever comes out of it; a few kilobytes may become terabytes.
"""

import bz2
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

MAX_CHUNK_BYTES = 100_000_000
"""of a chunk, unpacked; recorders begin a new one after a few megabytes"""
MAX_METADATA_BYTES = 1_000_000


class TooLargeError(Exception):
    """Something compressed becomes too large, or could; the message says what."""


def check_ros1_chunks(reader: Any, connections: set[int]) -> None:
    """Raises TooLargeError for a chunk with messages of those connections that is too large."""
    for info in reader.chunk_infos:
        chunk = reader.chunks[info.pos]
        if connections.isdisjoint(info.connection_counts):
            continue
        reader.bio.seek(chunk.datapos)
        _check(chunk.decompressor.__module__, reader.bio.read(chunk.datasize))


def check_mcap_chunks(path: Path) -> None:
    """Raises TooLargeError for a chunk of an MCAP file that is too large. Broken files pass: they
    are for the reader."""
    with path.open("rb") as file:
        file.seek(8)
        size = path.stat().st_size
        while len(head := file.read(9)) == 9:
            record, length = struct.unpack("<BQ", head)
            end = file.tell() + length
            if end > size:
                return
            if record == 0x06:  # a chunk: times, unpacked size, checksum, compression, content
                content = file.read(length)
                (name_length,) = struct.unpack_from("<I", content, 28)
                name = content[32 : 32 + name_length].decode("ascii", "replace")
                _check(name, content[32 + name_length + 8 :])
            file.seek(end)


def check_metadata(folder: Path) -> None:
    """Raises TooLargeError where a rosbag2 folder is compressed as a whole or by message."""
    path = folder / "metadata.yaml"
    if path.stat().st_size > MAX_METADATA_BYTES:
        raise TooLargeError(f"its metadata.yaml is larger than {MAX_METADATA_BYTES // 1000} kB")
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    mode = str(data["rosbag2_bagfile_information"].get("compression_mode") or "none").lower()
    if mode != "none":
        raise TooLargeError(f"it is compressed by {mode}")


def _check(compression: str, content: bytes) -> None:
    decompress = _bounded(compression)
    if decompress and len(decompress(content, MAX_CHUNK_BYTES + 1)) > MAX_CHUNK_BYTES:
        raise TooLargeError(f"a chunk has more than {MAX_CHUNK_BYTES // 1_000_000} MB")


def _bounded(compression: str) -> Callable[[bytes, int], bytes] | None:
    """What unpacks up to a number of bytes; None where the content is not compressed."""
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
