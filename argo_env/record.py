"""The record of a run: all that a report is made from, as data that can be written and read back.

It holds simulated times only. What depends on the machine it ran on is not part of it, so that the
same mission, site and seed give the same record.
"""

from argo_compiler.catalog import CheckpointKind, Interval
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, Mission
from argo_compiler.model import Model


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
    """`done`, `failed` or `cancelled`"""
    reason: str | None = None
    """why it failed or was cancelled"""
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


class TraceStep(Model):
    """One step of the state machine."""

    t: float
    """s"""
    source: str | None
    target: str | None
    cause: str
    """in words"""


class Result(Model):
    """How the mission ended."""

    success: bool
    verdict: str
    """one sentence: success, or what is missing"""
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

    version: int = 1
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
