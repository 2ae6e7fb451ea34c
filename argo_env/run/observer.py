"""What is told of a run to whoever observes it: a journal, a recording, a display."""

from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.record import RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec


class Observer:
    """Observes one run. Does nothing: override what is of interest.

    It can't steer the run while it is told of it. What it raises breaks the simulation off.
    """

    hears_samples = True
    """whether it is told as well where the robot was while nothing happened"""

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:
        """The run is about to begin, or to go on from its journal."""

    def on_entry(self, entry: Entry) -> None:
        """Something is to be known, and nobody has acted on it yet. What is raised here keeps it
        from having happened, and the run ends without it."""

    def on_change(self, entry: Entry, machine: Machine) -> None:
        """The same, now that the machine has been told."""

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """A step of simulated time has ended at `now` (s), `action` under way."""

    def on_interrupted(self, record: RunRecord) -> None:
        """The run goes on no further for now, and this is its record as it stands."""

    def on_end(self, record: RunRecord) -> None:
        """The run has ended, and this is its record."""


def hears(observer: Observer, name: str) -> bool:
    """Whether the observer does anything when it is told this, such as `on_step`."""
    own = getattr(getattr(observer, name), "__func__", None)
    return own is not getattr(Observer, name)
