"""The intermediate language (IL): what a mission is, as data.

The structures and names are those of the thesis (sections 3.2 and 4.4), so that a plan maps one to
one onto its ROS messages. What they mean is written in `docs/language.md` and carried out by
`argo_compiler.hfsm`. A `Mission` read from JSON has the right shape; whether it makes sense is what
`argo_compiler.checks` says.
"""

from enum import StrEnum
from typing import Literal

from pydantic import Field

from argo_compiler.diagnostics import Span
from argo_compiler.model import Model, Pose


class Action(StrEnum):
    """What a task does. START only says where the mission begins; the machine passes over it."""

    START = "START"
    WAYPOINT = "WAYPOINT"
    MEASURE = "MEASURE"


class Mode(StrEnum):
    """Who drives (thesis 1.2)."""

    AUTONOMOUS = "autonomous"
    SUPERVISORY = "supervisory"


class Order(StrEnum):
    """Whether the checkpoints' order is the script's or may be changed."""

    PRECISE = "precise"
    ANY = "any"


class Stop(StrEnum):
    """What a group does when its time is up: leave at once, or complete the round."""

    HARD = "hard"
    SOFT = "soft"


class ConditionType(StrEnum):
    """The comparisons of table 3.1 of the thesis, its misprint for GREATER corrected."""

    LESS = "MEASURED_VALUE_LESS"
    GREATER = "MEASURED_VALUE_GREATER"
    WITHIN = "MEASURED_VALUE_WITHIN"


class OnFailure(StrEnum):
    """How the mission goes on when a task has failed for good, all its retries included."""

    CONTINUE = "continue"
    """as after a task that has ended without a value"""
    RETURN = "return"
    """drive to the mission's `dock` and end there"""
    ABORT = "abort"
    """end where the robot stands"""


class EventKind(StrEnum):
    """What may happen besides the end of an action: the competition's events (thesis 1.2), and
    what tells that one of them is over."""

    GAS_LEAK = "gas_leak"
    HOT_SPOT = "hot_spot"
    ABNORMAL_SOUND = "abnormal_sound"
    """of a pump"""
    PLATFORM_ALARM = "platform_alarm"
    """the general platform alarm, GPA"""
    POSITIVE_OBSTACLE = "positive_obstacle"
    """something stands in the way"""
    NEGATIVE_OBSTACLE = "negative_obstacle"
    """a part of the way is missing"""
    LOW_BATTERY = "low_battery"
    CONNECTION_LOST = "connection_lost"
    EMERGENCY_STOP = "emergency_stop"
    DYSFUNCTION = "dysfunction"
    """of the robot itself"""
    ABNORMAL_READING = "abnormal_reading"
    """a measured value outside the checkpoint's nominal range"""
    TIME_UP = "time_up"
    """the mission's maximum duration is over; the executor raises it by itself"""
    ALL_CLEAR = "all_clear"
    """a danger is over"""
    BATTERY_CHARGED = "battery_charged"
    CONNECTION_RESTORED = "connection_restored"


class Response(StrEnum):
    """What a reaction does. Each of them reports the event first."""

    REPORT = "report"
    """nothing else; the mission does not even notice"""
    PAUSE = "pause"
    """stop and stand still"""
    RETURN = "return"
    """drive to the mission's `dock`"""
    SAFE_AREA = "safe_area"
    """drive to the reaction's `pose`"""
    ABORT = "abort"
    """end the mission where the robot stands"""


class Afterwards(StrEnum):
    """What happens to the mission when the drive of a reaction has ended."""

    RESUME = "resume"
    """go on where it was interrupted; the interrupted action is started anew"""
    WAIT = "wait"
    """stand still until a person resumes the mission or ends it"""
    END = "end"
    """the mission is over"""


