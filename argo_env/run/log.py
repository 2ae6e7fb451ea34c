"""Log of a run: entries, one for each moment at which something happens, and their sums.

A run that continues from its journal reads the same entries that it would have made, so its log is
the same as that of a run that was never interrupted.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Literal

from pydantic import BeforeValidator, TypeAdapter, ValidationError

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, worded, wording_of
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
from argo_env.files.yaml_messages import error_message
from argo_env.robot.pose import BodyPose, PoseTuple
from argo_env.run.record import (
    DIGITS,
    REPORTED,
    Anomaly,
    Contact,
    GivenValue,
    Mishap,
    PathSample,
    Reading,
    TaskRun,
)
from argo_env.run.verdict import VerdictCode, VerdictPart
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
EXTERNAL_KINDS = frozenset(_EVENTS) - {"succeeded", "failed", "stopped", "tick"}
"""Kinds of events that may come from outside the run; the run makes the other kinds itself."""


_NOT_GIVEN = ("kind", "reason_wording", "detail_wording")
"""fields of an event as data that the event itself does not have"""


class LoggedEvent(Model):
    """Event as data; the fields that its kind does not have are left out."""

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
    unreachable: bool | None = None
    reason: Text | None = None
    reason_wording: Wording | None = None
    event: EventKind | None = None
    detail: Text | None = None
    detail_wording: Wording | None = None
    by_hand: tuple[ByHand, ...] | None = None

    @classmethod
    def from_event(cls, event: Event) -> "LoggedEvent":
        """Return an event as data. Raises Invalid for what is no event, or has invalid values."""
        kind = _NAMES.get(type(event))
        if kind is None:
            raise Invalid(Message("{event} is not an event", event=repr(event)))
        try:
            fields = asdict(event)
            for name in ("reason", "detail"):
                if (wording := wording_of(fields.get(name))) is not None:
                    fields[f"{name}_wording"] = wording
            return cls.model_validate({"kind": kind, **fields})
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            raise Invalid(
                Message(
                    "{event}: {message}",
                    event=repr(event),
                    message=error_message(fault, fault["loc"]),
                )
            ) from None

    def to_event(self) -> Event:
        """Return the event for the machine. Raises ValueError if fields are missing or too many."""
        fields = {
            name: value for name, value in self if name not in _NOT_GIVEN and value is not None
        }
        if self.reason is not None:
            fields["reason"] = worded(self.reason, self.reason_wording)
        if self.detail is not None:
            fields["detail"] = worded(self.detail, self.detail_wording)
        try:
            return _EVENTS[self.kind](**fields)
        except TypeError as error:
            raise ValueError(f"no event of kind {self.kind} has {sorted(fields)}") from error


def require_external(event: LoggedEvent) -> None:
    """Raise Invalid for an event that is incomplete or can't come from outside the run."""
    try:
        event.to_event()
    except ValueError as error:
        raise Invalid(str(error)) from None
    if event.kind not in EXTERNAL_KINDS:
        raise Invalid(Message("events of kind `{kind}` come from the run itself", kind=event.kind))
    if event.event == EventKind.TIME_UP:
        raise Invalid("`time_up` occurs by itself, at the mission's max_duration")


def require_event_time(t: float) -> None:
    """Raise Invalid unless the time t (s) of an event is finite and at least 0."""
    if not 0 <= t < math.inf:
        raise Invalid(Message("no event can occur at {t:g} s: give a time from 0 s on", t=t))


def _from_text(stopped: object) -> object:
    """Return the reason of a stop; older journals have it as a text."""
    return (
        VerdictPart(code=VerdictCode.OTHER, text=stopped) if isinstance(stopped, str) else stopped
    )


