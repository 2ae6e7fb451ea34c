"""Execution of one simulation: its pace, people's requests, and messages to the service."""

from collections.abc import Callable, Sequence

from argo_compiler.base.errors import ArgoError, Conflict, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.hfsm import ByHand, Cancel, GiveBack, Occurred, Pause, Resume, TakeOver
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import Action, Mission, Task
from argo_env.drives.powertrain import Powertrain
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import Reading
from argo_env.run.run_commands import DoByHand, InjectFault, StopByHand, StopRun
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from argo_planner.service.runs import requests as asked
from argo_planner.service.runs.requests import (
    RequestBook,
    RequestProgress,
    RequestState,
    RunRequest,
    request_subject,
)
from argo_planner.service.runs.state import (
    EntryTold,
    PoseTold,
    RequestTold,
    RunMode,
    RunState,
    RunStatus,
    StateTold,
    TaskCount,
)

POSE_RATE = 30.0
"""highest number of poses, and of states with new entries, per second of real time"""
STATE_RATE = 2.0
"""highest number of states per second of real time while there are no new entries"""
MAX_LAG = 0.5
"""s of real time; a simulation that lags behind by more does not catch up"""

SendMessage = Callable[[Model], None]
"""function that sends a message to the service"""


class EntryReporter(Observer):
    """Observer that sends the entries of a run to the service, with their numbers.

    Holds the last reading of each checkpoint.
    """

    def __init__(self, run: str, send: SendMessage, past: tuple[Entry, ...] = ()) -> None:
        """Create the reporter of a run; `past` entries are counted, but not sent.

        The first entry that is sent has the number `len(past) + 1`.
        """
        self._run, self._send = run, send
        self.count = 0
        """number of entries"""
        self.readings: dict[int, Reading] = {}
        self.has_news = True
        """whether there was an entry since this was last set to False"""
        for entry in past:
            self._add(entry)

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """Count a new entry, and send it to the service with its number."""
        self._add(entry)
        self._send(EntryTold.model_construct(run=self._run, number=self.count, entry=entry))

    def _add(self, entry: Entry) -> None:
        self.count += 1
        self.has_news = True
        if entry.reading is not None:
            self.readings[entry.reading.checkpoint] = entry.reading


class Pace:
    """Speed of simulated time, with both clocks' times when the speed last changed."""

    def __init__(self, speed: float | None, simulated: float, now: float) -> None:
        """Start at a simulated and a real time, both in s.

        Args:
            speed: Simulated seconds per second; None: as fast as possible.
            simulated: Simulated time in s.
            now: Real time in s.
        """
        self.speed = speed
        self._waits = False
        self._simulated, self._now = simulated, now

    def set_speed(self, speed: float | None, simulated: float, now: float) -> None:
        """Change the speed from now on; arguments as in the constructor."""
        self.speed = speed
        self._simulated, self._now = simulated, now

    def seconds_until_step(self, simulated: float, now: float, waits_for_person: bool) -> float:
        """Return the real time in s until the next time step is due; 0 or less: it is due.

        Args:
            simulated: Present simulated time in s.
            now: Present real time in s.
            waits_for_person: Whether the run waits for a person. The speed then is 1 at most.
        """
        if waits_for_person is not self._waits:
            self._waits = waits_for_person
            self._simulated, self._now = simulated, now
        speed = self.speed
        if waits_for_person:
            speed = 1.0 if speed is None else min(1.0, speed)
        if speed is None:
            return 0.0
        due = self._now + (simulated - self._simulated) / speed
        if now - due > MAX_LAG:
            self._simulated, self._now = simulated, now
            return 0.0
        return due - now


