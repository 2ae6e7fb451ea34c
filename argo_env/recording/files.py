"""Files of recordings, checked before a long run is made; and a recorder whose failure does not end
its run."""

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


class BestEffort(Observer):
    """Tells a recorder of a run until the recording can't be written any further, as on a full
    disk; the run goes on without it. Holds the recorder, and why that ended."""

    def __init__(self, recorder: "RunRecorder", warn: Callable[[str], None]) -> None:
        """`warn` is told what is lost, when that happens."""
        self._recorder = recorder
        self._warn = warn
        self.loss = ""
        """why the recording ends before the run, and where; empty if it does not"""

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        self._try(lambda: self._recorder.on_begin(setup, spec))

    def on_entry(self, entry: Entry) -> None:
        self._try(lambda: self._recorder.on_entry(entry))

    def on_step(self, now: float, action: RobotAction | None) -> None:
        self._try(lambda: self._recorder.on_step(now, action))

    def on_change(self, entry: Entry, machine: Machine) -> None:
        self._try(lambda: self._recorder.on_change(entry, machine))

    def on_interrupted(self, record: RunRecord) -> None:
        self._try(lambda: self._recorder.on_interrupted(record))

    def on_end(self, record: RunRecord) -> None:
        self._try(lambda: self._recorder.on_end(record))

    def close(self) -> None:
        """Writes the end of the recording."""
        self._try(self._recorder.close)

    def _try(self, act: Callable[[], None]) -> None:
        if self.loss:
            return
        try:
            act()
        except UnwritableRecording as error:
            until = self._recorder.until
            reached = "nothing of the run is in it" if until is None else f"it ends at {until:g} s"
            self.loss = f"{reached}: {error.reason}"
            self._recorder.give_up()
            self._warn(f"{error}; {reached}, and the run goes on without it")


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
    check_writable(file)
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
