"""Record of a run: all that a report is made from, as data that can be written and read back.

It holds simulated times only, and nothing that depends on the computer. So the same mission, site
and seed give the same record.
"""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Any

from pydantic import computed_field, model_validator

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_of
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm import Hfsm, Outcome
from argo_compiler.hfsm.progress import TaskTally
from argo_compiler.il import Action, EventKind, Mission, Response
from argo_env.drives.drive import Trouble
from argo_env.faults.kinds import AnyFault
from argo_env.files.checked_files import CHECKSUM
from argo_env.formatting import floor_and_position_text, min_sec_text
from argo_env.run.verdict import VerdictCode, VerdictPart
from argo_env.run.verdict_line import Headline, Noticed, NoticedKind, run_headline
from argo_env.site.shapes import Vector
from argo_env.site.spec import Rect

DIGITS = 4
"""decimal digits of recorded lengths and angles: finer than the geometry is exact"""
FROM_READING = "reading"
"""source of an anomaly that is an abnormal value measured at a checkpoint"""
REPORTED = "told"
"""source of an anomaly that was reported to the robot from outside"""
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
"""Events that report the end of others, with the events that each of them can end."""


def ends(end: EventKind, event: EventKind) -> bool:
    """Return True if the event `end` reports the end of others, and `event` may be one of them."""
    return event in _ENDS.get(end, ())


class PathSample(Model):
    """Point of the recorded path: the robot's pose at a time."""

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
    """charge of the battery, 0 to 1; None: not known, or no battery"""


class TaskRun(Model):
    """Run of a task: one execution of its action, from start to end."""

    task: str
    action: Action
    object_id: str | None = None
    start: float
    """s"""
    end: float
    """s"""
    outcome: str
    """`done`, `failed`, `cancelled`, or `interrupted` by a pause or a reaction"""
    reason: Text | None = None
    """why it failed, was cancelled or interrupted"""
    reason_wording: Wording | None = None
    distance: float
    """m driven"""
    climbed: float
    """m upwards"""
    measuring: tuple[tuple[float, float], ...] | None = None
    """s, start and end of each measurement, arm included; several if the robot looked from several
    poses. None: not recorded, as in old records"""
    early: tuple[float, float] | None = None
    """s, start and end of the wait at the pose until the task's window began"""
    unmoved: tuple[str, ...] = ()
    """joints that the task states and this robot or its simulation does not move"""
    by_hand: bool = False
    """whether a person let the robot do this, and not the mission"""

    @property
    def measuring_duration(self) -> float:
        """Total time in s that the measurements of this execution took."""
        return sum(end - start for start, end in self.measuring or ())

    @property
    def outcome_in_words(self) -> str:
        """Outcome of the task's action in words, such as `done by hand`."""
        return f"{self.outcome} by hand" if self.by_hand else self.outcome


class Reading(Model):
    """Reading: a value that was measured at a checkpoint."""

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
    """number of poses from which the robot tried to read, the last one with success"""
    confidence: float = 1.0
    """confidence of the sensor in the value, 0 to 1"""


class Contact(Model):
    """Contact between the robot and the site, from its start to its end."""

    start: float
    """s"""
    end: float
    """s"""
    link: str
    """link of the robot"""
    element: str
    """element of the site"""
    x: float
    """m"""
    y: float
    """m"""
    z: float
    """m"""
    depth: float
    """m, the deepest overlap"""


class Mishap(Model):
    """Mishap of the drive: the robot slipped, was stuck or tipped over, perhaps only for a time."""

    t: float
    """s"""
    trouble: Trouble
    detail: Text
    """in a few words, such as `made 0.09 m of 0.45 m commanded`"""
    place: Vector
    """position in m"""
    floor: int
    detail_wording: Wording | None = None


