"""The intermediate language (IL): what a mission is, as data.

The structures and names are those of the thesis (sections 3.2 and 4.4), so that a plan maps one to
one onto its ROS messages. What they mean is written in `docs/language.md` and carried out by
`argo_compiler.hfsm`. A `Mission` read from JSON has the right shape; whether it makes sense is what
`argo_compiler.checks` says.
"""

from enum import StrEnum
from typing import Literal

from pydantic import Field

from argo_compiler.base.model import Model, Pose
from argo_compiler.diagnostics import Span

MAX_TIME_S = 1e12
"""of each time in a mission, and of its clock: some 30,000 years, as far as a clock in s counts
milliseconds"""
MAX_COUNT = 1_000_000_000
"""of rounds, and of the numbers that rank reactions and tell areas apart"""
MAX_RETRIES = 1_000_000


class Action(StrEnum):
    """What a task does. START only says where the mission begins; the machine passes over it."""

    START = "START"
    WAYPOINT = "WAYPOINT"
    MEASURE = "MEASURE"
    WAIT = "WAIT"
    """stand still; the machine does it by itself, and the robot is told nothing"""


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
    """The comparisons of table 3.1 of the thesis, its misprint for GREATER corrected, and what else
    a reading may be."""

    LESS = "MEASURED_VALUE_LESS"
    GREATER = "MEASURED_VALUE_GREATER"
    WITHIN = "MEASURED_VALUE_WITHIN"
    UNREADABLE = "READING_UNREADABLE"
    """the checkpoint was looked at, and no value could be read"""
    FAILED = "READING_FAILED"
    """the last measurement gave no value, for whatever reason; unreadable is one of them"""
    STALE = "READING_STALE"
    """there is a value, and it is older than `max_age`"""
    ABNORMAL = "READING_ABNORMAL"
    """there is a value, and it lies outside the checkpoint's nominal range"""

    @property
    def compares(self) -> bool:
        """Whether it compares the value with bounds."""
        return self in _COMPARISONS


_COMPARISONS = frozenset([ConditionType.LESS, ConditionType.GREATER, ConditionType.WITHIN])


class OnFailure(StrEnum):
    """How the mission goes on when a task has failed for good, all its retries included."""

    CONTINUE = "continue"
    """as after a task that has ended without a value"""
    RETURN = "return"
    """drive to the mission's `dock` and end there"""
    ABORT = "abort"
    """end where the robot stands"""
    BRANCH = "branch"
    """go on with the task's `failure_target`"""


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

    @property
    def drives(self) -> bool:
        """Whether it drives somewhere."""
        return self in (Response.RETURN, Response.SAFE_AREA)


class Afterwards(StrEnum):
    """What happens to the mission when the drive of a reaction has ended."""

    RESUME = "resume"
    """go on where it was interrupted; the interrupted action is started anew"""
    WAIT = "wait"
    """stand still until a person resumes the mission or ends it"""
    END = "end"
    """the mission is over"""


DEFAULT_PRIORITIES = {
    EventKind.EMERGENCY_STOP: 100,
    EventKind.GAS_LEAK: 95,
    EventKind.PLATFORM_ALARM: 90,
    EventKind.HOT_SPOT: 80,
    EventKind.DYSFUNCTION: 70,
    EventKind.LOW_BATTERY: 60,
    EventKind.TIME_UP: 50,
    EventKind.CONNECTION_LOST: 40,
    EventKind.NEGATIVE_OBSTACLE: 30,
    EventKind.POSITIVE_OBSTACLE: 25,
    EventKind.ABNORMAL_SOUND: 20,
    EventKind.ABNORMAL_READING: 10,
    EventKind.ALL_CLEAR: 3,
    EventKind.BATTERY_CHARGED: 2,
    EventKind.CONNECTION_RESTORED: 1,
}
"""The priority of a reaction that gives none, by how bad its event is: dangers to people first,
then to the robot, then to the mission."""


