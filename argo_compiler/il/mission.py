"""Intermediate language (IL): the data models of a mission.

The structures and names are those of the thesis (sections 3.2 and 4.4), so that a mission maps one
to one onto its ROS messages. `docs/language.md` defines their meaning, and `argo_compiler.hfsm`
executes it. A `Mission` read from JSON has the right shape; `argo_compiler.checks` checks whether
it makes sense.
"""

from enum import StrEnum
from typing import Any, Literal

from pydantic import Field, model_validator

from argo_compiler.base.model import Model, Pose
from argo_compiler.diagnostics import Span
from argo_compiler.il.events import DEFAULT_PRIORITIES, EventKind
from argo_compiler.il.responses import Response, expand_response

MAX_TIME_S = 1e12
"""limit of each time in a mission, and of its clock: some 30,000 years; up to this, a clock in s
still resolves milliseconds"""
MAX_COUNT = 1_000_000_000
"""limit of numbers of rounds, of priorities and of numbers of areas"""
MAX_RETRIES = 1_000_000


class Action(StrEnum):
    """Action of a task. START only defines where the mission begins; the machine skips it."""

    START = "START"
    WAYPOINT = "WAYPOINT"
    MEASURE = "MEASURE"
    WAIT = "WAIT"
    """stand still; the machine waits by itself, and the robot gets no command"""


class Mode(StrEnum):
    """Mode of control: who drives the robot (thesis 1.2)."""

    AUTONOMOUS = "autonomous"
    SUPERVISORY = "supervisory"


class Order(StrEnum):
    """Order of the checkpoints: as in the script, or free to be changed."""

    PRECISE = "precise"
    ANY = "any"


class Stop(StrEnum):
    """End of a group when its time is up: leave it at once, or complete the round."""

    HARD = "hard"
    SOFT = "soft"


class ConditionType(StrEnum):
    """Comparisons and other tests of a reading.

    The comparisons are those of table 3.1 of the thesis, with its misprint for GREATER corrected.
    """

    LESS = "MEASURED_VALUE_LESS"
    GREATER = "MEASURED_VALUE_GREATER"
    WITHIN = "MEASURED_VALUE_WITHIN"
    UNREADABLE = "READING_UNREADABLE"
    """the robot looked at the checkpoint, but could not read a value"""
    UNREACHABLE = "READING_UNREACHABLE"
    """the robot could not get to a pose from which it measures the checkpoint"""
    FAILED = "READING_FAILED"
    """the last measurement gave no value, for whatever reason; this includes unreadable and
    unreachable ones"""
    STALE = "READING_STALE"
    """there is a value, and it is older than `max_age`"""
    ABNORMAL = "READING_ABNORMAL"
    """there is a value, and it lies outside the checkpoint's nominal range"""

    @property
    def compares(self) -> bool:
        """True if a condition of this type compares the value of the reading with bounds."""
        return self in _COMPARISONS


_COMPARISONS = frozenset([ConditionType.LESS, ConditionType.GREATER, ConditionType.WITHIN])


class OnFailure(StrEnum):
    """Continuation of the mission after a task has failed for good, with all its retries."""

    CONTINUE = "continue"
    """as after a task that has ended without a value"""
    RETURN = "return"
    """drive to the mission's `dock` and end there"""
    ABORT = "abort"
    """end where the robot stands"""
    BRANCH = "branch"
    """continue with the task's `failure_target`"""


class Afterwards(StrEnum):
    """Continuation of the mission after the drive and the hold of a reaction."""

    RESUME = "resume"
    """continue where the mission was interrupted; the interrupted action is started again"""
    WAIT = "wait"
    """stand still until a person resumes or ends the mission"""
    END = "end"
    """end the mission"""


