"""Commands to a current run, their checks, and the supervision of the robot by a person."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.base.message import Message, as_message
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
from argo_compiler.hfsm.handover import match_to_mission
from argo_compiler.il import Action, Mission, Task
from argo_env.faults.fault import Fault, TimedFault
from argo_env.faults.kinds import AnyFault, resolve_fault
from argo_env.run.log import Entry, LoggedEvent, require_event_time, require_external
from argo_env.run.machine import Machine
from argo_env.run.record import TaskRun
from argo_env.run.run_setup import RunSetup
from argo_env.site import Site

_ROBOT_ACTIONS = (Action.WAYPOINT, Action.MEASURE)


class Supervision:
    """Supervision of the robot by a person, which changes with the entries of a run.

    It holds whether a person has the robot, and the actions by hand: the running and the done ones.
    """

    def __init__(self, mission: Mission) -> None:
        self.taken_over = False
        """whether a person has taken the robot over, and not given it back"""
        self.acting = False
        """whether an action by hand is running"""
        self._mission = mission
        self._results: list[tuple[float, ByHand]] = []

    def done_by_hand(self, now: float) -> tuple[ByHand, ...]:
        """Return the tasks of the mission done by hand since the take-over.

        Their ages are the times from their ends to `now` (s).
        """
        return tuple(result.model_copy(update={"age": now - end}) for end, result in self._results)

    def on_action_end(self, run: TaskRun, entry: Entry) -> None:
        """Note that the action by hand has ended.

        Its task counts as done if the action succeeded and the task is one of the mission. `run` is
        the action in the record's form, and `entry` the log's entry with its reading.
        """
        self.acting = False
        if run.outcome != "done" or self._mission.task(run.task) is None:
            return
        reading = entry.reading
        result = ByHand(
            task=run.task,
            value=None if reading is None else reading.value,
            abnormal=reading is not None and not reading.normal,
            duration=run.end - run.start,
        )
        self._results.append((run.end, result))

    def update(self, event_kind: str, machine: Machine) -> None:
        """Update the supervision after the machine has handled an event of any kind."""
        if event_kind == "take_over" and machine.paused:
            self.taken_over = True
        elif event_kind in ("resume", "give_back") or not machine.paused:
            self.taken_over = False
            self._results.clear()


def check_task_by_hand(task: Task, mission: Mission, site: Site) -> None:
    """Raise Invalid for a task that can't be done by hand.

    Raises NotFound for a checkpoint that the site does not have.
    """
    if not isinstance(task, Task):
        raise Invalid(
            Message("{task} is not a task: give one that drives or measures", task=repr(task))
        )
    own = mission.task(task.name)
    if own is not None and own != task:
        raise Invalid(
            Message(
                "the mission has another task '{task}': give that one, or another name to this",
                task=task.name,
            )
        )
    if task.action not in _ROBOT_ACTIONS:
        raise Invalid(
            Message(
                "task '{task}' is a {action}, for which the robot does nothing: give one "
                "that drives or measures",
                task=task.name,
                action=task.action,
            )
        )
    if task.action is Action.MEASURE:
        site.checkpoint_for(task.object_id)
    elif task.pose is None:
        raise Invalid(
            Message("task '{task}' does not state where to drive: give it a pose", task=task.name)
        )


def require_supervised(supervision: Supervision, running: Task | None) -> None:
    """Raise Conflict if a person can't let the robot act by hand now.

    That is so if an action runs (`running` is its task), or nobody has taken the robot over.
    """
    if running is not None:
        raise Conflict(
            Message(
                "the action of task '{running}' has not ended yet: stop it, or let time "
                "pass until no action runs",
                running=running.name,
            )
        )
    if not supervision.taken_over:
        raise Conflict(
            "nobody has taken the robot over: take it over before you let it do anything by hand"
        )


@dataclass(frozen=True, slots=True)
class InjectFault:
    """Injection of a fault, which begins now or at its own later time, and lasts as it states."""

    fault: AnyFault


@dataclass(frozen=True, slots=True)
class StopRun:
    """Stop of the run at once, whatever it is doing; the record states the reason."""

    reason: str | None = None
    """in English; None: a person stops it"""


@dataclass(frozen=True, slots=True)
class DoByHand:
    """Action by hand, ordered by a person who has taken the robot over.

    The task is one of the mission's, or another WAYPOINT or MEASURE under a name of its own.
    """

    task: Task


@dataclass(frozen=True, slots=True)
class StopByHand:
    """Stop of the action by hand, which is cancelled and cleans up."""


RunCommand = (
    Pause | Resume | TakeOver | GiveBack | Cancel | Occurred | ReadingGiven | InjectFault | StopRun
    | DoByHand | StopByHand
)  # fmt: skip

_MACHINE_EVENTS = (Pause, Resume, TakeOver, GiveBack, Cancel, Occurred, ReadingGiven)


def check_event(event: RunCommand, mission: Mission, site: Site) -> Event:
    """Return the command as an event for the mission's machine, after checks.

    Raises Invalid if it is no such event or can't come from outside the run, NotFound for a
    checkpoint that the site does not have.
    """
    if not isinstance(event, _MACHINE_EVENTS):
        raise Invalid(
            Message(
                "{event} is not a command that a run can receive from outside", event=repr(event)
            )
        )
    logged = LoggedEvent.from_event(event)
    _check(logged, mission, site)
    return logged.to_event()


def check_scheduled_events(
    events: Sequence[tuple[float, LoggedEvent]], mission: Mission, site: Site
) -> None:
    """Raise Invalid for scheduled events and times (s) that can't occur in a run of the mission."""
    for t, event in events:
        if not isinstance(event, LoggedEvent):
            raise Invalid(
                Message(
                    "{event} is not a `LoggedEvent`: convert events and their times with "
                    "`logged_events`",
                    event=repr(event),
                )
            )
        try:
            require_event_time(t)
            _check(event, mission, site)
        except (Invalid, NotFound) as error:
            raise Invalid(
                Message(
                    "the event {kind} given at {t:g} s: {error}", kind=event.kind, t=t, error=error
                )
            ) from None


