"""Parts of an entry of the disk cache: arrays and texts that take long to compute.

A file is written atomically. It ends with a checksum of the entry's key, the file's name and all
bytes before the checksum. Arrays are in an uncompressed `.npz` file of NumPy, whose ZIP comment is
the checksum. NumPy is imported for arrays only: a command that needs only cached texts starts
without it.
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
_CHUNK = 1 << 18  # bytes
_Read = TypeVar("_Read")
_log = logging.getLogger(__name__)


class Parts:
    """Named arrays and texts in a folder on disk.

    A part that is damaged or can't be read counts as missing, and a part that can't be written is
    not stored: a cache is never the reason why something fails. Any number of processes may read
    and write at the same time.
    """

    def __init__(self, folder: Path | None, key: str) -> None:
        """Open the folder, or none: without a folder nothing is stored.

        The `key` identifies the data that the parts belong to; a file of another key is not read.
        """
        self._folder = folder
        self._key = key

    def load_or_make(self, name: str, make: "Callable[[], Mapping[str, NDArray[Any]]]") -> Arrays:
        """Return the arrays of a part; if it can't be read, make and store them."""
        arrays = self.load_arrays(name)
        if arrays is None:
            arrays = dict(make())
            self.store_arrays(name, arrays)
        return arrays

    def load_arrays(self, name: str) -> "Arrays | None":
        """Return the arrays of a part by their names, read-only; None if it can't be read."""
        return self._load(f"{name}.npz", _read_arrays)

    def store_arrays(self, name: str, arrays: "Mapping[str, NDArray[Any]]") -> None:
        """Store arrays as a part, in place of one of the same name."""
        if self._folder is not None:
            self._store(self._folder, f"{name}.npz", _npz(arrays))

    def load_text(self, name: str) -> str | None:
        """Return the text of a part, or None if it can't be read."""
        return self._load(f"{name}.txt", _read_text)

    def store_text(self, name: str, text: str) -> None:
        """Store a text as a part, in place of one of the same name."""
        if self._folder is not None:
            self._store(self._folder, f"{name}.txt", text.encode())

    def _load(self, file_name: str, read: Callable[[BinaryIO], _Read]) -> _Read | None:
        if self._folder is None:
            return None
        path = self._folder / file_name
        try:
            with path.open("rb", buffering=0) as file:
                if _is_intact(file, self._identity(file_name)):
                    return read(file)
        except FileNotFoundError:
            return None
        except OSError as error:
            _log.debug("%s: can't be read: %s", path, error)
            return None
        _log.warning("%s: is damaged or belongs to other data, and is made anew", path)
        return None

    def _store(self, folder: Path, file_name: str, content: bytes | memoryview) -> None:
        """Write a file atomically, so that no reader ever sees half of it."""
        from tempfile import NamedTemporaryFile

        path, draft = folder / file_name, None
        checksum = zlib.crc32(content, zlib.crc32(self._identity(file_name)))
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=folder, prefix=".", delete=False) as file:
                draft = file.name
                file.write(content)
                file.write(_digits(checksum))
            os.replace(draft, path)
        except OSError as error:  # read-only, full, removed in the meantime
            _log.debug("%s: can't be stored: %s", path, error)
            if draft is not None:
                with suppress(OSError):
                    os.unlink(draft)

    def _identity(self, file_name: str) -> bytes:
        return f"{self._key} {file_name}".encode()


NO_CACHE = Parts(None, "")
"""parts that are never stored"""


def _npz(arrays: "Mapping[str, NDArray[Any]]") -> memoryview:
    """Return the content of an `.npz` file to which a comment, its checksum, must be appended."""
    import numpy as np

    plain = {label: np.ascontiguousarray(array) for label, array in arrays.items()}
    sink = io.BytesIO()
    np.savez(sink, **plain)  # type: ignore[arg-type]  # an array could be named `allow_pickle`
    content = sink.getbuffer()
    content[-2:] = _CHECKSUM.to_bytes(2, "little")  # the length of the comment
    return content


def _is_intact(file: BinaryIO, identity: bytes) -> bool:
    """Return True if the file's checksum fits its content and the identity of the part."""
    check, remaining = zlib.crc32(identity), os.fstat(file.fileno()).st_size - _CHECKSUM
    while remaining > 0 and (chunk := file.read(min(remaining, _CHUNK))):
        check, remaining = zlib.crc32(chunk, check), remaining - len(chunk)
    return file.read() == _digits(check)


def _read_arrays(file: BinaryIO) -> Arrays:
    import numpy as np

    file.seek(0)
    with np.load(file, allow_pickle=False) as archive:
        arrays = dict(archive)
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def _read_text(file: BinaryIO) -> str:
    file.seek(0)
    return file.read()[:-_CHECKSUM].decode()


def _digits(check: int) -> bytes:
    return b"%0*x" % (_CHECKSUM, check)
