"""The PyBullet world: a site, its checkpoints and the robot, addressed by name."""

import math
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.catalog import CheckpointKind
from argo_compiler.errors import ArgoError
from argo_env import resources
from argo_env.pybullet_client import Connection, pybullet, quiet
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec, robot_folder
from argo_env.sensing.vision.placement import AS_PLANNED, Placement, displaced
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.index import ElementIndex
from argo_env.site.shapes import WALKING_ROLES, Box, Element, Solid, Vector
from argo_env.site.urdf import to_urdf

_ROBOT_BIT = 2
_SITE_BIT = 1
_MAX_RAYS = 16_000  # PyBullet refuses batches larger than 16,384
_TOUCH_DEPTH = 0.001  # m of overlap from which a touch counts
_HULL = ("base_link", "left_track", "right_track", "left_flipper", "right_flipper")
_ARM = {  # links of the arm, and what of the robot each could hit
    "upper_arm": _HULL,
    "forearm": (*_HULL, "arm_base"),
    "sensor_head": (*_HULL, "arm_base", "upper_arm"),
    "camera": (*_HULL, "arm_base", "upper_arm"),
}
_SUN: Vector = (0.55, -0.75, 1.25)  # direction towards the light


@dataclass(frozen=True, eq=False)
class Shot:
    """A picture that a camera has taken, and where the camera was."""

    pixels: NDArray[np.uint8]
    """red, green and blue, shape (height, width, 3)"""
    focal: float
    """px, of the pinhole camera with its centre in the middle of the picture"""
    position: NDArray[np.float64]
    """m, in the site's frame"""
    rotation: NDArray[np.float64]
    """columns are the camera's axes: right, down, and along the line of sight, shape (3, 3)"""


@dataclass(frozen=True)
class Touch:
    """One overlap of the robot with the site at the present moment."""

    link: str
    element: str
    point: Vector
    depth: float
    """m"""


