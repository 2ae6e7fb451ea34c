"""The record of a run: all that a report is made from, as data that can be written and read back.

It holds simulated times only. What depends on the machine it ran on is not part of it, so that the
same mission, site and seed give the same record.
"""

from collections.abc import Sequence
from enum import StrEnum

from pydantic import computed_field, model_validator

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm import Hfsm, Outcome
from argo_compiler.hfsm.progress import TaskTally
from argo_compiler.il import Action, EventKind, Mission, Response
from argo_env.drives.drive import Trouble
from argo_env.faults.kinds import AnyFault
from argo_env.formatting import clock, where
from argo_env.run.verdict_line import Headline, headline
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect

DIGITS = 4
"""of recorded lengths and angles: below what the geometry means"""
FROM_READING = "reading"
"""the source of an anomaly that a value measured at a checkpoint is"""
TOLD = "told"
"""the source of an anomaly that the robot was told of from outside"""
_ENDS = {
    EventKind.ALL_CLEAR: frozenset(
        {
            EventKind.GAS_LEAK,
            EventKind.HOT_SPOT,
            EventKind.ABNORMAL_SOUND,
            EventKind.PLATFORM_ALARM,
            EventKind.EMERGENCY_STOP,
            EventKind.DYSFUNCTION,
        }
    ),
    EventKind.BATTERY_CHARGED: frozenset({EventKind.LOW_BATTERY}),
    EventKind.CONNECTION_RESTORED: frozenset({EventKind.CONNECTION_LOST}),
}
"""What tells that something is over, and what that may be."""


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
    measuring: tuple[tuple[float, float], ...] | None = None
    """s, the start and end of each measurement, arm included; several if it looked from several
    places. None: not told, as in old records"""
    early: tuple[float, float] | None = None
    """s, from when to when it stood at the place, as the task's window had not begun yet"""
    unmoved: tuple[str, ...] = ()
    """the joints that the task asks for, and this robot or its simulation does not move"""
    by_hand: bool = False
    """whether a person let the robot do it, and not the mission"""

    @property
    def measured_for(self) -> float:
        """s, that it measured."""
        return sum(end - start for start, end in self.measuring or ())

    @property
    def how(self) -> str:
        """Its outcome in words."""
        return f"{self.outcome} by hand" if self.by_hand else self.outcome


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
    """Something that the robot found by sensing or was told of, or that tells that such a thing is
    over."""

    t: float
    """s"""
    kind: EventKind
    detail: str
    """in a few words, such as `gas, 840 ppm, near pump P-301`"""
    source: str
    """the watch that found it, `reading` or `told`"""
    place: Vector | None = None
    """m, where it is; None where the signal tells no place"""
    noticed_from: Vector | None = None
    """m, where the robot was when it noticed what has no place, if that says anything about it, as
    of gas and connection; and when it was told of something"""
    floor: int | None = None
    """the floor of `place` or `noticed_from`"""
    confidence: float = 1.0
    """0 to 1"""
    extent: Rect | None = None
    """m, [x0, y0, x1, y1]: what an obstacle closes of the surface"""

    @property
    def over(self) -> bool:
        """Whether it tells that something is over."""
        return self.kind in _ENDS

    @property
    def is_reading(self) -> bool:
        """Whether it is a value that was measured."""
        return self.source == FROM_READING

    @property
    def is_told(self) -> bool:
        """Whether the robot was told of it, and did not sense it."""
        return self.source == TOLD

    @property
    def whereabouts(self) -> str:
        """Where it is, or where the robot was, in words; empty if neither is known."""
        if self.place is not None:
            return f"on {where(self.floor, self.place)}"
        if self.noticed_from is None:
            return ""
        how = "told while the robot was on" if self.is_told else "noticed from"
        return f"{how} {where(self.floor, self.noticed_from)}"

    def ends(self, other: "Anomaly") -> bool:
        """Whether it tells that the other, of before, is over: a watch can say so of what it found
        itself, a person of anything."""
        return other.kind in _ENDS.get(self.kind, ()) and self.source in (TOLD, other.source)