class SupervisedRun:
    """A run that a person may take over, with the tasks that the person has skipped."""

    def __init__(self, simulation: Simulation, skipped: Sequence[str]) -> None:
        """Wrap a simulation.

        Args:
            simulation: Simulation of the run.
            skipped: Tasks that were skipped before the run's process died; they count only if a
                person still has the robot.
        """
        self._simulation = simulation
        self._skipped = [*skipped] if simulation.taken_over else []

    @property
    def marked_to_skip(self) -> tuple[str, ...]:
        """Tasks whose next visit is left out when the robot is given back."""
        return tuple(self._skipped)

    def mark_to_skip(self, name: str) -> None:
        """Mark the next visit of a task as skipped; it is left out when the robot is given back.

        Raises Conflict if no person has the robot or the task is already skipped, NotFound if the
        mission has no task of that name or it is the START task.
        """
        if not self._simulation.taken_over:
            raise Conflict(
                "only a person who has the robot can skip a task: take the robot over first"
            )
        task = self._simulation.spec.mission.task(name)
        if task is None or task.action is Action.START:
            raise NotFound(
                Message("the mission has no task '{name}' that can be skipped", name=name)
            )
        if name in self._skipped:
            raise Conflict(
                Message(
                    "the next visit of '{name}' is skipped already; it is left out when the "
                    "robot is given back",
                    name=name,
                )
            )
        self._skipped.append(name)

    def done_then_skipped(self, mission: Mission) -> tuple[ByHand, ...]:
        """Return the tasks that the person has done and those skipped, for giving the robot back.

        `mission` is the mission with which the run continues, which may have been edited. A skipped
        task is missing from the result if `mission` has a task of the same name with another
        action, checkpoint or pose, but not if it has no task of this name. Tasks that were done are
        always in it.
        """
        old = self._simulation.spec.mission
        names = (name for name in self._skipped if _is_same(old.task(name), mission.task(name)))
        skipped = (ByHand(task=name, skipped=True) for name in names)
        return (*self._simulation.done_by_hand, *skipped)

    def clear_marks_to_skip(self) -> None:
        """Remove all marks of skipped tasks, after the robot was given back."""
        self._skipped.clear()

    def find_or_make_task(self, request: asked.DoTask | asked.DriveTo | asked.MeasureAt) -> Task:
        """Return the task that a request by hand asks for: one of the mission, or a new one.

        Raises NotFound if the mission has no task of that name.
        """
        mission = self._simulation.spec.mission
        if isinstance(request, asked.DoTask):
            task = mission.task(request.task)
            if task is None:
                raise NotFound(Message("the mission has no task '{task}'", task=request.task))
            return task
        drive = isinstance(request, asked.DriveTo)
        name = "drive by hand" if drive else "measure by hand"
        while mission.task(name) is not None:
            name += "'"
        if isinstance(request, asked.DriveTo):
            return Task(name=name, action=Action.WAYPOINT, pose=request.pose)
        return Task(name=name, action=Action.MEASURE, object_id=request.checkpoint)


def _is_same(old: Task | None, new: Task | None) -> bool:
    """Return True if two tasks of one name have the same action, checkpoint and pose.

    A missing task counts as the same, as that is reported elsewhere.
    """
    if old is None or new is None:
        return True
    return (old.action, old.object_id, old.pose) == (new.action, new.object_id, new.pose)


