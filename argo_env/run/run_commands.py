"""Requests to a run that goes on, refusals of those that make no sense, and the actions of a person
who has taken the robot over."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.hfsm import (
    ByHand,
    Cancel,
    Event,
    GiveBack,
    Occurred,
    Pause,
    Progress,
    Resume,
    TakeOver,
)
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.hfsm.handover import match
from argo_compiler.il import Action, Mission, Task
from argo_env.faults.fault import Fault, TimedFault
from argo_env.faults.kinds import AnyFault, settle_one
from argo_env.run.log import Entry, LoggedEvent, require_event_time, require_external
from argo_env.run.machine import Machine
from argo_env.run.record import TaskRun
from argo_env.run.run_setup import RunSetup
from argo_env.site import Site

_DRIVEN = (Action.WAYPOINT, Action.MEASURE)


class Supervision:
    """Follows the entries of a run. Holds whether a person has the robot, whether an action that
    they asked for is under way, and those that have been done."""

    def __init__(self, mission: Mission) -> None:
        self.taken_over = False
        """whether a person has taken the robot over, and not given it back"""
        self.acting = False
        """whether an action by hand is under way"""
        self._mission = mission
        self._results: list[tuple[float, ByHand]] = []

    def results_at(self, now: float) -> tuple[ByHand, ...]:
        """The mission's tasks done by hand since the take-over, told at time `now` (s)."""
        return tuple(one.model_copy(update={"age": now - end}) for end, one in self._results)

    def end_action(self, run: TaskRun, entry: Entry) -> None:
        """An action by hand has ended."""
        self.acting = False
        if run.outcome != "done" or self._mission.task(run.task) is None:
            return
        reading = entry.reading
        done = ByHand(
            task=run.task,
            value=None if reading is None else reading.value,
            abnormal=reading is not None and not reading.normal,
            duration=run.end - run.start,
        )
        self._results.append((run.end, done))

    def update(self, kind: str, machine: Machine) -> None:
        """The machine was told an event of that kind."""
        if kind == "take_over" and machine.paused:
            self.taken_over = True
        elif kind in ("resume", "give_back") or not machine.paused:
            self.taken_over = False
            self._results.clear()


def check_by_hand(task: Task, mission: Mission, site: Site) -> None:
    """Raises Invalid for a task that no robot carries out for a person, NotFound for a checkpoint
    that the site does not have."""
    if not isinstance(task, Task):
        raise Invalid(f"{task!r} is no task: give one that drives or measures")
    own = mission.task(task.name)
    if own is not None and own != task:
        raise Invalid(
            f"the mission has another task '{task.name}': give that one, or another name to this"
        )
    if task.action not in _DRIVEN:
        raise Invalid(
            f"task '{task.name}' is a {task.action}, for which the robot does nothing: give one "
            "that drives or measures"
        )
    if task.action is Action.MEASURE:
        site.measured_by(task.object_id)
    elif task.pose is None:
        raise Invalid(f"task '{task.name}' says not where to drive: give it a pose")


def require_supervised(supervision: Supervision, running: Task | None) -> None:
    """Raises Conflict where a person can't let the robot do anything now."""
    if running is not None:
        raise Conflict(
            f"the action of task '{running.name}' has not ended yet: stop it, or let time pass "
            "until no action runs"
        )
    if not supervision.taken_over:
        raise Conflict(
            "nobody has taken the robot over: take it over before you let it do anything by hand"
        )


@dataclass(frozen=True, slots=True)
class InjectFault:
    """Something goes wrong from now on, as long as the fault says."""

    fault: AnyFault


@dataclass(frozen=True, slots=True)
class StopRun:
    """The run ends here, whatever it is doing; the record says why."""

    reason: str = "it was stopped by a person"


@dataclass(frozen=True, slots=True)
class DoByHand:
    """A person who has taken the robot over lets it carry out the action of a task: one of the
    mission's, or another WAYPOINT or MEASURE under a name of its own."""

    task: Task


@dataclass(frozen=True, slots=True)
class StopByHand:
    """The action that a person let the robot carry out is cancelled, and cleans up."""


RunCommand = (
    Pause | Resume | TakeOver | GiveBack | Cancel | Occurred | ReadingGiven | InjectFault | StopRun
    | DoByHand | StopByHand
)  # fmt: skip

_TO_THE_MACHINE = (Pause, Resume, TakeOver, GiveBack, Cancel, Occurred, ReadingGiven)


