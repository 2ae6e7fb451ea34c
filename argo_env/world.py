"""The PyBullet world: a site, its checkpoints and the robot, addressed by name."""

import math
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.catalog import CheckpointKind
from argo_compiler.errors import ArgoError
from argo_env import resources
from argo_env.pybullet_client import Connection, pybullet, quiet
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec, robot_folder
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.index import ElementIndex
from argo_env.site.shapes import WALKING_ROLES, Vector
from argo_env.site.urdf import to_urdf

_ROBOT_BIT = 2
_SITE_BIT = 1
_MAX_RAYS = 16_000  # PyBullet refuses batches larger than 16,384
_TOUCH_DEPTH = 0.001  # m of overlap from which a touch counts


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

    def __init__(self, site: Site, robot: RobotSpec, gui: bool = False) -> None:
        """Raises ArgoError if a window is asked for where there is no display."""
        if gui and not os.environ.get("DISPLAY"):
            raise ArgoError("--gui needs a display, and DISPLAY is not set; use --render instead")
        super().__init__(gui)
        self.site = site
        self.robot = robot
        with quiet():
            self._site_body = self._load_site()
            self._checkpoints = {c.id: self._load_checkpoint(c) for c in site.checkpoints}
            self._robot_body = self._load(robot_folder() / robot.urdf, fixed=False)
        self._site_links = self._links(self._site_body)
        self._robot_links = self._links(self._robot_body)
        self._joints = self._joint_indices(self._robot_body)
        self._elements = {
            m: ElementIndex(site.elements, m) for m in {e.material for e in site.elements}
        }
        self._walking = {e.material for e in site.elements if e.role in WALKING_ROLES}
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

    def place_robot(self, pose: BodyPose) -> None:
        """Puts the robot there, whatever is in the way."""
        self._place(self._robot_body, (pose.x, pose.y, pose.z), (0.0, pose.pitch, pose.yaw))

    def set_joints(self, positions: Mapping[str, float]) -> None:
        """Puts joints of the robot to positions (rad), by name."""
        for name, position in positions.items():
            pybullet.resetJointState(
                self._robot_body, self._joints[name], position, physicsClientId=self._client
            )

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

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """The name of the first thing on the straight line, the robot left out; None if clear."""
        body, link, _, point, _ = pybullet.rayTest(
            origin, target, collisionFilterMask=_SITE_BIT, physicsClientId=self._client
        )[0]
        if body < 0:
            return None
        return self._name(body, link, point)

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
            if not stands and distance <= -_TOUCH_DEPTH:
                found.append(Touch(link, self._name(body, link_b, point), point, -distance))
        return tuple(found)

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
        return self._elements[self._site_links[link]].at(point)

    def _load_site(self) -> int:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{self.site.name}.urdf"
            path.write_text(to_urdf(self.site.name, self.site.elements), encoding="utf-8")
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