class World(Connection):
    """The simulated world. Holds a PyBullet connection; close it, or use it as a context.

    Nothing moves by itself here: a drive places the robot, and collisions are looked up.
    """

    def __init__(
        self,
        site: Site,
        robot: RobotSpec,
        gui: bool = False,
        elements: tuple[Element, ...] | None = None,
    ) -> None:
        """`elements`: the solids that are really there, if they differ from those of the site.

        Raises ArgoError if a window is asked for where there is no display.
        """
        if gui and not os.environ.get("DISPLAY"):
            raise ArgoError("--gui needs a display, and DISPLAY is not set; use --render instead")
        super().__init__(gui)
        self.site = site
        self.robot = robot
        self._solids = site.elements if elements is None else elements
        self.light = 1.0
        """how bright it is, from 0 to 1: full daylight"""
        self.on_shot: Callable[[Shot], None] | None = None
        """told each picture that a camera of the robot takes"""
        self._placements: dict[int, Placement] = {}
        self._screens: dict[int, str] = {}
        self._felt: tuple[Touch, ...] | None = None
        with quiet():
            self._site_body = self._load_site()
            self._checkpoints = {c.id: self._load_checkpoint(c) for c in site.checkpoints}
            self._robot_body = self._load(robot_folder() / robot.urdf, fixed=False)
        self._site_links = self._links(self._site_body)
        self._robot_links = self._links(self._robot_body)
        self._joints = self._joint_indices(self._robot_body)
        self._elements = {
            m: ElementIndex(self._solids, m) for m in {e.material for e in self._solids}
        }
        self._walking = {e.material for e in self._solids if e.role in WALKING_ROLES}
        for link in self._robot_links:
            pybullet.setCollisionFilterGroupMask(
                self._robot_body, link, _ROBOT_BIT, _SITE_BIT, physicsClientId=self._client
            )
        for body in (self._site_body, *self._checkpoints.values()):
            for link in self._links(body):
                pybullet.setCollisionFilterGroupMask(
                    body, link, _SITE_BIT, _SITE_BIT | _ROBOT_BIT, physicsClientId=self._client
                )

        self.move_arm(robot.arm_stowed)
        if gui:
            self._look_at_site()

    @property
    def solids(self) -> tuple[Element, ...]:
        """The solids that are really there, checkpoints apart."""
        return self._solids

    def place_robot(self, pose: BodyPose) -> None:
        """Puts the robot there, whatever is in the way."""
        self._place(self._robot_body, (pose.x, pose.y, pose.z), (0.0, pose.pitch, pose.yaw))

    def set_joints(self, positions: Mapping[str, float]) -> None:
        """Puts joints of the robot to positions (rad), by name."""
        for name, position in positions.items():
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

    def displace(self, checkpoint_id: int, placement: Placement) -> None:
        """Puts a checkpoint elsewhere than planned; KeyError if there is no such checkpoint."""
        planned = self.site.checkpoint(checkpoint_id)
        self._placements[checkpoint_id] = placement
        actual = self.in_place(checkpoint_id)
        rpy = (placement.roll, 0.0, planned.yaw + placement.turn)
        self._place(self._checkpoints[checkpoint_id], actual.position, rpy)
        # Rays are tested against where bodies were at the last collision detection.
        pybullet.performCollisionDetection(physicsClientId=self._client)

    def placement(self, checkpoint_id: int) -> Placement:
        """How a checkpoint stands against the plan."""
        return self._placements.get(checkpoint_id, AS_PLANNED)

    def in_place(self, checkpoint_id: int) -> SiteCheckpoint:
        """The checkpoint where it really is; KeyError if there is no such checkpoint."""
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
        pybullet.setCollisionFilterGroupMask(
            body, -1, _SITE_BIT, _SITE_BIT | _ROBOT_BIT, physicsClientId=client
        )
        self._screens[body] = name
        pybullet.performCollisionDetection(physicsClientId=client)
        return body

    def remove_screen(self, number: int) -> None:
        """Takes away what `add_screen` has put there; KeyError if it is not there."""
        del self._screens[number]
        pybullet.removeBody(number, physicsClientId=self._client)
        pybullet.performCollisionDetection(physicsClientId=self._client)

    def picture(
        self, view: Sequence[float], projection: Sequence[float], size: tuple[int, int]
    ) -> NDArray[np.uint8]:
        """What a camera sees in daylight, red, green and blue, shape (height, width, 3). The
        matrices are OpenGL's, column by column; `size` is width and height in px."""
        width, height = size
        image = pybullet.getCameraImage(
            width,
            height,
            view,
            projection,
            lightDirection=_SUN,
            lightAmbientCoeff=0.62,
            lightDiffuseCoeff=0.42,
            lightSpecularCoeff=0.0,
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            flags=pybullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        return np.asarray(image[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3]

    def arm_obstacle(self, positions: Mapping[str, float], clearance: float) -> str | None:
        """What the arm would come nearer to than `clearance` (m) with its joints at `positions`
        (rad): a thing of the site or a link of the robot; None if nothing. Moves no joint."""
        names = list(positions)
        before = dict(zip(names, self.joint_positions(names), strict=True))
        self.set_joints(positions)
        try:
            return self._near_arm(clearance)
        finally:
            self.set_joints(before)

    def _near_arm(self, clearance: float) -> str | None:
        links = {name: number for number, name in self._robot_links.items()}
        bodies = (self._site_body, *self._checkpoints.values(), *self._screens)
        for name, hull in _ARM.items():
            for part in hull:
                if self._closest(links[name], self._robot_body, clearance, linkIndexB=links[part]):
                    return part
            for body in bodies:
                for contact in self._closest(links[name], body, clearance):
                    return self._name(body, contact[4], contact[6])
        return None

    def _closest(
        self, link: int, body: int, distance: float, **options: int
    ) -> list[tuple[Any, ...]]:
        """Where a link of the robot is nearer to a body than `distance` (m)."""
        found: list[tuple[Any, ...]] = pybullet.getClosestPoints(
            self._robot_body,
            body,
            distance,
            linkIndexA=link,
            physicsClientId=self._client,
            **options,
        )
        return found

    def heights(
        self, points: NDArray[np.float64], below: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Height of the first thing under each of `points`, shape (n, 2), looking down from the
        heights `below`, shape (n,). Where there is nothing within 2 m, as in the seam between two
        plates, it is that depth."""
        starts = np.column_stack([points, below])
        ends = np.column_stack([points, below - 2.0])
        result = np.empty(len(points))
        for first in range(0, len(points), _MAX_RAYS):
            part = slice(first, first + _MAX_RAYS)
            hits = pybullet.rayTestBatch(
                starts[part].tolist(),
                ends[part].tolist(),
                collisionFilterMask=_SITE_BIT,
                physicsClientId=self._client,
            )
            result[part] = [
                hit[3][2] if hit[0] >= 0 else end[2]
                for hit, end in zip(hits, ends[part], strict=True)
            ]
        return result

    def ranges(self, origin: Vector, ends: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far (m) the first thing is from `origin` on the way to each of `ends`, shape (n, 3),
        the robot left out; inf where there is nothing."""
        shares = [hit[2] if hit[0] >= 0 else math.inf for hit in self._rays(origin, ends)]
        return np.asarray(np.array(shares) * np.linalg.norm(ends - np.array(origin), axis=1))

    def surfaces(
        self, origin: Vector, ends: NDArray[np.float64]
    ) -> tuple[list[str | None], NDArray[np.float64]]:
        """What is seen from `origin` on the way to each of `ends`, shape (n, 3): the material, None
        where there is nothing and "" where it is no part of the site, and the outward normal."""
        hits = self._rays(origin, ends)
        site = self._site_body
        seen = [
            None if hit[0] < 0 else self._site_links[hit[1]] if hit[0] == site else ""
            for hit in hits
        ]
        return seen, np.array([hit[4] for hit in hits])

    def _rays(self, origin: Vector, ends: NDArray[np.float64]) -> list[tuple[Any, ...]]:
        """PyBullet's answers: body, link, share of the way, point and normal of the first hit."""
        hits: list[tuple[Any, ...]] = []
        for first in range(0, len(ends), _MAX_RAYS):
            part = ends[first : first + _MAX_RAYS].tolist()
            hits += pybullet.rayTestBatch(
                [origin] * len(part),
                part,
                collisionFilterMask=_SITE_BIT,
                physicsClientId=self._client,
            )
        return hits

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """The name of the first thing on the straight line, the robot left out; None if clear."""
        body, link, _, point, _ = pybullet.rayTest(
            origin, target, collisionFilterMask=_SITE_BIT, physicsClientId=self._client
        )[0]
        if body < 0:
            return None
        return self._name(body, link, point)

    def feel(self, touches: tuple[Touch, ...]) -> None:
        """Takes what a drive with forces has pressed against since the last call: `touches` then
        tells that, and overlaps of the arm only."""
        self._felt = touches

    def touches(self) -> tuple[Touch, ...]:
        """Where the robot touches what it must not: all but tracks and flippers on the ground."""
        pybullet.performCollisionDetection(physicsClientId=self._client)
        found = []
        for contact in pybullet.getContactPoints(
            bodyA=self._robot_body, physicsClientId=self._client
        ):
            body, link_a, link_b, point, distance = (
                contact[2], contact[3], contact[4], contact[6], contact[8],
            )  # fmt: skip
            link = self._robot_links[link_a]
            stands = (
                body == self._site_body
                and link.endswith(("_track", "_flipper"))
                and self._site_links[link_b] in self._walking
            )
            if self._felt is not None and link not in _ARM:
                continue
            if not stands and distance <= -_TOUCH_DEPTH:
                found.append(Touch(link, self._name(body, link_b, point), point, -distance))
        felt, self._felt = self._felt, None if self._felt is None else ()
        return (*(felt or ()), *found)

    def _look_at_site(self) -> None:
        """Sets the window's camera so that the whole site is in view, from the south-west."""
        x0, y0, x1, y1 = self.site.spec.ground
        top = self.site.spec.floors[-1].z
        pybullet.configureDebugVisualizer(pybullet.COV_ENABLE_GUI, 0, physicsClientId=self._client)
        pybullet.resetDebugVisualizerCamera(
            1.2 * max(x1 - x0, y1 - y0, top),
            -35.0,
            -25.0,
            ((x0 + x1) / 2, (y0 + y1) / 2, top / 3),
            physicsClientId=self._client,
        )

    def _name(self, body: int, link: int, point: Vector) -> str:
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

    def _links(self, body: int) -> dict[int, str]:
        base = pybullet.getBodyInfo(body, physicsClientId=self._client)[0].decode()
        return {-1: base} | {k: link for k, (_, link) in self._parts(body).items()}

    def _joint_indices(self, body: int) -> dict[str, int]:
        return {joint: k for k, (joint, _) in self._parts(body).items()}
