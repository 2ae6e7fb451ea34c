"""What a run tells whoever records it. A run without a recorder pays nothing for it."""

from typing import Protocol

from argo_compiler.hfsm import Executor
from argo_compiler.il import Mission
from argo_env.run.action import ActionUnderWay, Rig
from argo_env.run.log import Entry
from argo_env.run.record import RunRecord
from argo_env.run.spec import RunSettings


class Recorder(Protocol):
    """Records one run: `begin`, then `step` and `note` as it goes on, then `finish`."""

    def begin(self, rig: Rig, mission: Mission, settings: RunSettings) -> None:
        """The run is about to begin, or to go on from its journal."""
        ...

    def step(self, now: float, action: ActionUnderWay | None) -> None:
        """A step of simulated time has ended at `now` (s), `action` under way."""
        ...

    def note(self, entry: Entry, executor: Executor) -> None:
        """Something has happened, and the executor has been told."""
        ...

    def finish(self, record: RunRecord) -> None:
        """The run has ended, and this is its record."""
        ...