class Condition(Model):
    """Test of the last reading of a checkpoint.

    LESS: value < param1. GREATER: value > param1. WITHIN: param1 < value < param2. With `inclusive`
    the bounds themselves satisfy it as well. The other types test the kind of reading, and have no
    bounds. Without a value, or with one that is older than `max_age`, a comparison is false.
    """

    type: ConditionType
    id: str = ""
    """a name for people; the machine does not use it"""
    object_id: str
    """the checkpoint whose reading is tested"""
    param1: float | None = None
    """the bound, for LESS and GREATER; the lower bound, for WITHIN"""
    param2: float | None = None
    """the upper bound, for WITHIN only"""
    inclusive: bool = False
    """whether values equal to a bound satisfy it (at least, at most)"""
    max_age: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s; None: a value never becomes too old. STALE needs one"""


class Transition(Model):
    """Transition to the next task when a task has ended and all conditions are satisfied.

    Without conditions it is unconditional.
    """

    target: str
    conditions: tuple[Condition, ...] = ()


class JointState(Model):
    """Target state of named joints during the action, for semi-autonomous ones (thesis 4.4)."""

    names: tuple[str, ...]
    positions: tuple[float, ...] = ()
    """rad or m, one for each name, or none at all"""
    velocities: tuple[float, ...] = ()
    """rad/s or m/s, one for each name, or none at all"""
    efforts: tuple[float, ...] = ()
    """Nm or N, one for each name, or none at all"""


class WaitRule(Model):
    """Duration of a WAIT: a fixed time, or until an event or conditions.

    Either `duration` is given, or `event`, `conditions` or both of them, of which the first ends
    the wait.
    """

    duration: float | None = Field(default=None, ge=0, le=MAX_TIME_S)
    """s since the visit of the task began; 0: the task does nothing, and only joins transitions"""
    event: EventKind | None = None
    """wait until it occurs; an occurrence before this visit of the task does not count"""
    conditions: tuple[Condition, ...] = ()
    """wait until all of them are satisfied"""
    limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s, with `event` or `conditions`: the task fails when it is over"""
    charge_to: float | None = Field(default=None, gt=0, le=1)
    """BATTERY_CHARGED: the share of the battery's charge, 0 to 1, with which the robot raises the
    event for this wait; None: the robot's own level, or with `charge_for` any"""
    charge_for: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """BATTERY_CHARGED: s since the wait began before which the robot does not raise the event"""


class TimeWindow(Model):
    """Time window of a task, in s since the mission's start."""

    earliest: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """if the robot arrives earlier, it waits there until this time"""
    latest: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """when the task must have ended; None: no limit"""
    hard: bool = True
    """whether the task fails if it has not ended at `latest`; otherwise it is done even if it is
    late"""
    missed_target: str | None = None
    """the task that follows if a hard window is missed; None: as after any other failure"""


class Task(Model):
    """Step of a mission. `name` is unique within the mission and never empty."""

    name: str = Field(min_length=1)
    action: Action
    group: str = ""
    """the group it is displayed in; the machine uses the group's own start and end"""
    object_id: str | None = None
    """MEASURE: the checkpoint"""
    pose: Pose | None = None
    """WAYPOINT: the target. START: the robot's initial pose. MEASURE: the pose from which it
    measures; None: any pose from which it sees the checkpoint"""
    wait: WaitRule | None = None
    """WAIT: its duration"""
    velocity: float | None = Field(default=None, gt=0)
    """m/s on the path to this task, wherever it starts; None: the robot's planning speed"""
    joint_states: JointState | None = None
    retries: int = Field(default=0, ge=0, le=MAX_RETRIES)
    """how often a failed action is tried again before the task fails"""
    on_failure: OnFailure = OnFailure.CONTINUE
    failure_target: str | None = None
    """BRANCH: the task that follows"""
    time_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s for each attempt, the drive to the task included, after which it has failed; None: no
    limit"""
    reading_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """MEASURE: s for which the robot tries to read the value, after which it is unreadable; None:
    the robot's own limit"""
    optional: bool = False
    """whether the mission is complete without it: an order that has too little time may leave it
    out, and its failure does not count as one of the mission"""
    priority: int = Field(default=1, ge=1, le=1_000_000)
    """its value where not all tasks can be done; the machine does not use it"""
    window: TimeWindow | None = None
    transitions: tuple[Transition, ...] = ()
    source: Span | None = None
    """where a script asked for it"""


class Group(Model):
    """Group of tasks that are repeated: those from `start` to `end` in the mission's order.

    The first of count, duration and `until` that is reached ends it; with none of them it is
    endless and a transition must leave it. `/` in the name nests: `Alpha/Beta` lies inside `Alpha`.
    """

    name: str = Field(min_length=1)
    start: str
    end: str
    max_repeat_count: int = Field(default=0, ge=0, le=MAX_COUNT)
    """total number of rounds; 0: no limit"""
    max_repeat_duration: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """s on the group's clock since it was entered; 0: no limit"""
    count_interruptions: bool = False
    """whether the time of pauses, reactions and supervision counts as part of the duration"""
    stop: Stop = Stop.HARD
    every: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """s on the group's clock from the start of one round to that of the next. The schedule does not
    drift: round n is due (n - 1) times this after the group was entered, and a round that is
    late starts at once. 0: a round starts when the previous one has ended"""
    until: tuple[Condition, ...] = ()
    """no other round starts once all of these are satisfied at the end of one; empty: no such
    limit"""
    source: Span | None = None

    @property
    def has_hard_stop(self) -> bool:
        """True if the group is left as soon as its time is up, in the middle of a round."""
        return self.stop is Stop.HARD and self.max_repeat_duration > 0


