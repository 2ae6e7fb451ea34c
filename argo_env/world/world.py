"""World in PyBullet: contacts, lines of sight, heights and pictures among the bodies of a site."""

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Remedy, Unavailable
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site
from argo_env.site.shapes import Element, Vector
from argo_env.world.bodies import SITE_BIT, STANDING_LINKS, Bodies
from argo_env.world.pybullet_client import pybullet

_MAX_RAYS = 256  # in a batch: small results are freed before Python's collector examines them
_TOUCH_DEPTH = 0.001  # m of overlap from which a touch counts
_HULL = ("base_link", "left_track", "right_track", "left_flipper", "right_flipper")
_ARM = {  # links of the arm, and the links of the robot that each could touch
    "upper_arm": _HULL,
    "forearm": (*_HULL, "arm_base"),
    "sensor_head": (*_HULL, "arm_base", "upper_arm"),
    "camera": (*_HULL, "arm_base", "upper_arm"),
}
_ARM_REACH = 2.5  # m from the robot's middle: checkpoints farther away can't be touched by the arm


@dataclass(frozen=True, eq=False)
class Shot:
    """Picture that a camera has taken, with the pose of the camera."""

    pixels: NDArray[np.uint8]
    """red, green and blue, shape (height, width, 3)"""
    focal: float
    """px, focal length of the pinhole camera, whose centre is in the middle of the picture"""
    position: NDArray[np.float64]
    """m, in the site's frame"""
    rotation: NDArray[np.float64]
    """columns are the camera's axes: right, down, and along the line of sight, shape (3, 3)"""


@dataclass(frozen=True)
class Touch:
    """Contact of the robot with the site at one moment."""

    link: str
    """name of the robot's link"""
    element: str
    """name of the site's element, checkpoint or screen"""
    point: Vector
    """m"""
    depth: float
    """m of overlap"""