class Finding(Anomaly):
    """An anomaly that is none of the ends of others, and what came of it."""

    number: int | None
    """of the anomaly in the record, from 1; None: an abnormal reading of which it tells nothing"""
    what: str
    """in a few words, such as `gas leak`, or `gauge 5 (#8) abnormal: 9.2 bar`"""
    answered: bool
    """whether a reaction of the mission answered it"""
    answer: str
    """in words: by what, or that none did"""
    over_at: float | None = None
    """s, when it was told to be over; None: it was not"""

    @property
    def in_words(self) -> str:
        """What it is and what came of it: of a reading, that no reaction answers it goes unsaid, as
        its value is what the mission was to find out."""
        if self.is_reading:
            return self.what + (f" ({self.answer})" if self.answered else "")
        over = "" if self.over_at is None else f", over at {clock(self.over_at)}"
        return f"{self.what} at {clock(self.t)} ({self.answer}){over}"


class Interruption(Model):
    """A pause or a reaction, during which the mission stood still."""

    start: float
    """s"""
    end: float
    """s"""
    event: EventKind | None = None
    """the event of the reaction; None: paused until a person goes on"""
    limit_over: bool = False
    """whether the limit of its hold ended it"""

    @property
    def cause(self) -> str:
        """In words."""
        if self.event is None:
            return "paused"
        return f"reaction to {self.event.replace('_', ' ')}"


class WaitRun(Model):
    """The mission stood at a WAIT."""

    task: str
    what: str
    """it waited for, in words"""
    start: float
    """s"""
    end: float
    """s"""
    ended: bool
    """whether that was its end, or that of the run"""
    failure: str | None = None
    """why it failed, if it did: its limit or its window was over"""
    why: str | None = None
    """what ended it, in words"""


class WindowOutcome(StrEnum):
    """What came of a task's time window."""

    KEPT = "kept"
    LATE = "late"
    """done all the same, as the window is soft"""
    MISSED = "missed"
    FAILED = "failed"
    """for another reason"""
    LEFT = "left"
    """the visit was ended from outside: by a group's time, a person or a reaction"""
    OPEN = "open"
    """the run ended, or stands, in the middle of it"""
    NOT_VISITED = "not visited"


class WindowRun(Model):
    """One visit of a task that has a time window, or none."""

    task: str
    earliest: float
    """s"""
    latest: float | None
    """s"""
    hard: bool
    visited: float | None
    """s, when the mission came to it"""
    ended: float | None
    """s"""
    kept: WindowOutcome


class RoundRun(Model):
    """A round of a group."""

    group: str
    number: int
    """from 1"""
    since: float
    """s, when the group was entered, or the round before had ended"""
    due: float | None = None
    """s, for groups with `every`"""
    began: float | None = None
    """s; None: the mission left the group, or the run ended, before it was due"""
    ended: float | None = None
    """s; None: the run ended before"""


class GivenValue(Model):
    """A value of a checkpoint that somebody told the run."""

    t: float
    """s"""
    checkpoint: int
    name: str
    value: float
    unit: str
    normal: bool
    """whether it lies in the nominal range"""

    @property
    def in_words(self) -> str:
        odd = "" if self.normal else ", which is abnormal"
        return f"told that {self.name} (#{self.checkpoint}) shows {self.value:.4g} {self.unit}{odd}"


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
    """s since the mission's start"""
    max_duration: float | None
    """s"""
    within_max_duration: bool
    docked: bool | None
    """whether the robot ended in its station; None: the mission does not ask for it"""
    distance: float
    """m"""
    climbed: float
    """m"""

    @property
    def only_failures(self) -> bool:
        """Whether the plan came to its end, and nothing but failed tasks is missing."""
        at_its_end = self.outcome is Outcome.COMPLETED_WITH_FAILURES
        return at_its_end and self.within_max_duration and self.docked is not False