class Condition(Model):
    """A test of the last value measured at a checkpoint.

    LESS: value < param1. GREATER: value > param1. WITHIN: param1 < value < param2. With `inclusive`
    the bounds themselves count as well. A value that was never measured, or is older than
    `max_age`, makes the condition false.
    """

    type: ConditionType
    id: str = ""
    """a name for people; the machine does not use it"""
    object_id: str
    """the checkpoint whose value is compared"""
    param1: float
    param2: float | None = None
    """upper bound, for WITHIN only"""
    inclusive: bool = False
    """whether the bounds are among the values that satisfy it (at least, at most)"""
    max_age: float | None = Field(default=None, gt=0)
    """s; None: a value never becomes stale"""


class Transition(Model):
    """Where to go on when a task has ended and all conditions hold; none: unconditional."""

    target: str
    conditions: tuple[Condition, ...] = ()


class JointState(Model):
    """Positions of named joints, for semi-autonomous actions (thesis 4.4)."""

    names: tuple[str, ...]
    positions: tuple[float, ...]
    """rad or m, one for each name"""


class Task(Model):
    """One thing to do. `name` is unique within the mission and never empty."""

    name: str = Field(min_length=1)
    action: Action
    group: str = ""
    """the group it is shown in; the machine goes by the group's own start and end"""
    object_id: str | None = None
    """MEASURE: the checkpoint"""
    pose: Pose | None = None
    """WAYPOINT and START: where"""
    velocity: float | None = Field(default=None, gt=0)
    """m/s on the way to the next task; None: the robot's planning speed"""
    joint_states: JointState | None = None
    retries: int = Field(default=0, ge=0)
    """how often a failed action is tried again before it counts as failed"""
    on_failure: OnFailure = OnFailure.CONTINUE
    transitions: tuple[Transition, ...] = ()
    source: Span | None = None
    """where a script asked for it"""


class Group(Model):
    """A round: the tasks from `start` to `end` in the mission's order, repeated.

    With both a count and a duration, whichever comes first ends it; with neither it is endless and
    some transition must leave it. `/` in the name nests: `Alpha/Beta` lies inside `Alpha`.
    """

    name: str = Field(min_length=1)
    start: str
    end: str
    max_repeat_count: int = Field(default=0, ge=0)
    """rounds in all; 0: no limit"""
    max_repeat_duration: float = Field(default=0.0, ge=0)
    """s on the mission's clock since the group was entered; 0: no limit"""
    count_interruptions: bool = False
    """whether the time of pauses, reactions and supervision counts as part of the duration"""
    stop: Stop = Stop.HARD
    source: Span | None = None


class Reaction(Model):
    """What to do when an event occurs. A mission has at most one for each kind of event.

    The response is carried out, then `until` is waited for, if given, then `afterwards` is done.
    A reaction of higher priority interrupts one of lower priority; see `docs/language.md`.
    """

    event: EventKind
    response: Response
    pose: Pose | None = None
    """SAFE_AREA: where to"""
    until: EventKind | None = None
    """PAUSE, RETURN, SAFE_AREA: stand still until this event occurs, or a person resumes"""
    afterwards: Afterwards = Afterwards.END
    """RETURN and SAFE_AREA only: a PAUSE is followed by the mission, a REPORT interrupts nothing,
    an ABORT is the end"""
    priority: int = 0
    """the greater one goes first"""
    source: Span | None = None


class Mission(Model):
    """A planned mission: the sheet's header, the tasks in order, the groups over them, and the
    reactions to what may happen."""

    version: Literal[2] = 2
    """of this format"""
    designation: str = ""
    site: str = ""
    """the site that poses and checkpoints belong to"""
    mode: Mode = Mode.AUTONOMOUS
    max_duration: float | None = Field(default=None, gt=0)
    """s since the mission's start, interruptions included; None: no limit"""
    start_area: int | None = None
    end_area: int | None = None
    """where the mission ends docked; None: it ends where its last task ends"""
    dock: Pose | None = None
    """the docking station that RETURN drives to"""
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
    """the names of tasks that were taken away when the order was chosen, as they did not fit into
    the time; for people, the machine does not use it"""

    def task(self, name: str) -> Task | None:
        return next((t for t in self.tasks if t.name == name), None)

    @property
    def omitted(self) -> tuple[str, ...]:
        """What was left out and has not been added again."""
        names = {task.name for task in self.tasks}
        return tuple(name for name in self.left_out if name not in names)
