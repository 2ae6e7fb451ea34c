"""Body of the robot on its tracks: masses, contacts and belts, without any path to follow."""

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from argo_env.drives.drive import FLIPPER_RATE
from argo_env.drives.tracked.belts import Belts, Traction
from argo_env.drives.tracked.lumped import lump_links
from argo_env.drives.tracked.terrain import ContactLog, Terrain
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec, robot_folder
from argo_env.site.shapes import Vector
from argo_env.world.pybullet_client import Connection, pybullet
from argo_env.world.world import Touch, World

TIME_STEP = 1 / 240  # s
GRAVITY = 9.81  # m/s²
FLIPPER_LIMITS = (math.radians(-30.0), math.radians(50.0))  # rad, up is positive
FLIPPER_TORQUE = 150.0  # N m, each (assumption: two flippers can lift one end of the robot)
ACCELERATION = 1.0  # m/s², of the belts
SWING = 3.0  # rad/s², of the turning rate
_YAW_GAIN = 4.0  # 1/s: belts that slip in a turn are sped up until the turning rate is met
_YAW_REACH = 1.5  # share of the commanded turning rate that the integral may add at most
_ITERATIONS = 6  # of the contact solver
_DROP = 0.002  # m above the ground, from which the robot is put down
_SETTLING = 60  # steps until the robot is at rest
FLIPPERS = ("left_flipper_joint", "right_flipper_joint")
_FAR = (0.0, 0.0, 1000.0)  # m, where nothing is


@dataclass(frozen=True)
class Snapshot:
    """State of a body at one time, which can be restored."""

    state: int
    """number that PyBullet gave the state"""
    memory: tuple[Any, ...]


@dataclass(frozen=True)
class Command:
    """Command to the tracks and flippers."""

    speed: float = 0.0
    """m/s forwards"""
    turn_rate: float = 0.0
    """rad/s counter-clockwise"""
    flipper: float = 0.0
    """rad, tips up"""


