"""Drives one simulation: lets time pass at its speed, does what people ask, tells what happens."""

from collections.abc import Callable, Sequence

from argo_compiler.base.errors import ArgoError, Conflict, NotFound
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

POSES = 30.0
"""a second of the clock, at most"""
STATES = 2.0
"""likewise, of those that tell nothing but how time goes on"""
LAG = 0.5
"""s by which a slow machine may be late before it does not make up for it"""

Tell = Callable[[Model], None]


class RunTeller(Observer):
    """Tells the entries of a run, with their numbers. Holds the last readings."""

    def __init__(self, run: str, tell: Tell, past: tuple[Entry, ...] = ()) -> None:
        self._run, self._tell = run, tell
        self.count = 0
        self.readings: dict[int, Reading] = {}
        self.fresh = True
        """whether something has been told since this was last set to False"""
        for entry in past:
            self._note(entry)

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """An entry was made, and the machine has it."""
        self._note(entry)
        self._tell(EntryTold.model_construct(run=self._run, number=self.count, entry=entry))

    def _note(self, entry: Entry) -> None:
        self.count += 1
        self.fresh = True
        if entry.reading is not None:
            self.readings[entry.reading.checkpoint] = entry.reading


class Pace:
    """How fast simulated time goes. Holds where both clocks stood when that changed last."""

    def __init__(self, speed: float | None, simulated: float, now: float) -> None:
        """`speed`: simulated seconds a second; None: as fast as possible. Both times in s."""
        self.speed = speed
        self._waits = False
        self._simulated, self._now = simulated, now

    def change(self, speed: float | None, simulated: float, now: float) -> None:
        """From now on time goes at that speed."""
        self.speed = speed
        self._simulated, self._now = simulated, now

    def left(self, simulated: float, now: float, waits: bool) -> float:
        """How long (s) until the next step is due; 0 or less: now. While the run `waits` for a
        person, time goes no faster than theirs."""
        if waits is not self._waits:
            self._waits = waits
            self._simulated, self._now = simulated, now
        speed = self.speed
        if waits:
            speed = 1.0 if speed is None else min(1.0, speed)
        if speed is None:
            return 0.0
        due = self._now + (simulated - self._simulated) / speed
        if now - due > LAG:
            self._simulated, self._now = simulated, now
            return 0.0
        return due - now


class SupervisedRun:
    """A run that a person may take over. Holds what they have skipped since they did."""

    def __init__(self, simulation: Simulation, skipped: Sequence[str]) -> None:
        """`skipped`: before its process died; it counts if they have the robot still."""
        self._simulation = simulation
        self._skipped = [*skipped] if simulation.taken_over else []

    @property
    def skipped(self) -> tuple[str, ...]:
        """The tasks whose next visit is left out when the robot is given back."""
        return tuple(self._skipped)

    def skip(self, name: str) -> None:
        """Leaves out the next visit of a task. Raises Conflict if nobody has the robot or that is
        skipped already, NotFound for what can't be skipped."""
        if not self._simulation.taken_over:
            raise Conflict("a task is skipped by a person who has the robot: take it over first")
        task = self._simulation.spec.mission.task(name)
        if task is None or task.action is Action.START:
            raise NotFound(f"the mission has no task '{name}' that could be skipped")
        if name in self._skipped:
            raise Conflict(
                f"the next visit of '{name}' is skipped already; it is left out when the robot is "
                "given back"
            )
        self._skipped.append(name)

    def done(self, mission: Mission) -> tuple[ByHand, ...]:
        """Return what the person has done and skipped so far, to be given back with a mission.

        The mission may have been edited: a task that was skipped and is another one in it, under
        the same name, is not skipped.
        """
        old = self._simulation.spec.mission
        skipped = (name for name in self._skipped if _same(old.task(name), mission.task(name)))
        left_out = (ByHand(task=name, skipped=True) for name in skipped)
        return (*self._simulation.done_by_hand, *left_out)

    def forget(self) -> None:
        """The robot was given back."""
        self._skipped.clear()

    def task(self, request: asked.DoTask | asked.DriveTo | asked.MeasureAt) -> Task:
        """Return the task that a person asks for: one of the mission, or one made for the request.

        Raises NotFound if the mission has no task of that name.
        """
        mission = self._simulation.spec.mission
        if isinstance(request, asked.DoTask):
            task = mission.task(request.task)
            if task is None:
                raise NotFound(f"the mission has no task '{request.task}'")
            return task
        drive = isinstance(request, asked.DriveTo)
        name = "drive by hand" if drive else "measure by hand"
        while mission.task(name) is not None:
            name += "'"
        if isinstance(request, asked.DriveTo):
            return Task(name=name, action=Action.WAYPOINT, pose=request.pose)
        return Task(name=name, action=Action.MEASURE, object_id=request.checkpoint)


