"""The bodies of a site, its checkpoints and the robot in PyBullet: what is where, by name."""

import math
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.catalog import CheckpointKind
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

_RAY_BIT, _ROBOT_BIT = 1, 2  # PyBullet's rays are of the first group, whatever they look for
SITE_BIT = 4
"""collision filter group of all but the robot"""
_HIT_BY = _RAY_BIT | _ROBOT_BIT  # not by its like: nothing of the site moves, and it takes long
STANDING = ("_track", "_flipper")
"""how the names of the links end that the robot stands on"""
_INDICATOR = 0.15  # m that a needle or lever reaches beyond where it is now, at most
_BESIDE = np.array([0.25, 0.25, 0.0])  # m around a checkpoint that count as near it
_SITES = 4  # whose solids' bounds are remembered


class Bodies(Connection):
    """A site with its checkpoints and a robot. Holds a connection, and where everything is.

    Nothing moves by itself here: everything is put where it is to be. PyBullet is told where the
    robot is when it is asked about it: a robot that drives in the open is put to many places about
    which nobody asks.
    """

    def __init__(
        self,
        site: Site,
        robot: RobotSpec,
        gui: bool,
        elements: tuple[Element, ...],
        drawn: bool,
    ) -> None:
        """`elements`: the solids that are really there; `drawn`: whether pictures show anything of
        all this, which takes twice as long to load."""
        super().__init__(gui)
        self._gui = gui
        self._drawn = gui or drawn
        self.site = site
        self.robot = robot
        self._solids = elements
        self._placements: dict[int, Placement] = {}
        self._pose = BodyPose(0.0, 0.0, 0.0, 0.0)
        self._posture: dict[str, float] = {}
        self._untold: dict[str, float] = {}  # joints that PyBullet has elsewhere, or may have
        self._astray = False  # whether PyBullet has the robot elsewhere, or may have
        self._envelope: tuple[SolidBounds, SolidBounds] | None = None  # in this posture
        self._clearance: Clearance | None = None  # of what stands where it stands now
        self._objects: SolidBounds | None = None  # around each checkpoint where it stands now
        self._moved = True  # whether anything but the robot has, since collisions were looked for
        self._screens: dict[int, str] = {}
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder)
            self._site_body = self._load_site(made)
            self._checkpoints = {c.id: self._load_checkpoint(c, made) for c in site.checkpoints}
            robot_file = self._as_drawn(robot_folder() / robot.urdf, made)
            self._robot_body = self._load(robot_file, fixed=False)
        self._site_links = self._links(self._site_body)
        self._robot_links = self._links(self._robot_body)
        self._joints = self._joint_indices(self._robot_body)
        self._walking = {e.material for e in elements if e.role in WALKING_ROLES}
        self._filter(self._robot_body, _ROBOT_BIT, SITE_BIT)
        for body in (self._site_body, *self._checkpoints.values()):
            self._filter(body, SITE_BIT, _HIT_BY)
        self.move_arm(robot.arm_stowed)

    @property
    def solids(self) -> tuple[Element, ...]:
        """The solids that are really there, checkpoints apart."""
        return self._solids

    def place_robot(self, pose: BodyPose) -> None:
        """Puts the robot there, whatever is in the way."""
        self._pose, self._astray = pose, True
        if self._gui:
            self._tell()

    def set_joints(self, positions: Mapping[str, float]) -> None:
        """Puts joints of the robot to positions (rad), by name."""
        for name, position in positions.items():
            if self._posture.get(name) != position:
                self._posture[name], self._envelope = position, None
            self._untold[name] = position
        if self._gui:
            self._tell()

    def joint_positions(self, names: Sequence[str]) -> list[float]:
        """Positions (rad) of joints of the robot, by name."""
        self._tell()
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
        self._moved, self._clearance, self._objects = True, None, None
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
        self._filter(body, SITE_BIT, _HIT_BY)
        self._screens[body] = name
        self._detect()
        return body

    def remove_screen(self, number: int) -> None:
        """Takes away what `add_screen` has put there; KeyError if it is not there."""
        del self._screens[number]
        pybullet.removeBody(number, physicsClientId=self._client)
        self._detect()

    def only_solids_between(self, low: Vector, high: Vector) -> bool:
        """Whether no checkpoint is near a box (m), and nothing else moves."""
        box = SolidBounds(np.array(low) - _BESIDE, np.array(high) + _BESIDE)
        return not self._screens and not self._around_checkpoints().overlapping(box).any()

    def _around_checkpoints(self) -> SolidBounds:
        """The boxes in which the checkpoints are, wherever their indicators."""
        if self._objects is None:
            boxes = [self._box(b, self._links(b)) for b in self._checkpoints.values()]
            low = np.array([box.low for box in boxes]).reshape(-1, 3)
            high = np.array([box.high for box in boxes]).reshape(-1, 3)
            self._objects = SolidBounds(low - _INDICATOR, high + _INDICATOR)
        return self._objects

    def _is_clear(self) -> bool:
        """Whether the robot surely has no contact with anything that it must not touch."""
        return self._is_clear_at(self._pose)

    def _is_clear_at(self, pose: BodyPose) -> bool:
        """Whether it would surely have none there."""
        if self._moved or self._screens:
            return False
        if self._clearance is None:
            solids, walking = _bounds_of(self._solids)
            objects = self._around_checkpoints()
            self._clearance = Clearance(
                SolidBounds(
                    np.concatenate([solids.low, objects.low]),
                    np.concatenate([solids.high, objects.high]),
                ),
                np.concatenate([walking, np.zeros(len(objects.low), dtype=bool)]),
            )
        if self._envelope is None:
            self._tell()
            self._place(self._robot_body, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            self._astray = True
            upper = [k for k, name in self._robot_links.items() if not name.endswith(STANDING)]
            body = self._robot_body
            self._envelope = self._box(body, self._robot_links), self._box(body, upper)
        return self._clearance.is_clear(pose, *self._envelope, self.contact_breaking)

    def _detect(self) -> None:
        self._tell()
        super()._detect()

    def _tell(self) -> None:
        """Tells PyBullet where the robot and its joints are."""
        for name, position in self._untold.items():
            pybullet.resetJointState(
                self._robot_body, self._joints[name], position, physicsClientId=self._client
            )
        self._untold.clear()
        if self._astray:
            at = self._pose
            self._place(self._robot_body, (at.x, at.y, at.z), (at.roll, at.pitch, at.yaw))
            self._astray = False

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

    @cached_property
    def _elements(self) -> dict[str, ElementIndex]:
        return {m: ElementIndex(self._solids, m) for m in {e.material for e in self._solids}}

    def _load_site(self, folder: Path) -> int:
        path = folder / "site.urdf"
        path.write_text(to_urdf(self.site.name, self._solids, self._drawn), encoding="utf-8")
        return self._load(path, fixed=True)

    def _load_checkpoint(self, checkpoint: SiteCheckpoint, folder: Path) -> int:
        name = checkpoint.kind.value.replace(" ", "_")
        path = resources.urdf() / "checkpoints" / f"{name}.urdf"
        body = self._load(self._as_drawn(path, folder), fixed=True)
        self._place(body, checkpoint.position, (0.0, 0.0, checkpoint.yaw))
        return body

    def _as_drawn(self, path: Path, folder: Path) -> Path:
        """The file of a body, or one in the folder without what only pictures show."""
        if self._drawn:
            return path
        bare = folder / path.name
        bare.write_text(_undrawn(path), encoding="utf-8")
        return bare

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


@lru_cache(maxsize=8)  # of the robot and of each kind of checkpoint
def _undrawn(path: Path) -> str:
    """A URDF file without what only pictures show."""
    robot = ElementTree.parse(path).getroot()
    for link in robot.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    return ElementTree.tostring(robot, encoding="unicode")


@lru_cache(maxsize=_SITES)
def _bounds_of(elements: tuple[Element, ...]) -> tuple[SolidBounds, NDArray[np.bool_]]:
    """The upright boxes around all solids, and on which of them wheels and tracks may stand: as in
    PyBullet, all of a material on which anything is walked."""
    parts = [(e.material, s) for e in elements for s in e.solids]
    half = np.array([half_extents(solid) for _, solid in parts])
    center = np.array([solid.center for _, solid in parts])
    walked = {e.material for e in elements if e.role in WALKING_ROLES}
    walking = np.array([material in walked for material, _ in parts])
    return SolidBounds(center - half, center + half), walking
