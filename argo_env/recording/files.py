"""Files of recordings, checked before a run, and a recorder whose failure does not end its run."""

import logging
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.files.atomic_write import check_writable
from argo_env.recording.output import RecordingFile, UnwritableRecording
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec

if TYPE_CHECKING:
    from argo_env.recording.run_recorder import RunRecorder


class BestEffortRecorder(Observer):
    """Observer that passes a run to a recorder until the recording can't be written any further.

    After that, for example on a full disk, the run continues without it. The object holds the
    recorder and the reason why the recording ended.
    """

    def __init__(self, recorder: "RunRecorder", warn: Callable[[str], None]) -> None:
        """Take the recorder, and a function that is called with a warning when data are lost."""
        self._recorder = recorder
        self._warn = warn
        self.loss = ""
        """where and why the recording ends before the run; empty if it does not"""

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        self._try(lambda: self._recorder.on_begin(setup, spec))

    def on_entry(self, entry: Entry) -> None:
        self._try(lambda: self._recorder.on_entry(entry))

    def on_step(self, now: float, action: RobotAction | None) -> None:
        self._try(lambda: self._recorder.on_step(now, action))

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:
        self._try(lambda: self._recorder.on_entry_applied(entry, machine))

    def on_interrupted(self, record: RunRecord) -> None:
        self._try(lambda: self._recorder.on_interrupted(record))

    def on_end(self, record: RunRecord) -> None:
        self._try(lambda: self._recorder.on_end(record))

    def complete_without_closing(self) -> None:
        """Complete the recording: write what is pending, and the index; do not close the file.

        If it can't be written, no error is raised: a warning is given, and `loss` has the reason.
        """
        self._try(self._recorder.complete_without_closing)

    def _try(self, write: Callable[[], None]) -> None:
        """Call the function, unless the recording has ended; end the recording if it fails."""
        if self.loss:
            return
        try:
            write()
        except UnwritableRecording as error:
            until = self._recorder.readable_until
            end = "it has nothing of the run" if until is None else f"it ends at {until:g} s"
            self.loss = f"{end}: {error.reason}"
            self._recorder.discard_pending_and_further_pictures()
            self._warn(f"{error}; {end}, and the run continues without it")


_log = logging.getLogger(__name__)

_LIBRARIES = ("mcap", "mcap_protobuf", "foxglove_schemas_protobuf")


def require_libraries() -> None:
    """Raise ArgoError if the extra that recordings need is not installed."""
    missing = [name for name in _LIBRARIES if find_spec(name) is None]
    if missing:
        raise Unavailable(f"recordings need {', '.join(missing)}: {install_line('recording')}")


def check_recording_path(file: Path) -> None:
    """Raise ArgoError if no recording can be written to this file; call it before a long run.

    The reason is its suffix, its folder, or an extra that is not installed.
    """
    if file.suffix.lower() != ".mcap":
        raise Invalid(f"{file}: a recording is an .mcap file; name it so")
    check_writable(file)
    require_libraries()


@contextmanager
def recording_to(
    file: Path, source: Path | None = None, warn: Callable[[str], None] = _log.warning
) -> Iterator[BestEffortRecorder]:
    """Yield a recorder that writes to the file, and close it afterwards.

    The recorded part stays, and can be read, if the run fails, its process is killed or the disk is
    full. On a full disk the run continues without the recording.

    Args:
        file: file to write; an existing one is replaced.
        source: file or folder that the mission was read from; it is stored in the recording.
        warn: function that is called with a warning when data are lost.

    Raises:
        ArgoError: as `check_recording_path` does, or if the file can't be made.
    """
    check_recording_path(file)
    # These modules import packages of the extra.
    from argo_env.recording.run_recorder import RunRecorder
    from argo_env.recording.writer import RecordingWriter

    with closing(RecordingFile(file)) as stream:
        recorder = BestEffortRecorder(RunRecorder(RecordingWriter(stream), source, warn), warn)
        try:
            yield recorder
        finally:
            recorder.complete_without_closing()
