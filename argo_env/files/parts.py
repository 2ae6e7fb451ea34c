"""Arrays that took long to find, kept on disk: plain numbers in files that are whole or not there.

A file is one of NumPy's, uncompressed, and ends with a comment: the checksum of what it belongs to
and of all before.
"""

import io
import logging
import os
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]

_CHECKSUM = 8  # bytes
_AT_ONCE = 1 << 18  # bytes
_log = logging.getLogger(__name__)


class Parts:
    """Named arrays in a folder. Of what can't be read it is as if it were not there, and what can't
    be written is not kept: a cache is never the reason why something fails.

    Any number of processes may read and write at the same time.
    """

    def __init__(self, folder: Path | None, key: str) -> None:
        """`key` says what the parts belong to; a file of another key is not read. Without a folder
        nothing is kept."""
        self._folder = folder
        self._key = key

    def made(self, name: str, make: Callable[[], Mapping[str, NDArray[Any]]]) -> Arrays:
        """The part of that name; `make` makes it if it is not there, and then it is kept."""
        found = self.find(name)
        if found is None:
            found = dict(make())
            self.keep(name, found)
        return found

    def find(self, name: str) -> Arrays | None:
        """The arrays of a part, which must not be written to; None if it is not there whole."""
        if self._folder is None:
            return None
        path = self._path(name)
        try:
            with path.open("rb", buffering=0) as file:
                found = _decode(file, self._part(name))
        except FileNotFoundError:
            return None
        except OSError as error:
            _log.debug("%s: can't be read: %s", path, error)
            return None
        if found is None:
            _log.warning("%s: is damaged or does not belong there, and is made anew", path)
        return found

    def keep(self, name: str, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Writes a part in one go, so that no reader ever sees half of it."""
        if self._folder is None:
            return
        from tempfile import NamedTemporaryFile

        draft: str | None = None
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=self._folder, prefix=".", delete=False) as file:
                draft = file.name
                for piece in _encode(arrays, self._part(name)):
                    file.write(piece)
            os.replace(draft, self._path(name))
        except OSError as error:  # read-only, full, taken away meanwhile
            _log.debug("%s: can't be kept: %s", self._path(name), error)
            if draft is not None:
                with suppress(OSError):
                    os.unlink(draft)

    def find_text(self, name: str) -> str | None:
        """The text of a part; None if it is not there whole."""
        found = self.find(name)
        return None if found is None else found["text"].tobytes().decode()

    def keep_text(self, name: str, text: str) -> None:
        """Writes a text as a part."""
        self.keep(name, {"text": np.frombuffer(text.encode(), dtype=np.uint8)})

    def _path(self, name: str) -> Path:
        assert self._folder is not None
        return self._folder / f"{name}.npz"

    def _part(self, name: str) -> str:
        return f"{self._key} {name}"


NOWHERE = Parts(None, "")
"""Keeps nothing."""


def _encode(arrays: Mapping[str, NDArray[Any]], part: str) -> tuple[memoryview, bytes]:
    """Return the content of a file, and the checksum that ends it, as the comment of the zip."""
    plain = {label: np.ascontiguousarray(array) for label, array in arrays.items()}
    sink = io.BytesIO()
    np.savez(sink, allow_pickle=False, **plain)
    content = sink.getbuffer()
    content[-2:] = _CHECKSUM.to_bytes(2, "little")  # the length of the comment
    return content, _said(zlib.crc32(content, zlib.crc32(part.encode())))


def _decode(file: BinaryIO, part: str) -> Arrays | None:
    """Return the arrays in a file; None if anything is not as it was written for this part."""
    check, left = zlib.crc32(part.encode()), os.fstat(file.fileno()).st_size - _CHECKSUM
    while left > 0 and (piece := file.read(min(left, _AT_ONCE))):
        check, left = zlib.crc32(piece, check), left - len(piece)
    if file.read() != _said(check):
        return None
    file.seek(0)
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def _said(check: int) -> bytes:
    return b"%0*x" % (_CHECKSUM, check)