class Condition(Model):
    """A test of the last reading of a checkpoint.

    LESS: value < param1. GREATER: value > param1. WITHIN: param1 < value < param2. With `inclusive`
    the bounds themselves count as well. The other types look at what the reading is, and have no
    bounds. Without a value, or with one that is older than `max_age`, a comparison is false.
    """

    type: ConditionType
    id: str = ""
    """a name for people; the machine does not use it"""
    object_id: str
    """the checkpoint whose reading is looked at"""
    param1: float | None = None
    """the bound, for LESS, GREATER and WITHIN"""
    param2: float | None = None
    """upper bound, for WITHIN only"""
    inclusive: bool = False
    """whether the bounds are among the values that satisfy it (at least, at most)"""
    max_age: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s; None: a value never becomes too old. STALE needs one"""


class Transition(Model):
    """Where to go on when a task has ended and all conditions hold; none: unconditional."""

    target: str
    conditions: tuple[Condition, ...] = ()


class JointState(Model):
    """Where named joints are to be during the action, for semi-autonomous ones (thesis 4.4)."""

    names: tuple[str, ...]
    positions: tuple[float, ...] = ()
    """rad or m, one for each name, or none at all"""
    velocities: tuple[float, ...] = ()
    """rad/s or m/s, likewise"""
    efforts: tuple[float, ...] = ()
    """Nm or N, likewise"""


class WaitRule(Model):
    """How long a WAIT lasts: for a time, or until something has happened.

    Either `duration` is given, or `event`, `conditions` or both of them, of which the first ends
    the wait.
    """

    duration: float | None = Field(default=None, ge=0, le=MAX_TIME_S)
    """s since the task was come to; 0: a place where ways meet, at which nothing is done"""
    event: EventKind | None = None
    """until this occurs; what occurred before the task was come to does not count"""
    conditions: tuple[Condition, ...] = ()
    """until all of them hold"""
    limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s, with `event` or `conditions`: then the task has failed"""


class TimeWindow(Model):
    """When a task is to be done, in s since the mission's start."""

    earliest: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """before this, the robot goes there and waits at the place"""
    latest: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """by when the task has to have ended; None: any time"""
    hard: bool = True
    """whether the task has failed if it has not ended at `latest`; else it is done all the same"""
    missed_target: str | None = None
    """the task that follows if a hard window is missed; None: as after any other failure"""


class Task(Model):
    """One thing to do. `name` is unique within the mission and never empty."""

    name: str = Field(min_length=1)
    action: Action
    group: str = ""
    """the group it is shown in; the machine goes by the group's own start and end"""
    object_id: str | None = None
    """MEASURE: the checkpoint"""
    pose: Pose | None = None
    """WAYPOINT: where to. START: where the robot stands at the beginning. MEASURE: where it is to
    stand when it measures; None: wherever it sees the checkpoint from"""
    wait: WaitRule | None = None
    """WAIT: how long"""
    velocity: float | None = Field(default=None, gt=0)
    """m/s on the way to this task, wherever it comes from; None: the robot's planning speed"""
    joint_states: JointState | None = None
    retries: int = Field(default=0, ge=0, le=MAX_RETRIES)
    """how often a failed action is tried again before it counts as failed"""
    on_failure: OnFailure = OnFailure.CONTINUE
    failure_target: str | None = None
    """BRANCH: the task that follows"""
    time_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s for each attempt, the way there included, after which it has failed; None: no limit"""
    reading_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """MEASURE: s that the robot tries to read the value, after which it is unreadable; None: as
    long as the robot does by itself"""
    optional: bool = False
    """whether the mission is complete without it: an order that has too little time may leave it
    out, and its failure does not count as one of the mission"""
    priority: int = Field(default=1, ge=1, le=1_000_000)
    """what it is worth where not all can be done; the machine does not use it"""
    window: TimeWindow | None = None
    transitions: tuple[Transition, ...] = ()
    source: Span | None = None
    """where a script asked for it"""


class Group(Model):
    """A round: the tasks from `start` to `end` in the mission's order, repeated.

    Of count, duration and `until`, whichever comes first ends it; with none of them it is endless
    and some transition must leave it. `/` in the name nests: `Alpha/Beta` lies inside `Alpha`.
    """

    name: str = Field(min_length=1)
    start: str
    end: str
    max_repeat_count: int = Field(default=0, ge=0, le=MAX_COUNT)
    """rounds in all; 0: no limit"""
    max_repeat_duration: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """s on the mission's clock since the group was entered; 0: no limit"""
    count_interruptions: bool = False
    """whether the time of pauses, reactions and supervision counts as part of the duration"""
    stop: Stop = Stop.HARD
    every: float = Field(default=0.0, ge=0, le=MAX_TIME_S)
    """s on the group's clock from the beginning of one round to that of the next. The plan does not
    drift: round n is due (n - 1) times this after the group was entered, and one that is late
    begins at once. 0: a round begins when the one before has ended"""
    until: tuple[Condition, ...] = ()
    """no other round begins once all of these hold at the end of one; none: not looked at"""
    source: Span | None = None

    @property
    def ends_at_once(self) -> bool:
        """Return whether the group is left as soon as its time is up, in the middle of a round."""
        return self.stop is Stop.HARD and self.max_repeat_duration > 0


