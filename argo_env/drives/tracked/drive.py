"""Tracked drive: the robot follows its path on its tracks, with masses and forces.

The drive compares commands and motion to detect that the robot slips, is stuck or tips over. A
stuck robot gets free by backing off, turning straight, and continuing with the flippers at another
angle.
"""

import math
from collections import deque
from dataclasses import dataclass

from argo_compiler.base.message import Message
from argo_env.closing import NonCopyable
from argo_env.drives.drive import DriveStatus, Incident, Trouble
from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.body import TIME_STEP, TrackedBody
from argo_env.drives.tracked.flippers import CAREFUL_SPEED, Flight, Flippers, measure_flight
from argo_env.drives.tracked.follower import Follower
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.world.world import Touch, World

ATTEMPTS = 3
ANGLE_DURATION = 3.0  # s for which the flippers keep the angle of a recovery after it
_ANGLES = tuple(math.radians(a) for a in (30.0, -10.0, 45.0))  # of the flippers, attempt by attempt
_BACK = 0.12  # m/s
_BACK_TIME = 2.0  # s
_ASIDE = 0.10  # m/s
_ASIDE_TIME = 1.2  # s
_TURN = 0.3  # rad/s
_LEVEL = math.radians(8.0)  # pitch up to which a recovery turns the robot straight


@dataclass(frozen=True)
class RecoveryPhase:
    """Phase of a recovery: commands for some time."""

    duration: float
    """s"""
    speed: float
    """m/s"""
    turn_rate: float | None
    """rad/s; None turns towards the heading of the motion"""
    flipper: float
    """rad"""


def recovery_phases(
    motion: Motion, attempts_before: int, pitch: float
) -> tuple[RecoveryPhase, ...]:
    """Return the phases of the next attempt to free a robot that is stuck on `motion`.

    `pitch` is the robot's (rad): on a slope it only backs off.
    """
    angle = _ANGLES[attempts_before % len(_ANGLES)]
    if motion.turn:
        side = 1 if attempts_before % 2 == 0 else -1
        return (
            RecoveryPhase(1.0, 0.0, -math.copysign(_TURN, motion.turn), angle),
            RecoveryPhase(_ASIDE_TIME, side * _ASIDE, 0.0, angle),
        )
    back = RecoveryPhase(_BACK_TIME, -motion.gear * _BACK, 0.0, angle)
    if abs(pitch) > _LEVEL:
        return (back,)
    return (back, RecoveryPhase(2.0, 0.0, None, angle))


# While a robot tips over an edge, it makes only half the commanded distance for 3 s.
WINDOW = 5.0  # s over which motion and commands are compared
_LEAST_DISTANCE = 0.12  # m commanded within the window; below it, distances are not judged
_LEAST_TURN = math.radians(15.0)
_STUCK = 0.2  # share of the commanded motion, below which the robot is stuck
_SLIPPING = 0.5  # share of the commanded motion, below which the robot slips
_MOST_ROLL = math.radians(35.0)
_MOST_PITCH = math.radians(60.0)  # front down; flights are up to 45°
_LEAST_PITCH = math.radians(-40.0)


@dataclass(frozen=True)
class _Sample:
    pose: BodyPose
    distance: float
    """m commanded since the previous sample"""
    turn: float
    """rad commanded since the previous sample"""


class StallDetector:
    """Detector of a robot that does not move as commanded.

    It holds the poses and commands of the last WINDOW seconds.
    """

    def __init__(self, period: float) -> None:
        """`period` is the time between calls of `update`, in s."""
        self._period = period
        self._samples: deque[_Sample] = deque(maxlen=round(WINDOW / period))

    def clear(self) -> None:
        """Discard the samples, for example when a phase of a recovery begins or ends."""
        self._samples.clear()

    def update(
        self, pose: BodyPose, roll: float, speed: float, turn_rate: float
    ) -> Incident | None:
        """Add a sample, and return the fault of the drive that the last WINDOW s show, or None.

        `roll` (rad) is the robot's; `speed` (m/s) and `turn_rate` (rad/s) are the commands since
        the last call.
        """
        if abs(roll) > _MOST_ROLL or not _LEAST_PITCH < pose.pitch < _MOST_PITCH:
            detail = Message(
                "pitch {degrees:.0f}°, roll {degrees_2:.0f}°",
                degrees=math.degrees(pose.pitch),
                degrees_2=math.degrees(roll),
            )
            return Incident(Trouble.TIPPED, detail, pose)
        self._samples.append(
            _Sample(pose, abs(speed) * self._period, abs(turn_rate) * self._period)
        )
        if len(self._samples) < (self._samples.maxlen or 0):
            return None
        before = self._samples[0].pose
        distance = math.fsum(s.distance for s in self._samples)
        turn = math.fsum(s.turn for s in self._samples)
        went = math.dist((pose.x, pose.y, pose.z), (before.x, before.y, before.z))
        turned = abs(wrap(pose.yaw - before.yaw))
        share = max(
            went / distance if distance > _LEAST_DISTANCE else 0.0,
            turned / turn if turn > _LEAST_TURN else 0.0,
        )
        if (distance <= _LEAST_DISTANCE and turn <= _LEAST_TURN) or share >= _SLIPPING:
            return None
        detail = (
            Message("made {went:.2f} m of {distance:.2f} m commanded", went=went, distance=distance)
            if distance > _LEAST_DISTANCE
            else Message(
                "turned {degrees:.0f}° of {degrees_2:.0f}° commanded",
                degrees=math.degrees(turned),
                degrees_2=math.degrees(turn),
            )
        )
        return Incident(Trouble.STUCK if share < _STUCK else Trouble.SLIPPING, detail, pose)


