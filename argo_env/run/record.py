"""The record of a run: all that a report is made from, as data that can be written and read back.

It holds simulated times only. What depends on the machine it ran on is not part of it, so that the
same mission, site and seed give the same record.
"""

from argo_compiler.catalog import CheckpointKind, Interval
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm import Hfsm, Outcome
from argo_compiler.il import Action, EventKind, Mission
from argo_compiler.model import Model
from argo_env.drives.drive import Trouble
from argo_env.faults.kinds import AnyFault
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect

DIGITS = 4
"""of recorded lengths and angles: below what the geometry means"""
FROM_READING = "reading"
"""the source of an anomaly that a value measured at a checkpoint is"""
_OVER = frozenset({EventKind.ALL_CLEAR, EventKind.BATTERY_CHARGED, EventKind.CONNECTION_RESTORED})


class PathSample(Model):
    """Where the robot was at a time: a point of its track."""

    t: float
    """s"""
    x: float
    """m"""
    y: float
    """m"""
    z: float
    """m"""
    yaw: float
    """rad"""
    pitch: float
    """rad, positive with the front down"""
    floor: int
    charge: float | None = None
    """of the battery, 0 to 1; None: it has none that is looked at"""


class TaskRun(Model):
    """One execution of a task, from the start of its action to its end."""

    task: str
    action: Action
    object_id: str | None = None
    start: float
    """s"""
    end: float
    """s"""
    outcome: str
    """`done`, `failed`, `cancelled`, or `interrupted` by a pause or a reaction"""
    reason: str | None = None
    """why it failed, was cancelled or interrupted"""
    distance: float
    """m driven"""
    climbed: float
    """m upwards"""


class Reading(Model):
    """What was measured at a checkpoint."""

    checkpoint: int
    name: str
    kind: CheckpointKind
    floor: int
    task: str
    t: float
    """s"""
    value: float
    unit: str
    nominal: Interval
    normal: bool
    """whether the value lies in the nominal range"""
    distance: float
    """m, from the camera to the face"""
    views: int = 1
    """from how many places it was tried, the last one with success"""
    confidence: float = 1.0
    """of the sensor that it is right, 0 to 1"""


class Contact(Model):
    """A touch between the robot and the site, from its beginning to its end."""

    start: float
    """s"""
    end: float
    """s"""
    link: str
    """of the robot"""
    element: str
    """of the site"""
    x: float
    """m"""
    y: float
    """m"""
    z: float
    """m"""
    depth: float
    """m, the deepest overlap"""


class Mishap(Model):
    """The robot slipped, was stuck or tipped over; it may have got free again."""

    t: float
    """s"""
    trouble: Trouble
    detail: str
    """in a few words, such as `made 0.09 m of 0.45 m commanded`"""
    place: Vector
    """m"""
    floor: int


class Anomaly(Model):
    """Something that the robot found by sensing, or that tells that such a thing is over."""

    t: float
    """s"""
    kind: EventKind
    detail: str
    """in a few words, such as `gas, 840 ppm, near pump P-301`"""
    source: str
    """the watch that found it"""
    place: Vector | None = None
    """m, where it is; None where the signal tells no place"""
    noticed_from: Vector | None = None
    """m, where the robot was when it noticed what has no place, if that says anything about it, as
    of gas and connection"""
    floor: int | None = None
    """the floor of `place` or `noticed_from`"""
    confidence: float = 1.0
    """0 to 1"""
    extent: Rect | None = None
    """m, [x0, y0, x1, y1]: what an obstacle closes of the surface"""

    @property
    def over(self) -> bool:
        """Whether it tells that something is over."""
        return self.kind in _OVER


class Interruption(Model):
    """A pause or a reaction, during which the mission stood still."""

    start: float
    """s"""
    end: float
    """s"""
    event: EventKind | None = None
    """the event of the reaction; None: paused until a person goes on"""

    @property
    def cause(self) -> str:
        """In words."""
        if self.event is None:
            return "paused"
        return f"reaction to {self.event.replace('_', ' ')}"


class TraceStep(Model):
    """One step of the state machine."""

    t: float
    """s"""
    source: str | None
    target: str | None
    cause: str
    """in words"""


class Reordering(Model):
    """The order in which the tasks were done, as it was suggested before the run."""

    written: tuple[str, ...]
    """the names of the tasks that may change places, as the mission was written"""
    order: tuple[str, ...]
    """the same in the order suggested, without what is left out"""
    written_duration: float
    """s, predicted for the order that was written"""
    duration: float
    """s, predicted for the order suggested"""
    bound: float
    """s, less than which no order takes that does as much"""
    proven: bool
    """whether no other order is better"""


class Result(Model):
    """How the mission ended."""

    success: bool
    verdict: str
    """one sentence: success, or what is missing"""
    ended: bool = True
    """whether this is the end of the run; else it was interrupted here, and may go on"""
    outcome: Outcome | None = None
    """how the state machine ended; None: the run was stopped before"""
    duration: float
    """s"""
    max_duration: float | None
    """s"""
    within_max_duration: bool
    docked: bool | None
    """whether the robot ended in its station; None: the mission does not ask for it"""
    distance: float
    """m"""
    climbed: float
    """m"""


class RunRecord(Model):
    """A whole run."""

    version: int = 4
    """of this format"""
    mission: Mission
    hfsm: Hfsm
    site: str
    robot: str
    drive: str
    sensor: str
    seed: int
    diagnostics: tuple[Diagnostic, ...]
    """of the import: what was healed or respelled"""
    result: Result
    tasks: tuple[TaskRun, ...]
    readings: tuple[Reading, ...]
    contacts: tuple[Contact, ...]
    trace: tuple[TraceStep, ...]
    path: tuple[PathSample, ...]
    interruptions: tuple[Interruption, ...] = ()
    mishaps: tuple[Mishap, ...] = ()
    """what the drive had trouble with, in the order of time"""
    anomalies: tuple[Anomaly, ...] = ()
    """what was found, in the order of time"""
    faults: tuple[AnyFault, ...] = ()
    """what really went wrong, with all that the seed drew; the robot was told nothing of it"""
    resumed: tuple[float, ...] = ()
    """s, when the run went on from its journal after its process had died"""
    reordering: Reordering | None = None
    """None: the tasks were done in the order in which the mission was written"""

    @property
    def findings(self) -> tuple[Anomaly, ...]:
        """What was found, without what tells that it is over."""
        return tuple(anomaly for anomaly in self.anomalies if not anomaly.over)

    @property
    def missed_faults(self) -> tuple[AnyFault, ...]:
        """The faults that did not happen: the run ended before they would have begun."""
        return tuple(fault for fault in self.faults if fault.begins > self.result.duration)

    def why_missed(self, fault: AnyFault) -> str:
        """Says of one of these why it did not happen."""
        return (
            f"fault {fault.kind.replace('_', ' ')} did not happen: begins at {fault.begins:g} s, "
            f"the mission ended at {round(self.result.duration, 1):g} s"
        )