def check_event(event: RunCommand, mission: Mission, site: Site) -> Event:
    """The event as one for the machine of the mission; Invalid if nobody outside can tell it,
    NotFound for a checkpoint that the site does not have."""
    if not isinstance(event, _TO_THE_MACHINE):
        raise Invalid(f"{event!r} is nothing that a run can be told from outside")
    logged = LoggedEvent.from_event(event)
    _check(logged, mission, site)
    return logged.to_event()


def check_scheduled_events(
    events: Sequence[tuple[float, LoggedEvent]], mission: Mission, site: Site
) -> None:
    """Raises Invalid for events and times (s) that no run of the mission can be given."""
    for t, event in events:
        if not isinstance(event, LoggedEvent):
            raise Invalid(f"{event!r} is no event as data: make it one with `logged`")
        try:
            require_event_time(t)
            _check(event, mission, site)
        except (Invalid, NotFound) as error:
            raise Invalid(f"the event {event.kind} given at {t:g} s: {error}") from None


def require_no_action_by_hand(event: Event, acting: Task | None) -> None:
    """Raises Conflict if the mission were to go on while an action by hand is under way."""
    if acting is not None and isinstance(event, Resume | GiveBack):
        raise Conflict(
            f"the robot still carries out '{acting.name}' by hand: stop that, or let time pass "
            "until it has ended"
        )


def require_no_action(machine: Machine) -> None:
    """Raises Conflict while an action still runs: nothing can be given back."""
    if running := machine.running:
        raise Conflict(
            f"the action of task '{running.name}' has not ended yet: take over, and let time pass "
            "until no action runs"
        )


def require_taken_over(machine: Machine, now: float) -> None:
    """Raises Conflict where a robot is to be given back that nobody has taken over."""
    if machine.running and not machine.paused and machine.reaction is None:
        raise Conflict(
            f"the robot was to be given back by {now:g} s, and nobody has taken it over: the "
            f"action of task '{machine.running.name}' runs. Give a take-over before that"
        )


def mark_abnormal(site: Site, mission: Mission, event: Event) -> Event:
    """The event with what the site tells of it: whether values that a person gives are abnormal."""

    def abnormal(object_id: str | None, value: float) -> bool:
        return any(
            str(c.id) == object_id and not c.nominal.contains(value) for c in site.checkpoints
        )

    match event:
        case ReadingGiven():
            odd = event.abnormal or abnormal(event.object_id, event.value)
            return replace(event, abnormal=odd)
        case GiveBack(done):
            seen = []
            for one in done:
                task = mission.task(one.task)
                odd = one.abnormal
                if task is not None and one.value is not None:
                    odd = odd or abnormal(task.object_id, one.value)
                seen.append(one.model_copy(update={"abnormal": odd}))
            return GiveBack(tuple(seen))
    return event


def _check(event: LoggedEvent, mission: Mission, site: Site) -> None:
    """Raises Invalid or NotFound for what a run of the mission can't be told."""
    require_external(event)
    if event.by_hand:
        _check_by_hand(event.by_hand, mission)
    if event.object_id is not None:
        site.measured_by(event.object_id)


def _check_by_hand(done: Sequence[ByHand], mission: Mission) -> None:
    """Raises Invalid for what a person can't have done by hand in the mission."""
    _, findings = match(Progress(active=None, by_hand=tuple(done)), mission)
    for finding in findings:
        if finding.code.startswith("handover.by-hand"):
            raise Invalid(f"{finding.message}: {finding.hint}")


def resolve_new_fault(fault: AnyFault, setup: RunSetup, seed: int, now: float) -> AnyFault:
    """The fault, settled, as it begins at time `now` (s), or later if it says so.

    Raises Conflict for one that can't begin while a run goes on, ArgoError for what the site does
    not have.
    """
    if not isinstance(fault, Fault):
        raise Invalid(f"{fault!r} is no fault")
    kind = f"a fault of kind `{fault.kind}`"
    if setup.schedule is None:
        raise Conflict(f"{kind} finds nothing to act on: this run has no parts that go wrong")
    if not isinstance(fault, TimedFault):
        raise Conflict(
            f"{kind} is there from the run's start or not at all: give it in the faults of the "
            "run's spec"
        )
    if fault.needs_world and not setup.watches_world:
        raise Conflict(
            f"the drive `{setup.drive.name}` has no world in which {kind} could be found; "
            "take another drive"
        )
    if fault.until is not None and fault.until <= now:
        raise Invalid(f"{kind} would end at {fault.until:g} s, and it is {now:g} s already")
    begins = now if fault.at is None else max(now, fault.at)
    try:
        return settle_one(
            fault.model_copy(update={"at": begins}),
            len(setup.schedule.faults),
            setup.navigator.site,
            seed,
        )
    except ArgoError as error:
        raise type(error)(f"{kind}: {error}") from None
