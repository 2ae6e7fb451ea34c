"""The tracked drive: the robot follows its path by its tracks, with masses and forces.

That it slips, is stuck or tips over shows in what it commands and how it moves; it gets free again
by backing off, turning straight, and going on with the flippers at another angle.
"""

import math
from collections import deque
from dataclasses import dataclass

from argo_env.closing import NonCopyable
from argo_env.drives.drive import DriveStatus, Incident, Trouble
from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.body import TIME_STEP, TrackedBody
from argo_env.drives.tracked.flippers import CAREFUL, Flight, Flippers, find_flight
from argo_env.drives.tracked.follower import Follower
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.world.world import Touch, World

ATTEMPTS = 3
GOING_ON = 3.0  # s for which the flippers keep the other angle
_ANGLES = tuple(math.radians(a) for a in (30.0, -10.0, 45.0))  # of the flippers, attempt by attempt
_BACK = 0.12  # m/s
_BACK_TIME = 2.0  # s
_ASIDE = 0.10  # m/s
_ASIDE_TIME = 1.2  # s
_TURN = 0.3  # rad/s
_LEVEL = math.radians(8.0)  # of pitch, up to which it turns straight


@dataclass(frozen=True)
class RecoveryPhase:
    """One thing that is done for a while."""

    duration: float
    """s"""
    speed: float
    """m/s"""
    turn_rate: float | None
    """rad/s; None turns towards the heading of the motion"""
    flipper: float
    """rad"""


def phases(motion: Motion, attempt: int, pitch: float) -> tuple[RecoveryPhase, ...]:
    """What to do for the attempt (0, 1, ...) to get free from where `motion` is stuck."""
    angle = _ANGLES[attempt % len(_ANGLES)]
    if motion.turn:
        side = 1 if attempt % 2 == 0 else -1
        return (
            RecoveryPhase(1.0, 0.0, -math.copysign(_TURN, motion.turn), angle),
            RecoveryPhase(_ASIDE_TIME, side * _ASIDE, 0.0, angle),
        )
    back = RecoveryPhase(_BACK_TIME, -motion.gear * _BACK, 0.0, angle)
    if abs(pitch) > _LEVEL:
        return (back,)
    return (back, RecoveryPhase(2.0, 0.0, None, angle))


WINDOW = 5.0  # s that are looked back; as it tips over an edge, a robot loses half its way for 3 s
_LEAST_WAY = 0.12  # m commanded within the window, from which a way is judged
_LEAST_TURN = math.radians(15.0)
_STUCK = 0.2  # share of what was commanded, under which the robot is stuck
_SLIPPING = 0.5  # the same, under which it slips
_MOST_ROLL = math.radians(35.0)
_MOST_PITCH = math.radians(60.0)  # front down; flights are up to 45°
_LEAST_PITCH = math.radians(-40.0)


@dataclass(frozen=True)
class _Sample:
    pose: BodyPose
    way: float
    """m commanded since the one before"""
    turn: float
    """rad, the same"""


class StallWatch:
    """Looks back over the last seconds. Holds where the robot was and what was commanded."""

    def __init__(self, period: float) -> None:
        """`period` (s) is that between calls of `look`."""
        self._period = period
        self._samples: deque[_Sample] = deque(maxlen=round(WINDOW / period))

    def forget(self) -> None:
        """Begins anew, as after a change of mind."""
        self._samples.clear()

    def look(self, pose: BodyPose, roll: float, speed: float, turn_rate: float) -> Incident | None:
        """What is wrong now, if anything is; `speed` (m/s) and `turn_rate` (rad/s) are what was
        commanded since the last call."""
        if abs(roll) > _MOST_ROLL or not _LEAST_PITCH < pose.pitch < _MOST_PITCH:
            detail = f"pitch {math.degrees(pose.pitch):.0f}°, roll {math.degrees(roll):.0f}°"
            return Incident(Trouble.TIPPED, detail, pose)
        self._samples.append(
            _Sample(pose, abs(speed) * self._period, abs(turn_rate) * self._period)
        )
        if len(self._samples) < (self._samples.maxlen or 0):
            return None
        before = self._samples[0].pose
        way = sum(s.way for s in self._samples)
        turn = sum(s.turn for s in self._samples)
        went = math.dist((pose.x, pose.y, pose.z), (before.x, before.y, before.z))
        turned = abs(wrap(pose.yaw - before.yaw))
        share = max(
            went / way if way > _LEAST_WAY else 0.0, turned / turn if turn > _LEAST_TURN else 0.0
        )
        if (way <= _LEAST_WAY and turn <= _LEAST_TURN) or share >= _SLIPPING:
            return None
        detail = (
            f"made {went:.2f} m of {way:.2f} m commanded"
            if way > _LEAST_WAY
            else f"turned {math.degrees(turned):.0f}° of {math.degrees(turn):.0f}° commanded"
        )
        return Incident(Trouble.STUCK if share < _STUCK else Trouble.SLIPPING, detail, pose)


_CONTROL = 0.05  # s between commands
_AT_REST = 0.01  # m/s, and rad/s about the vertical
_STOPPING = 3.0  # s after which a robot that should stand counts as standing
_FREE = 0.3  # m beyond where it was stuck, from which attempts count anew
_ALIGNING = 1.5  # 1/s
_MOST_ALIGNING = 0.3  # rad/s


