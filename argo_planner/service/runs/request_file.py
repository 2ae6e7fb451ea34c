"""The requests to a run on disk: each is there before the run's process hears of it."""

import os
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    cut_off,
    sync_folder,
    write_all,
)
from argo_planner.service.runs.requests import RequestState

_FLAGS = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC


class RequestFile:
    """Lines with checksums, each a request and how far it was; the last one of an id counts."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def keep(self, requests: Sequence[RequestState]) -> None:
        """Writes down how far requests are, all at once. Raises Unavailable; then none is kept."""
        lines = b"".join(checked_line(request.model_dump(mode="json")) for request in requests)
        try:
            file = os.open(self._path, _FLAGS, 0o644)
            try:
                size = os.fstat(file).st_size
                if size > 0 and os.pread(file, 1, size - 1) != b"\n":
                    lines = b"\n" + lines  # a process was killed before it had ended its line
                try:
                    write_all(file, lines)
                    os.fsync(file)
                except OSError:
                    cut_off(file, size)
                    raise
            finally:
                os.close(file)
            if size == 0:
                sync_folder(self._path.parent)
        except OSError as error:
            raise Unavailable(
                f"{self._path}: can't be written: {error.strerror}; nothing was passed on to the "
                "run: ask again when there is room"
            ) from error

    def all(self) -> list[RequestState]:
        """How far the requests were when that was kept last, in the order in which they came. What
        is damaged is passed over. Raises Unavailable if the file can't be read."""
        try:
            content = self._path.read_bytes()
        except FileNotFoundError:
            return []
        except OSError as error:
            raise Unavailable(f"{self._path}: can't be read: {error.strerror}") from error
        found: dict[str, RequestState] = {}
        for line in content.split(b"\n"):
            if (data := checked_object(line)) is not None:
                try:
                    request = RequestState.model_validate(data)
                except ValidationError:
                    continue
                found[request.id] = request
        return [*found.values()]
