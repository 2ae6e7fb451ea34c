"""The PyBullet world: what the robot touches, sees and stands on among the bodies of a site."""

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
from argo_env.world.bodies import SITE_BIT, STANDING, Bodies
from argo_env.world.pybullet_client import pybullet

_MAX_RAYS = 256  # in a batch: what few give is freed before Python looks for garbage in it
_TOUCH_DEPTH = 0.001  # m of overlap from which a touch counts
_HULL = ("base_link", "left_track", "right_track", "left_flipper", "right_flipper")
_ARM = {  # links of the arm, and what of the robot each could hit
    "upper_arm": _HULL,
    "forearm": (*_HULL, "arm_base"),
    "sensor_head": (*_HULL, "arm_base", "upper_arm"),
    "camera": (*_HULL, "arm_base", "upper_arm"),
}
_ARM_REACH = 2.5  # m from the robot's middle, in which all is that the arm may touch


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


class World(Bodies):
    """The simulated world. Holds a PyBullet connection; close it, or use it as a context.

    Nothing moves by itself here: a drive places the robot, and collisions are looked up.
    """

    def __init__(
        self,
        site: Site,
        robot: RobotSpec,
        gui: bool = False,
        elements: tuple[Element, ...] | None = None,
        drawn: bool = True,
    ) -> None:
        """`elements`: the solids that are really there, if they differ from those of the site.
        Unless `drawn` there are no pictures of it, and it loads in half the time.

        Raises ArgoError if a window is asked for where there is no display.
        """
        if gui and not os.environ.get("DISPLAY"):
            raise Unavailable(
                "a window needs a display, and DISPLAY is not set; make a film instead",
                remedies=(Remedy.FILM_INSTEAD,),
            )
        solids = site.elements if elements is None else elements
        super().__init__(site, robot, gui, solids, drawn)
        self.light = 1.0
        """how bright it is, from 0 to 1: full daylight"""
        self.on_shot: Callable[[Shot], None] | None = None
        """told each picture that a camera of the robot takes"""
        self._felt: tuple[Touch, ...] | None = None
        self._was_clear = False
        if gui:
            self._look_at_site()

    def feel(self, touches: tuple[Touch, ...]) -> None:
        """Takes what a drive with forces has pressed against since the last call: `touches` then
        tells that, and overlaps of the arm only."""
        self._felt = touches

    def touches(self) -> tuple[Touch, ...]:
        """Where the robot touches what it must not: all but tracks and flippers on the ground."""
        found = []
        for contact in self._contacts():
            body, link_a, link_b, point, distance = (
                contact[2], contact[3], contact[4], contact[6], contact[8],
            )  # fmt: skip
            link = self._robot_links[link_a]
            stands = (
                body == self._site_body
                and link.endswith(STANDING)
                and self._site_links[link_b] in self._walking
            )
            if self._felt is not None and link not in _ARM:
                continue
            if not stands and distance <= -_TOUCH_DEPTH:
                found.append(Touch(link, self._name(body, link_b, point), point, -distance))
        felt, self._felt = self._felt, None if self._felt is None else ()
        return (*(felt or ()), *found)

    def stays_clear(self, pose: BodyPose) -> bool:
        """Whether `touches` would find nothing with the robot there either, and PyBullet need not
        be asked. Not where someone watches."""
        return self._was_clear and self._felt is None and not self._gui and self._is_clear_at(pose)

    def _contacts(self) -> Sequence[tuple[Any, ...]]:
        """PyBullet's contacts of the robot; none where it is clear of all that it must not touch,
        as it was the last time. That once more makes PyBullet forget the contacts from before."""
        clear, before = self._is_clear(), self._was_clear
        self._was_clear = clear
        if clear and before:
            return ()
        self._detect()
        self._moved = False
        contacts: Sequence[tuple[Any, ...]] = pybullet.getContactPoints(
            bodyA=self._robot_body, physicsClientId=self._client
        )
        return contacts

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
        self._tell()
        links = {name: number for number, name in self._robot_links.items()}
        bodies = (self._site_body, *self._checkpoints_near(), *self._screens)
        for name, hull in _ARM.items():
            for part in hull:
                if self._closest(links[name], self._robot_body, clearance, linkIndexB=links[part]):
                    return part
            for body in bodies:
                for contact in self._closest(links[name], body, clearance):
                    return self._name(body, contact[4], contact[6])
        return None

    def _checkpoints_near(self) -> list[int]:
        """The bodies of checkpoints that the arm may reach: to ask about all takes long."""
        here = self._middle(self._robot_body)
        return [
            body
            for body in self._checkpoints.values()
            if math.dist(self._middle(body), here) < _ARM_REACH
        ]

    def _middle(self, body: int) -> Vector:
        """Where the centre of mass of a body's base is (m)."""
        client = self._client
        place: Vector = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)[0]
        return place

    def _closest(
        self, link: int, body: int, distance: float, **options: int
    ) -> list[tuple[Any, ...]]:
        """Where a link of the robot is nearer to a body than `distance` (m)."""
        with self._in_contact():
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
        depth = below - 2.0
        hits = self._rays(np.column_stack([points, below]), np.column_stack([points, depth]))
        return np.array(
            [hit[3][2] if hit[0] >= 0 else z for hit, z in zip(hits, depth.tolist(), strict=True)]
        )

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

    def _rays(
        self, starts: Vector | NDArray[np.float64], ends: NDArray[np.float64]
    ) -> list[tuple[Any, ...]]:
        """PyBullet's answers: body, link, share of the way, point and normal of the first hit on
        the way from each start, or from the one that there is, to each end."""
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
        """The name of the first thing on the straight line, the robot left out; None if clear."""
        body, link, _, point, _ = pybullet.rayTest(
            origin, target, collisionFilterMask=SITE_BIT, physicsClientId=self._client
        )[0]
        if body < 0:
            return None
        return self._name(body, link, point)

    def picture(
        self, view: Sequence[float], projection: Sequence[float], size: tuple[int, int]
    ) -> NDArray[np.uint8]:
        """What a camera sees in daylight, red, green and blue, shape (height, width, 3). The
        matrices are OpenGL's, column by column; `size` is width and height in px."""
        assert self._drawn, "of a world that is not drawn there are no pictures"
        self._tell()
        return self._render(view, projection, size)[0]

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
