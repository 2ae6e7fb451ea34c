"""Bodies of a site, its checkpoints and the robot in PyBullet, with their names and poses."""

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
from argo_env.world.placement import AS_PLANNED, Placement, displaced_checkpoint
from argo_env.world.pybullet_client import Connection, pybullet

_RAY_BIT, _ROBOT_BIT = 1, 2  # PyBullet's rays are in the first group, whatever their mask
SITE_BIT = 4
"""collision filter group of all but the robot"""
_SITE_MASK = _RAY_BIT | _ROBOT_BIT  # the site does not move, so it need not collide with itself
STANDING_LINKS = ("_track", "_flipper")
"""endings of the names of the links that the robot stands on"""
_INDICATOR = 0.15  # m by which a needle or lever may extend the box around a checkpoint, at most
_NEAR_CHECKPOINT = np.array([0.25, 0.25, 0.0])  # m around a checkpoint that count as near it
_CACHED_SITES = 4  # whose solids' bounds are cached


class Bodies(Connection):
    """Site with its checkpoints and a robot, as bodies in PyBullet. It holds all poses.

    Nothing moves by itself: callers set all poses. PyBullet receives the robot's pose and joints
    only before a query, since most poses of a robot that drives in the open are never queried.
    """

    def __init__(
        self,
        site: Site,
        robot: RobotSpec,
        gui: bool,
        elements: tuple[Element, ...],
        drawn: bool,
    ) -> None:
        """Load all bodies.

        Args:
            site: site as planned.
            robot: description of the robot.
            gui: True to open a window.
            elements: solids that the site really has; faults may have added or removed some.
            drawn: True to load what pictures show; without it, loading takes half the time.
        """
        super().__init__(gui)
        self._gui = gui
        self._drawn = gui or drawn
        self.site = site
        self.robot = robot
        self._solids = elements
        self._placements: dict[int, Placement] = {}
        self._pose = BodyPose(0.0, 0.0, 0.0, 0.0)
        self._posture: dict[str, float] = {}
        self._unsynced_joints: dict[str, float] = {}  # positions that PyBullet may not have yet
        self._pose_unsynced = False  # True if PyBullet may not have the robot's pose yet
        # Caches; None if joints or checkpoints were moved since they were computed.
        self._robot_bounds: tuple[SolidBounds, SolidBounds] | None = None
        self._clearance: Clearance | None = None
        self._checkpoint_bounds: SolidBounds | None = None  # one box for each checkpoint
        self._scene_changed = True  # True if other bodies moved since the last collision detection
        self._screens: dict[int, str] = {}
        with tempfile.TemporaryDirectory() as folder:
            temporary = Path(folder)
            self._site_body = self._load_site(temporary)
            self._checkpoints = {
                c.id: self._load_checkpoint(c, temporary) for c in site.checkpoints
            }
            robot_file = self._body_file(robot_folder() / robot.urdf, temporary)
            self._robot_body = self._load(robot_file, fixed=False)
        self._site_links = self._links(self._site_body)
        self._robot_links = self._links(self._robot_body)
        self._joints = self._joint_indices(self._robot_body)
        self._walkable_materials = {e.material for e in elements if e.role in WALKING_ROLES}
        self._filter(self._robot_body, _ROBOT_BIT, SITE_BIT)
        for body in (self._site_body, *self._checkpoints.values()):
            self._filter(body, SITE_BIT, _SITE_MASK)
        self.set_arm_degrees(robot.arm_stowed)

    @property
    def solids(self) -> tuple[Element, ...]:
        """Solids that the site really has, with those that faults add or remove; no checkpoints."""
        return self._solids

    def place_robot(self, pose: BodyPose) -> None:
        """Set the robot's pose, without regard to obstacles."""
        self._pose, self._pose_unsynced = pose, True
        if self._gui:
            self._sync_robot()

    def set_joints(self, positions: Mapping[str, float]) -> None:
        """Set joints of the robot to positions (rad), given by their names."""
        for name, position in positions.items():
            if self._posture.get(name) != position:
                self._posture[name], self._robot_bounds = position, None
            self._unsynced_joints[name] = position
        if self._gui:
            self._sync_robot()

    def joint_positions(self, names: Sequence[str]) -> list[float]:
        """Return the positions (rad) of joints of the robot, in the order of their names."""
        self._sync_robot()
        states = pybullet.getJointStates(
            self._robot_body, [self._joints[n] for n in names], physicsClientId=self._client
        )
        return [state[0] for state in states]

    def set_arm_degrees(self, joints: Mapping[str, float]) -> None:
        """Set the arm's joints to positions in degrees, such as the robot's `arm_stowed`."""
        self.set_joints({name: math.radians(angle) for name, angle in joints.items()})

    def show_value(self, checkpoint_id: int, value: float) -> None:
        """Move the needle, float or lever of a checkpoint to a value in its unit.

        A value out of the checkpoint's range moves it beyond the ends of the scale. Raises NotFound
        if there is no such checkpoint.
        """
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
        self._scene_changed = True

    def set_displacement(self, checkpoint_id: int, placement: Placement) -> None:
        """Set the displacement of a checkpoint from its planned pose, instead of an earlier one.

        Raises NotFound if there is no such checkpoint.
        """
        planned = self.site.checkpoint(checkpoint_id)
        self._placements[checkpoint_id] = placement
        actual = self.actual_checkpoint(checkpoint_id)
        rpy = (placement.roll, 0.0, planned.yaw + placement.turn)
        self._place(self._checkpoints[checkpoint_id], actual.position, rpy)
        self._scene_changed, self._clearance, self._checkpoint_bounds = True, None, None
        self._detect()

    def placement(self, checkpoint_id: int) -> Placement:
        """Return the displacement of a checkpoint from its planned pose, `AS_PLANNED` by default.

        That is also returned if there is no such checkpoint.
        """
        return self._placements.get(checkpoint_id, AS_PLANNED)

    def actual_checkpoint(self, checkpoint_id: int) -> SiteCheckpoint:
        """Return the checkpoint with its actual pose.

        Raises NotFound if there is no such checkpoint.
        """
        return displaced_checkpoint(
            self.site.checkpoint(checkpoint_id), self.placement(checkpoint_id)
        )

    def add_screen(self, name: str, solid: Solid, colour: Vector) -> int:
        """Add a solid to the world, which blocks lines of sight, and return its number.

        `name` is its name as an obstacle. `colour` is red, green and blue from 0 to 1.
        """
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
        self._filter(body, SITE_BIT, _SITE_MASK)
        self._screens[body] = name
        self._detect()
        return body

    def remove_screen(self, number: int) -> None:
        """Remove a solid that `add_screen` has added; raise KeyError if there is none."""
        del self._screens[number]
        pybullet.removeBody(number, physicsClientId=self._client)
        self._detect()

    def has_only_fixed_solids_near(self, low: Vector, high: Vector) -> bool:
        """Return True if nothing near the box between two corners (m) can move or be removed.

        That is, there is no checkpoint near it, and no screen in the world.
        """
        box = SolidBounds(np.array(low) - _NEAR_CHECKPOINT, np.array(high) + _NEAR_CHECKPOINT)
        return not self._screens and not self._bounds_of_checkpoints().overlapping(box).any()

    def _bounds_of_checkpoints(self) -> SolidBounds:
        """Return one box around each checkpoint, for any position of its indicator."""
        if self._checkpoint_bounds is None:
            boxes = [self._box(b, self._links(b)) for b in self._checkpoints.values()]
            low = np.array([box.low for box in boxes]).reshape(-1, 3)
            high = np.array([box.high for box in boxes]).reshape(-1, 3)
            self._checkpoint_bounds = SolidBounds(low - _INDICATOR, high + _INDICATOR)
        return self._checkpoint_bounds

    def _is_clear(self) -> bool:
        """Return True if the robot surely has no contact with anything that it must not touch."""
        return self._is_clear_at(self._pose)

    def _is_clear_at(self, pose: BodyPose) -> bool:
        """Return True if the robot would surely touch nothing at `pose` that it must not touch."""
        if self._scene_changed or self._screens:
            return False
        if self._clearance is None:
            solids, are_walkable = _bounds_of(self._solids)
            checkpoints = self._bounds_of_checkpoints()
            self._clearance = Clearance(
                SolidBounds(
                    np.concatenate([solids.low, checkpoints.low]),
                    np.concatenate([solids.high, checkpoints.high]),
                ),
                np.concatenate([are_walkable, np.zeros(len(checkpoints.low), dtype=bool)]),
            )
        if self._robot_bounds is None:
            self._sync_robot()
            self._place(self._robot_body, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            self._pose_unsynced = True
            upper = [
                k for k, name in self._robot_links.items() if not name.endswith(STANDING_LINKS)
            ]
            body = self._robot_body
            self._robot_bounds = self._box(body, self._robot_links), self._box(body, upper)
        return self._clearance.is_surely_clear(pose, *self._robot_bounds, self.contact_breaking)

    def _detect(self) -> None:
        self._sync_robot()
        super()._detect()

    def _sync_robot(self) -> None:
        """Pass the robot's pose and joint positions to PyBullet, if they changed."""
        for name, position in self._unsynced_joints.items():
            pybullet.resetJointState(
                self._robot_body, self._joints[name], position, physicsClientId=self._client
            )
        self._unsynced_joints.clear()
        if self._pose_unsynced:
            at = self._pose
            self._place(self._robot_body, (at.x, at.y, at.z), (at.roll, at.pitch, at.yaw))
            self._pose_unsynced = False

    def _box(self, body: int, links: Iterable[int]) -> SolidBounds:
        """Return the box around links of a body, parallel to the site's axes."""
        boxes = [pybullet.getAABB(body, link, physicsClientId=self._client) for link in links]
        return SolidBounds.one_box_around_all(
            [SolidBounds(np.array(low), np.array(high)) for low, high in boxes]
        )

    def _name_at(self, body: int, link: int, point: Vector) -> str:
        """Return the name of the checkpoint, screen or element at a point (m) of a body's link."""
        for id, checkpoint_body in self._checkpoints.items():
            if body == checkpoint_body:
                return self.site.checkpoint(id).name
        if body in self._screens:
            return self._screens[body]
        return self._elements[self._site_links[link]].nearest(point)

    @cached_property
    def _elements(self) -> dict[str, ElementIndex]:
        return {m: ElementIndex(self._solids, m) for m in {e.material for e in self._solids}}

    def _load_site(self, folder: Path) -> int:
        path = folder / "site.urdf"
        path.write_text(to_urdf(self.site.name, self._solids, self._drawn), encoding="utf-8")
        return self._load(path, fixed=True)

    def _load_checkpoint(self, checkpoint: SiteCheckpoint, folder: Path) -> int:
        name = checkpoint.kind.value.replace(" ", "_")
        path = resources.urdf_folder() / "checkpoints" / f"{name}.urdf"
        body = self._load(self._body_file(path, folder), fixed=True)
        self._place(body, checkpoint.position, (0.0, 0.0, checkpoint.yaw))
        return body

    def _body_file(self, path: Path, folder: Path) -> Path:
        """Return the file of a body or, in a world without pictures, a copy without visuals.

        The copy is written to `folder`.
        """
        if self._drawn:
            return path
        bare = folder / path.name
        bare.write_text(_without_visuals(path), encoding="utf-8")
        return bare

    def _filter(self, body: int, group: int, mask: int) -> None:
        """Set the collision group and mask of all links of a body."""
        for link in self._links(body):
            pybullet.setCollisionFilterGroupMask(
                body, link, group, mask, physicsClientId=self._client
            )

    def _links(self, body: int) -> dict[int, str]:
        base = pybullet.getBodyInfo(body, physicsClientId=self._client)[0].decode()
        return {-1: base} | {k: link for k, (_, link) in self._parts(body).items()}

    def _joint_indices(self, body: int) -> dict[str, int]:
        return {joint: k for k, (joint, _) in self._parts(body).items()}


@lru_cache(maxsize=8)  # for the robot and each kind of checkpoint
def _without_visuals(path: Path) -> str:
    """Return the content of a URDF file without its visuals."""
    robot = ElementTree.parse(path).getroot()
    for link in robot.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    return ElementTree.tostring(robot, encoding="unicode")


@lru_cache(maxsize=_CACHED_SITES)
def _bounds_of(elements: tuple[Element, ...]) -> tuple[SolidBounds, NDArray[np.bool_]]:
    """Return boxes parallel to the site's axes around all solids, and which solids are walkable.

    Wheels and tracks may stand on walkable solids. As in PyBullet, a solid is
    walkable if any of the elements with its material is walkable.
    """
    parts = [(e.material, s) for e in elements for s in e.solids]
    half = np.array([half_extents(solid) for _, solid in parts])
    center = np.array([solid.center for _, solid in parts])
    walkable = {e.material for e in elements if e.role in WALKING_ROLES}
    are_walkable = np.array([material in walkable for material, _ in parts])
    return SolidBounds(center - half, center + half), are_walkable