class Anomaly(Model):
    """Anomaly that the robot noticed or that was reported to it, or the end of one."""

    t: float
    """s"""
    kind: EventKind
    detail: Text
    """in a few words, such as `gas, 840 ppm, near pump P-301`"""
    source: str
    """name of the watch that noticed it, or `reading`, or `told` if it was reported from outside"""
    detail_wording: Wording | None = None
    place: Vector | None = None
    """position in m; None if the signal does not contain one"""
    noticed_from: Vector | None = None
    """position of the robot in m when it noticed an anomaly without a position, if that says
    anything about the anomaly, as for gas and the connection, or when the anomaly was reported"""
    floor: int | None = None
    """the floor of `place` or `noticed_from`; None: not known"""
    confidence: float = 1.0
    """0 to 1"""
    extent: Rect | None = None
    """m, [x0, y0, x1, y1]: part of the surface that an obstacle closes"""

    @property
    def is_end(self) -> bool:
        """True if this reports that an anomaly has ended."""
        return self.kind in _ENDS

    @property
    def is_reading(self) -> bool:
        """True if this is an abnormal value that was measured."""
        return self.source == FROM_READING

    @property
    def is_reported_from_outside(self) -> bool:
        """True if an event from outside reports this; False if the robot noticed it."""
        return self.source == REPORTED

    @property
    def whereabouts(self) -> str:
        """Position in words: of the anomaly, or else of the robot then; empty if none is known."""
        on = "at" if self.floor is None else "on"
        if self.place is not None:
            return f"{on} {floor_and_position_text(self.floor, self.place)}"
        if self.noticed_from is None:
            return ""
        prefix = (
            f"reported while the robot was {on}"
            if self.is_reported_from_outside
            else "noticed from"
        )
        return f"{prefix} {floor_and_position_text(self.floor, self.noticed_from)}"

    def reports(self, reading: Reading) -> bool:
        """Return True if this reports that the reading's value is abnormal."""
        return (
            self.is_reading
            and self.kind is EventKind.ABNORMAL_READING
            and self.t == reading.t
            and self.detail == _shown_value(reading)
        )

    def is_end_of(self, other: "Anomaly") -> bool:
        """Return True if this reports the end of the earlier anomaly `other`.

        A watch can end an anomaly that it noticed itself, a person can end any.
        """
        return ends(self.kind, other.kind) and self.source in (REPORTED, other.source)


class Finding(Anomaly):
    """Finding: an anomaly, without reports of ends, and the mission's answer to it."""

    number: int | None
    """number of the anomaly in the record, from 1; None: an abnormal reading without an anomaly"""
    what: str
    """in a few words, such as `gas leak`, or `gauge 5 (#8) abnormal: 9.2 bar`"""
    answered: bool
    """whether a reaction of the mission answered it"""
    answer: str
    """the answer in words, or that there was none"""
    response: Response | None = None
    """of the mission's reaction to it, whether that began or not; None: it has no reaction"""
    over_at: float | None = None
    """s, when its end was reported; None: it was not"""

    @property
    def in_words(self) -> str:
        """Finding and answer in words.

        For an abnormal reading that no reaction answers, the answer is left out: its value is what
        the mission was to find out.
        """
        if self.is_reading:
            return self.what + (f" ({self.answer})" if self.answered else "")
        end = "" if self.over_at is None else f", over at {min_sec_text(self.over_at)}"
        return f"{self.what} at {min_sec_text(self.t)} ({self.answer}){end}"


class Interruption(Model):
    """Interruption of the mission: a pause or a reaction, during which it did not progress."""

    start: float
    """s"""
    end: float
    """s"""
    event: EventKind | None = None
    """event that the reaction answers; None: a pause until a person resumes the mission"""
    limit_over: bool = False
    """whether the time limit of the reaction's hold ended it"""

    @property
    def cause(self) -> str:
        """Cause of the interruption in words, such as `paused`."""
        if self.event is None:
            return "paused"
        return f"reaction to {self.event.replace('_', ' ')}"


class WaitRun(Model):
    """Visit of a WAIT task, during which the mission waited."""

    task: str
    what: str
    """the awaited condition, in words"""
    start: float
    """s"""
    end: float
    """s"""
    ended: bool
    """whether the wait itself ended; False: the run ended during the wait"""
    failure: str | None = None
    """reason of a failure: the time limit or the window was over; None: it did not fail"""
    why: str | None = None
    """reason of its end, in words"""