class TrackedBody(Connection):
    """Body of the robot among the solids of a world. Holds its own physics server and the belts.

    Callers that make drives close the world only; the server ends with this object, or when closed.

    The server has the same solids as the world and nothing else that could move, so that steps are
    cheap and a snapshot is complete. The world gets the robot's pose after each `advance`.
    """

    contact_breaking = 0.003
    """distance in m; gives fewer contacts without a force than PyBullet's 0.02"""

    def __init__(
        self,
        world: World,
        robot: RobotSpec,
        traction: Traction | None = None,
        mass_scale: float = 1.0,
    ) -> None:
        """`mass_scale` multiplies the masses of the robot's model."""
        super().__init__()
        # Both servers must find the same contacts.
        world.contact_breaking = self.contact_breaking
        self._world = world
        self._robot = robot
        self._terrain = Terrain(world)
        with tempfile.TemporaryDirectory() as folder:
            self._ground = self._load(self._terrain.write_urdf(folder), fixed=True)
            model = Path(folder) / "robot.urdf"
            text = lump_links(robot_folder() / robot.urdf, robot.arm_stowed, FLIPPERS, mass_scale)
            model.write_text(text, encoding="utf-8")
            self._body: int = pybullet.loadURDF(
                str(model),
                flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=self._client,
            )
        self._grounds = self._links(self._ground)
        self._names = self._links(self._body)
        joints = {joint: k for k, (joint, _) in self._parts(self._body).items()}
        self._flippers = [joints[name] for name in FLIPPERS]
        self._prepare()
        self.mass = math.fsum(self._dynamics(link)[0] for link in self._names)
        """mass of the robot in kg"""
        offset: Vector = self._dynamics(-1)[3]
        self._belts = Belts(offset, traction or Traction(), self.mass * GRAVITY)
        self._walking = next(k for k, v in self._grounds.items() if v == self._terrain.walking)
        self._center = offset  # of mass of the base, in its frame
        self._pivot = self._mean_x()
        self._command = Command()
        self._speed, self._turn, self._push = 0.0, 0.0, 0.0
        # Contacts of the last step, stored here since PyBullet does not restore them.
        self._contacts: list[tuple[Any, ...]] = []
        self._contact_log = ContactLog(self._terrain, self._grounds, self._names)
        self._drive_flippers()
        self._home = pybullet.saveState(physicsClientId=self._client)

    def reset(self, pose: BodyPose, flipper: float = 0.0) -> None:
        """Put the robot down at the pose, at rest, its arm stowed; discard the previous state."""
        self._return_to(self._home)
        self._belts.bends = [0.0] * len(self._belts.bends)
        self._speed, self._turn, self._push = 0.0, 0.0, 0.0
        self._contacts = []
        self._contact_log.pop_deepest_touches()
        for k in self._flippers:
            pybullet.resetJointState(self._body, k, flipper, physicsClientId=self._client)
        self.command(0.0, 0.0, flipper)
        up = _DROP * math.cos(pose.pitch)
        self._place(self._body, (pose.x, pose.y, pose.z + up), (0.0, pose.pitch, pose.yaw))
        self.advance(_SETTLING)

    def command(self, speed: float, turn_rate: float, flipper: float) -> None:
        """Set the command that the tracks and flippers follow from now on.

        `speed` is in m/s forwards, `turn_rate` in rad/s counter-clockwise, `flipper` is the angle
        of the flippers in rad, tips up; the command keeps within the flippers' limits.
        """
        flipper = min(FLIPPER_LIMITS[1], max(FLIPPER_LIMITS[0], flipper))
        self._command = Command(speed, turn_rate, flipper)
        self._drive_flippers()

    def advance(self, steps: int) -> None:
        """Simulate `steps` steps of TIME_STEP each."""
        client, body = self._client, self._body
        for _ in range(steps):
            position, turned = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
            velocity, spin = pybullet.getBaseVelocity(body, physicsClientId=client)
            axes = pybullet.getMatrixFromQuaternion(turned)
            speeds = self._belt_speeds(spin[0] * axes[2] + spin[1] * axes[5] + spin[2] * axes[8])
            (fx, fy, fz, tx, ty, tz), other_contacts = self._belts.wrench_and_other_contacts(
                self._contacts, self._walking, speeds, position, axes, velocity, spin, TIME_STEP
            )
            pybullet.applyExternalForce(
                body, -1, (fx, fy, fz), position, pybullet.WORLD_FRAME, physicsClientId=client
            )
            pybullet.applyExternalTorque(
                body, -1, (tx, ty, tz), pybullet.WORLD_FRAME, physicsClientId=client
            )
            if other_contacts:
                self._contact_log.add_strong_contacts(
                    other_contacts, self._origin(position, axes), axes
                )
            self._simulate()
            self._contacts = pybullet.getContactPoints(bodyA=body, physicsClientId=client)
        self._show()

    @property
    def pose(self) -> BodyPose:
        position, axes = self._frame()
        return BodyPose(
            *position,
            math.atan2(axes[3], axes[0]),
            math.atan2(-axes[6], math.hypot(axes[0], axes[3])),
            math.atan2(axes[7], axes[8]),
        )

    @property
    def turn_center_x(self) -> float:
        """Position in m on the robot's x axis of the point about which the robot turns in place.

        It is below the robot's centre of mass.
        """
        return self._pivot

    @property
    def roll(self) -> float:
        """Roll of the robot in rad, positive with the left side up."""
        return self.pose.roll

    @property
    def velocity(self) -> tuple[float, float]:
        """Velocity in m/s along the robot's x axis, and in rad/s about its z axis."""
        velocity, spin = pybullet.getBaseVelocity(self._body, physicsClientId=self._client)
        _, axes = self._frame()
        ahead = math.fsum(velocity[k] * axes[3 * k] for k in range(3))
        return ahead, math.fsum(spin[k] * axes[3 * k + 2] for k in range(3))

    @property
    def flipper(self) -> float:
        """Mean angle of both flippers in rad, tips up."""
        states = pybullet.getJointStates(self._body, self._flippers, physicsClientId=self._client)
        return float(states[0][0] + states[1][0]) / 2

    @property
    def belt_speeds(self) -> tuple[float, float]:
        """Present speeds of the left and the right belts in m/s; they lag behind the command."""
        half = self._robot.track_gauge / 2 * (self._turn + self._push)
        return self._speed - half, self._speed + half

    def pop_deepest_touches(self) -> tuple[Touch, ...]:
        """Return the contacts with what the robot must not touch, and discard them."""
        return self._contact_log.pop_deepest_touches()

    def snapshot(self) -> Snapshot:
        """Return the present state; call `release` when it is no longer needed.

        PyBullet does not restore its cache of contacts. So this method clears that cache, too: the
        simulation continues after taking a snapshot exactly as after `restore`.
        """
        state = pybullet.saveState(physicsClientId=self._client)
        self._return_to(state)
        memory = (
            self._command, self._speed, self._turn, self._push,
            tuple(self._belts.bends), tuple(self._contacts), self._contact_log.deepest_touches(),
        )  # fmt: skip
        return Snapshot(state, memory)

    def restore(self, snapshot: Snapshot) -> None:
        """Restore the state of a snapshot; the simulation then repeats itself bit by bit."""
        self._return_to(snapshot.state)
        (
            self._command, self._speed, self._turn, self._push, bends, contacts, touches
        ) = snapshot.memory  # fmt: skip
        self._belts.bends, self._contacts = list(bends), list(contacts)
        self._contact_log.restore(touches)
        # PyBullet does not restore the targets of motors.
        self._drive_flippers()
        self._show()

    def release(self, snapshot: Snapshot) -> None:
        """Release the memory of a snapshot."""
        pybullet.removeState(snapshot.state, physicsClientId=self._client)

    def _prepare(self) -> None:
        client = self._client
        pybullet.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=TIME_STEP,
            numSolverIterations=_ITERATIONS,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
            physicsClientId=client,
        )
        for link in self._names:
            # Belts push along normals only; their traction is added as a force.
            pybullet.changeDynamics(
                self._body,
                link,
                lateralFriction=0.0,
                linearDamping=0.0,
                angularDamping=0.0,
                activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
                physicsClientId=client,
            )
        self._place(self._body, _FAR, (0.0, 0.0, 0.0))

    def _return_to(self, state: int) -> None:
        """Restore a saved state of PyBullet, by its id, with an empty cache of contacts."""
        self._place(self._body, _FAR, (0.0, 0.0, 0.0))
        self._detect()
        pybullet.restoreState(state, physicsClientId=self._client)
        self._drive_flippers()

    def _mean_x(self) -> float:
        """Return the x coordinate (m) of the robot's centre of mass in the base's frame.

        The robot must stand level at `_FAR`.
        """
        total = self._dynamics(-1)[0] * self._center[0]
        for link in self._flippers:
            state = pybullet.getLinkState(self._body, link, physicsClientId=self._client)
            total += self._dynamics(link)[0] * (state[0][0] - _FAR[0])
        return float(total / self.mass)

    def _drive_flippers(self) -> None:
        for k in self._flippers:
            pybullet.setJointMotorControl2(
                self._body,
                k,
                pybullet.POSITION_CONTROL,
                targetPosition=self._command.flipper,
                force=FLIPPER_TORQUE,
                maxVelocity=FLIPPER_RATE,
                physicsClientId=self._client,
            )

    def _belt_speeds(self, yaw_rate: float) -> tuple[float, float]:
        """Move the belts' speeds towards the command for one step; return left and right in m/s.

        `yaw_rate` (rad/s) is the body's actual turn rate.
        """
        wanted = self._command
        most = ACCELERATION * TIME_STEP
        self._speed += min(most, max(-most, wanted.speed - self._speed))
        most = SWING * TIME_STEP
        self._turn += min(most, max(-most, wanted.turn_rate - self._turn))
        reach = _YAW_REACH * abs(self._turn)
        push = self._push + _YAW_GAIN * TIME_STEP * (self._turn - yaw_rate)
        self._push = min(reach, max(-reach, push))
        half = self._robot.track_gauge / 2 * (self._turn + self._push)
        return self._speed - half, self._speed + half

    def _frame(self) -> tuple[Vector, tuple[float, ...]]:
        """Return the origin (m) of the base's frame, and the base's rotation matrix row by row."""
        position, turned = pybullet.getBasePositionAndOrientation(
            self._body, physicsClientId=self._client
        )
        axes = pybullet.getMatrixFromQuaternion(turned)
        return self._origin(position, axes), axes

    def _origin(self, position: Vector, m: tuple[float, ...]) -> Vector:
        """Return the origin (m) of the base's frame if the base's centre of mass is at `position`.

        `m` is the base's rotation matrix row by row.
        """
        (x, y, z), (a, b, c) = position, self._center
        return (
            x - m[0] * a - m[1] * b - m[2] * c,
            y - m[3] * a - m[4] * b - m[5] * c,
            z - m[6] * a - m[7] * b - m[8] * c,
        )

    def _show(self) -> None:
        self._world.place_robot(self.pose)
        angle = self.flipper
        self._world.set_joints(dict.fromkeys(FLIPPERS, angle))

    def _dynamics(self, link: int) -> tuple[Any, ...]:
        info: tuple[Any, ...] = pybullet.getDynamicsInfo(
            self._body, link, physicsClientId=self._client
        )
        return info

    def _links(self, body: int) -> dict[int, str]:
        base = pybullet.getBodyInfo(body, physicsClientId=self._client)[0].decode()
        return {-1: base} | {k: link for k, (_, link) in self._parts(body).items()}