class World(Bodies):
    """Simulated world. It holds a connection to PyBullet; close it, or use it as a context.

    Nothing moves by itself: a drive sets the robot's pose, and contacts are computed on request.
    """

    def __init__(
        self,
        site: Site,
        robot: RobotSpec,
        gui: bool = False,
        elements: tuple[Element, ...] | None = None,
        drawn: bool = True,
    ) -> None:
        """Load the world.

        Args:
            site: site as planned.
            robot: description of the robot.
            gui: True to open a window.
            elements: actual solids, if they differ from those of the site.
            drawn: False for a world without pictures, which loads in half the time.

        Raises:
            Unavailable: a window needs a display, and there is none.
        """
        if gui and not os.environ.get("DISPLAY"):
            raise Unavailable(
                "a window needs a display, and DISPLAY is not set; make a film instead",
                remedies=(Remedy.FILM_INSTEAD,),
            )
        solids = site.elements if elements is None else elements
        super().__init__(site, robot, gui, solids, drawn)
        self.light = 1.0
        """brightness, from 0 to 1: full daylight"""
        self.on_shot: Callable[[Shot], None] | None = None
        """called with each picture that a camera of the robot takes"""
        self._drive_touches: tuple[Touch, ...] | None = None
        self._was_clear = False
        if gui:
            self._look_at_site()

    def set_drive_touches(self, touches: tuple[Touch, ...]) -> None:
        """Set the contacts that a drive with forces has had since the last call.

        They replace those of an earlier call. The next call of `touches` returns them, the later
        calls do not. After the first call of this function, `touches` itself looks for contacts of
        the arm only, for good.
        """
        self._drive_touches = touches

    def touches(self) -> tuple[Touch, ...]:
        """Return the robot's contacts, except of its tracks and flippers with walkable ground.

        After a call of `set_drive_touches`, they are the present ones of the arm, and those that
        were set last, unless an earlier call of this function has returned them.
        """
        touches = []
        for contact in self._contacts():
            body, link_a, link_b, point, distance = (
                contact[2], contact[3], contact[4], contact[6], contact[8],
            )  # fmt: skip
            link = self._robot_links[link_a]
            is_standing = (
                body == self._site_body
                and link.endswith(STANDING_LINKS)
                and self._site_links[link_b] in self._walkable_materials
            )
            if self._drive_touches is not None and link not in _ARM:
                continue
            if not is_standing and distance <= -_TOUCH_DEPTH:
                touches.append(Touch(link, self._name_at(body, link_b, point), point, -distance))
        drive_touches, self._drive_touches = (
            self._drive_touches,
            None if self._drive_touches is None else (),
        )
        return (*(drive_touches or ()), *touches)

    def has_surely_no_touches_at(self, pose: BodyPose) -> bool:
        """Return True if `touches` would surely be empty with the robot at `pose`.

        This is found by bounding boxes, without PyBullet; False means that it is not sure. The
        result is always False in a world with a window, after `set_drive_touches`, and if these
        boxes did not show the robot to be clear in the last call of `touches`.
        """
        return (
            self._was_clear
            and self._drive_touches is None
            and not self._gui
            and self._is_clear_at(pose)
        )

    def _contacts(self) -> Sequence[tuple[Any, ...]]:
        """Return PyBullet's contacts of the robot; none if it is clear, as it was the last time.

        A robot that has just become clear is checked once more, so that PyBullet discards its
        earlier contacts.
        """
        clear, before = self._is_clear(), self._was_clear
        self._was_clear = clear
        if clear and before:
            return ()
        self._detect()
        self._scene_changed = False
        contacts: Sequence[tuple[Any, ...]] = pybullet.getContactPoints(
            bodyA=self._robot_body, physicsClientId=self._client
        )
        return contacts

    def arm_obstacle(self, joint_radians: Mapping[str, float], clearance: float) -> str | None:
        """Return the name of any obstacle nearer than `clearance` (m) to the arm; None if none is.

        The arm's joints are at `joint_radians`, by their names; other joints stay where they are.
        After the check, all joints are where they were before. An obstacle is an element, a
        checkpoint, a screen, or another link of the robot.
        """
        names = list(joint_radians)
        before = dict(zip(names, self.joint_positions(names), strict=True))
        self.set_joints(joint_radians)
        try:
            return self._obstacle_near_arm(clearance)
        finally:
            self.set_joints(before)

    def _obstacle_near_arm(self, clearance: float) -> str | None:
        self._sync_robot()
        links = {name: number for number, name in self._robot_links.items()}
        bodies = (self._site_body, *self._reachable_checkpoints(), *self._screens)
        for name, hull in _ARM.items():
            for part in hull:
                if self._closest(links[name], self._robot_body, clearance, linkIndexB=links[part]):
                    return part
            for body in bodies:
                for contact in self._closest(links[name], body, clearance):
                    return self._name_at(body, contact[4], contact[6])
        return None

    def _reachable_checkpoints(self) -> list[int]:
        """Return the bodies of checkpoints that the arm may reach; to check all would be slow."""
        here = self._centre_of_mass(self._robot_body)
        return [
            body
            for body in self._checkpoints.values()
            if math.dist(self._centre_of_mass(body), here) < _ARM_REACH
        ]

    def _centre_of_mass(self, body: int) -> Vector:
        """Return the position of the centre of mass of a body's base (m)."""
        client = self._client
        position: Vector = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)[0]
        return position

    def _closest(
        self, link: int, body: int, distance: float, **options: int
    ) -> list[tuple[Any, ...]]:
        """Return points at which a robot's link is nearer to a body than `distance` (m)."""
        with self._contact_breaking_applied():
            contacts: list[tuple[Any, ...]] = pybullet.getClosestPoints(
                self._robot_body,
                body,
                distance,
                linkIndexA=link,
                physicsClientId=self._client,
                **options,
            )
        return contacts

    def surface_or_ray_end_heights(
        self, points: NDArray[np.float64], from_heights: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the height (m) of the first solid under each of `points` (x and y), shape (n, 2).

        Rays go down from the heights `from_heights` (m), shape (n,), and pass through the robot.
        Where there is nothing within 2 m, as in the seam between two plates, the result is 2 m less
        than `from_heights`.
        """
        depth = from_heights - 2.0
        hits = self._rays(np.column_stack([points, from_heights]), np.column_stack([points, depth]))
        return np.array(
            [hit[3][2] if hit[0] >= 0 else z for hit, z in zip(hits, depth.tolist(), strict=True)]
        )

    def hit_distances_or_inf(
        self, origin: Vector, ends: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the distance (m) from `origin` to the first solid towards each of `ends` (n, 3).

        Rays pass through the robot. The distance is inf where there is nothing up to the end.
        """
        shares = [hit[2] if hit[0] >= 0 else math.inf for hit in self._rays(origin, ends)]
        return np.asarray(np.array(shares) * np.linalg.norm(ends - np.array(origin), axis=1))

    def hit_materials_and_normals(
        self, origin: Vector, ends: NDArray[np.float64]
    ) -> tuple[list[str | None], NDArray[np.float64]]:
        """Return materials and outward normals of the surfaces seen from `origin` towards `ends`.

        The shapes of `ends` and of the normals are (n, 3). Where there is nothing, the material
        is None and the normal is zero. The material is "" for checkpoints and screens.
        """
        hits = self._rays(origin, ends)
        site = self._site_body
        seen = [
            None if hit[0] < 0 else self._site_links[hit[1]] if hit[0] == site else ""
            for hit in hits
        ]
        return seen, np.array([hit[4] for hit in hits])

    def _rays(
        self, starts: Vector | NDArray[np.float64], ends: NDArray[np.float64]
    ) -> list[tuple[Any, ...]]:
        """Return PyBullet's first hit on the line from each start, or the only one, to each end.

        A hit is body, link, share of the line, point and normal.
        """
        starts = np.broadcast_to(starts, ends.shape)
        hits: list[tuple[Any, ...]] = []
        for first in range(0, len(ends), _MAX_RAYS):
            part = slice(first, first + _MAX_RAYS)
            hits += pybullet.rayTestBatch(
                starts[part].tolist(),
                ends[part].tolist(),
                collisionFilterMask=SITE_BIT,
                physicsClientId=self._client,
            )
        return hits

    def obstacle_between(self, origin: Vector, target: Vector) -> str | None:
        """Return the name of the first obstacle between two points (m), or None if there is none.

        The robot is no obstacle.
        """
        body, link, _, point, _ = pybullet.rayTest(
            origin, target, collisionFilterMask=SITE_BIT, physicsClientId=self._client
        )[0]
        if body < 0:
            return None
        return self._name_at(body, link, point)

    def render_picture(
        self, view: Sequence[float], projection: Sequence[float], size: tuple[int, int]
    ) -> NDArray[np.uint8]:
        """Return a camera's picture in daylight: red, green and blue, shape (height, width, 3).

        Args:
            view: OpenGL's view matrix, column by column.
            projection: OpenGL's projection matrix, column by column.
            size: width and height in px.
        """
        assert self._drawn, "a world that was loaded with drawn=False has no pictures"
        self._sync_robot()
        return self._render(view, projection, size)[0]

    def _look_at_site(self) -> None:
        """Set the window's camera so that the whole site is in view, from the south-west."""
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