class WindowOutcome(StrEnum):
    """Outcome of a visit with regard to the task's time window."""

    KEPT = "kept"
    LATE = "late"
    """done after a soft window"""
    MISSED = "missed"
    FAILED = "failed"
    """failed for another reason than the window"""
    LEFT = "left"
    """ended from outside: by a group's time limit, a person or a reaction"""
    OPEN = "open"
    """not ended when the record was made"""
    NOT_VISITED = "not visited"


class WindowVisit(Model):
    """Visit of a task that has a time window; also such a task that was not visited at all."""

    task: str
    earliest: float
    """s"""
    latest: float | None
    """s"""
    hard: bool
    visited: float | None
    """s, start of the visit; None: the task was not visited"""
    ended: float | None
    """s"""
    kept: WindowOutcome


class RoundRun(Model):
    """Round of a group."""

    group: str
    number: int
    """from 1"""
    since: float
    """s, when the group was entered or the previous round ended; a group inside an awaited round
    is entered when that round begins"""
    due: float | None = None
    """s, for groups with `every`; while the round is awaited, as planned at `since`"""
    began: float | None = None
    """s; None: the mission left the group or the run ended before the round was due"""
    ended: float | None = None
    """s; None: the run ended before"""

    def awaited_until(self, now: float) -> float:
        """Return the time (s) until which the round was awaited; `now` (s) if it still is."""
        if self.began is not None:
            return self.began
        return now if self.ended is None else self.ended


class GivenValue(Model):
    """Value of a checkpoint that a person reported to the run."""

    t: float
    """s"""
    checkpoint: int
    name: str
    value: float
    unit: str
    normal: bool
    """whether the value lies in the nominal range"""

    @property
    def in_words(self) -> str:
        note = "" if self.normal else ", which is abnormal"
        return (
            f"reported: {self.name} (#{self.checkpoint}) shows {self.value:.4g} {self.unit}{note}"
        )


class TraceStep(Model):
    """Step of the state machine."""

    t: float
    """s"""
    source: str | None
    target: str | None
    cause: str
    """cause in words"""


class Reordering(Model):
    """Reordering of the mission's tasks that was suggested before the run and applied to it."""

    written: tuple[str, ...]
    """names of the tasks that may change places, in the written order"""
    order: tuple[str, ...]
    """their names in the suggested order, without the tasks that it leaves out"""
    written_duration: float
    """s, predicted for the written order"""
    duration: float
    """s, predicted for the suggested order"""
    bound: float
    """s, lower bound on the duration of any order that does as much"""
    proven: bool
    """whether no other order is better"""


class Result(Model):
    """Result of a mission: verdict, outcome, duration and distance."""

    success: bool
    verdict: str
    """one sentence: success, or what is missing"""
    parts: tuple[VerdictPart, ...] = ()
    """the verdict as data; empty in old records"""
    ended: bool = True
    """whether the run has ended; False: it was interrupted here and may continue"""
    outcome: Outcome | None = None
    """outcome of the state machine; None: the run was stopped before the machine ended"""
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
    def only_tasks_failed(self) -> bool:
        """True if the mission came to its end without success, and only because tasks failed."""
        completed = self.outcome is Outcome.COMPLETED_WITH_FAILURES
        return completed and self.within_max_duration and self.docked is not False

    @property
    def reached_all_the_same(self) -> tuple[str, ...]:
        """Tasks whose drive was interrupted, at whose pose the robot ended all the same."""
        code = VerdictCode.REACHED_ALL_THE_SAME
        return tuple(name for part in self.parts if part.code is code for name in part.names)