def _same(old: Task | None, new: Task | None) -> bool:
    """Return whether two tasks of one name are the same task; True if one of them is missing, which
    is reported elsewhere."""
    if old is None or new is None:
        return True
    return (old.action, old.object_id, old.pose) == (new.action, new.object_id, new.pose)


class RunDriver:
    """One run under way. Holds the simulation's requests and its pace."""

    def __init__(
        self,
        simulation: Simulation,
        first: RunState,
        teller: RunTeller,
        tell: Tell,
        clock: Callable[[], float],
        requests: Sequence[RequestState] = (),
    ) -> None:
        """The run as it stood `first`, and what was asked of it before; the clock tells seconds."""
        self._simulation = simulation
        self._state = first.model_copy(update={"status": RunStatus.RUNNING})
        self._teller = teller
        self._tell = tell
        self._clock = clock
        self._pace = Pace(first.speed, simulation.now, clock())
        self._book = RequestBook(first.id, requests)
        self._awaited: dict[str, Callable[[], bool]] = {}
        self._by_hand: str | None = None
        self._hands = SupervisedRun(simulation, first.skipped)
        self._pose_due = self._stated = 0.0
        self.following: tuple[RunSpec, int] | None = None
        """with what the run is to go on instead of this simulation, and of which revision of the
        plan that is"""

    @property
    def speed(self) -> float | None:
        """Simulated seconds a second; None: as fast as possible."""
        return self._pace.speed

    @property
    def requests(self) -> tuple[RequestState, ...]:
        """What was asked, the last one last."""
        return self._book.told()

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self._simulation.ended

    def turn(self) -> float:
        """Lets one time step pass if it is due; returns how long (s) nothing has to be done."""
        waits = self._waits_for_person()
        left = self._pace.left(self._simulation.now, self._clock(), waits)
        if left <= 0.0:
            self._simulation.step()
            self._look()
        now = self._clock()
        if now >= self._pose_due:
            # Late ones are made up for, so that steps of nearly this length are all told.
            self._pose_due = max(self._pose_due + 1.0 / POSES, now - 1.0 / POSES)
            self._tell(self._pose())
        due = self._stated + 1.0 / (POSES if self._teller.fresh else STATES)
        if now >= due:
            self.tell_state()
        return min(left, max(0.0, due - now)) if self._teller.fresh else left

    def take_up(self, request: RunRequest, by: str) -> None:
        """What was asked for while the run was interrupted: to go on, which it does as soon as
        something happens in it again, or to stop."""
        if isinstance(request, asked.EndRun) and not self.over:
            self.ask(request, by)
            return
        known = self._teller.count
        self._progress(request.id, request.kind, by, RequestProgress.UNDER_WAY)
        self._awaited[request.id] = lambda: self._teller.count > known or self.over
        self._look()

    def ask(self, request: RunRequest, by: str) -> None:
        """Does what is asked for, or refuses it."""
        try:
            until = self._begin(request)
        except ArgoError as error:
            self._progress(request.id, request.kind, by, RequestProgress.REFUSED, str(error))
        else:
            self._progress(request.id, request.kind, by, RequestProgress.UNDER_WAY)
            self._awaited[request.id] = until
        self._look()
        self.tell_state()

    def confirm_following(self) -> None:
        """Confirms that the run goes on with an edited plan, as it does now."""
        confirmed = {"progress": RequestProgress.CONFIRMED}
        self._settle(
            [
                request.model_copy(update=confirmed)
                for request in self._book.pending
                if request.kind == "go_on_edited"
            ]
        )

    def tell_state(self) -> None:
        """Tells how the run stands."""
        self._stated, self._teller.fresh = self._clock(), False
        self._tell(StateTold.model_construct(state=self.state()))

    def state(self) -> RunState:
        """How the run stands."""
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
                "skipped": self._hands.skipped,
                "readings": tuple(self._teller.readings.values()),
                "charge": self._charge(),
                "silent_since": simulation.silent_since,
                "entries": self._teller.count,
                "requests": self.requests,
                "speed": self._pace.speed,
                "headline": simulation.record().headline if self.over else None,
            }
        )

    # ---- requests

    def _begin(self, request: RunRequest) -> Callable[[], bool]:
        """Begins what is asked for; returns what tells whether it is so."""
        simulation = self._simulation
        machine = simulation.machine
        match request:
            case asked.ChangeSpeed(speed=speed):
                self._pace.change(speed, simulation.now, self._clock())
            case asked.SkipTask(task=name):
                self._hands.skip(name)
            case asked.GiveRobotBack():
                if not simulation.taken_over:
                    raise Conflict("nobody has the robot: it is given back by who took it over")
                simulation.handle(GiveBack(self._hands.done(simulation.spec.mission)))
                self._hands.forget()
                return lambda: simulation.ended or not simulation.taken_over
            case asked.GoOnEdited(mission=mission, revision=revision):
                if not simulation.taken_over:
                    raise Conflict("the plan is exchanged by a person who has the robot")
                self.following = (
                    simulation.continuation_spec(mission, self._hands.done(mission)),
                    revision,
                )
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
                    raise Conflict("a person has the robot: it goes on when they give it back")
                simulation.handle(Resume())
                return lambda: simulation.ended or not machine.paused
            case asked.StopByHandNow():
                simulation.handle(StopByHand())
                return lambda: simulation.task is None
            case asked.DoTask() | asked.DriveTo() | asked.MeasureAt():
                simulation.handle(DoByHand(self._hands.task(request)))
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

    def _look(self) -> None:
        """Confirms what is so by now."""
        settled = []
        for id, until in [*self._awaited.items()]:
            progress, reason = RequestProgress.CONFIRMED, None
            if not until():
                if not self.over:
                    continue
                progress, reason = RequestProgress.FAILED, "the run has ended before"
            elif id == self._by_hand:
                self._by_hand = None
                progress, reason = self._outcome()
            del self._awaited[id]
            update = {"progress": progress, "reason": reason}
            settled.append(self._book.of(id).model_copy(update=update))
        self._settle(settled)

    def _outcome(self) -> tuple[RequestProgress, str | None]:
        """How what was done by hand last has ended."""
        last = next(run for run in reversed(self._simulation.record().tasks) if run.by_hand)
        if last.outcome == "done":
            return RequestProgress.CONFIRMED, None
        return RequestProgress.FAILED, last.reason or last.outcome

    def _settle(self, requests: Sequence[RequestState]) -> None:
        """Requests are over. The state that they have brought about is told first: whoever waits
        for a request knows it then."""
        if not requests:
            return
        for request in requests:
            self._book.note(request)
        self.tell_state()
        for request in requests:
            self._tell(RequestTold(run=self._state.id, request=request))

    def _progress(
        self, id: str, kind: str, by: str, progress: RequestProgress, reason: str | None = None
    ) -> None:
        told = RequestState(id=id, kind=kind, by=by, progress=progress, reason=reason)
        self._book.note(told)
        self._tell(RequestTold(run=self._state.id, request=told))

    # ---- what is told

    def _waits_for_person(self) -> bool:
        """Whether nothing goes on until somebody tells the run something."""
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