def require_no_resume_while_acting(event: Event, acting: Task | None) -> None:
    """Raise Conflict if the event would resume the mission while an action by hand is running."""
    if acting is not None and isinstance(event, Resume | GiveBack):
        raise Conflict(
            Message(
                "the robot still carries out '{acting}' by hand: stop that, or let time "
                "pass until it has ended",
                acting=acting.name,
            )
        )


def require_no_action(machine: Machine) -> None:
    """Raise Conflict if the machine's action still runs: the robot can't be given back then."""
    if running := machine.running:
        raise Conflict(
            Message(
                "the action of task '{running}' has not ended yet: take over, and let time "
                "pass until no action runs",
                running=running.name,
            )
        )


def require_give_back_can_occur(machine: Machine, now: float) -> None:
    """Raise Conflict if a give-back that waits at time `now` (s) can never occur.

    The caller knows that it is due; `now` is for the message only. It can't occur if a task of the
    mission runs, the mission is not paused or taken over, and no reaction is under way.
    """
    if machine.running and not machine.paused and machine.reaction is None:
        raise Conflict(
            Message(
                "the robot was to be given back by {now:g} s, and nobody has taken it "
                "over: the action of task '{running}' runs. Give a take-over before that",
                now=now,
                running=machine.running.name,
            )
        )


def mark_abnormal(site: Site, mission: Mission, event: Event) -> Event:
    """Return the event with reported values outside their nominal range marked as abnormal.

    A person has reported these values. Those that the person marked as abnormal stay so.
    """

    def is_abnormal(object_id: str | None, value: float) -> bool:
        return any(
            str(c.id) == object_id and not c.nominal.contains(value) for c in site.checkpoints
        )

    match event:
        case ReadingGiven():
            abnormal = event.abnormal or is_abnormal(event.object_id, event.value)
            return replace(event, abnormal=abnormal)
        case GiveBack(results):
            marked = []
            for result in results:
                task = mission.task(result.task)
                abnormal = result.abnormal
                if task is not None and result.value is not None:
                    abnormal = abnormal or is_abnormal(task.object_id, result.value)
                marked.append(result.model_copy(update={"abnormal": abnormal}))
            return GiveBack(tuple(marked))
    return event


def _check(event: LoggedEvent, mission: Mission, site: Site) -> None:
    """Raise Invalid or NotFound for an event that can't occur in a run of the mission."""
    require_external(event)
    if event.by_hand:
        _check_by_hand(event.by_hand, mission)
    if event.object_id is not None:
        site.checkpoint_for(event.object_id)


def _check_by_hand(results: Sequence[ByHand], mission: Mission) -> None:
    """Raise Invalid for tasks done by hand that a person can't have done in the mission."""
    _, diagnostics = match_to_mission(Progress(active=None, by_hand=tuple(results)), mission)
    for diagnostic in diagnostics:
        if diagnostic.code.startswith("handover.by-hand"):
            raise Invalid(
                Message(
                    "{message}: {hint}",
                    message=as_message(diagnostic.message),
                    hint=as_message(diagnostic.hint or ""),
                )
            )


def resolve_new_fault(fault: AnyFault, setup: RunSetup, seed: int, now: float) -> AnyFault:
    """Return a fault injected at time `now` (s) with its target and what the seed draws for it.

    It begins at `now`, or at its own later time. Raises Conflict for a fault that can't begin
    during a run, ArgoError if the site does not have its target.
    """
    if not isinstance(fault, Fault):
        raise Invalid(Message("{fault} is not a fault", fault=repr(fault)))
    kind = Message("a fault of kind `{kind}`", kind=fault.kind)
    if setup.schedule is None:
        raise Conflict(
            Message("{kind} has no effect: no faults are simulated in this run", kind=kind)
        )
    if not isinstance(fault, TimedFault):
        raise Conflict(
            Message(
                "{kind} can only begin with the run: give it in the faults of the run's spec",
                kind=kind,
            )
        )
    if fault.needs_world and not setup.has_simulated_world:
        raise Conflict(
            Message(
                "the drive `{drive}` has no world in which {kind} could be found; choose "
                "another drive",
                drive=setup.drive.name,
                kind=kind,
            )
        )
    if fault.until is not None and fault.until <= now:
        raise Invalid(
            Message(
                "{kind} would end at {until:g} s, and it is {now:g} s already",
                kind=kind,
                until=fault.until,
                now=now,
            )
        )
    begins = now if fault.at is None else max(now, fault.at)
    try:
        return resolve_fault(
            fault.model_copy(update={"at": begins}),
            len(setup.schedule.faults),
            setup.navigator.site,
            seed,
        )
    except ArgoError as error:
        raise type(error)(Message("{kind}: {error}", kind=kind, error=error)) from None
