"""Watches for the robot itself: connection, emergency stop, drive and camera.

Each reads a signal that such a robot has: voltage and current, replies of the base station, the
circuit of the emergency stop, the distance driven compared with the planned one, pictures of a test
pattern.
"""

import math
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, repeat

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.message import Message
from argo_compiler.hfsm.charging import LOW
from argo_compiler.il import EventKind
from argo_env.drives.battery import Battery
from argo_env.drives.powertrain import Powertrain
from argo_env.navigation.path import Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.seeding import generator
from argo_env.sensing.battery_watch import BatteryWatch
from argo_env.sensing.sensor import Measurement, MeasurementError, Sensor
from argo_env.sensing.watch import Detection, ReportedDetection, Watch
from argo_env.site import Site
from argo_env.surroundings.surroundings import RadioNetwork

_HEALTHY_NOISE = 0.001  # of the scale, in the picture of the test pattern
_SHOTS = 8  # pictures of the test pattern in one self-test


class SensorWithFaults:
    """Sensor that wraps another one, and may fail or become noisy.

    It holds its present condition, which faults change.
    """

    def __init__(self, sensor: Sensor, site: Site, seed: int, usual_noise: float = 0.0) -> None:
        """`usual_noise`: standard deviation of noise without a fault, as a share of the scale."""
        self._sensor = sensor
        self._site = site
        self._seed = seed
        self._tests = generator(seed, "instrument")
        self.name = sensor.name
        self.time = 0.0
        """s, simulated time of the next measurement; the run sets it"""
        self.failed = False
        """True while the camera gives no picture"""
        self.usual_noise = usual_noise
        """standard deviation of the noise without a fault, as a share of the checkpoint's scale"""
        self.noise = usual_noise
        """standard deviation of the present noise, as a share of the checkpoint's scale"""

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Read the checkpoint with the wrapped sensor, and add the present noise to the value.

        A value with noise stays within the checkpoint's scale, and is rounded to two decimals.
        Raises MeasurementError if the wrapped sensor does, and while the camera gives no picture.
        """
        if self.failed:
            raise MeasurementError("the camera gives no picture")
        measurement = self._sensor.measure(checkpoint_id, pose)
        if not self.noise:
            return measurement
        scale = self._site.checkpoint(checkpoint_id).range
        # The noise depends on checkpoint and time only, so earlier measurements don't change it.
        rng = generator(self._seed, "reading", checkpoint_id, round(1000 * self.time))
        value = measurement.value + self.noise * (scale.high - scale.low) * rng.standard_normal()
        return replace(measurement, value=round(min(max(value, scale.low), scale.high), 2))

    def measure_test_pattern_errors(self) -> tuple[float, ...] | None:
        """Return one reading for each of several pictures of the pattern in the camera's housing.

        The pattern shows 0 on a scale of 0 to 1, so each reading is an error. Returns None if the
        camera gives no picture.
        """
        if self.failed:
            return None
        spread = max(self.noise, _HEALTHY_NOISE)
        return tuple((spread * self._tests.standard_normal(_SHOTS)).tolist())


WINDOW = 10.0  # s over which the distance driven is compared with the planned one
SLOW = 0.6  # share of the planned speed below which something is wrong
_SAMPLE = 0.2  # s between the poses of the planned path that the robot's pose is compared with
_RADIAN = 0.3  # m that a radian counts as in this comparison
NOISY = 0.01  # standard deviation in the test pattern above which the camera is too noisy


class ConnectionWatch:
    """Watch for the connection to the base station: it reports when it is lost and restored.

    It holds the number of replies in a row that were missed.
    """

    name = "connection"
    period = 0.5

    def __init__(self, network: RadioNetwork, missed: int = 4) -> None:
        """`missed`: the number of missing replies in a row from which the connection is lost."""
        self._network = network
        self._limit = missed
        self._missed = 0

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:  # noqa: ARG002
        lost = bool(reported) and reported[-1].kind is EventKind.CONNECTION_LOST
        self._missed = self._limit if lost else 0

    def can_skip_updates(self, lowest_charge: float, highest_charge: float) -> bool:  # noqa: ARG002
        """Return True if the network has no shadows and the last reply has arrived."""
        return not self._network.shadows and not self._missed

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        here = (pose.x, pose.y, pose.z)
        if not self._network.is_connected(pose):
            self._missed += 1
            if self._missed == self._limit:
                silent = self._limit * self.period
                detail = Message("no answer for {silent:g} s", silent=silent)
                return (Detection(EventKind.CONNECTION_LOST, detail, noticed_from=here),)
            return ()
        lost, self._missed = self._missed >= self._limit, 0
        if lost:
            detail = Message("the base station answers")
            return (Detection(EventKind.CONNECTION_RESTORED, detail, noticed_from=here),)
        return ()


class EmergencyStopWatch:
    """Watch for the circuit of the emergency stop: it reports when someone presses the stop.

    It holds the state of the circuit at the last update.
    """

    name = "emergency stop"
    period = 0.1

    def __init__(self, drive: Powertrain) -> None:
        self._drive = drive
        self._pressed = False

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:  # noqa: ARG002
        self._pressed = bool(reported) and self._drive.stop_pressed

    def can_skip_updates(self, lowest_charge: float, highest_charge: float) -> bool:  # noqa: ARG002
        """Return True if the circuit has not changed since the last update."""
        return self._pressed == self._drive.stop_pressed

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        was_pressed, self._pressed = self._pressed, self._drive.stop_pressed
        if self._pressed and not was_pressed:
            return (
                Detection(
                    EventKind.EMERGENCY_STOP, Message("someone has pressed the emergency stop")
                ),
            )
        return ()


class DriveWatch:
    """Watch for the speed of the drive, compared with the planned one.

    It reports a drive that makes less than the share `SLOW` of the planned speed. It holds the
    planned path, and the robot's progress along it over the last `WINDOW` seconds.
    """

    name = "drive"
    period = 1.0

    def __init__(self, drive: Powertrain, robot: RobotSpec) -> None:
        self._drive = drive
        self._robot = robot
        self._planned: tuple[Path, float | None] | None = None
        self._planned_poses = np.empty((0, 4))  # see `_sample_poses`
        self._index = 0
        self._held = 0
        self._progress: deque[tuple[float, float]] = deque()
        self._reported = False

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:  # noqa: ARG002
        self._reported = bool(reported)  # until the robot is seen to be fast enough again

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:
        planned = self._drive.path_and_velocity
        if planned is None:
            return ()
        if planned is not self._planned:
            self._planned, self._index = planned, 0
            self._planned_poses = _sample_poses(*planned, self._robot)
            self._progress.clear()
        self._index = self._nearest(pose)
        if self._drive.held_steps != self._held:
            # Brakes say nothing about the drive: measure the speed anew, but keep the position.
            self._held = self._drive.held_steps
            self._progress.clear()
        self._progress.append((now, self._index * _SAMPLE))
        while now - self._progress[0][0] > WINDOW + 1e-6:
            self._progress.popleft()
        since, start = self._progress[0]
        if now - since < WINDOW - 1e-6 or self._index >= len(self._planned_poses) - 1:
            return ()
        share = (self._progress[-1][1] - start) / (now - since)
        if share >= SLOW:
            self._reported = False
            return ()
        if self._reported:
            return ()
        self._reported = True
        detail = Message("the drive makes {share:.0%} of the planned speed", share=share)
        here = (pose.x, pose.y, pose.z)
        return (Detection(EventKind.DYSFUNCTION, detail, noticed_from=here),)

    def _nearest(self, pose: BodyPose) -> int:
        """Return the index of the planned pose nearest to `pose`.

        The search begins at the index of the previous update, and ends where twice the planned
        speed would have led since then.
        """
        nearest, least = self._index, math.inf
        last = self._index + round(2 * self.period / _SAMPLE)
        rows = self._planned_poses[self._index : last + 1].tolist()
        for number, (x, y, z, yaw) in enumerate(rows, start=self._index):
            dx, dy, dz = x - pose.x, y - pose.y, z - pose.z
            turn_distance = _RADIAN * ((yaw - pose.yaw + math.pi) % math.tau) - _RADIAN * math.pi
            distance = dx * dx + dy * dy + dz * dz + turn_distance * turn_distance
            if distance < least:
                nearest, least = number, distance
        return nearest


class CameraWatch:
    """Watch for the camera, by pictures of a test pattern.

    It holds whether the previous test failed, and reports only the first of consecutive failures.
    """

    name = "camera"
    period = 5.0

    def __init__(self, sensor: SensorWithFaults) -> None:
        self._sensor = sensor
        self._reported = False

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:  # noqa: ARG002
        self._reported = bool(reported)  # if the camera works again, the first picture shows it

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        pattern = self._sensor.measure_test_pattern_errors()
        spread = 0.0 if pattern is None else math.hypot(*pattern) / math.sqrt(len(pattern))
        was_reported, self._reported = self._reported, pattern is None or spread > NOISY
        if not self._reported or was_reported:
            return ()
        detail = (
            Message("the camera gives no picture")
            if pattern is None
            else Message(
                "the camera's picture of the test pattern is off by {spread:.1%} of the scale",
                spread=spread,
            )
        )
        return (Detection(EventKind.DYSFUNCTION, detail),)


def onboard_watches(
    robot: RobotSpec,
    battery: Battery,
    network: RadioNetwork,
    drive: Powertrain,
    sensor: SensorWithFaults,
    low_battery: float | None = None,
) -> tuple[Watch, ...]:
    """Return all watches for the robot itself, for one run.

    `low_battery` is the charge, 0 to 1, below which the battery is low; None means `LOW`.
    """
    return (
        EmergencyStopWatch(drive),
        BatteryWatch(battery, LOW if low_battery is None else low_battery),
        ConnectionWatch(network),
        DriveWatch(drive, robot),
        CameraWatch(sensor),
    )


def _sample_poses(path: Path, velocity: float | None, robot: RobotSpec) -> NDArray[np.float64]:
    """Return x, y, z (m) and yaw (rad) every _SAMPLE s on the path as planned, shape (n, 4).

    `velocity` (m/s) is the planned speed on the flat; None means the robot's own speeds. The last
    row is the end of the path.
    """
    rows: list[NDArray[np.float64]] = []
    first = 0.0
    for motion in path.motions:
        duration = motion.duration(robot, velocity)
        max_samples = 1 + math.ceil(max(0.0, duration - first) / _SAMPLE)
        times = [*accumulate(repeat(_SAMPLE, max_samples), initial=first)]
        samples_within = bisect_left(times, duration)
        x, y, z, yaw = motion.coordinates_at(np.array(times[:samples_within]) / duration)
        rows.append(np.column_stack([x, y, z, wrap(yaw)]))
        first = times[samples_within] - duration
    end = path.end
    return np.concatenate([*rows, [(end.x, end.y, end.z, end.yaw)]])