class Reaction(Model):
    """Reaction to an event. A mission has at most one for each kind of event.

    The response is executed; then the robot holds until `until`, if it is given; then `afterwards`
    follows. A reaction of higher rank interrupts one of lower rank; see the page `language`
    of the documentation.
    """

    event: EventKind
    response: Response
    pose: Pose | None = None
    """SAFE_AREA: the target. RETURN: the pose of the dock; None: the mission's dock"""
    area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    """RETURN: the starting area whose dock is at `pose`, for people"""
    until: EventKind | None = None
    """PAUSE, RETURN, SAFE_AREA: hold until this event occurs, or a person resumes"""
    afterwards: Afterwards = Afterwards.END
    """RETURN and SAFE_AREA only: after a PAUSE the mission resumes, a REPORT interrupts nothing,
    and an ABORT ends the mission"""
    hold_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s for which it holds at most; None: no limit"""
    on_limit: Afterwards = Afterwards.WAIT
    """what follows at that limit: RESUME continues as if `until` had occurred, WAIT pauses the
    mission, END ends it"""
    priority: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    """the greater one goes first; None: by how bad the event is, see `DEFAULT_PRIORITIES`"""
    battery_below: float | None = Field(default=None, gt=0, lt=1)
    """LOW_BATTERY: the share of the battery's charge, 0 to 1, below which the robot raises the
    event in this mission; None: the robot's own level"""
    charge_to: float | None = Field(default=None, gt=0, le=1)
    """until BATTERY_CHARGED: the share of the battery's charge, 0 to 1, with which the robot raises
    that event for this hold; None: the robot's own level, or with `charge_for` any"""
    charge_for: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """until BATTERY_CHARGED: s since the hold began before which the robot does not raise that
    event"""
    source: Span | None = None

    @model_validator(mode="before")
    @classmethod
    def _expand_response(cls, data: Any) -> Any:
        """Replace a response of an installed package by one of Argo's own; see `il.responses`."""
        return expand_response(data) if isinstance(data, dict) else data

    @property
    def holds(self) -> bool:
        """True if the robot stands still until an event occurs or a person resumes the mission."""
        return self.until is not None or self.response is Response.PAUSE

    @property
    def urgency_score(self) -> tuple[int, int]:
        """Urgency among reactions; the reaction with the greatest goes first.

        ABORT ranks above all others, then the reaction to an emergency stop, then the priority
        decides, by default that of the event.
        """
        safety = 0
        if self.response is Response.ABORT:
            safety = 2
        elif self.event is EventKind.EMERGENCY_STOP:
            safety = 1
        priority = self.priority
        return safety, DEFAULT_PRIORITIES[self.event] if priority is None else priority


class Mission(Model):
    """Mission: header, tasks in order, groups over them, and reactions to events."""

    version: Literal[4] = 4
    """version of this format"""
    designation: str = ""
    site: str = ""
    """the site of its poses and checkpoints"""
    mode: Mode = Mode.AUTONOMOUS
    max_duration: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s since the mission's start, interruptions included; None: no limit"""
    start_area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    end_area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    """the area in whose dock the mission ends; None: it ends where its last task ends"""
    dock: Pose | None = None
    """pose of the docking station to which RETURN drives"""
    order: Order = Order.PRECISE
    anomaly_specification: str = ""
    real_time_reporting: str = ""
    after_mission_report: str = ""
    tasks: tuple[Task, ...] = ()
    groups: tuple[Group, ...] = ()
    reactions: tuple[Reaction, ...] = ()
    current: str | None = None
    """the task that the planner shows as current; the machine does not use it"""
    left_out: tuple[str, ...] = ()
    """names of tasks that were left out when the order was chosen, as there was not enough time for
    them; for people, the machine does not use it"""
    before: tuple[tuple[str, str], ...] = ()
    """pairs of tasks by name: a run that reaches both of them reaches the first one before the
    second. A chosen order respects it; the machine does not use it"""

    def task(self, name: str) -> Task | None:
        return next((t for t in self.tasks if t.name == name), None)

    @property
    def omitted_task_names(self) -> tuple[str, ...]:
        """Names of the tasks that were left out and have not been added again."""
        names = {task.name for task in self.tasks}
        return tuple(name for name in self.left_out if name not in names)
