"""Where recordings are written and what they need: checked before a long run is made."""

import os
from collections.abc import Iterator
from contextlib import closing, contextmanager
from importlib.util import find_spec
from pathlib import Path

from argo_compiler.errors import Conflict, Invalid, NotFound, Unavailable
from argo_compiler.extras import install_line
from argo_env.recording.output import RecordingFile
from argo_env.run.observer import Observer

VERSION = "1"
"""of what a recording of Argo's holds"""
MAGIC = b"\x89MCAP0\r\n"
"""what every .mcap file begins and ends with (MCAP specification)"""


_LIBRARIES = ("mcap", "mcap_protobuf", "foxglove_schemas_protobuf")


def require_libraries() -> None:
    """Raises ArgoError if the extra that recordings need isn't installed."""
    missing = [name for name in _LIBRARIES if find_spec(name) is None]
    if missing:
        raise Unavailable(f"recordings need {', '.join(missing)}: {install_line('recording')}")


def check_recording(file: Path) -> None:
    """Raises ArgoError if no recording can be written there: for its suffix, its folder, or an
    extra that isn't installed. To be called before a long run is made."""
    if file.suffix.lower() != ".mcap":
        raise Invalid(f"{file}: a recording is an .mcap file; name it so")
    if not os.path.isdir(file.absolute().parent):
        raise NotFound(f"{file}: there is no folder {file.parent}; make it, or choose another")
    if os.path.isdir(file):
        raise Conflict(f"{file}: is a folder; choose another name for the recording")
    if not os.access(file if os.path.exists(file) else file.absolute().parent, os.W_OK):
        raise Unavailable(f"{file}: can't be written; choose another place for the recording")
    require_libraries()


@contextmanager
def recording_to(file: Path, source: Path | None = None) -> Iterator[Observer]:
    """A recorder that writes to the file, and the text of the mission's `source` with it.

    A recording that was there is replaced. What has been recorded stays, and can be read, if the
    run fails or its process is killed.

    Raises ArgoError where `check_recording` does, and while it goes on if the disk is full.
    """
    check_recording(file)
    # What this needs is not there without the extra.
    from argo_env.recording.mcap_recorder import McapRecorder

    with closing(RecordingFile(file)) as stream:
        recorder = McapRecorder(stream, source)
        try:
            yield recorder
        finally:
            recorder.close()