class Entry(Model):
    """Entry of a run's log: one moment, with the robot's pose and what has happened."""

    t: float
    """s"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    distance: float
    """m, driven since the mission's start"""
    climbed: float
    """m, upwards since the mission's start"""
    charge: float | None = None
    """charge of the battery, 0 to 1"""
    battery_alarm: float | None = None
    """charge, 0 to 1, below which the robot reports a low battery next; None: the mission's level,
    or no battery"""
    alarm_power: float | None = None
    """power of the loudest tone of the alarm since it began, as recorded; None: there was none"""
    given: int = 0
    """number of scheduled events that had occurred"""
    added: tuple[tuple[float, LoggedEvent], ...] = ()
    """events that are scheduled from here on, with their times in s"""
    faults: tuple[AnyFault, ...] = ()
    """faults that are injected here"""
    running: str | None = None
    """the task whose action ran before the events"""
    events: tuple[LoggedEvent, ...] = ()
    """events for the executor, in this order"""
    found: tuple[Anomaly, ...] = ()
    """anomalies that the robot noticed by itself"""
    mishaps: tuple[Mishap, ...] = ()
    """mishaps of the drive since the previous entry"""
    reading: Reading | None = None
    task: TaskRun | None = None
    """the run of a task that has ended"""
    by_hand: Task | None = None
    """the task that a person lets the robot carry out from here on"""
    stop_by_hand: bool = False
    """whether a person stops the action by hand"""
    contacts: tuple[Contact, ...] = ()
    """contacts that have ended since the previous entry"""
    touching: tuple[Contact, ...] = ()
    """contacts that may still go on"""
    sample: bool = False
    """whether the pose is a point of the recorded path"""
    resumed: bool = False
    """whether the run was resumed here after its process had died"""
    ended: bool = False
    """whether this is the end of the run"""
    stopped: Annotated[VerdictPart | None, BeforeValidator(_from_text)] = None
    """with `ended`: why the run was stopped before the mission's end, if it was"""

    @property
    def body_pose(self) -> BodyPose:
        return BodyPose(*self.pose)

    @property
    def must_survive_power_loss(self) -> bool:
        """True if the entry must survive a loss of power.

        It then has events, faults, the end of a task, a person's order that the robot acts by hand
        or stops such an action, or is the entry of the run's resumption or end.
        """
        has_news = self.events or self.faults or self.task or self.by_hand or self.stop_by_hand
        return bool(has_news) or self.resumed or self.ended

    @property
    def other_anomalies_then_reading(self) -> tuple[Reading | Anomaly, ...]:
        """Anomalies that the robot noticed, but no abnormal readings; last, any reading it took."""
        # An abnormal reading is an anomaly as well, and is returned only as the reading.
        noticed = tuple(anomaly for anomaly in self.found if not anomaly.is_reading)
        return (*noticed, *((self.reading,) if self.reading else ()))

    def anomalies_reported_from_outside(self, site: Site) -> tuple[Anomaly, ...]:
        """Return the anomalies that events from outside report, with the robot's position then."""
        # The events of what the robot found itself come first.
        x, y, z = (round(v, DIGITS) for v in self.pose[:3])
        return tuple(
            Anomaly(
                t=self.t,
                kind=event.event,
                detail=event.detail or "",
                source=REPORTED,
                noticed_from=(x, y, z),
                floor=site.floor_at(self.pose[2]),
            )
            for event in self.events[len(self.found) :]
            if event.event is not None
        )

    @property
    def _has_reading_by_hand(self) -> bool:
        """True if there is a reading by hand; its event is `events[len(found)]`."""
        return self.reading is not None and self.task is not None and self.task.by_hand

    def values_from_people(self, site: Site) -> tuple[GivenValue, ...]:
        """Return the values of checkpoints that people reported, not those that the robot read."""
        given = []
        own_reading = len(self.found) if self._has_reading_by_hand else None
        for number, event in enumerate(self.events):
            if number == own_reading:
                continue
            if event.kind == "reading_given" and event.value is not None:
                checkpoint = site.checkpoint_for(event.object_id)
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
    """Sum of a run's entries, from which the record is made; grows with each entry."""

    def __init__(self, site: Site) -> None:
        self.site = site
        self.last: Entry | None = None
        self.tasks: list[TaskRun] = []
        self.readings: list[Reading] = []
        self.given_values: list[GivenValue] = []
        self.anomalies: list[Anomaly] = []
        self.found: list[tuple[Anomaly, tuple[float, float, float, float, float]]] = []
        """anomalies that the robot noticed by itself, each with its pose then"""
        self.mishaps: list[Mishap] = []
        self.last_event = 0.0
        """s, time of the last event, start of an action by hand or end of a task"""
        self.contacts: list[Contact] = []
        self.resumed: list[float] = []
        self._path: list[PathSample] = []
        self._pending_samples: list[tuple[float, PoseTuple, float | None]] = []
        """samples that are not yet in the path: times (s), poses and charges"""

    def add(self, entry: Entry) -> None:
        self.last = entry
        if entry.task:
            self.tasks.append(entry.task)
        if entry.reading:
            self.readings.append(entry.reading)
        self.given_values += entry.values_from_people(self.site)
        self.found += [(anomaly, entry.pose) for anomaly in entry.found]
        self.anomalies += (*entry.found, *entry.anomalies_reported_from_outside(self.site))
        self.mishaps += entry.mishaps
        if entry.events or entry.by_hand or entry.task:
            self.last_event = entry.t
        self.contacts += entry.contacts
        if entry.resumed:
            self.resumed.append(entry.t)
        if entry.sample:
            self.add_sample(entry.t, entry.pose, entry.charge)

    def with_entry(self, entry: Entry) -> "RunLog":
        """Return a copy of the log with one more entry; the log itself does not change."""
        other = RunLog(self.site)
        for name in _LISTS:
            setattr(other, name, list(getattr(self, name)))
        other._path, other._pending_samples = list(self._path), list(self._pending_samples)
        other.last_event = self.last_event
        other.add(entry)
        return other

    def add_sample(self, t: float, pose: PoseTuple, charge: float | None) -> None:
        """Add a point to the recorded path: time `t` (s), pose and battery charge (0 to 1)."""
        self._pending_samples.append((t, pose, charge))

    @property
    def last_sample_time(self) -> float | None:
        """Time of the last point of the recorded path in s; None if it has no point."""
        if self._pending_samples:
            return self._pending_samples[-1][0]
        return self._path[-1].t if self._path else None

    @property
    def path(self) -> Sequence[PathSample]:
        """Points of the recorded path, in the order of time."""
        if self._pending_samples:
            # Validating many samples at once takes half the time of one by one.
            self._path += _PATH.validate_python(
                [self._point(*passed) for passed in self._pending_samples]
            )
            self._pending_samples.clear()
        return self._path

    def _point(self, t: float, pose: PoseTuple, charge: float | None) -> dict[str, float | None]:
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
