"""An inspection under way, a simulation whose tasks are given one by one; and estimates of the
travel times from any place to all docks and checkpoints of a site."""

import math
import weakref
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ActionFailed
from argo_compiler.il import Action, EventKind, Mission, Task
from argo_env.closing import Closing
from argo_env.drives.battery import ESTIMATE_ERROR, estimated_charge
from argo_env.navigation import Navigator
from argo_env.planning.opening import OpenedSite
from argo_env.robot.pose import BodyPose, PoseArray, pose_tuple_at
from argo_env.run.log import Entry
from argo_env.run.machine import Machine, OpenMachine
from argo_env.run.observer import Observer
from argo_env.run.record import Anomaly, Contact, Mishap, Reading, RunRecord
from argo_env.run.run_commands import StopRun
from argo_env.run.simulation import Simulation
from argo_env.run.validation import CheckedRun
from argo_env.site.shapes import Vector

FULL = 0.999  # charge from where on the battery counts as full
_ESTIMATED = 1000  # steps of charging for which the charge is estimated ahead
_TRAIL = 0.15  # m between poses that are kept
_ROUNDING = 1e-6  # m, left by sums of floats


@dataclass(frozen=True)
class Deed:
    """What an action came to."""

    reading: Reading | None = None
    failure: str | None = None
    found: tuple[Anomaly, ...] = ()
    trouble: tuple[Mishap, ...] = ()
    contacts: int = 0


