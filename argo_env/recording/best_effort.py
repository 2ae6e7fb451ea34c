"""A recorder that its run does not depend on."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from argo_env.recording.output import UnwritableRecording
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.rig import Rig
from argo_env.run.robot import RobotAction
from argo_env.run.spec import RunSpec

if TYPE_CHECKING:  # what the extra brings
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

    def on_begin(self, rig: Rig, spec: RunSpec) -> None:
        self._try(lambda: self._recorder.on_begin(rig, spec))

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
