"""Observers of a run, such as a journal, a recording or a display."""

from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.record import RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec


class Observer:
    """Observer of one run, whose methods do nothing: override those of interest.

    An observer can't send commands to the run from within its methods. An exception that a method
    raises ends the simulation.
    """

    wants_samples = True
    """whether it must be called for entries in which only the robot's pose is new, too"""

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        """Prepare for a run that is about to begin, or to continue from its journal."""

    def on_entry(self, entry: Entry) -> None:
        """Receive an entry before the run applies it.

        An exception raised here keeps the entry from being applied, and the simulation ends.
        """

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:
        """Receive an entry after the machine has handled its events."""

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """Follow a step that has ended at `now` (s); `action` runs after it, None if none does."""

    def on_interrupted(self, record: RunRecord) -> None:
        """Receive the record so far of a run that was interrupted before its end."""

    def on_end(self, record: RunRecord) -> None:
        """Receive the record of the ended run."""


def overrides(observer: Observer, name: str) -> bool:
    """Return True if the observer overrides the method of this name, such as `on_step`."""
    own = getattr(getattr(observer, name), "__func__", None)
    return own is not getattr(Observer, name)
