"""Magic bytes and version of recordings, and the file that a recording is written to.

The file has no buffer: the operating system has all written data at once.
"""

import os
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import Unavailable
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors

VERSION = "2"
"""version of the contents of Argo's recordings"""
MAGIC = b"\x89MCAP0\r\n"
"""bytes that each .mcap file begins and ends with (MCAP specification)"""


class UnwritableRecording(Unavailable):
    """Error of a recording that can't be written any further."""

    def __init__(self, path: Path, reason: str) -> None:
        """Take the file, and the operating system's message as `reason`."""
        super().__init__(f"{path}: the recording can't be written any further: {reason}")
        self.path = path
        self.reason = reason

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.path, self.reason), vars(self)


class RecordingFile:
    """A new file that is open for writing until it is closed; it replaces an existing one.

    Raises ArgoError if the file can't be made, and `write` raises UnwritableRecording.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with reporting_write_errors(path, "the recording", CHOOSE_ANOTHER_PLACE):
            self._file = path.open("wb", buffering=0)
        self._size = 0
        self._intact_size = 0
        self._failed = False

    def write(self, data: bytes) -> int:
        """Write all of the data and return their length.

        A call that fails truncates the file to its intact part and raises UnwritableRecording.
        Calls after that write nothing, so that the file has no gap, and return the length as usual.
        """
        left = memoryview(data)
        try:
            while left and not self._failed:
                left = left[self._file.write(left) or 0 :]
        except OSError as error:
            self._failed = True
            with suppress(OSError):  # a device can't be truncated
                os.ftruncate(self._file.fileno(), self._intact_size)
            raise UnwritableRecording(self._path, error.strerror or str(error)) from error
        self._size += len(data)
        return len(data)

    def mark_intact(self) -> None:
        """Mark all data written so far as intact: they stay if later data can't be written."""
        self._intact_size = self._size

    def tell(self) -> int:
        return self._size

    def flush(self) -> None:
        """Do nothing: there is no buffer."""

    def close(self) -> None:
        self._file.close()
