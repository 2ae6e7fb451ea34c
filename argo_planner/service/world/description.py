"""Description of a site for the planner page, which states what the page has to load and draw."""

import hashlib
import math
from collections.abc import Sequence

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model, Pose
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_env.navigation import Navigator
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, heading_angle
from argo_env.planning.code import code_digest
from argo_env.planning.opening import OpenedSite
from argo_env.robot.spec import RobotSpec
from argo_env.site import SiteCheckpoint
from argo_env.site.build import Deck
from argo_env.site.shapes import Vector
from argo_env.site.spec import FloorSpec, Rect
from argo_planner.service.world.meshes import Detail
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

NORTH = math.pi / 2
"""direction of north in rad from the x axis: the y axis of a site points north"""


class DescribedFloor(Model):
    """Floor of a site."""

    number: int
    name: str
    z: float
    """height of its deck, in m"""
    storey: float
    """height from its deck to that of the next floor, in m"""
    bounds: Rect
    """bounding rectangle of its walkways, in m"""
    plates: tuple[Rect, ...]
    """its deck without the openings, as rectangles that do not overlap, in m"""
    corners: tuple[Pose, ...] = ()
    """poses of a patrol of the floor, in their order"""


class DescribedCheckpoint(Worded):
    """Checkpoint, with the pose that it is read from."""

    id: int
    name: str
    kind: CheckpointKind
    unit: str
    range: Interval
    nominal: Interval
    position: Vector
    """centre of its face, in m"""
    facing: float
    """yaw of the direction that its face points in, in rad"""
    floor: int
    """number of its floor"""
    stands: Pose | None = None
    """pose from which the robot reads it, coming from the dock of the lowest number; it may take
    another one if it comes from elsewhere; None: the robot can't read it"""
    problem: Text | None = None
    """why the robot can't read it; None: it can"""
    problem_wording: Wording | None = wording_field("problem")


class DescribedDock(Model):
    """Docking station."""

    area: int
    """number of its starting area"""
    pose: Pose
    """pose of the docked robot"""


class DescribedPlace(Model):
    """Named location that scripts may use."""

    name: str
    pose: Pose


class DescribedRobot(Model):
    """Robot of the site: its dimensions in m and its speeds."""

    name: str
    length: float
    width: float
    height: float
    """height with the arm stowed"""
    front: float
    """distance from the point of rotation to the front"""
    rear: float
    """distance from the point of rotation to the rear"""
    speed: float
    """speed on flat ground, in m/s"""
    reverse_speed: float
    """speed backwards, in m/s"""
    stair_up_speed: float
    """speed up stairs, along the slope, in m/s"""
    stair_down_speed: float
    """speed down stairs, along the slope, in m/s"""
    turn_rate: float
    """rate of turns in place, in rad/s"""
    measuring_time: float
    """duration of a measurement, in s"""
    battery: float
    """energy that may be used on one charge, in Wh"""


class WorldDescription(Model):
    """Site for a page; lengths in m, angles in rad, z upwards."""

    name: str
    title: str
    digest: str
    """digest that changes if the description, a mesh or a map may have changed"""
    north: float = NORTH
    """direction of north in the site's frame"""
    ground: Rect
    """rectangle that contains the whole site"""
    ground_z: float
    """height of the ground"""
    cell: float = CELL
    """edge of a cell of the maps of where the robot can stand"""
    headings: tuple[float, ...]
    """headings of these maps, by number"""
    details: tuple[Detail, ...] = tuple(Detail)
    """levels of detail of the meshes, the finest first"""
    floors: tuple[DescribedFloor, ...]
    checkpoints: tuple[DescribedCheckpoint, ...]
    docks: tuple[DescribedDock, ...]
    places: tuple[DescribedPlace, ...]
    """named locations, each of which a reaction may have as its safe area"""
    robot: DescribedRobot
    obstacles: tuple[Obstacle, ...] = ()


def describe_world(site: OpenedSite, obstacles: Sequence[Obstacle] = ()) -> WorldDescription:
    """Return the description of a site with obstacles on it."""
    plan, spec = site.site, site.site.spec
    navigator = with_obstacles(site, obstacles).navigator
    patrols = {floor.number: floor.patrol for floor in site.catalog.floors}
    return WorldDescription(
        name=plan.name,
        title=spec.title,
        digest=world_digest(site, obstacles),
        ground=spec.ground,
        ground_z=spec.ground_z,
        headings=tuple(heading_angle(k) for k in range(HEADINGS)),
        floors=tuple(_floor(floor, spec.storey, patrols[floor.number]) for floor in spec.floors),
        checkpoints=tuple(_checkpoint(c, navigator) for c in plan.checkpoints),
        docks=tuple(DescribedDock(area=n, pose=p) for n, p in sorted(plan.docks.items())),
        places=tuple(DescribedPlace(name=name, pose=pose) for name, pose in plan.places.items()),
        robot=_robot(site.robot),
        obstacles=tuple(obstacles),
    )


def world_digest(site: OpenedSite, obstacles: Sequence[Obstacle] = ()) -> str:
    """Return a digest of the site with its robot, the obstacles, and the code that plans on it."""
    sink = hashlib.blake2b(f"{site.digest} {code_digest()}".encode(), digest_size=16)
    for obstacle in obstacles:
        sink.update(obstacle.model_dump_json().encode() + b"\n")
    return sink.hexdigest()


def _floor(floor: FloorSpec, storey: float, patrol: tuple[Pose, ...]) -> DescribedFloor:
    walkways = tuple(floor.walkways.values())
    plates = Deck.from_rectangles(walkways, tuple(floor.openings.values())).plates()
    x0, y0, x1, y1 = zip(*walkways, strict=True)
    return DescribedFloor(
        number=floor.number,
        name=Message("Floor {number}", number=floor.number),
        z=floor.z,
        storey=storey,
        bounds=(min(x0), min(y0), max(x1), max(y1)),
        plates=tuple(plates),
        corners=patrol,
    )


def _checkpoint(checkpoint: SiteCheckpoint, navigator: Navigator) -> DescribedCheckpoint:
    stands, problem = None, None
    try:
        stands = navigator.viewing_pose(checkpoint.id)
    except ArgoError as error:
        problem = str(error)
    return DescribedCheckpoint(
        id=checkpoint.id,
        name=checkpoint.name,
        kind=checkpoint.kind,
        unit=checkpoint.unit,
        range=checkpoint.range,
        nominal=checkpoint.nominal,
        position=checkpoint.position,
        facing=checkpoint.yaw,
        floor=checkpoint.floor,
        stands=stands,
        problem=problem,
    )


def _robot(robot: RobotSpec) -> DescribedRobot:
    footprint = robot.footprint
    return DescribedRobot(
        name=robot.name,
        length=footprint.front + footprint.rear,
        width=2 * footprint.half_width,
        height=robot.driving_height,
        front=footprint.front,
        rear=footprint.rear,
        speed=robot.speed,
        reverse_speed=robot.reverse_speed,
        stair_up_speed=robot.stair_up_speed,
        stair_down_speed=robot.stair_down_speed,
        turn_rate=robot.turn_rate_radians,
        measuring_time=robot.sensor.measuring_time,
        battery=robot.battery,
    )
