"""The log of a run: entries, one for each moment of note, and what they add up to.

A run that goes on from its journal reads the same entries that it would have made, so its log is
the same as that of a run that was never cut short.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Literal

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    ByHand,
    Cancel,
    Event,
    GiveBack,
    Occurred,
    Pause,
    Resume,
    TakeOver,
    Tick,
)
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import EventKind, Task
from argo_env.faults.kinds import AnyFault
from argo_env.files.yaml_messages import message_of
from argo_env.robot.pose import BodyPose, Place
from argo_env.run.record import (
    DIGITS,
    TOLD,
    Anomaly,
    Contact,
    GivenValue,
    Mishap,
    PathSample,
    Reading,
    TaskRun,
)
from argo_env.site import Site

_EVENTS: dict[str, type[Event]] = {
    "succeeded": ActionSucceeded,
    "failed": ActionFailed,
    "stopped": ActionStopped,
    "tick": Tick,
    "occurred": Occurred,
    "reading_given": ReadingGiven,
    "pause": Pause,
    "resume": Resume,
    "take_over": TakeOver,
    "give_back": GiveBack,
    "cancel": Cancel,
}
_NAMES = {cls: name for name, cls in _EVENTS.items()}
FROM_OUTSIDE = frozenset(_EVENTS) - {"succeeded", "failed", "stopped", "tick"}
"""The kinds of events that a run may be told; the others it makes itself."""


class LoggedEvent(Model):
    """An event as data; the fields that its kind has not are left out."""

    kind: Literal[
        "succeeded", "failed", "stopped", "tick", "occurred", "reading_given", "pause", "resume",
        "take_over", "give_back", "cancel",
    ]  # fmt: skip
    task: str | None = None
    id: int | None = None
    object_id: str | None = None
    value: float | None = None
    abnormal: bool | None = None
    unreadable: bool | None = None
    reason: str | None = None
    event: EventKind | None = None
    detail: str | None = None
    by_hand: tuple[ByHand, ...] | None = None

    @classmethod
    def of(cls, event: Event) -> "LoggedEvent":
        """The event as data; Invalid if it is none, or has values that it can't have."""
        kind = _NAMES.get(type(event))
        if kind is None:
            raise Invalid(f"{event!r} is no event")
        try:
            return cls.model_validate({"kind": kind, **asdict(event)})
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            raise Invalid(f"{event!r}: {message_of(fault, fault['loc'])}") from None

    def original(self) -> Event:
        """The event; ValueError if fields are missing or too many."""
        given = {name: value for name, value in self if name != "kind" and value is not None}
        try:
            return _EVENTS[self.kind](**given)
        except TypeError as error:
            raise ValueError(f"no event of kind {self.kind} has {sorted(given)}") from error


def require_from_outside(event: LoggedEvent) -> None:
    """Raises Invalid for an event that nobody outside can tell a run."""
    try:
        event.original()
    except ValueError as error:
        raise Invalid(str(error)) from None
    if event.kind not in FROM_OUTSIDE:
        raise Invalid(f"the robot itself tells that an action has {event.kind}")
    if event.event == EventKind.TIME_UP:
        raise Invalid("`time_up` occurs by itself, at the mission's max_duration")


def require_time(t: float) -> None:
    """Raises Invalid for a time (s) at which a run can't be told anything."""
    if not 0 <= t < math.inf:
        raise Invalid(f"nothing occurs at {t:g} s, before the run or never")


