"""What a run is made with, apart from its mission and its site: data that a journal keeps."""

from pydantic import Field

from argo_compiler.hfsm import Event
from argo_compiler.model import Model
from argo_env.faults.kinds import AnyFault
from argo_env.run.log import LoggedEvent


class RunSettings(Model):
    """How a run is carried out. Equal settings give equal runs."""

    drive: str = "kinematic"
    """name of the drive"""
    sensor: str = "ideal"
    """name of the sensor that reads checkpoints"""
    seed: int = Field(default=0, ge=0)
    """of all that is drawn"""
    values: dict[int, float] = Field(default_factory=dict)
    """what checkpoints show, by number, where it is not drawn"""
    events: tuple[tuple[float, LoggedEvent], ...] = ()
    """what the run is told, and when (s)"""
    faults: tuple[AnyFault, ...] = ()
    """what goes wrong; the robot finds out by sensing"""


def logged(*events: tuple[float, Event]) -> tuple[tuple[float, LoggedEvent], ...]:
    """Events and their times (s) as settings hold them."""
    return tuple((t, LoggedEvent.of(event)) for t, event in events)
