"""Arrays and texts that took long to find, kept on disk in files that are whole or not there.

Each file ends with a checksum of what it belongs to and of all before. Arrays are in one of NumPy's
files, uncompressed, and the checksum is its comment. NumPy is imported for arrays only: a command
that finds its texts starts without it.
"""

import io
import logging
import os
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias, TypeVar

if TYPE_CHECKING:
    from numpy.typing import NDArray

Arrays: TypeAlias = "dict[str, NDArray[Any]]"

_CHECKSUM = 8  # bytes
_AT_ONCE = 1 << 18  # bytes
_Read = TypeVar("_Read")
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

    def made(self, name: str, make: "Callable[[], Mapping[str, NDArray[Any]]]") -> Arrays:
        """The part of that name; `make` makes it if it is not there, and then it is kept."""
        found = self.find(name)
        if found is None:
            found = dict(make())
            self.keep(name, found)
        return found

    def find(self, name: str) -> "Arrays | None":
        """The arrays of a part, which must not be written to; None if it is not there whole."""
        return self._find(f"{name}.npz", _read_arrays)

    def keep(self, name: str, arrays: "Mapping[str, NDArray[Any]]") -> None:
        """Writes arrays as a part."""
        if self._folder is not None:
            self._keep(self._folder, f"{name}.npz", _npz(arrays))

    def find_text(self, name: str) -> str | None:
        """The text of a part; None if it is not there whole."""
        return self._find(f"{name}.txt", _read_text)

    def keep_text(self, name: str, text: str) -> None:
        """Writes a text as a part."""
        if self._folder is not None:
            self._keep(self._folder, f"{name}.txt", text.encode())

    def _find(self, file_name: str, read: Callable[[BinaryIO], _Read]) -> _Read | None:
        if self._folder is None:
            return None
        path = self._folder / file_name
        try:
            with path.open("rb", buffering=0) as file:
                if _is_whole(file, self._part(file_name)):
                    return read(file)
        except FileNotFoundError:
            return None
        except OSError as error:
            _log.debug("%s: can't be read: %s", path, error)
            return None
        _log.warning("%s: is damaged or does not belong there, and is made anew", path)
        return None

    def _keep(self, folder: Path, file_name: str, content: bytes | memoryview) -> None:
        """Writes a file in one go, so that no reader ever sees half of it."""
        from tempfile import NamedTemporaryFile

        path, draft = folder / file_name, None
        checksum = zlib.crc32(content, zlib.crc32(self._part(file_name)))
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=folder, prefix=".", delete=False) as file:
                draft = file.name
                file.write(content)
                file.write(_digits(checksum))
            os.replace(draft, path)
        except OSError as error:  # read-only, full, taken away meanwhile
            _log.debug("%s: can't be kept: %s", path, error)
            if draft is not None:
                with suppress(OSError):
                    os.unlink(draft)

    def _part(self, file_name: str) -> bytes:
        return f"{self._key} {file_name}".encode()


NOWHERE = Parts(None, "")
"""Keeps nothing."""


def _npz(arrays: "Mapping[str, NDArray[Any]]") -> memoryview:
    """Return the content of a file of arrays, but for the comment that follows it."""
    import numpy as np

    plain = {label: np.ascontiguousarray(array) for label, array in arrays.items()}
    sink = io.BytesIO()
    np.savez(sink, **plain)  # type: ignore[arg-type]  # one could be called `allow_pickle`
    content = sink.getbuffer()
    content[-2:] = _CHECKSUM.to_bytes(2, "little")  # the length of the comment
    return content


def _is_whole(file: BinaryIO, part: bytes) -> bool:
    """Return whether all in the file is as it was written for this part."""
    check, left = zlib.crc32(part), os.fstat(file.fileno()).st_size - _CHECKSUM
    while left > 0 and (piece := file.read(min(left, _AT_ONCE))):
        check, left = zlib.crc32(piece, check), left - len(piece)
    return file.read() == _digits(check)


def _read_arrays(file: BinaryIO) -> Arrays:
    import numpy as np

    file.seek(0)
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def _read_text(file: BinaryIO) -> str:
    file.seek(0)
    return file.read()[:-_CHECKSUM].decode()


def _digits(check: int) -> bytes:
    return b"%0*x" % (_CHECKSUM, check)