class TrackedDrive(NonCopyable):
    """Follows paths with the tracked body. Holds the body, the path and what went wrong on it."""

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
        """what went wrong since the robot was placed, whether it went on or not"""
        self._world = world
        self._robot = robot
        self._follower: Follower | None = None
        self._flippers = Flippers()
        self._flight: tuple[Motion, Flight] | None = None
        self._watch = StallWatch(self.time_step)
        self._phases: deque[RecoveryPhase] = deque()
        self._phase_left = 0.0
        self._attempts = 0
        self._stuck_at: BodyPose | None = None
        self._other_angle = 0.0  # s for which the flippers keep the angle of the recovery
        self._standing = 0.0  # s since it was to stop
        self._failure: str | None = None

    @property
    def pose(self) -> BodyPose:
        return self.body.pose

    @property
    def failure(self) -> str | None:
        return self._failure

    @property
    def motion(self) -> Motion | None:
        """The motion of the path that is under way; None without a path."""
        return self._follower.motion if self._follower else None

    def place(self, pose: BodyPose) -> None:
        """Puts the robot there, at rest; it settles on the ground within a moment."""
        self._forget()
        self.incidents.clear()
        self._flippers = Flippers()
        self.body.reset(pose, self._flippers.angle)
        self._world.set_drive_touches(())

    def begin(self, path: Path, velocity: float | None) -> None:
        """Sets off along `path` at `velocity` (m/s) on the flat, or at the robot's own speeds."""
        self._forget()
        self._follower = Follower(path, self._robot, velocity, self.body.pivot)

    def halt(self) -> None:
        """Stops the tracks and forgets the path; the steps that follow let it come to rest."""
        failure = self._failure
        self._forget()
        self._failure = failure
        self._stop()

    def step(self) -> DriveStatus:
        """Goes on for one time step, in which the tracks get new commands twice."""
        for _ in range(round(self.time_step / _CONTROL)):
            self._control()
            self.body.advance(round(_CONTROL / TIME_STEP))
        touches = self.body.touches()
        self._world.set_drive_touches(touches)
        if self._follower is not None and self._failure is None:
            self._look(touches)
        if self._failure is not None and self._follower is not None:
            self._follower = None
            self._stop()
            return DriveStatus.FAILED
        if self._follower is not None or not self._at_rest():
            return DriveStatus.MOVING
        return DriveStatus.ARRIVED

    def _control(self) -> None:
        if self._follower is None:
            self._standing += _CONTROL
            self._stop()
            return
        pose = self.body.pose
        if self._phases:
            self._recover(pose)
            return
        step = self._follower.step(pose, self.body.velocity)
        if step.motion is None:
            self._follower = None
            self._standing = 0.0
            self._stop()
            return
        careful = self._flippers.step(self._flight_of(step.motion), step.motion, pose, _CONTROL)
        speed = max(-CAREFUL, min(CAREFUL, step.speed)) if careful else step.speed
        angle = self._flippers.angle
        if self._other_angle > 0.0:
            self._other_angle -= _CONTROL
            angle = self._phase_angle
        self._command(speed, step.turn_rate, angle)

    def _command(self, speed: float, turn_rate: float, angle: float) -> None:
        self.body.command(speed, turn_rate, angle)
        self._commanded = speed, turn_rate

    def _stop(self) -> None:
        self.body.command(0.0, 0.0, self._flippers.angle)

    def _flight_of(self, motion: Motion) -> Flight | None:
        """The flight that a motion goes over; looked at once."""
        if not motion.on_stairs:
            return None
        if self._flight is None or self._flight[0] is not motion:
            self._flight = motion, find_flight(self._world, motion, self._robot.track_gauge)
        return self._flight[1]

    def _look(self, touches: tuple[Touch, ...]) -> None:
        """Notes what is wrong, and decides what to do about it."""
        assert self._follower is not None
        incident = self._watch.look(self.body.pose, self.body.roll, *self._commanded)
        if incident is None:
            return
        last = self.incidents[-1] if self.incidents else None
        if last is None or last.trouble != incident.trouble or _apart(last, incident) > _FREE:
            self.incidents.append(incident)
        if incident.trouble is Trouble.SLIPPING:
            return
        at = f"({incident.pose.x:.2f}, {incident.pose.y:.2f}, {incident.pose.z:.2f})"
        if incident.trouble is Trouble.TIPPED:
            self._failure = f"the robot tipped over at {at}: {incident.detail}"
            return
        if self._stuck_at is None or _distance(self._stuck_at, incident.pose) > _FREE:
            self._attempts, self._stuck_at = 0, incident.pose
        against = ", ".join(sorted({touch.element for touch in touches}))
        if self._attempts >= ATTEMPTS:
            self._failure = (
                f"the robot is stuck at {at}{f' against {against}' if against else ''}: "
                f"{incident.detail} within {WINDOW:.0f} s, and backing off {ATTEMPTS} times did "
                "not help"
            )
            return
        motion = self._follower.motion
        if motion is not None:
            self._phases.extend(phases(motion, self._attempts, incident.pose.pitch))
            self._phase_left = self._phases[0].duration
            self._attempts += 1
            self._watch.forget()

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
            self._watch.forget()
            if self._phases:
                self._phase_left = self._phases[0].duration
            else:
                self._other_angle, self._phase_angle = GOING_ON, phase.flipper

    def _at_rest(self) -> bool:
        speed, turn_rate = self.body.velocity
        return (abs(speed) < _AT_REST and abs(turn_rate) < _AT_REST) or self._standing > _STOPPING

    def _forget(self) -> None:
        self._follower = None
        self._failure = None
        self._phases.clear()
        self._watch.forget()
        self._attempts = 0
        self._stuck_at = None
        self._other_angle = 0.0
        self._phase_angle = 0.0
        self._standing = 0.0
        self._commanded = 0.0, 0.0


def _distance(a: BodyPose, b: BodyPose) -> float:
    return math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))


def _apart(a: Incident, b: Incident) -> float:
    return _distance(a.pose, b.pose)