class Entry(Model):
    """What is to be known of one moment: where the robot was, and what had happened."""

    t: float
    """s"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    distance: float
    """m, driven since the mission's start"""
    climbed: float
    """m, upwards since the mission's start"""
    charge: float | None = None
    """of the battery, 0 to 1"""
    given: int = 0
    """how many of the events that the run was given had occurred"""
    added: tuple[tuple[float, LoggedEvent], ...] = ()
    """events that the run is given from here on, and when (s)"""
    faults: tuple[AnyFault, ...] = ()
    """what goes wrong from here on beside that"""
    running: str | None = None
    """the task whose action ran before the events"""
    events: tuple[LoggedEvent, ...] = ()
    """for the executor, in this order"""
    found: tuple[Anomaly, ...] = ()
    """what the robot noticed by itself"""
    mishaps: tuple[Mishap, ...] = ()
    """what the drive had trouble with"""
    reading: Reading | None = None
    task: TaskRun | None = None
    """the run of a task that has ended"""
    by_hand: Task | None = None
    """what a person lets the robot do from here on"""
    stop_by_hand: bool = False
    """whether that is to be stopped"""
    contacts: tuple[Contact, ...] = ()
    """those that are over since the entry before"""
    touching: tuple[Contact, ...] = ()
    """those that may still go on"""
    sample: bool = False
    """whether the pose is a point of the recorded path"""
    resumed: bool = False
    """whether the run goes on here after its process had died"""
    ended: bool = False
    """whether this is the end of the run"""
    stopped: str | None = None
    """with `ended`: why the run was stopped before the mission's end, if it was"""

    @property
    def body_pose(self) -> BodyPose:
        return BodyPose(*self.pose)

    @property
    def precious(self) -> bool:
        """Whether it tells more than where the robot was."""
        told = self.events or self.faults or self.task or self.by_hand or self.stop_by_hand
        return bool(told) or self.resumed or self.ended

    @property
    def news(self) -> tuple[Reading | Anomaly, ...]:
        """What was sensed: things noticed, then the reading."""
        # An abnormal reading is found as well; it is told as the reading.
        noticed = tuple(anomaly for anomaly in self.found if not anomaly.is_reading)
        return (*noticed, *((self.reading,) if self.reading else ()))

    def told(self, site: Site) -> tuple[Anomaly, ...]:
        """What the robot was told of from outside, and where it was then. What it has found itself
        comes first among the events."""
        x, y, z = (round(v, DIGITS) for v in self.pose[:3])
        return tuple(
            Anomaly(
                t=self.t,
                kind=event.event,
                detail=event.detail or "",
                source=TOLD,
                noticed_from=(x, y, z),
                floor=site.floor_at(self.pose[2]),
            )
            for event in self.events[len(self.found) :]
            if event.event is not None
        )

    @property
    def _read_by_hand(self) -> bool:
        """Whether the first event after what was found is what the robot itself read, by hand."""
        return self.reading is not None and self.task is not None and self.task.by_hand

    def given_values(self, site: Site) -> tuple[GivenValue, ...]:
        """The values of checkpoints that the robot was told."""
        given = []
        own = len(self.found) if self._read_by_hand else None
        for number, event in enumerate(self.events):
            if number == own:
                continue
            if event.kind == "reading_given" and event.value is not None:
                checkpoint = site.measured_by(event.object_id)
                given.append(
                    GivenValue(
                        t=self.t,
                        checkpoint=checkpoint.id,
                        name=checkpoint.name,
                        value=event.value,
                        unit=checkpoint.unit,
                        normal=checkpoint.nominal.contains(event.value),
                    )
                )
        return tuple(given)


_LISTS = (
    "tasks", "readings", "given_values", "anomalies", "found", "mishaps", "contacts", "resumed",
)  # fmt: skip
_PATH = TypeAdapter(list[PathSample])


class RunLog:
    """What the record is made from. Grows as entries are added."""

    def __init__(self, site: Site) -> None:
        self.site = site
        self.last: Entry | None = None
        self.tasks: list[TaskRun] = []
        self.readings: list[Reading] = []
        self.given_values: list[GivenValue] = []
        self.anomalies: list[Anomaly] = []
        self.found: list[tuple[Anomaly, tuple[float, float, float, float, float]]] = []
        """what the robot noticed by itself, and its pose then"""
        self.mishaps: list[Mishap] = []
        self.last_event = 0.0
        """s, when the machine was told of something last, or a person let the robot do something"""
        self.contacts: list[Contact] = []
        self.resumed: list[float] = []
        self._path: list[PathSample] = []
        self._passed: list[tuple[float, Place, float | None]] = []
        """what the path has besides: times (s), poses and charges"""

    def add(self, entry: Entry) -> None:
        self.last = entry
        if entry.task:
            self.tasks.append(entry.task)
        if entry.reading:
            self.readings.append(entry.reading)
        self.given_values += entry.given_values(self.site)
        self.found += [(anomaly, entry.pose) for anomaly in entry.found]
        self.anomalies += (*entry.found, *entry.told(self.site))
        self.mishaps += entry.mishaps
        if entry.events or entry.by_hand or entry.task:
            self.last_event = entry.t
        self.contacts += entry.contacts
        if entry.resumed:
            self.resumed.append(entry.t)
        if entry.sample:
            self.sample(entry.t, entry.pose, entry.charge)

    def with_entry(self, entry: Entry) -> "RunLog":
        """Another log, with one more entry; this one stays as it is."""
        other = RunLog(self.site)
        for name in _LISTS:
            setattr(other, name, list(getattr(self, name)))
        other._path, other._passed = list(self._path), list(self._passed)
        other.last_event = self.last_event
        other.add(entry)
        return other

    def sample(self, t: float, pose: Place, charge: float | None) -> None:
        """One more point of the recorded path: at time `t` (s), with such a charge (0 to 1)."""
        self._passed.append((t, pose, charge))

    @property
    def sampled_at(self) -> float | None:
        """s, of the last point of the recorded path."""
        if self._passed:
            return self._passed[-1][0]
        return self._path[-1].t if self._path else None

    @property
    def path(self) -> Sequence[PathSample]:
        """The recorded path."""
        if self._passed:
            # Many samples in one go take half the time of one by one.
            self._path += _PATH.validate_python([self._point(*passed) for passed in self._passed])
            self._passed.clear()
        return self._path

    def _point(self, t: float, pose: Place, charge: float | None) -> dict[str, float | None]:
        x, y, z, yaw, pitch = pose
        return {
            "t": t,
            "x": round(x, DIGITS),
            "y": round(y, DIGITS),
            "z": round(z, DIGITS),
            "yaw": round(yaw, DIGITS),
            "pitch": round(pitch, DIGITS),
            "floor": self.site.floor_at(z),
            "charge": None if charge is None else round(charge, DIGITS),
        }
