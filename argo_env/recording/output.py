"""The file that a recording is written to, without a buffer: what is written is with the system."""

from pathlib import Path

from argo_compiler.errors import Unavailable


class RecordingFile:
    """A new file, open for writing. Holds it until it is closed; replaces what was there.

    Raises ArgoError, as `write` does, if the file can't be written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._file = path.open("wb", buffering=0)
        except OSError as error:
            raise self._error(error) from error
        self._size = 0
        self._failed = False

    def write(self, data: bytes) -> int:
        """Writes all of the data; after a failure nothing more, so that no gap comes about."""
        left = memoryview(data)
        try:
            while left and not self._failed:
                left = left[self._file.write(left) or 0 :]
        except OSError as error:
            self._failed = True
            raise self._error(error) from error
        self._size += len(data)
        return len(data)

    def tell(self) -> int:
        return self._size

    def flush(self) -> None:
        """Has nothing to do: there is no buffer."""

    def close(self) -> None:
        self._file.close()

    def _error(self, error: OSError) -> Unavailable:
        return Unavailable(
            f"{self._path}: the recording can't be written: {error.strerror}; choose another place"
        )