class Inspection(Closing):
    """A robot on a site with all that may go wrong. Holds the simulation; close it."""

    def __init__(
        self,
        run: CheckedRun,
        limit: float,
        observers: Sequence[Observer] = (),
    ) -> None:
        """The run's mission begins where the robot is, and has no other task. The run is over
        after `limit` s."""
        self._machine = OpenMachine(run.spec.mission)
        self._told = _Told()
        told = [self._told, *observers]
        self._simulation = Simulation(self._machine, run.site, run, observers=told)
        self._drive = self._simulation.setup.drive
        self._limit = limit
        self._tasks: dict[str, int] = {}
        self._noticed: list[EventKind] = []
        self._trail: list[tuple[float, BodyPose]] = []
        self._mark(self.now, self._drive.pose)

    def close(self) -> None:
        """Ends the run; only its record can be asked for afterwards."""
        self._simulation.close()

    @property
    def now(self) -> float:
        """s since the start."""
        return self._simulation.now

    @property
    def time_up(self) -> bool:
        return self.now >= self._limit - 1e-6

    @property
    def dead(self) -> bool:
        """Whether the battery is empty."""
        battery = self._simulation.setup.battery
        return battery is not None and battery.is_empty

    @property
    def charge(self) -> float:
        """0 to 1, as the robot makes it out of the battery's voltage and current."""
        battery = self._simulation.setup.battery
        return 1.0 if battery is None else estimated_charge(battery.voltage, battery.current)

    @property
    def pose(self) -> BodyPose:
        return self._simulation.pose

    @property
    def trail(self) -> tuple[tuple[float, BodyPose], ...]:
        """Times (s) and poses, so near to one another that they show the way; the last is now."""
        return (*self._trail, (self.now, self.pose))

    @property
    def navigator(self) -> Navigator:
        """The site as the robot knows it, less what it has found to be closed."""
        return self._simulation.setup.navigator

    @property
    def noticed(self) -> tuple[EventKind, ...]:
        """The kinds of what was found so far."""
        return tuple(self._noticed)

    def record(self) -> RunRecord:
        """The record of the run as it stands."""
        return self._simulation.record()

    def read(self, checkpoint: int) -> Deed:
        """Drives to where the checkpoint can be read, and reads it."""
        name, id = self._name(f"read {checkpoint}"), str(checkpoint)
        return self._carry_out(Task(name=name, action=Action.MEASURE, object_id=id))

    def drive(self, pose: Pose) -> Deed:
        """Drives there."""
        return self._carry_out(Task(name=self._name("drive"), action=Action.WAYPOINT, pose=pose))

    def stand(self, seconds: float, charging: bool = False) -> Deed:
        """Stands still for so long, and with `charging` until the battery is full."""
        self._told.clear()
        end = self.now + seconds
        while not self._over and (self.now < end or (charging and self.charge < FULL)):
            self._step(end if self.now < end else self._surely_not_full)
        if self.time_up:
            self._stop()
        return self._deed()

    def finish(self) -> None:
        """No task will follow: the run ends with the last one."""
        self._machine.close()
        self._simulation.end_if_finished()

    @property
    def _surely_not_full(self) -> float:
        """s, a time up to which the battery can't be found full, however it is charged."""
        battery = self._simulation.setup.battery
        assert battery is not None
        watts, seconds = (
            self._simulation.setup.navigator.robot.power.charging,
            self._drive.time_step,
        )
        missing = (FULL - ESTIMATE_ERROR - battery.charge) * battery.capacity
        charges = battery.current < 0.0
        if missing > 0.0 or not charges:
            return self.now + max(0.0, missing) * 3600.0 / watts
        return self.now + battery.steps_until(FULL, -watts, seconds, _ESTIMATED) * seconds

    @property
    def _over(self) -> bool:
        return self._simulation.ended or self.time_up

    def _carry_out(self, task: Task) -> Deed:
        self._told.clear()
        began = self.now
        self._simulation.append_task(task)
        while self._simulation.task is not None and not self._over:
            self._step(math.inf)
        if self.time_up:
            self._stop()
        return self._deed(began)

    def _stop(self) -> None:
        if not self._simulation.ended:
            self._simulation.handle(StopRun(f"the time limit of {self._limit:g} s was reached"))

    def _step(self, until: float) -> None:
        """Goes on for one time step, or for many up to that time (s)."""
        began = self.now
        places = self._simulation.fast_forward(min(until, self._limit))
        for number in _apart(_position(self._trail[-1][1]), places):
            now = round(began + (number + 1) * self._drive.time_step, 6)
            self._trail.append((now, BodyPose(*pose_tuple_at(places, number))))
        self._mark(self.now, self._drive.pose)

    def _deed(self, began: float = math.inf) -> Deed:
        """What came since the clearing; contacts are those with a touch after time `began` (s)."""
        told = self._told
        found = tuple(n for n in told.sensed if isinstance(n, Anomaly))
        self._noticed += [anomaly.kind for anomaly in found]
        touched = {(c.start, c.link, c.element) for c in told.contacts() if c.end > began}
        return Deed(told.reading, told.failure, found, tuple(told.mishaps), len(touched))

    def _name(self, what: str) -> str:
        """A name that no task has yet."""
        self._tasks[what] = count = self._tasks.get(what, 0) + 1
        return what if count == 1 else f"{what} ({count})"

    def _mark(self, now: float, pose: BodyPose) -> None:
        """Keeps the pose at time `now` (s) if the robot is far enough from the last one kept."""
        if self._trail:
            last = self._trail[-1][1]
            if pose is last:
                return
            if math.dist(_position(pose), _position(last)) < _TRAIL:
                return
        self._trail.append((now, pose))


def _apart(last: Vector, places: PoseArray) -> Iterator[int]:
    """The numbers of the places that are as far as `_TRAIL` from `last` (m), each then being the
    last one for the next."""
    if not len(places):
        return
    points = places[:, :3].tolist()
    # No place is farther away than the way to it is long.
    ways = np.linalg.norm(np.diff(places[:, :3], axis=0), axis=1)
    gone = [*accumulate(ways.tolist(), initial=math.dist(last, points[0]))]
    number, begun = 0, 0.0
    while True:
        number = bisect_left(gone, begun + _TRAIL - _ROUNDING, number)
        while number < len(points) and math.dist(points[number], last) < _TRAIL:
            number += 1
        if number == len(points):
            return
        yield number
        last, begun = points[number], gone[number]
        number += 1