class RunRecord(Model):
    """A whole run."""

    version: int = 5
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
    waits: tuple[WaitRun, ...] = ()
    """what the mission waited for, in the order of time"""
    windows: tuple[WindowRun, ...] = ()
    """what came of time windows"""
    rounds: tuple[RoundRun, ...] = ()
    """of groups, in the order in which they could begin"""
    given_values: tuple[GivenValue, ...] = ()
    mishaps: tuple[Mishap, ...] = ()
    """what the drive had trouble with, in the order of time"""
    anomalies: tuple[Anomaly, ...] = ()
    """what was found, in the order of time"""
    faults: tuple[AnyFault, ...] = ()
    """what really went wrong, with all that the seed drew; the robot was told nothing of it"""
    began: float = 0.0
    """s of the mission's time: more than 0 where the run goes on from where another one stood"""
    before: tuple[TaskTally, ...] = ()
    """what had ended before that, and is none of this run"""
    resumed: tuple[float, ...] = ()
    """s, when the run went on from its journal after its process had died"""
    reordering: Reordering | None = None
    """None: the tasks were done in the order in which the mission was written"""

    @model_validator(mode="before")
    @classmethod
    def _without_computed(cls, data: object) -> object:
        """What follows from the rest is written for other programs, and not read back."""
        if not isinstance(data, dict):
            return data
        return {
            name: value for name, value in data.items() if name not in cls.model_computed_fields
        }

    @computed_field  # type: ignore[prop-decorator]
    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that was out of the ordinary, each once, and what came of it."""
        told = {anomaly.t for anomaly in self.anomalies if anomaly.is_reading}
        bare = [anomaly_from_reading(r) for r in self.readings if not (r.normal or r.t in told)]
        found = [
            self._finding(anomaly, number, self.anomalies[number:])
            for number, anomaly in enumerate(self.anomalies, start=1)
            if not anomaly.over
        ]
        found += [self._finding(anomaly, None, ()) for anomaly in bare]
        return tuple(sorted(found, key=lambda finding: finding.t))

    @computed_field  # type: ignore[prop-decorator]
    @property
    def headline(self) -> Headline:
        """How the run went, in a line."""
        return headline(
            self.result.verdict,
            success=self.result.success,
            ended=self.result.ended,
            only_failures=self.result.only_failures,
            noticed={
                "finding": [finding.in_words for finding in self.findings],
                "late task": [f"{run.task} ended after its time window" for run in self.late],
                "contact": [
                    f"{c.link} touched {c.element} at {clock(c.start)}" for c in self.contacts
                ],
                "mishap": [f"{m.trouble} at {clock(m.t)}" for m in self.mishaps],
            },
        )

    @property
    def late(self) -> tuple[WindowRun, ...]:
        """The visits that ended after their soft window."""
        return tuple(run for run in self.windows if run.kept is WindowOutcome.LATE)

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

    def _finding(self, anomaly: Anomaly, number: int | None, later: Sequence[Anomaly]) -> Finding:
        answered, answer = self._answer(anomaly)
        return Finding(
            **dict(anomaly),
            number=number,
            what=self._what(anomaly),
            answered=answered,
            answer=answer,
            over_at=next((a.t for a in later if a.ends(anomaly)), None),
        )

    def _what(self, anomaly: Anomaly) -> str:
        for reading in self.readings:
            if anomaly.is_reading and reading.t == anomaly.t:
                value = f"{reading.value:.4g} {reading.unit}"
                return f"{reading.name} (#{reading.checkpoint}) abnormal: {value}"
        return anomaly.kind.replace("_", " ")

    def _answer(self, anomaly: Anomaly) -> tuple[bool, str]:
        """Whether a reaction answered it, and by what in words."""
        own = next((r for r in self.mission.reactions if r.event is anomaly.kind), None)
        if own is None:
            return False, "no reaction answers it"
        begun = own.response is Response.REPORT or any(
            i.event is anomaly.kind and i.end >= anomaly.t for i in self.interruptions
        )
        # The end of the mission is no interruption.
        aborted = own.response is Response.ABORT and self.result.outcome is Outcome.ABORTED
        if begun or aborted:
            return True, f"answered by reaction: {own.response.replace('_', ' ')}"
        return False, "the reaction to it did not begin"


def anomaly_from_reading(reading: Reading, place: Vector | None = None) -> Anomaly:
    """Return what a reading outside the nominal range tells; `place` (m) is its checkpoint's, None
    for one that no anomaly was made of, as one made by hand."""
    return Anomaly(
        t=reading.t,
        kind=EventKind.ABNORMAL_READING,
        detail=f"{reading.name} shows {reading.value:g} {reading.unit}",
        source=FROM_READING,
        place=place,
        floor=reading.floor,
    )
