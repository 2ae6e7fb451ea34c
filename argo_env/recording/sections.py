"""The two sections of an .mcap file, the data and the index, with their checksums.

The library checks those of chunks and of the data section. Those of attachments and of the index it
leaves to its users.
"""

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import TYPE_CHECKING

from argo_env.recording.format import MAGIC

if TYPE_CHECKING:  # what the extra brings
    from mcap.records import Attachment, McapRecord

_FOOTER = struct.Struct("<BQQQI")
"""opcode, length, where the index and its offsets begin, checksum (MCAP specification)"""
_FOOTER_OPCODE = 2


class Content(BytesIO):
    """The bytes of a file, which are never fewer than asked for: EndOfFile instead."""

    def read(self, size: int | None = -1, /) -> bytes:
        from mcap.exceptions import EndOfFile

        data = super().read(size)
        if size is not None and len(data) < size:
            raise EndOfFile
        return data


def data_section(content: Content) -> "Iterator[McapRecord]":
    """The records of the data section up to its DataEnd, each once its checksum is found right; the
    content stands behind that section then.

    Raises what `unreadable` names where they make no sense.
    """
    from mcap.exceptions import McapError
    from mcap.records import Attachment, Chunk, DataEnd, Footer, Metadata
    from mcap.stream_reader import StreamReader, breakup_chunk

    limit = len(content.getbuffer())  # a longer part can't be in it
    reader = StreamReader(content, emit_chunks=True, validate_crcs=True, record_size_limit=limit)
    argos = False
    for record in reader.records:
        match record:
            case Metadata() if record.name == "argo":
                argos = True
                yield record
            case Chunk():
                yield from breakup_chunk(record, validate_crc=True)
            case Attachment():
                if not _is_as_written(record, content):
                    raise McapError(f"the checksum of {record.name} is wrong")
                yield record
            case DataEnd():
                if argos and record.data_section_crc == 0:
                    # 0 says that there is none (MCAP specification); Argo always writes it.
                    raise McapError("the checksum of its data is missing")
                yield record
                return
            case Footer():
                raise McapError("the end of its data is missing")
            case _:
                yield record


def is_sound_end(content: bytes, start: int) -> bool:
    """Whether from `start` on there is the index that was written, the footer and nothing else."""
    at = len(content) - len(MAGIC) - _FOOTER.size
    if at < start or not content.endswith(MAGIC):
        return False
    opcode, _, index, _, checksum = _FOOTER.unpack_from(content, at)
    summed = content[start : -len(MAGIC) - 4]
    return bool(opcode == _FOOTER_OPCODE and index == start and zlib.crc32(summed) == checksum)


def trailing(content: bytes, start: int) -> int | None:
    """How many bytes follow after a sound end, where the index begins at `start`; None if no sound
    end is in it."""
    at = start
    while (at := content.find(MAGIC, at)) >= 0:
        at += len(MAGIC)
        if is_sound_end(content[:at], start):
            return len(content) - at
    return None


def unreadable() -> tuple[type[Exception], ...]:
    """What the libraries raise for bytes that make no sense."""
    from mcap.exceptions import McapError
    from zstandard import ZstdError

    return McapError, ZstdError, struct.error, ValueError, OverflowError, MemoryError


def _is_as_written(attachment: "Attachment", content: Content) -> bool:
    """Whether what was read last is what the library would write of it, checksum included."""
    from mcap.data_stream import RecordBuilder

    builder = RecordBuilder()
    attachment.write(builder)
    written: bytes = builder.end()  # type: ignore[no-untyped-call]
    end = content.tell()
    return content.getbuffer()[end - len(written) : end] == written