_CONTROL = 0.05  # s between commands
_AT_REST = 0.01  # m/s, and rad/s about the vertical, below which the robot is at rest
_STOPPING = 3.0  # s after which a stopping robot counts as at rest
_FREE = 0.3  # m from where it was stuck, beyond which attempts are counted anew
_ALIGNING = 1.5  # 1/s
_MOST_ALIGNING = 0.3  # rad/s


class TrackedDrive(NonCopyable):
    """Drive that follows paths with the tracked body.

    It holds the body, the path, a running recovery and the faults since the robot was placed.
    """

    name = "tracked"
    time_step = 0.1

    def __init__(
        self,
        world: World,
        robot: RobotSpec,
        traction: Traction | None = None,
        mass_scale: float = 1.0,
    ) -> None:
        self.body = TrackedBody(world, robot, traction, mass_scale)
        self.incidents: list[Incident] = []
        """faults since the robot was placed, whether or not the robot could continue"""
        self._world = world
        self._robot = robot
        self._follower: Follower | None = None
        self._flippers = Flippers()
        self._flight: tuple[Motion, Flight] | None = None
        self._stall_detector = StallDetector(self.time_step)
        self._phases: deque[RecoveryPhase] = deque()
        self._phase_left = 0.0
        self._attempts = 0
        self._stuck_at: BodyPose | None = None
        self._angle_time_left = 0.0  # s for which they keep `_phase_angle`
        self._stopping_time = 0.0  # s since the robot was commanded to stop
        self._failure: str | None = None

    @property
    def pose(self) -> BodyPose:
        return self.body.pose

    @property
    def failure(self) -> str | None:
        return self._failure

    @property
    def motion(self) -> Motion | None:
        """Motion of the path that is under way; None without a path."""
        return self._follower.motion if self._follower else None

    def place_robot(self, pose: BodyPose) -> None:
        """Put the robot at the pose, at rest on the ground; discard the path and the incidents."""
        self._clear()
        self.incidents.clear()
        self._flippers = Flippers()
        self.body.reset(pose, self._flippers.angle)
        self._world.set_drive_touches(())

    def follow(self, path: Path, velocity: float | None) -> None:
        """Start to follow `path` at `velocity` (m/s) on the flat, or at the robot's own speeds."""
        self._clear()
        self._follower = Follower(path, self._robot, velocity, self.body.turn_center_x)

    def halt(self) -> None:
        """Stop the tracks, and discard the path; the robot comes to rest in the next steps."""
        failure = self._failure
        self._clear()
        self._failure = failure
        self._stop()

    def step(self) -> DriveStatus:
        """Continue for one time step, in which the tracks get new commands twice."""
        for _ in range(round(self.time_step / _CONTROL)):
            self._control()
            self.body.advance(round(_CONTROL / TIME_STEP))
        touches = self.body.pop_deepest_touches()
        self._world.set_drive_touches(touches)
        if self._follower is not None and self._failure is None:
            self._check_motion(touches)
        if self._failure is not None and self._follower is not None:
            self._follower = None
            self._stop()
            return DriveStatus.FAILED
        if self._follower is not None or not self._at_rest():
            return DriveStatus.MOVING
        return DriveStatus.ARRIVED

    def _control(self) -> None:
        if self._follower is None:
            self._stopping_time += _CONTROL
            self._stop()
            return
        pose = self.body.pose
        if self._phases:
            self._recover(pose)
            return
        step = self._follower.step(pose, self.body.velocity)
        if step.motion is None:
            self._follower = None
            self._stopping_time = 0.0
            self._stop()
            return
        careful = self._flippers.step_and_should_go_slowly(
            self._flight_for(step.motion), step.motion, pose, _CONTROL
        )
        speed = max(-CAREFUL_SPEED, min(CAREFUL_SPEED, step.speed)) if careful else step.speed
        angle = self._flippers.angle
        if self._angle_time_left > 0.0:
            self._angle_time_left -= _CONTROL
            angle = self._phase_angle
        self._command(speed, step.turn_rate, angle)

    def _command(self, speed: float, turn_rate: float, angle: float) -> None:
        self.body.command(speed, turn_rate, angle)
        self._commanded = speed, turn_rate

    def _stop(self) -> None:
        self.body.command(0.0, 0.0, self._flippers.angle)

    def _flight_for(self, motion: Motion) -> Flight | None:
        """Return the flight of stairs of a motion; None for a motion that is not on stairs.

        It is found once for each motion.
        """
        if not motion.on_stairs:
            return None
        if self._flight is None or self._flight[0] is not motion:
            self._flight = motion, measure_flight(self._world, motion, self._robot.track_gauge)
        return self._flight[1]

    def _check_motion(self, touches: tuple[Touch, ...]) -> None:
        """Record a present fault of the drive; start a recovery or fail if the robot is stuck.

        `touches` are for the message: what the robot is stuck against.
        """
        assert self._follower is not None
        incident = self._stall_detector.update(self.body.pose, self.body.roll, *self._commanded)
        if incident is None:
            return
        last = self.incidents[-1] if self.incidents else None
        if (
            last is None
            or last.trouble != incident.trouble
            or _distance_apart(last, incident) > _FREE
        ):
            self.incidents.append(incident)
        if incident.trouble is Trouble.SLIPPING:
            return
        at = f"({incident.pose.x:.2f}, {incident.pose.y:.2f}, {incident.pose.z:.2f})"
        if incident.trouble is Trouble.TIPPED:
            self._failure = Message(
                "the robot tipped over at {at}: {detail}", at=at, detail=incident.detail
            )
            return
        if self._stuck_at is None or _distance(self._stuck_at, incident.pose) > _FREE:
            self._attempts, self._stuck_at = 0, incident.pose
        against = ", ".join(sorted({touch.element for touch in touches}))
        if self._attempts >= ATTEMPTS:
            self._failure = Message(
                "the robot is stuck at {at}{part}: {detail} within {window:.0f} s, and "
                "backing off {attempts} times did not help",
                at=at,
                part=Message(" against {against}", against=against) if against else "",
                detail=incident.detail,
                window=WINDOW,
                attempts=ATTEMPTS,
            )
            return
        motion = self._follower.motion
        if motion is not None:
            self._phases.extend(recovery_phases(motion, self._attempts, incident.pose.pitch))
            self._phase_left = self._phases[0].duration
            self._attempts += 1
            self._stall_detector.clear()

    def _recover(self, pose: BodyPose) -> None:
        phase = self._phases[0]
        motion = self._follower.motion if self._follower else None
        rate = phase.turn_rate
        if rate is None:
            error = wrap(motion.start.yaw - pose.yaw) if motion else 0.0
            rate = max(-_MOST_ALIGNING, min(_MOST_ALIGNING, _ALIGNING * error))
        self._command(phase.speed, rate, phase.flipper)
        self._phase_left -= _CONTROL
        if self._phase_left <= 1e-9:
            self._phases.popleft()
            self._stall_detector.clear()
            if self._phases:
                self._phase_left = self._phases[0].duration
            else:
                self._angle_time_left, self._phase_angle = ANGLE_DURATION, phase.flipper

    def _at_rest(self) -> bool:
        speed, turn_rate = self.body.velocity
        return (
            abs(speed) < _AT_REST and abs(turn_rate) < _AT_REST
        ) or self._stopping_time > _STOPPING

    def _clear(self) -> None:
        self._follower = None
        self._failure = None
        self._phases.clear()
        self._stall_detector.clear()
        self._attempts = 0
        self._stuck_at = None
        self._angle_time_left = 0.0
        self._phase_angle = 0.0
        self._stopping_time = 0.0
        self._commanded = 0.0, 0.0


def _distance(a: BodyPose, b: BodyPose) -> float:
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))


def _distance_apart(a: Incident, b: Incident) -> float:
    return _distance(a.pose, b.pose)