class Reaction(Model):
    """What to do when an event occurs. A mission has at most one for each kind of event.

    The response is carried out, then `until` is waited for, if given, then `afterwards` is done.
    A reaction of higher rank interrupts one of lower rank; see `docs/language.md`.
    """

    event: EventKind
    response: Response
    pose: Pose | None = None
    """SAFE_AREA: where to. RETURN: to which dock; None: the mission's"""
    area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    """RETURN: the starting area that `pose` is the dock of, for people"""
    until: EventKind | None = None
    """PAUSE, RETURN, SAFE_AREA: stand still until this event occurs, or a person resumes"""
    afterwards: Afterwards = Afterwards.END
    """RETURN and SAFE_AREA only: a PAUSE is followed by the mission, a REPORT interrupts nothing,
    an ABORT is the end"""
    hold_limit: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s that it stands still at most; None: no limit"""
    on_limit: Afterwards = Afterwards.WAIT
    """what happens when that time is over: RESUME goes on as if `until` had occurred, WAIT pauses
    the mission, END ends it"""
    priority: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    """the greater one goes first; None: by how bad the event is, see `DEFAULT_PRIORITIES`"""
    battery_below: float | None = Field(default=None, gt=0, lt=1)
    """LOW_BATTERY: the share of the battery's charge, 0 to 1, below which the robot raises the
    event in this mission; None: the robot's own level"""
    source: Span | None = None

    @property
    def holds(self) -> bool:
        """Whether it stands still until something occurs or a person resumes."""
        return self.until is not None or self.response is Response.PAUSE

    @property
    def rank(self) -> tuple[int, int]:
        """The greater one goes first: ABORT before all, then the reaction to an emergency stop,
        then by priority."""
        safety = 0
        if self.response is Response.ABORT:
            safety = 2
        elif self.event is EventKind.EMERGENCY_STOP:
            safety = 1
        given = self.priority
        return safety, DEFAULT_PRIORITIES[self.event] if given is None else given


class Mission(Model):
    """A planned mission: the sheet's header, the tasks in order, the groups over them, and the
    reactions to what may happen."""

    version: Literal[3] = 3
    """of this format"""
    designation: str = ""
    site: str = ""
    """the site that poses and checkpoints belong to"""
    mode: Mode = Mode.AUTONOMOUS
    max_duration: float | None = Field(default=None, gt=0, le=MAX_TIME_S)
    """s since the mission's start, interruptions included; None: no limit"""
    start_area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
    end_area: int | None = Field(default=None, ge=-MAX_COUNT, le=MAX_COUNT)
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
    before: tuple[tuple[str, str], ...] = ()
    """pairs of tasks by their names: a run that comes to both of them comes to the first one before
    it comes to the second. An order that is chosen keeps to it; the machine does not use it"""

    def task(self, name: str) -> Task | None:
        return next((t for t in self.tasks if t.name == name), None)

    @property
    def omitted(self) -> tuple[str, ...]:
        """What was left out and has not been added again."""
        names = {task.name for task in self.tasks}
        return tuple(name for name in self.left_out if name not in names)
