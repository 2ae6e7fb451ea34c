"""Arrays that took long to find, kept on disk: plain numbers in files that are whole or not there.

A file holds a line with the checksum of all that follows, a line of JSON that says what it is, and
the arrays one after the other.
"""

import json
import logging
import math
import os
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]

_SIGNATURE = b"argo-part-1 "
_ALIGNED = 64  # bytes
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
        path = self._folder / name
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            _log.debug("%s: can't be read: %s", path, error)
            return None
        found = _decode(content, self._key, name)
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
                for piece in _encode(arrays, self._key, name):
                    file.write(piece)
            os.replace(draft, self._folder / name)
        except OSError as error:  # read-only, full, taken away meanwhile
            _log.debug("%s: can't be kept: %s", self._folder / name, error)
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


NOWHERE = Parts(None, "")
"""Keeps nothing."""


def _encode(arrays: Mapping[str, NDArray[Any]], key: str, name: str) -> list[bytes | memoryview]:
    plain = {label: np.ascontiguousarray(array) for label, array in arrays.items()}
    said = {label: (array.dtype.str, array.shape) for label, array in plain.items()}
    header = json.dumps({"key": key, "name": name, "arrays": said}).encode()
    start = len(_SIGNATURE) + 9 + len(header) + 1
    pieces: list[bytes | memoryview] = [header + b"\n"]
    for array in plain.values():
        gap = -start % _ALIGNED
        pieces += [b"\0" * gap, memoryview(array.reshape(-1).view(np.uint8).data)]
        start += gap + array.nbytes
    check = 0
    for piece in pieces:
        check = zlib.crc32(piece, check)
    return [_SIGNATURE + b"%08x\n" % check, *pieces]


def _decode(content: bytes, key: str, name: str) -> Arrays | None:
    """The arrays in a file; None if anything is not as it was written."""
    first = len(_SIGNATURE) + 9
    if content[:first] != _SIGNATURE + b"%08x\n" % zlib.crc32(memoryview(content)[first:]):
        return None
    end = content.index(b"\n", first)
    said = json.loads(content[first:end])
    if (said["key"], said["name"]) != (key, name):
        return None
    arrays, start = {}, end + 1
    for label, (dtype, shape) in said["arrays"].items():
        start += -start % _ALIGNED
        count = math.prod(shape)
        array = np.frombuffer(content, np.dtype(dtype), count, start).reshape(shape)
        arrays[label], start = array, start + array.nbytes
    return arrays