class RunDriver:
    """Driver of a simulation, with its pace and the requests to it."""

    def __init__(
        self,
        simulation: Simulation,
        first: RunState,
        reporter: EntryReporter,
        send: SendMessage,
        clock: Callable[[], float],
        requests: Sequence[RequestState] = (),
    ) -> None:
        """Create the driver of a simulation.

        Args:
            simulation: Simulation of the run.
            first: State of the run before this simulation.
            reporter: Reporter that observes the simulation.
            send: Function that sends a message to the service.
            clock: Clock of real time in s.
            requests: Earlier requests to the run.
        """
        self._simulation = simulation
        self._state = first.model_copy(update={"status": RunStatus.RUNNING})
        self._reporter = reporter
        self._send = send
        self._clock = clock
        self._pace = Pace(first.speed, simulation.now, clock())
        self._book = RequestBook(first.id, requests)
        self._effects: dict[str, Callable[[], bool]] = {}
        """for the id of each request under way, a function that returns True once it has effect"""
        self._by_hand: str | None = None
        """id of the request whose action by hand is under way"""
        self._supervised = SupervisedRun(simulation, first.skipped)
        self._pose_due = self._state_sent = 0.0
        self.continuation: tuple[RunSpec, int] | None = None
        """spec with which the run continues after this simulation, and the revision of the edited
        plan; None: no person has asked to continue with an edited plan"""

    @property
    def speed(self) -> float | None:
        """Simulated seconds per second; None: as fast as possible."""
        return self._pace.speed

    @property
    def pending_and_latest_requests(self) -> tuple[RequestState, ...]:
        """Pending requests and the latest settled ones, in the order in which they came."""
        return self._book.pending_and_latest()

    @property
    def over(self) -> bool:
        """True if the run has ended."""
        return self._simulation.ended

    def step_if_due(self) -> float:
        """Simulate one time step if it is due, and send the pose and the state if they are due.

        Returns the real time in s until this must be called again; 0 or less: at once.
        """
        waits = self._waits_for_person()
        time_left = self._pace.seconds_until_step(self._simulation.now, self._clock(), waits)
        if time_left <= 0.0:
            self._simulation.step()
            self._settle_requests()
        now = self._clock()
        if now >= self._pose_due:
            # The delay of a late pose is made up for, so that where time steps are nearly as long
            # as the interval between poses, the pose of each step is sent.
            self._pose_due = max(self._pose_due + 1.0 / POSE_RATE, now - 1.0 / POSE_RATE)
            self._send(self._pose())
        has_news = self._reporter.has_news
        state_due = self._state_sent + 1.0 / (POSE_RATE if has_news else STATE_RATE)
        if now >= state_due:
            self.send_state()
        return min(time_left, max(0.0, state_due - now)) if self._reporter.has_news else time_left

    def handle_resume_or_stop(self, request: RunRequest, by: str) -> None:
        """Carry out the request, by author `by`, that an interrupted run be resumed or stopped.

        A request to resume is confirmed once there is a new entry. If the run is over already, any
        request is confirmed at once.
        """
        if isinstance(request, asked.EndRun) and not self.over:
            self.handle_request(request, by)
            return
        count = self._reporter.count
        self._set_progress(request, by, RequestProgress.UNDER_WAY)
        self._effects[request.id] = lambda: self._reporter.count > count or self.over
        self._settle_requests()

    def handle_request(self, request: RunRequest, by: str) -> None:
        """Begin to carry out a request of the author `by`, or refuse it, and send its progress.

        A refusal raises no error: the state of the request has the reason.
        """
        try:
            has_effect = self._begin(request)
        except ArgoError as error:
            self._set_progress(request, by, RequestProgress.REFUSED, str(error))
        else:
            self._set_progress(request, by, RequestProgress.UNDER_WAY)
            self._effects[request.id] = has_effect
        self._settle_requests()
        self.send_state()

    def confirm_requests_to_continue(self) -> None:
        """Confirm the pending requests to continue with an edited plan: this simulation does so."""
        confirmed = {"progress": RequestProgress.CONFIRMED}
        self._settle(
            [
                request.model_copy(update=confirmed)
                for request in self._book.pending
                if request.kind == "go_on_edited"
            ]
        )

    def send_state(self) -> None:
        """Send the state of the run to the service."""
        self._state_sent, self._reporter.has_news = self._clock(), False
        self._send(StateTold.model_construct(state=self.run_state()))

    def run_state(self) -> RunState:
        """Return the state of the run."""
        simulation = self._simulation
        machine = simulation.machine
        progress = machine.progress()
        if simulation.taken_over:
            mode = RunMode.SUPERVISED
        elif machine.paused:
            mode = RunMode.PAUSED
        else:
            mode = RunMode.AUTONOMOUS if machine.reaction is None else RunMode.REACTING
        task = simulation.task
        return self._state.model_copy(
            update={
                "status": RunStatus.ENDED if self.over else RunStatus.RUNNING,
                "t": simulation.now,
                "mode": mode,
                "moving": task is not None,
                "task": task.name if task else None,
                "by_hand": simulation.by_hand is not None,
                "reaction": machine.reaction,
                "rounds": dict(machine.rounds),
                "tasks": tuple(TaskCount(**dict(tally)) for tally in progress.tallies),
                "skipped": self._supervised.marked_to_skip,
                "readings": tuple(self._reporter.readings.values()),
                "charge": self._charge(),
                "silent_since": simulation.silent_since,
                "entries": self._reporter.count,
                "requests": self.pending_and_latest_requests,
                "speed": self._pace.speed,
                "headline": simulation.record().headline if self.over else None,
            }
        )

    # ---- requests

    def _begin(self, request: RunRequest) -> Callable[[], bool]:
        """Begin to carry out a request; return a function that returns True once it has effect.

        The driver calls this function until it does. Raises ArgoError if the request is refused.
        """
        simulation = self._simulation
        machine = simulation.machine
        match request:
            case asked.ChangeSpeed(speed=speed):
                self._pace.set_speed(speed, simulation.now, self._clock())
            case asked.SkipTask(task=name):
                self._supervised.mark_to_skip(name)
            case asked.GiveRobotBack():
                if not simulation.taken_over:
                    raise Conflict("nobody has the robot, so that it can't be given back")
                by_hand = self._supervised.done_then_skipped(simulation.spec.mission)
                simulation.handle(GiveBack(by_hand))
                self._supervised.clear_marks_to_skip()
                return lambda: simulation.ended or not simulation.taken_over
            case asked.GoOnEdited(mission=mission, revision=revision):
                if not simulation.taken_over:
                    raise Conflict(
                        "only a person who has the robot can continue with the edited mission: "
                        "take the robot over first"
                    )
                by_hand = self._supervised.done_then_skipped(mission)
                self.continuation = simulation.continuation_spec(mission, by_hand), revision
                return lambda: False
            case asked.TakeRobot():
                simulation.handle(TakeOver())
                return lambda: simulation.taken_over and simulation.task is None
            case asked.PauseRun():
                if simulation.taken_over:
                    raise Conflict(
                        "a person has the robot: the mission stands still until they give it back"
                    )
                if machine.paused:
                    return lambda: simulation.task is None
                simulation.handle(Pause())
                return lambda: machine.paused and simulation.task is None
            case asked.GoOnWithRun():
                if simulation.taken_over:
                    raise Conflict(
                        "a person has the robot: the mission continues when they give it back"
                    )
                simulation.handle(Resume())
                return lambda: simulation.ended or not machine.paused
            case asked.StopByHandNow():
                simulation.handle(StopByHand())
                return lambda: simulation.task is None
            case asked.DoTask() | asked.DriveTo() | asked.MeasureAt():
                simulation.handle(DoByHand(self._supervised.find_or_make_task(request)))
                self._by_hand = request.id
                return lambda: simulation.by_hand is None
            case asked.CancelMission():
                simulation.handle(Cancel())
                return lambda: simulation.ended
            case asked.EndRun():
                simulation.handle(StopRun())
            case asked.TellEvent(event=event, detail=detail):
                simulation.handle(Occurred(event, detail))
            case asked.TellReading(checkpoint=checkpoint, value=value):
                simulation.handle(ReadingGiven(checkpoint, value))
            case asked.BeginFault(fault=fault):
                simulation.handle(InjectFault(fault))
        return lambda: True

    def _settle_requests(self) -> None:
        """Settle the requests that have taken effect; the others fail if the run has ended."""
        settled = []
        for id, has_effect in [*self._effects.items()]:
            progress = RequestProgress.CONFIRMED
            reason: str | None = None
            if not has_effect():
                if not self.over:
                    continue
                progress, reason = RequestProgress.FAILED, Message("the run ended first")
            elif id == self._by_hand:
                self._by_hand = None
                progress, reason = self._outcome_by_hand()
            del self._effects[id]
            update = {"progress": progress, "reason": reason}
            settled.append(self._book.find(id).model_copy(update=update))
        self._settle(settled)

    def _outcome_by_hand(self) -> tuple[RequestProgress, str | None]:
        """Return the outcome of the last action by hand, as progress of its request, and why."""
        last = next(run for run in reversed(self._simulation.record().tasks) if run.by_hand)
        if last.outcome == "done":
            return RequestProgress.CONFIRMED, None
        return RequestProgress.FAILED, last.reason or last.outcome

    def _settle(self, requests: Sequence[RequestState]) -> None:
        """Update and send requests that are over, after the state that they have led to.

        A client that waits for a request thus has the state when the request is over.
        """
        if not requests:
            return
        for request in requests:
            self._book.update(request)
        self.send_state()
        for request in requests:
            self._send(RequestTold(run=self._state.id, request=request))

    def _set_progress(
        self, request: RunRequest, by: str, progress: RequestProgress, reason: str | None = None
    ) -> None:
        state = RequestState(
            id=request.id,
            kind=request.kind,
            by=by,
            subject=request_subject(request),
            progress=progress,
            reason=reason,
        )
        self._book.update(state)
        self._send(RequestTold(run=self._state.id, request=state))

    # ---- messages

    def _waits_for_person(self) -> bool:
        """Return True if nothing happens until a person makes a request."""
        simulation, machine = self._simulation, self._simulation.machine
        drive = simulation.setup.drive
        if isinstance(drive, Powertrain) and drive.stop_pressed:
            return True
        if simulation.task is not None:
            return False
        held = simulation.taken_over or machine.paused
        return held or (machine.running is None and machine.next_deadline is None)

    def _charge(self) -> float | None:
        battery = self._simulation.setup.battery
        return None if battery is None else battery.charge

    def _pose(self) -> PoseTold:
        pose = self._simulation.pose
        return PoseTold.model_construct(
            run=self._state.id,
            t=self._simulation.now,
            pose=(pose.x, pose.y, pose.z, pose.yaw, pose.pitch),
            charge=self._charge(),
        )
