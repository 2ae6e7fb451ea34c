"""Inspection under way: a simulation that gets its tasks one by one, and estimated travel times.

The travel times are those from any pose to all docks and checkpoints of a site.
"""

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

FULL = 0.999  # charge from which on the battery counts as full
_PREDICTED_STEPS = 1000  # steps of charging that are predicted at most
_TRAIL_SPACING = 0.15  # m between the poses of a trail
_ROUNDING = 1e-6  # m, error of sums of floats


@dataclass(frozen=True)
class ActionResult:
    """Result of an action: the reading or the failure, and what happened during it."""

    reading: Reading | None = None
    failure: str | None = None
    anomalies: tuple[Anomaly, ...] = ()
    mishaps: tuple[Mishap, ...] = ()
    contacts: int = 0


class Inspection(Closing):
    """Robot on a site with all that may go wrong; it holds the simulation. Close it."""

    def __init__(
        self,
        run: CheckedRun,
        limit: float,
        observers: Sequence[Observer] = (),
    ) -> None:
        """Start the simulation, which ends after `limit` s.

        The run's mission must consist of the task in which the robot starts, and of no other.
        """
        self._machine = OpenMachine(run.spec.mission)
        self._observer = _ActionObserver()
        all_observers = [self._observer, *observers]
        self._simulation = Simulation(self._machine, run.site, run, observers=all_observers)
        self._drive = self._simulation.setup.drive
        self._limit = limit
        self._tasks: dict[str, int] = {}
        self._noticed: list[EventKind] = []
        self._trail: list[tuple[float, BodyPose]] = []
        self._record_pose(self.now, self._drive.pose)

    def close(self) -> None:
        """End the run; only its record is available afterwards."""
        self._simulation.close()

    @property
    def now(self) -> float:
        """Seconds since the start."""
        return self._simulation.now

    @property
    def is_time_up(self) -> bool:
        """True if the time limit is reached."""
        return self.now >= self._limit - 1e-6

    @property
    def is_battery_empty(self) -> bool:
        """True if the battery is empty."""
        battery = self._simulation.setup.battery
        return battery is not None and battery.is_empty

    @property
    def charge(self) -> float:
        """Charge, 0 to 1, as the robot estimates it from the battery's voltage and current.

        It is 1 if the simulation has no battery.
        """
        battery = self._simulation.setup.battery
        return 1.0 if battery is None else estimated_charge(battery.voltage, battery.current)

    @property
    def pose(self) -> BodyPose:
        return self._simulation.pose

    @property
    def trail(self) -> tuple[tuple[float, BodyPose], ...]:
        """Driven path: times (s) and poses, some 15 cm apart; the last one is the present pose."""
        return (*self._trail, (self.now, self.pose))

    @property
    def navigator(self) -> Navigator:
        """Navigator of the site as described, which avoids what was found to be closed."""
        return self._simulation.setup.navigator

    @property
    def kinds_noticed_so_far(self) -> tuple[EventKind, ...]:
        """Kinds of the anomalies noticed so far, in their order; a kind may occur repeatedly."""
        return tuple(self._noticed)

    def record(self) -> RunRecord:
        """Return the record of the run so far."""
        return self._simulation.record()

    def measure_checkpoint(self, checkpoint: int) -> ActionResult:
        """Drive to a pose from which the checkpoint can be read, and read it."""
        name, id = self._name(f"read {checkpoint}"), str(checkpoint)
        return self._carry_out(Task(name=name, action=Action.MEASURE, object_id=id))

    def drive_to(self, pose: Pose) -> ActionResult:
        """Drive to a pose, and return what happened on the way."""
        return self._carry_out(Task(name=self._name("drive"), action=Action.WAYPOINT, pose=pose))

    def stay(self, seconds: float, longer_until_full: bool = False) -> ActionResult:
        """Stay for `seconds`; or longer, with `longer_until_full`, until the battery is full.

        It ends earlier if the time limit is reached or the run ends.
        """
        self._observer.clear()
        end = self.now + seconds
        while not self._over and (self.now < end or (longer_until_full and self.charge < FULL)):
            self._advance(end if self.now < end else self._earliest_full_time)
        if self.is_time_up:
            self._stop()
        return self._action_result()

    def end_mission(self) -> None:
        """End the mission, to which no task can be added then, and with it the run."""
        self._machine.close()
        self._simulation.end_if_finished()

    @property
    def _earliest_full_time(self) -> float:
        """Time (s) up to which the estimated charge can't be full, however the battery charges."""
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
        return (
            self.now
            + battery.steps_until_charged(FULL, -watts, seconds, _PREDICTED_STEPS) * seconds
        )

    @property
    def _over(self) -> bool:
        return self._simulation.ended or self.is_time_up

    def _carry_out(self, task: Task) -> ActionResult:
        self._observer.clear()
        began = self.now
        self._simulation.append_task(task)
        while self._simulation.task is not None and not self._over:
            self._advance(math.inf)
        if self.is_time_up:
            self._stop()
        return self._action_result(began)

    def _stop(self) -> None:
        if not self._simulation.ended:
            self._simulation.handle(StopRun(f"the time limit of {self._limit:g} s was reached"))

    def _advance(self, until: float) -> None:
        """Let one time step pass, or several that end by the time `until` (s)."""
        began = self.now
        poses = self._simulation.fast_forward(min(until, self._limit))
        for index in _spaced_indices(_position(self._trail[-1][1]), poses):
            now = round(began + (index + 1) * self._drive.time_step, 6)
            self._trail.append((now, BodyPose(*pose_tuple_at(poses, index))))
        self._record_pose(self.now, self._drive.pose)

    def _action_result(self, began: float = math.inf) -> ActionResult:
        """Return the result of the action, from what has happened since the observer was cleared.

        It counts the contacts that lasted beyond the time `began` (s); none by default.
        """
        observer = self._observer
        anomalies = tuple(n for n in observer.sensed if isinstance(n, Anomaly))
        self._noticed += [anomaly.kind for anomaly in anomalies]
        touched = {(c.start, c.link, c.element) for c in observer.contacts() if c.end > began}
        return ActionResult(
            observer.reading, observer.failure, anomalies, tuple(observer.mishaps), len(touched)
        )

    def _name(self, what: str) -> str:
        """Return a name for a new task that begins with `what` and that no task has yet."""
        self._tasks[what] = count = self._tasks.get(what, 0) + 1
        return what if count == 1 else f"{what} ({count})"

    def _record_pose(self, now: float, pose: BodyPose) -> None:
        """Add the pose at time `now` (s) to the trail if it is far enough from the last one."""
        if self._trail:
            last = self._trail[-1][1]
            if pose is last:
                return
            if math.dist(_position(pose), _position(last)) < _TRAIL_SPACING:
                return
        self._trail.append((now, pose))