def _position(pose: BodyPose) -> Vector:
    return pose.x, pose.y, pose.z


class _Told(Observer):
    """Holds what was told of the run since it was cleared."""

    wants_samples = False

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self.sensed: list[Reading | Anomaly] = []
        self.reading: Reading | None = None
        self.failure: str | None = None
        self.mishaps: list[Mishap] = []
        self._over: list[Contact] = []
        self._open: tuple[Contact, ...] = ()

    def contacts(self) -> tuple[Contact, ...]:
        """Those that are over, then those that may go on."""
        return (*self._over, *self._open)

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        self.sensed += entry.sensed
        self.reading = entry.reading or self.reading
        self.mishaps += entry.mishaps
        self._over += entry.contacts
        self._open = entry.touching
        for event in entry.events:
            original = event.to_event()
            if isinstance(original, ActionFailed):
                self.failure = original.reason


def beginning(site: OpenedSite, start: Pose) -> Mission:
    """The mission of an inspection before its first task: the robot stands at `start`."""
    task = Task(name="START", action=Action.START, pose=start)
    return Mission(site=site.name, tasks=(task,))


_NEAR = 1.0  # m from a dock or view within which the robot is taken to be there


class TravelTimes:
    """What the ways between docks and checkpoints of a site take. Holds what it has worked out."""

    def __init__(self, navigator: Navigator) -> None:
        self._navigator = weakref.ref(navigator)
        site = navigator.site
        docks = [site.docks[number] for number in sorted(site.docks)]
        self._places = [*docks, *(_view(navigator, c.id) for c in site.checkpoints)]
        self._known = known = [k for k, place in enumerate(self._places) if place is not None]
        places = [place for place in self._places if place is not None]
        self._times = np.full((len(self._places), len(self._places)), np.inf)
        self._times[np.ix_(known, known)] = navigator.travel_times(places)
        self._from_everywhere = navigator.parts.load_or_make(
            "travel-times", lambda: {"times": navigator.travel_times_to(places)}
        )["times"]

    def row(self, pose: BodyPose, navigator: Navigator) -> NDArray[np.float64]:
        """Estimated s from a pose to the docks and then to the checkpoints, in the order of their
        numbers, infinite where there is no way: as the site is known to `navigator`."""
        if navigator is self._navigator():
            apart = [
                np.inf
                if place is None
                else math.dist((place.x, place.y, place.z), (pose.x, pose.y, pose.z))
                for place in self._places
            ]
            nearest = int(np.argmin(apart))
            if apart[nearest] <= _NEAR:
                return np.asarray(self._times[nearest])
        here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
        row = np.full(len(self._places), np.inf)
        try:
            state = navigator.state_at(here)
        except Unreachable:
            return row
        if navigator is self._navigator():
            row[self._known] = self._from_everywhere[:, state]
            return row
        known = [k for k, place in enumerate(self._places) if place and _free(navigator, place)]
        places = [place for k in known if (place := self._places[k])]
        row[known] = navigator.travel_times_from(here, places)
        return row


def _view(navigator: Navigator, checkpoint: int) -> Pose | None:
    try:
        return navigator.viewing_pose(checkpoint)
    except Unreachable:
        return None


def _free(navigator: Navigator, pose: Pose) -> bool:
    try:
        navigator.state_at(pose)
    except Unreachable:
        return False
    return True


_found: WeakKeyDictionary[Navigator, TravelTimes] = WeakKeyDictionary()


def travel_times(navigator: Navigator) -> TravelTimes:
    """The travel times of a navigator's site, found once and kept as long as the navigator."""
    if navigator not in _found:
        _found[navigator] = TravelTimes(navigator)
    return _found[navigator]
