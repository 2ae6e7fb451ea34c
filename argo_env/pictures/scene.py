"""The site and the robot in a separate PyBullet world for rendering, storey by storey."""

import math
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_env.files import resources
from argo_env.pictures.camera import Camera, depth_in_metres
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec, robot_folder
from argo_env.site import Site
from argo_env.site.shapes import Element, Role, Vector
from argo_env.site.storeys import storeys
from argo_env.site.urdf import to_urdf
from argo_env.world.pybullet_client import Connection, pybullet

_HIDDEN: Vector = (0.0, 0.0, -1000.0)
_SOLID_BIT = 1  # collision filter of what stops rays along a line of sight
_DECK_ROLES = frozenset({Role.DECK, Role.STAIR, Role.RAILING})


@dataclass(frozen=True)
class CameraView:
    """View of a camera: colours (0 to 255), shape (height, width, 3), and the depth of each pixel.

    The depth is along the line of sight in m, infinite where there is nothing.
    """

    colours: NDArray[np.uint8]
    depth: NDArray[np.float64]


class Scene(Connection):
    """Scene to render, which holds a PyBullet connection.

    Close it, or use it as a context.
    """

    def __init__(self, site: Site | None, robot: RobotSpec) -> None:
        """Load the site and the robot; without a site the robot is alone."""
        super().__init__()
        self.robot = robot
        self._floors: dict[int, list[int]] = {}
        self._decks: dict[int, list[int]] = {}
        self._origins: dict[int, tuple[Vector, Vector]] = {}
        if site is not None:
            self._load_site(site)
        self._robot_body = self._load(robot_folder() / robot.urdf, fixed=False)
        for body in chain.from_iterable((*self._floors.values(), *self._decks.values())):
            self._origins.setdefault(body, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
        self._joints = {name: k for k, (name, _) in self._parts(self._robot_body).items()}
        self._set_ray_filters()
        self._shown: tuple[int, int] | None = None
        if self._floors:
            self.show_floors(max(self._floors))
        self.hide_robot()

    def show_floors(self, top: int, floors_with_decks: int | None = None) -> None:
        """Show the floors up to the one numbered `top`, and hide those above it.

        If `floors_with_decks` is given, decks, stairs and railings are shown for that many of the
        uppermost of these floors only: the lower ones are hardly visible, and take most of the
        time.
        """
        lowest = min(self._floors) if floors_with_decks is None else top - floors_with_decks + 1
        if (lowest, top) == self._shown:
            return
        self._shown = lowest, top
        for groups, first in ((self._floors, min(self._floors)), (self._decks, lowest)):
            for number, bodies in groups.items():
                for body in bodies:
                    origin, rpy = self._origins[body]
                    self._place(body, origin if first <= number <= top else _HIDDEN, rpy)
        self._detect()

    def place_robot(self, pose: BodyPose, joint_degrees: Mapping[str, float]) -> None:
        """Place the robot at the pose, with joints at positions in degrees, by name."""
        for name, angle in joint_degrees.items():
            pybullet.resetJointState(
                self._robot_body,
                self._joints[name],
                math.radians(angle),
                physicsClientId=self._client,
            )
        self._place(self._robot_body, (pose.x, pose.y, pose.z), (pose.roll, pose.pitch, pose.yaw))

    def hide_robot(self) -> None:
        """Hide the robot until it is placed again."""
        self._place(self._robot_body, _HIDDEN, (0.0, 0.0, 0.0))

    def render_from(self, camera: Camera) -> CameraView:
        """Return the view of a camera of what the scene shows, without shadows."""
        colours, buffer = self._render(camera.view_matrix, camera.projection_matrix, camera.size)
        return CameraView(colours, depth_in_metres(buffer, camera))

    def occluded(self, start: Vector, ends: list[Vector]) -> NDArray[np.bool_]:
        """Return a mask of those `ends` (m) that the site hides from the point `start` (m).

        Railings hide nothing.
        """
        hits = pybullet.rayTestBatch(
            [start] * len(ends),
            ends,
            collisionFilterMask=_SOLID_BIT,
            physicsClientId=self._client,
        )
        return np.array([hit[0] >= 0 for hit in hits])

    def _set_ray_filters(self) -> None:
        """Let rays stop at the site's solid parts only, as railings can be seen through."""
        for bodies in (*self._floors.values(), *self._decks.values(), [self._robot_body]):
            for body in bodies:
                solid = body != self._robot_body
                for link, (_, name) in ({-1: ("", "")} | self._parts(body)).items():
                    bit = _SOLID_BIT if solid and name != "railing" else 0
                    pybullet.setCollisionFilterGroupMask(
                        body, link, bit, bit, physicsClientId=self._client
                    )

    def _load_site(self, site: Site) -> None:
        for number, elements in storeys(site).items():
            decks = tuple(e for e in elements if number > 1 and e.role in _DECK_ROLES)
            others = tuple(e for e in elements if e not in decks)
            self._floors[number] = [self._load_storey(number, others)]
            self._decks[number] = [self._load_storey(number, decks)] if decks else []
        for checkpoint in site.checkpoints:
            name = checkpoint.kind.value.replace(" ", "_")
            body = self._load(resources.urdf_folder() / "checkpoints" / f"{name}.urdf", fixed=True)
            self._floors[checkpoint.floor].append(body)
            self._origins[body] = (checkpoint.position, (0.0, 0.0, checkpoint.yaw))

    def _load_storey(self, number: int, elements: tuple[Element, ...]) -> int:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "storey.urdf"
            path.write_text(to_urdf(f"floor_{number}", elements), encoding="utf-8")
            return self._load(path, fixed=True)
