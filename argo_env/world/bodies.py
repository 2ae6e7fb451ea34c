"""The bodies of a site, its checkpoints and the robot in PyBullet: what is where, by name."""

import math
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from argo_compiler.catalog import CheckpointKind
from argo_env.files import resources
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec, robot_folder
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.index import ElementIndex
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Solid, Vector, half_extents
from argo_env.site.urdf import to_urdf
from argo_env.world.clearance import Clearance, SolidBounds
from argo_env.world.placement import AS_PLANNED, Placement, displaced
from argo_env.world.pybullet_client import Connection, pybullet

_ROBOT_BIT = 2
SITE_BIT = 1
"""collision filter group of all but the robot"""
STANDING = ("_track", "_flipper")
"""how the names of the links end that the robot stands on"""
_OBJECT = 0.5  # m from the middle of a checkpoint that it reaches at most
_INDICATOR = 0.15  # m that a needle or lever reaches beyond where it is now, at most


class Bodies(Connection):
    """A site with its checkpoints and a robot. Holds a connection, and where everything is.

    Nothing moves by itself here: everything is put where it is to be.
    """

    def __init__(
        self, site: Site, robot: RobotSpec, gui: bool, elements: tuple[Element, ...]
    ) -> None:
        """`elements`: the solids that are really there."""
        super().__init__(gui)
        self.site = site
        self.robot = robot
        self._solids = elements
        self._placements: dict[int, Placement] = {}
        self._pose = BodyPose(0.0, 0.0, 0.0, 0.0)
        self._posture: dict[str, float] = {}
        self._envelope: tuple[SolidBounds, SolidBounds] | None = None  # in this posture
        self._clearance: Clearance | None = None  # of what stands where it stands now
        self._moved = True  # whether anything but the robot has, since collisions were looked for
        self._screens: dict[int, str] = {}
        self._site_body = self._load_site()
        self._checkpoints = {c.id: self._load_checkpoint(c) for c in site.checkpoints}
        self._robot_body = self._load(robot_folder() / robot.urdf, fixed=False)
        self._site_links = self._links(self._site_body)
        self._robot_links = self._links(self._robot_body)
        self._joints = self._joint_indices(self._robot_body)
        self._elements = {m: ElementIndex(elements, m) for m in {e.material for e in elements}}
        self._walking = {e.material for e in elements if e.role in WALKING_ROLES}
        self._filter(self._robot_body, _ROBOT_BIT, SITE_BIT)
        for body in (self._site_body, *self._checkpoints.values()):
            self._filter(body, SITE_BIT, SITE_BIT | _ROBOT_BIT)
        self.move_arm(robot.arm_stowed)

    @property
    def solids(self) -> tuple[Element, ...]:
        """The solids that are really there, checkpoints apart."""
        return self._solids

    def place_robot(self, pose: BodyPose) -> None:
        """Puts the robot there, whatever is in the way."""
        self._pose = pose
        self._place(self._robot_body, (pose.x, pose.y, pose.z), (pose.roll, pose.pitch, pose.yaw))

    def set_joints(self, positions: Mapping[str, float]) -> None:
        """Puts joints of the robot to positions (rad), by name."""
        for name, position in positions.items():
            if self._posture.get(name) != position:
                self._posture[name], self._envelope = position, None
            pybullet.resetJointState(
                self._robot_body, self._joints[name], position, physicsClientId=self._client
            )

    def joint_positions(self, names: Sequence[str]) -> list[float]:
        """Positions (rad) of joints of the robot, by name."""
        states = pybullet.getJointStates(
            self._robot_body, [self._joints[n] for n in names], physicsClientId=self._client
        )
        return [state[0] for state in states]

    def move_arm(self, joints: Mapping[str, float]) -> None:
        """Puts the arm's joints to positions in degrees, such as the robot's `arm_stowed`."""
        self.set_joints({name: math.radians(angle) for name, angle in joints.items()})

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """Moves the needle, float or lever of a checkpoint to a value in its unit."""
        checkpoint = self.site.checkpoint(checkpoint_id)
        share = (value - checkpoint.range.low) / (checkpoint.range.high - checkpoint.range.low)
        position = {
            CheckpointKind.PRESSURE_GAUGE: math.radians(-135 + 270 * share),
            CheckpointKind.LIQUID_LEVEL_GAUGE: -0.12 + 0.24 * share,
            CheckpointKind.VALVE: math.radians(90 * share),
        }[checkpoint.kind]
        body = self._checkpoints[checkpoint_id]
        joint = self._joint_indices(body)["indicator"]
        pybullet.resetJointState(body, joint, position, physicsClientId=self._client)
        self._moved = True

    def displace(self, checkpoint_id: int, placement: Placement) -> None:
        """Puts a checkpoint elsewhere than planned; NotFound if there is no such checkpoint."""
        planned = self.site.checkpoint(checkpoint_id)
        self._placements[checkpoint_id] = placement
        actual = self.in_place(checkpoint_id)
        rpy = (placement.roll, 0.0, planned.yaw + placement.turn)
        self._place(self._checkpoints[checkpoint_id], actual.position, rpy)
        self._moved, self._clearance = True, None
        self._detect()

    def placement(self, checkpoint_id: int) -> Placement:
        """How a checkpoint stands against the plan."""
        return self._placements.get(checkpoint_id, AS_PLANNED)

    def in_place(self, checkpoint_id: int) -> SiteCheckpoint:
        """The checkpoint where it really is; NotFound if there is no such checkpoint."""
        return displaced(self.site.checkpoint(checkpoint_id), self.placement(checkpoint_id))

    def add_screen(self, name: str, solid: Solid, colour: Vector) -> int:
        """Puts something in the way of sight, of a colour (red, green and blue from 0 to 1).
        Returns its number."""
        client = self._client
        shape: dict[str, Any]
        drawn: dict[str, Any]
        if isinstance(solid, Box):
            half = [edge / 2 for edge in solid.size]
            kind, shape, drawn = pybullet.GEOM_BOX, {"halfExtents": half}, {"halfExtents": half}
        else:
            kind, radius = pybullet.GEOM_CYLINDER, solid.radius
            shape = {"radius": radius, "height": solid.length}
            drawn = {"radius": radius, "length": solid.length}
        body: int = pybullet.createMultiBody(
            0,
            pybullet.createCollisionShape(kind, **shape, physicsClientId=client),
            pybullet.createVisualShape(
                kind, **drawn, rgbaColor=(*colour, 1), physicsClientId=client
            ),
            solid.center,
            pybullet.getQuaternionFromEuler(solid.rpy),
            physicsClientId=client,
        )
        self._filter(body, SITE_BIT, SITE_BIT | _ROBOT_BIT)
        self._screens[body] = name
        self._detect()
        return body

    def remove_screen(self, number: int) -> None:
        """Takes away what `add_screen` has put there; KeyError if it is not there."""
        del self._screens[number]
        pybullet.removeBody(number, physicsClientId=self._client)
        self._detect()

    def only_solids_between(self, low: Vector, high: Vector) -> bool:
        """Whether no checkpoint and nothing else that moves reaches into a box (m)."""
        places = (self.in_place(id).position for id in self._checkpoints)
        return not self._screens and not any(
            all(a - _OBJECT < v < b + _OBJECT for a, v, b in zip(low, place, high, strict=True))
            for place in places
        )

    def _is_clear(self) -> bool:
        """Whether the robot surely has no contact with anything that it must not touch."""
        if self._moved or self._screens:
            return False
        if self._clearance is None:
            parts = [(e.material, s) for e in self._solids for s in e.solids]
            half = np.array([half_extents(solid) for _, solid in parts])
            center = np.array([solid.center for _, solid in parts])
            objects = [self._box(b, self._links(b)) for b in self._checkpoints.values()]
            low = [center - half, *(box.low[None] - _INDICATOR for box in objects)]
            high = [center + half, *(box.high[None] + _INDICATOR for box in objects)]
            walking = [m in self._walking for m, _ in parts] + [False] * len(objects)
            solids = SolidBounds(np.concatenate(low), np.concatenate(high))
            self._clearance = Clearance(solids, np.array(walking))
        if self._envelope is None:
            self._place(self._robot_body, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            upper = [k for k, name in self._robot_links.items() if not name.endswith(STANDING)]
            body = self._robot_body
            self._envelope = self._box(body, self._robot_links), self._box(body, upper)
            self.place_robot(self._pose)
        return self._clearance.is_clear(self._pose, *self._envelope, self.contact_breaking)

    def _box(self, body: int, links: Iterable[int]) -> SolidBounds:
        """The upright box around links of a body."""
        boxes = [pybullet.getAABB(body, link, physicsClientId=self._client) for link in links]
        return SolidBounds.around(
            [SolidBounds(np.array(low), np.array(high)) for low, high in boxes]
        )

    def _name(self, body: int, link: int, point: Vector) -> str:
        """What a link of a body is called, at a point of it (m)."""
        for id, checkpoint_body in self._checkpoints.items():
            if body == checkpoint_body:
                return self.site.checkpoint(id).name
        if body in self._screens:
            return self._screens[body]
        return self._elements[self._site_links[link]].at(point)

    def _load_site(self) -> int:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{self.site.name}.urdf"
            path.write_text(to_urdf(self.site.name, self._solids), encoding="utf-8")
            return self._load(path, fixed=True)

    def _load_checkpoint(self, checkpoint: SiteCheckpoint) -> int:
        name = checkpoint.kind.value.replace(" ", "_")
        path = resources.urdf() / "checkpoints" / f"{name}.urdf"
        body = self._load(path, fixed=True)
        self._place(body, checkpoint.position, (0.0, 0.0, checkpoint.yaw))
        return body

    def _filter(self, body: int, group: int, mask: int) -> None:
        """What all links of a body are, and what they collide with."""
        for link in self._links(body):
            pybullet.setCollisionFilterGroupMask(
                body, link, group, mask, physicsClientId=self._client
            )

    def _links(self, body: int) -> dict[int, str]:
        base = pybullet.getBodyInfo(body, physicsClientId=self._client)[0].decode()
        return {-1: base} | {k: link for k, (_, link) in self._parts(body).items()}

    def _joint_indices(self, body: int) -> dict[str, int]:
        return {joint: k for k, (joint, _) in self._parts(body).items()}
