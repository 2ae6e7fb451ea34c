"""Mark and version of recordings, and the file that one is written to, without a buffer: what is
written is with the system."""

import os
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import Unavailable
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors

VERSION = "2"
"""of what a recording of Argo's holds"""
MAGIC = b"\x89MCAP0\r\n"
"""what every .mcap file begins and ends with (MCAP specification)"""


class UnwritableRecording(Unavailable):
    """The recording can't be written any further."""

    def __init__(self, path: Path, reason: str) -> None:
        """The `reason` is in the words of the system."""
        super().__init__(f"{path}: the recording can't be written any further: {reason}")
        self.path = path
        self.reason = reason

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.path, self.reason), vars(self)


class RecordingFile:
    """A new file, open for writing. Holds it until it is closed; replaces what was there.

    Raises ArgoError if the file can't be made, and `write` raises UnwritableRecording.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with reporting_write_errors(path, "the recording", CHOOSE_ANOTHER_PLACE):
            self._file = path.open("wb", buffering=0)
        self._size = 0
        self._kept = 0
        self._failed = False

    def write(self, data: bytes) -> int:
        """Writes all of the data; after a failure nothing more, so that no gap comes about, and
        the file ends where it was whole last."""
        left = memoryview(data)
        try:
            while left and not self._failed:
                left = left[self._file.write(left) or 0 :]
        except OSError as error:
            self._failed = True
            with suppress(OSError):  # no file but a device
                os.ftruncate(self._file.fileno(), self._kept)
            raise UnwritableRecording(self._path, error.strerror or str(error)) from error
        self._size += len(data)
        return len(data)

    def keep(self) -> None:
        """What has been written so far is whole: it stays if what follows can't be written."""
        self._kept = self._size

    def tell(self) -> int:
        return self._size

    def flush(self) -> None:
        """Has nothing to do: there is no buffer."""

    def close(self) -> None:
        self._file.close()