def _spaced_indices(last: Vector, poses: PoseArray) -> Iterator[int]:
    """Yield the indices of poses that are _TRAIL_SPACING or more from the preceding one.

    The first one is that far from the position `last` (m).
    """
    if not len(poses):
        return
    points = poses[:, :3].tolist()
    # The distance to a pose is at most the length of the path to it.
    lengths = np.linalg.norm(np.diff(poses[:, :3], axis=0), axis=1)
    distances = [*accumulate(lengths.tolist(), initial=math.dist(last, points[0]))]
    index, passed = 0, 0.0
    while True:
        index = bisect_left(distances, passed + _TRAIL_SPACING - _ROUNDING, index)
        while index < len(points) and math.dist(points[index], last) < _TRAIL_SPACING:
            index += 1
        if index == len(points):
            return
        yield index
        last, passed = points[index], distances[index]
        index += 1


def _position(pose: BodyPose) -> Vector:
    return pose.x, pose.y, pose.z


class _ActionObserver(Observer):
    """Observer that holds what has happened in the run since it was cleared."""

    wants_samples = False

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self.sensed: list[Reading | Anomaly] = []
        self.reading: Reading | None = None
        self.failure: str | None = None
        self.mishaps: list[Mishap] = []
        self._ended_contacts: list[Contact] = []
        self._present_contacts: tuple[Contact, ...] = ()

    def contacts(self) -> tuple[Contact, ...]:
        """Return the contacts that have ended, then those that may continue."""
        return (*self._ended_contacts, *self._present_contacts)

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        self.sensed += entry.other_anomalies_then_reading
        self.reading = entry.reading or self.reading
        self.mishaps += entry.mishaps
        self._ended_contacts += entry.contacts
        self._present_contacts = entry.touching
        for event in entry.events:
            original = event.to_event()
            if isinstance(original, ActionFailed):
                self.failure = original.reason


