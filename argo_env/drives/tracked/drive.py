"""The tracked drive: the robot follows its path by its tracks, with masses and forces."""

import math
from collections import deque

from argo_env.closing import NonCopyable
from argo_env.drives.drive import DriveStatus, Incident, Trouble
from argo_env.drives.tracked.belts import Traction
from argo_env.drives.tracked.body import TIME_STEP, TrackedBody
from argo_env.drives.tracked.flippers import CAREFUL, Flight, Flippers, find_flight
from argo_env.drives.tracked.follower import Follower
from argo_env.drives.tracked.recovery import ATTEMPTS, GOING_ON, RecoveryPhase, phases
from argo_env.drives.tracked.stall_watch import WINDOW, StallWatch
from argo_env.navigation.path import Motion, Path, wrap
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.world.world import Touch, World

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
        self._world.feel(())

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
        self._world.feel(touches)
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