class RunRecord(Model):
    """Record of a run."""

    version: int = 5
    """version of the format"""

    @model_validator(mode="before")
    @classmethod
    def _without_checksum(cls, data: Any) -> Any:
        """Leave out the checksum of a file."""
        if isinstance(data, dict):
            return {name: value for name, value in data.items() if name != CHECKSUM}
        return data

    mission: Mission
    hfsm: Hfsm
    site: str
    robot: str
    drive: str
    sensor: str
    seed: int
    diagnostics: tuple[Diagnostic, ...]
    """diagnostics of the import: what was repaired or respelled"""
    result: Result
    tasks: tuple[TaskRun, ...]
    readings: tuple[Reading, ...]
    contacts: tuple[Contact, ...]
    trace: tuple[TraceStep, ...]
    path: tuple[PathSample, ...]
    interruptions: tuple[Interruption, ...] = ()
    waits: tuple[WaitRun, ...] = ()
    """visits of WAIT tasks, in the order of time"""
    windows: tuple[WindowVisit, ...] = ()
    """visits of tasks with time windows, and tasks with windows that were not visited"""
    rounds: tuple[RoundRun, ...] = ()
    """rounds of groups, in the order in which they could begin"""
    given_values: tuple[GivenValue, ...] = ()
    mishaps: tuple[Mishap, ...] = ()
    """mishaps of the drive, in the order of time"""
    anomalies: tuple[Anomaly, ...] = ()
    """anomalies that were noticed or reported, in the order of time"""
    faults: tuple[AnyFault, ...] = ()
    """simulated faults, with all values that the seed drew; the robot did not know them"""
    began: float = 0.0
    """s since the mission's start; more than 0 if the run continues another run"""
    before: tuple[TaskTally, ...] = ()
    """tasks that ended before that, in the earlier run"""
    resumed: tuple[float, ...] = ()
    """s, times at which the run was resumed from its journal after its process had died"""
    reordering: Reordering | None = None
    """change of the tasks' order before the run; None: they are in the order as written"""

    def __repr_args__(self) -> Iterator[tuple[str, object]]:
        """Yield what tells one run from another; all fields would fill hundreds of screens."""
        for name in ("site", "robot", "drive", "sensor", "seed", "result"):
            yield name, getattr(self, name)

    @model_validator(mode="before")
    @classmethod
    def _without_computed(cls, data: object) -> object:
        """Drop the computed fields, which are written for other programs and not read back."""
        if not isinstance(data, dict):
            return data
        return {
            name: value for name, value in data.items() if name not in cls.model_computed_fields
        }

    @computed_field  # type: ignore[prop-decorator]
    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings of the run in the order of time, each with the reaction of the mission to it.

        They are the anomalies, without reports of their ends, and the readings outside the nominal
        range that no anomaly reports.
        """
        bare = [
            anomaly_from_reading(reading)
            for reading in self.readings
            if not (reading.normal or any(a.reports(reading) for a in self.anomalies))
        ]
        findings = [
            self._finding(anomaly, number, self.anomalies[number:])
            for number, anomaly in enumerate(self.anomalies, start=1)
            if not anomaly.is_end
        ]
        findings += [self._finding(anomaly, None, ()) for anomaly in bare]
        return tuple(sorted(findings, key=lambda finding: finding.t))

    @computed_field  # type: ignore[prop-decorator]
    @property
    def headline(self) -> Headline:
        """Headline of the run with its parts: its verdict and what was noticed."""
        return run_headline(
            self.result.verdict,
            self.result.parts,
            success=self.result.success,
            ended=self.result.ended,
            only_tasks_failed=self.result.only_tasks_failed,
            noticed=tuple(self._noticed()),
        )

    def _noticed(self) -> Iterator[Noticed]:
        """Yield what was noticed in the run: findings, late tasks, contacts and mishaps."""
        for finding in self.findings:
            reading = self.abnormal_reading(finding)
            yield Noticed(
                kind=NoticedKind.FINDING,
                text=finding.in_words,
                t=finding.t,
                event=finding.kind,
                checkpoint=reading and f"{reading.name} (#{reading.checkpoint})",
                value=reading and reading.value,
                unit=reading and reading.unit,
                response=finding.response,
                answered=finding.answered,
                over_at=finding.over_at,
            )
        for run in self.visits_ended_late:
            text = f"{run.task} ended after its time window"
            yield Noticed(kind=NoticedKind.LATE_TASK, text=text, task=run.task)
        for c in self.contacts:
            text = f"{c.link} touched {c.element} at {min_sec_text(c.start)}"
            kind = NoticedKind.CONTACT
            yield Noticed(kind=kind, text=text, t=c.start, link=c.link, element=c.element)
        for m in self.mishaps:
            text = f"{m.trouble} at {min_sec_text(m.t)}"
            yield Noticed(kind=NoticedKind.MISHAP, text=text, t=m.t, trouble=m.trouble)

    @property
    def visits_ended_late(self) -> tuple[WindowVisit, ...]:
        """Visits of tasks that ended after the task's soft time window."""
        return tuple(run for run in self.windows if run.kept is WindowOutcome.LATE)

    @property
    def faults_not_begun(self) -> tuple[AnyFault, ...]:
        """Faults that did not happen because the run ended before they began."""
        return tuple(fault for fault in self.faults if fault.start_time > self.result.duration)

    def explain_fault_not_begun(self, fault: AnyFault) -> str:
        """Return a text that says why a missed fault did not happen."""
        return (
            f"fault {fault.kind.replace('_', ' ')} did not happen: begins at "
            f"{fault.start_time:g} s, the mission ended at {round(self.result.duration, 1):g} s"
        )

    def abnormal_reading(self, anomaly: Anomaly) -> Reading | None:
        """Return the reading whose value the anomaly reports; None for any other anomaly."""
        return next((reading for reading in self.readings if anomaly.reports(reading)), None)

    def _finding(self, anomaly: Anomaly, number: int | None, later: Sequence[Anomaly]) -> Finding:
        answered, answer = self._answer(anomaly)
        return Finding(
            **dict(anomaly),
            number=number,
            what=self._what(anomaly),
            answered=answered,
            answer=answer,
            response=next(
                (r.response for r in self.mission.reactions if r.event is anomaly.kind), None
            ),
            over_at=next((a.t for a in later if a.is_end_of(anomaly)), None),
        )

    def _what(self, anomaly: Anomaly) -> str:
        if (reading := self.abnormal_reading(anomaly)) is not None:
            value = f"{reading.value:.4g} {reading.unit}"
            return f"{reading.name} (#{reading.checkpoint}) abnormal: {value}"
        return anomaly.kind.replace("_", " ")

    def _answer(self, anomaly: Anomaly) -> tuple[bool, str]:
        """Return whether a reaction answered the anomaly, and how, or why not, in words."""
        reaction = next((r for r in self.mission.reactions if r.event is anomaly.kind), None)
        if reaction is None:
            return False, "no reaction answers it"
        begun = reaction.response is Response.REPORT or any(
            i.event is anomaly.kind and i.end >= anomaly.t for i in self.interruptions
        )
        # An abort ends the mission, so it is not among the interruptions.
        aborted = reaction.response is Response.ABORT and self.result.outcome is Outcome.ABORTED
        if begun or aborted:
            return True, f"answered by reaction: {reaction.response.replace('_', ' ')}"
        return False, "the reaction to it did not begin"


def _shown_value(reading: Reading) -> str:
    """Return what a checkpoint showed, in words; names of checkpoints are unique on their site."""
    return Message(
        "{checkpoint} shows {value:g} {unit}",
        checkpoint=reading.name,
        value=reading.value,
        unit=reading.unit,
    )


def anomaly_from_reading(reading: Reading, place: Vector | None = None) -> Anomaly:
    """Return the anomaly of a reading outside the nominal range.

    Args:
        reading: the reading.
        place: position of the checkpoint in m. None: the anomaly has no position, as for a reading
            that the log does not have as an anomaly, such as one taken by hand.
    """
    return Anomaly(
        t=reading.t,
        kind=EventKind.ABNORMAL_READING,
        detail=(shown := _shown_value(reading)),
        detail_wording=wording_of(shown),
        source=FROM_READING,
        place=place,
        floor=reading.floor,
    )
