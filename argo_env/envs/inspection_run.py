"""One inspection under way: what missions are carried out with, driven action by action."""

import math
import weakref
from contextlib import ExitStack
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from argo_compiler.errors import Unreachable
from argo_compiler.hfsm import ActionFailed
from argo_compiler.il import Action, EventKind, Task
from argo_compiler.model import Pose
from argo_env.drives.battery import estimated_charge
from argo_env.navigation import Navigator
from argo_env.robot.pose import BodyPose
from argo_env.run.action import ActionUnderWay
from argo_env.run.odometry import Odometry
from argo_env.run.perception import Perception, blockage
from argo_env.run.record import Anomaly, Reading
from argo_env.run.session import outfit
from argo_env.run.spec import RunSettings

FULL = 0.999  # charge from where on the battery counts as full
_TRAIL = 0.15  # m between poses that are kept
_NEAR = 1.0  # m from a dock or view within which the robot is taken to be there


@dataclass(frozen=True)
class Deed:
    """What an action came to."""

    reading: Reading | None = None
    failure: str | None = None
    found: tuple[Anomaly, ...] = ()
    contacts: int = 0


class Inspection:
    """A robot on a site with all that may go wrong. Holds the run; close it."""

    def __init__(
        self, navigator: Navigator, settings: RunSettings, start: Pose, limit: float
    ) -> None:
        """The run is over after `limit` s."""
        self._stack = ExitStack()
        self._rig = outfit(settings, navigator, False, self._stack)
        self._limit = limit
        self._steps = 0
        self._odometry = Odometry(navigator.robot, self._rig.battery, navigator.site)
        self._perception = Perception(self._rig.watches, navigator.site, self._rig.drive.time_step)
        self._noticed: list[EventKind] = []
        self._trail: list[tuple[float, BodyPose]] = []
        here = navigator.snap(start)
        self._rig.drive.place(BodyPose(here.x, here.y, here.z, here.yaw))
        self._mark()
        if self._rig.schedule:
            self._rig.schedule.advance(0.0)

    def close(self) -> None:
        """Ends the run; nothing can be asked of it afterwards."""
        self._stack.close()

    @property
    def now(self) -> float:
        """s since the start."""
        return round(self._steps * self._rig.drive.time_step, 6)

    @property
    def time_up(self) -> bool:
        return self.now >= self._limit - 1e-6

    @property
    def dead(self) -> bool:
        """Whether the battery is empty."""
        return self._odometry.empty

    @property
    def charge(self) -> float:
        """0 to 1, as the robot makes it out of the battery's voltage and current."""
        battery = self._rig.battery
        return 1.0 if battery is None else estimated_charge(battery.voltage, battery.current)

    @property
    def pose(self) -> BodyPose:
        return self._rig.drive.pose

    @property
    def trail(self) -> tuple[tuple[float, BodyPose], ...]:
        """Times (s) and poses, so near to one another that they show the way; the last is now."""
        return (*self._trail, (self.now, self.pose))

    @property
    def navigator(self) -> Navigator:
        """The site as the robot knows it, less what it has found to be closed."""
        return self._rig.navigator

    @property
    def noticed(self) -> tuple[EventKind, ...]:
        """The kinds of what was found so far."""
        return tuple(self._noticed)

    def read(self, checkpoint: int) -> Deed:
        """Drives to where the checkpoint can be read, and reads it."""
        task = Task(name=f"read {checkpoint}", action=Action.MEASURE, object_id=str(checkpoint))
        return self._carry_out(task)

    def drive(self, pose: Pose) -> Deed:
        """Drives there."""
        return self._carry_out(Task(name="drive", action=Action.WAYPOINT, pose=pose))

    def stand(self, seconds: float, charging: bool = False) -> Deed:
        """Stands still for so long, and with `charging` until the battery is full."""
        found: list[Anomaly] = []
        end = self.now + seconds
        while not self._over and (self.now < end or (charging and self.charge < FULL)):
            found += self._advance(None)[1]
        return Deed(found=tuple(found))

    @property
    def _over(self) -> bool:
        return self.time_up or self.dead

    def _carry_out(self, task: Task) -> Deed:
        odometry = self._odometry
        action = ActionUnderWay(
            task, None, self._rig, self.now, odometry.distance, odometry.climbed
        )
        found: list[Anomaly] = []
        end = None
        while end is None and not self._over:
            end, noticed = self._advance(action)
            found += noticed
        odometry.close()
        contacts = len(odometry.over)
        odometry.over.clear()
        if end is None:
            self._rig.drive.halt()
        failure = end.reason if isinstance(end, ActionFailed) else None
        return Deed(action.reading(self.now), failure, tuple(found), contacts)

    def _mark(self) -> None:
        """Keeps the pose if the robot is far enough from the last one kept."""
        pose = self.pose
        if self._trail:
            last = self._trail[-1][1]
            if math.dist((pose.x, pose.y, pose.z), (last.x, last.y, last.z)) < _TRAIL:
                return
        self._trail.append((self.now, pose))

    def _advance(self, action: ActionUnderWay | None) -> tuple[object, tuple[Anomaly, ...]]:
        """One step of simulated time; the end of the action, if that is it, and what was found."""
        self._steps += 1
        rig, now = self._rig, self.now
        if rig.schedule:
            rig.schedule.advance(now)
        before = rig.drive.pose
        end = action.step() if action else None
        if action:
            self._odometry.moved(before, rig.drive.pose, rig.world.touches(), now)
        measuring = action is not None and action.measuring
        self._odometry.spend(before, rig.drive.pose, rig.drive.time_step, measuring)
        self._mark()
        noticed = self._perception.look(self._steps, now, rig.drive.pose)
        self._noticed += [anomaly.kind for anomaly in noticed]
        if closed := [b for anomaly in noticed if (b := blockage(anomaly))]:
            self._rig = replace(rig, navigator=rig.navigator.avoiding(closed))
            if action and end is None:
                action.detour(self._rig)
        return end, noticed


class TravelTimes:
    """What the ways between docks and checkpoints of a site take. Holds what it has worked out."""

    def __init__(self, navigator: Navigator) -> None:
        self._navigator = weakref.ref(navigator)
        site = navigator.site
        docks = [site.docks[number] for number in sorted(site.docks)]
        self._places = [*docks, *(_view(navigator, c.id) for c in site.checkpoints)]
        known = [k for k, place in enumerate(self._places) if place is not None]
        self._times = np.full((len(self._places), len(self._places)), np.inf)
        self._times[np.ix_(known, known)] = navigator.travel_times(
            [place for place in self._places if place is not None]
        )

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
        known = [k for k, place in enumerate(self._places) if place and _free(navigator, place)]
        row = np.full(len(self._places), np.inf)
        if _free(navigator, here):
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
        navigator.snap(pose)
    except Unreachable:
        return False
    return True


_found: WeakKeyDictionary[Navigator, TravelTimes] = WeakKeyDictionary()


def travel_times(navigator: Navigator) -> TravelTimes:
    """The travel times of a navigator's site, found once and kept as long as the navigator."""
    if navigator not in _found:
        _found[navigator] = TravelTimes(navigator)
    return _found[navigator]
