"""The watches over the robot itself: battery, connection, emergency stop, drive and camera.

Each looks at signals that such a robot has: volts and amperes, whether a packet comes back, the
circuit of the emergency stop, the way made against the way planned, pictures of a test pattern.
"""

import math
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, repeat

import numpy as np
from numpy.typing import NDArray

from argo_compiler.il import EventKind
from argo_env.drives.battery import ESTIMATE_ERROR, Battery, estimated_charge
from argo_env.drives.powertrain import Powertrain
from argo_env.navigation.path import Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.seeding import generator
from argo_env.sensing.sensor import Measurement, MeasurementError, Sensor
from argo_env.sensing.watch import Detection, Told, Watch
from argo_env.site import Site
from argo_env.surroundings.surroundings import RadioNetwork

_HEALTHY_NOISE = 0.001  # of the scale, in the picture of the test pattern
_SHOTS = 8  # pictures of the test pattern in one self-test


class OnboardSensor:
    """A sensor that may fail. Holds how it stands; faults change that."""

    def __init__(self, sensor: Sensor, site: Site, seed: int, usual_noise: float = 0.0) -> None:
        """`usual_noise`: that of a sensor in order, as a share of the scale."""
        self._sensor = sensor
        self._site = site
        self._seed = seed
        self._tests = generator(seed, "instrument")
        self.name = sensor.name
        self.moment = 0.0
        """s, when it reads next"""
        self.failed = False
        """whether the camera gives no picture"""
        self.usual_noise = usual_noise
        """standard deviation of what it adds to values while nothing is wrong with it, as a share
        of their scale"""
        self.noise = usual_noise
        """the same as it is now"""

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Reads the checkpoint as the sensor does, as far as it works."""
        if self.failed:
            raise MeasurementError("the camera gives no picture")
        found = self._sensor.measure(checkpoint_id, pose)
        if not self.noise:
            return found
        scale = self._site.checkpoint(checkpoint_id).range
        # Of checkpoint and moment alone: what else was read before changes nothing.
        rng = generator(self._seed, "reading", checkpoint_id, round(1000 * self.moment))
        value = found.value + self.noise * (scale.high - scale.low) * rng.standard_normal()
        return replace(found, value=round(min(max(value, scale.low), scale.high), 2))

    def test(self) -> tuple[float, ...] | None:
        """What the camera makes of the test pattern inside its housing, which stands at 0 of 1, in
        several pictures; None if there is no picture."""
        if self.failed:
            return None
        spread = max(self.noise, _HEALTHY_NOISE)
        return tuple((spread * self._tests.standard_normal(_SHOTS)).tolist())


LOW, FULL = 0.2, 0.99
"""shares of the charge: below the one the battery is low, from the other on it is charged again"""
WINDOW = 10.0  # s over which the way made is compared with the way planned
SLOW = 0.6  # share of the planned speed below which something is wrong
_SAMPLE = 0.2  # s between the places on the planned way that the robot's are compared with
_RADIAN = 0.3  # m that a radian counts as in this
NOISY = 0.01  # standard deviation in the test pattern above which the camera is too noisy


class BatteryWatch:
    """Estimates the charge from voltage and current. Holds whether it has been low: it is low again
    only after it was charged."""

    name = "battery"
    period = 1.0

    def __init__(self, battery: Battery, low: float = LOW) -> None:
        """`low`: the share of the charge below which it is."""
        self._battery = battery
        self._level = low
        self._low = False

    def remember(self, told: Sequence[Told], now: float) -> None:  # noqa: ARG002
        self._low = bool(told) and told[-1].kind is EventKind.LOW_BATTERY

    def sees_nothing_new(self, least: float, most: float) -> bool:
        """Whether the charge stays so far from the level at which it would be told that no
        estimate reaches it."""
        if self._low:
            return most + ESTIMATE_ERROR < FULL
        return least - ESTIMATE_ERROR > self._level

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        voltage = self._battery.voltage
        charge = estimated_charge(voltage, self._battery.current)
        if not self._low and charge < self._level:
            self._low = True
            return (Detection(EventKind.LOW_BATTERY, f"{voltage:.1f} V, {charge:.0%} charged"),)
        if self._low and charge >= FULL:
            self._low = False
            return (Detection(EventKind.BATTERY_CHARGED, f"{voltage:.1f} V, {charge:.0%} charged"),)
        return ()


class ConnectionWatch:
    """Asks the base station for a sign of life. Holds how many it has missed."""

    name = "connection"
    period = 0.5

    def __init__(self, network: RadioNetwork, missed: int = 4) -> None:
        """The connection is lost when `missed` answers in a row have not come."""
        self._network = network
        self._limit = missed
        self._missed = 0

    def remember(self, told: Sequence[Told], now: float) -> None:  # noqa: ARG002
        lost = bool(told) and told[-1].kind is EventKind.CONNECTION_LOST
        self._missed = self._limit if lost else 0

    def sees_nothing_new(self, least: float, most: float) -> bool:  # noqa: ARG002
        """Whether the network has no shadows, and the last answer has come."""
        return not self._network.shadows and not self._missed

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        here = (pose.x, pose.y, pose.z)
        if not self._network.connected(pose):
            self._missed += 1
            if self._missed == self._limit:
                silent = self._limit * self.period
                detail = f"no answer for {silent:g} s"
                return (Detection(EventKind.CONNECTION_LOST, detail, noticed_from=here),)
            return ()
        lost, self._missed = self._missed >= self._limit, 0
        if lost:
            detail = "the base station answers"
            return (Detection(EventKind.CONNECTION_RESTORED, detail, noticed_from=here),)
        return ()


class EmergencyStopWatch:
    """Looks at the circuit of the emergency stop. Holds how it was."""

    name = "emergency stop"
    period = 0.1

    def __init__(self, drive: Powertrain) -> None:
        self._drive = drive
        self._pressed = False

    def remember(self, told: Sequence[Told], now: float) -> None:  # noqa: ARG002
        self._pressed = bool(told) and self._drive.pressed

    def sees_nothing_new(self, least: float, most: float) -> bool:  # noqa: ARG002
        """Whether the circuit is as it was."""
        return self._pressed == self._drive.pressed

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        before, self._pressed = self._pressed, self._drive.pressed
        if self._pressed and not before:
            return (Detection(EventKind.EMERGENCY_STOP, "someone has pressed the emergency stop"),)
        return ()


class DriveWatch:
    """Compares the way that the robot makes with the one that was planned. Holds both."""

    name = "drive"
    period = 1.0

    def __init__(self, drive: Powertrain, robot: RobotSpec) -> None:
        self._drive = drive
        self._robot = robot
        self._way: tuple[Path, float | None] | None = None
        self._plan = np.empty((0, 4))  # as `_places` says
        self._at = 0
        self._held = 0
        self._progress: deque[tuple[float, float]] = deque()
        self._told = False

    def remember(self, told: Sequence[Told], now: float) -> None:  # noqa: ARG002
        self._told = bool(told)  # until the robot is seen to be fast enough again

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        way = self._drive.way
        if way is None:
            return ()
        if way is not self._way:
            self._way, self._at = way, 0
            self._plan = _places(*way, self._robot)
            self._progress.clear()
        self._at = self._nearest(pose)
        if self._drive.held != self._held:
            # Brakes say nothing of the drive; where the robot is on its way it must not forget.
            self._held = self._drive.held
            self._progress.clear()
        self._progress.append((now, self._at * _SAMPLE))
        while now - self._progress[0][0] > WINDOW + 1e-6:
            self._progress.popleft()
        since, before = self._progress[0]
        if now - since < WINDOW - 1e-6 or self._at >= len(self._plan) - 1:
            return ()
        share = (self._progress[-1][1] - before) / (now - since)
        if share >= SLOW:
            self._told = False
            return ()
        if self._told:
            return ()
        self._told = True
        detail = f"the drive makes {share:.0%} of the planned speed"
        here = (pose.x, pose.y, pose.z)
        return (Detection(EventKind.DYSFUNCTION, detail, noticed_from=here),)

    def _nearest(self, pose: BodyPose) -> int:
        """Where on the plan the robot is: at most twice as far on as time would have it."""
        nearest, least = self._at, math.inf
        last = self._at + round(2 * self.period / _SAMPLE)
        rows = self._plan[self._at : last + 1].tolist()
        for number, (x, y, z, yaw) in enumerate(rows, start=self._at):
            dx, dy, dz = x - pose.x, y - pose.y, z - pose.z
            turned = _RADIAN * ((yaw - pose.yaw + math.pi) % math.tau) - _RADIAN * math.pi
            apart = dx * dx + dy * dy + dz * dz + turned * turned
            if apart < least:
                nearest, least = number, apart
        return nearest


class CameraWatch:
    """Takes pictures of the test pattern. Holds whether the camera was found out of order."""

    name = "camera"
    period = 5.0

    def __init__(self, sensor: OnboardSensor) -> None:
        self._sensor = sensor
        self._told = False

    def remember(self, told: Sequence[Told], now: float) -> None:  # noqa: ARG002
        self._told = bool(told)  # if the camera is well again, the first picture shows it

    def look(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        pattern = self._sensor.test()
        spread = 0.0 if pattern is None else math.hypot(*pattern) / math.sqrt(len(pattern))
        before, self._told = self._told, pattern is None or spread > NOISY
        if not self._told or before:
            return ()
        detail = (
            "the camera gives no picture"
            if pattern is None
            else f"the camera's picture of the test pattern is off by {spread:.1%} of the scale"
        )
        return (Detection(EventKind.DYSFUNCTION, detail),)


def onboard_watches(
    robot: RobotSpec,
    battery: Battery,
    network: RadioNetwork,
    drive: Powertrain,
    sensor: OnboardSensor,
    low_battery: float | None = None,
) -> tuple[Watch, ...]:
    """All watches over the robot itself, for one run. `low_battery`: the share of the charge below
    which the battery is low; None: the robot's own level."""
    return (
        EmergencyStopWatch(drive),
        BatteryWatch(battery, LOW if low_battery is None else low_battery),
        ConnectionWatch(network),
        DriveWatch(drive, robot),
        CameraWatch(sensor),
    )


def _places(path: Path, velocity: float | None, robot: RobotSpec) -> NDArray[np.float64]:
    """x, y, z (m) and yaw (rad) every _SAMPLE s along the plan, shape (n, 4)."""
    rows: list[NDArray[np.float64]] = []
    first = 0.0
    for motion in path.motions:
        duration = motion.duration(robot, velocity)
        most = 1 + math.ceil(max(0.0, duration - first) / _SAMPLE)
        times = [*accumulate(repeat(_SAMPLE, most), initial=first)]
        under_way = bisect_left(times, duration)
        x, y, z, yaw = motion.along(np.array(times[:under_way]) / duration)
        rows.append(np.column_stack([x, y, z, wrap(yaw)]))
        first = times[under_way] - duration
    end = path.end
    return np.concatenate([*rows, [(end.x, end.y, end.z, end.yaw)]])
