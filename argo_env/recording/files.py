"""Where recordings are written and what they need: checked before a long run is made."""

import logging
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from importlib.util import find_spec
from pathlib import Path

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.files.writing import check_place
from argo_env.recording.best_effort import BestEffort
from argo_env.recording.output import RecordingFile

_log = logging.getLogger(__name__)

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
    check_place(file)
    require_libraries()


@contextmanager
def recording_to(
    file: Path, source: Path | None = None, warn: Callable[[str], None] = _log.warning
) -> Iterator[BestEffort]:
    """A recorder that writes to the file, and the text of the mission's `source` with it.

    A recording that was there is replaced. What has been recorded stays, and can be read, if the
    run fails, its process is killed, or the disk is full: then the run goes on without, and `warn`
    is told what is lost. Raises ArgoError where `check_recording` does.
    """
    check_recording(file)
    # What this needs is not there without the extra.
    from argo_env.recording.run_recorder import RunRecorder
    from argo_env.recording.writer import RecordingWriter

    with closing(RecordingFile(file)) as stream:
        recorder = BestEffort(RunRecorder(RecordingWriter(stream), source, warn), warn)
        try:
            yield recorder
        finally:
            recorder.close()