def initial_mission(site: OpenedSite, start: Pose) -> Mission:
    """Return a mission on the site that has only the START task, with the pose `start`."""
    task = Task(name="START", action=Action.START, pose=start)
    return Mission(site=site.name, tasks=(task,))


_NEAR = 1.0  # m from a dock or a viewing pose, within which the robot counts as there


class TravelTimes:
    """Travel times between docks and checkpoints of a site; it caches what it has computed."""

    def __init__(self, navigator: Navigator) -> None:
        self._navigator = weakref.ref(navigator)
        site = navigator.site
        docks = [site.docks[number] for number in sorted(site.docks)]
        self._poses = [*docks, *(_viewing_pose(navigator, c.id) for c in site.checkpoints)]
        self._reachable = reachable = [
            k for k, place in enumerate(self._poses) if place is not None
        ]
        poses = [place for place in self._poses if place is not None]
        self._times = np.full((len(self._poses), len(self._poses)), np.inf)
        self._times[np.ix_(reachable, reachable)] = navigator.travel_times(poses)
        self._from_everywhere = navigator.parts.load_or_make(
            "travel-times", lambda: {"times": navigator.travel_times_to(poses)}
        )["times"]

    def times_to_docks_and_checkpoints(
        self, pose: BodyPose, navigator: Navigator
    ) -> NDArray[np.float64]:
        """Return estimated times (s) from a pose to each dock and each checkpoint, shape (n,).

        First come the docks, then the checkpoints, both in the order of their numbers. Times are
        infinite where there is no path on the site as `navigator` knows it, which may differ from
        the one of this object by blockages.
        """
        if navigator is self._navigator():
            apart = [
                np.inf
                if place is None
                else math.dist((place.x, place.y, place.z), (pose.x, pose.y, pose.z))
                for place in self._poses
            ]
            nearest = int(np.argmin(apart))
            if apart[nearest] <= _NEAR:
                return np.asarray(self._times[nearest])
        here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
        row = np.full(len(self._poses), np.inf)
        try:
            state = navigator.state_at(here)
        except Unreachable:
            return row
        if navigator is self._navigator():
            row[self._reachable] = self._from_everywhere[:, state]
            return row
        reachable = [
            k for k, place in enumerate(self._poses) if place and _can_stand_at(navigator, place)
        ]
        poses = [place for k in reachable if (place := self._poses[k])]
        row[reachable] = navigator.travel_times_from(here, poses)
        return row


def _viewing_pose(navigator: Navigator, checkpoint: int) -> Pose | None:
    try:
        return navigator.viewing_pose(checkpoint)
    except Unreachable:
        return None


def _can_stand_at(navigator: Navigator, pose: Pose) -> bool:
    try:
        navigator.state_at(pose)
    except Unreachable:
        return False
    return True


_cached_times: WeakKeyDictionary[Navigator, TravelTimes] = WeakKeyDictionary()


def cached_travel_times(navigator: Navigator) -> TravelTimes:
    """Return the travel times of a navigator, which are computed once and kept as long as it is."""
    if navigator not in _cached_times:
        _cached_times[navigator] = TravelTimes(navigator)
    return _cached_times[navigator]
