"""What a page needs to know of a site before it draws anything."""

import hashlib
import math
from collections.abc import Sequence

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Model, Pose
from argo_env.navigation import Navigator
from argo_env.navigation.raster import CELL
from argo_env.navigation.stencil import HEADINGS, heading_angle
from argo_env.planning.code import digest_of_code
from argo_env.planning.opening import OpenedSite
from argo_env.robot.spec import RobotSpec
from argo_env.site import SiteCheckpoint
from argo_env.site.build import Deck
from argo_env.site.shapes import Vector
from argo_env.site.spec import FloorSpec, Rect
from argo_planner.service.world.meshes import Detail
from argo_planner.service.world.obstacles import Obstacle, with_obstacles

NORTH = math.pi / 2
"""rad from the x axis: sites are drawn with y to the north"""


class DescribedFloor(Model):
    """A floor."""

    number: int
    name: str
    z: float
    """m, of its deck"""
    storey: float
    """m up to the next floor"""
    bounds: Rect
    """m, around its walkways"""
    plates: tuple[Rect, ...]
    """m, its deck without the openings, in rectangles that do not overlap"""
    corners: tuple[Pose, ...] = ()
    """of a patrol of the floor, in its order"""


class DescribedCheckpoint(Model):
    """A checkpoint, and where it is read from."""

    id: int
    name: str
    kind: CheckpointKind
    unit: str
    range: Interval
    nominal: Interval
    position: Vector
    """m, the middle of its face"""
    facing: float
    """rad, where its face looks"""
    floor: int
    stands: Pose | None = None
    """where the robot stands to read it, coming from the dock of the lowest number; coming from
    elsewhere it may take another place"""
    problem: str | None = None
    """why the robot can't read it; None: it can"""


class DescribedDock(Model):
    """A docking station."""

    area: int
    """number of its starting area"""
    pose: Pose
    """of the docked robot"""


class DescribedPlace(Model):
    """A place that scripts may name."""

    name: str
    pose: Pose


class DescribedRobot(Model):
    """The robot that drives there; lengths in m, about its point of rotation."""

    name: str
    length: float
    width: float
    height: float
    """with the arm stowed"""
    front: float
    """from the point of rotation"""
    rear: float
    """from the point of rotation"""
    speed: float
    """m/s on the flat"""
    reverse_speed: float
    """m/s"""
    stair_up_speed: float
    """m/s along the slope"""
    stair_down_speed: float
    """m/s along the slope"""
    turn_rate: float
    """rad/s"""
    measuring_time: float
    """s"""
    battery: float
    """Wh that may be used on one charge"""


class WorldDescription(Model):
    """A site for a page. Lengths in m, angles in rad, z upwards; a unit of the frame is 1 m."""

    name: str
    title: str
    digest: str
    """changes with all that is told of the site, its meshes and maps"""
    north: float = NORTH
    """rad, the direction of the north in the site's frame"""
    ground: Rect
    """m, the area that all lies in"""
    ground_z: float
    """m"""
    cell: float = CELL
    """m, of the maps of where the robot can stand"""
    headings: tuple[float, ...]
    """rad, of the maps, by number"""
    details: tuple[Detail, ...] = tuple(Detail)
    """of the meshes, the finest first"""
    floors: tuple[DescribedFloor, ...]
    checkpoints: tuple[DescribedCheckpoint, ...]
    docks: tuple[DescribedDock, ...]
    places: tuple[DescribedPlace, ...]
    """any of which a reaction may have as its safe area"""
    robot: DescribedRobot
    obstacles: tuple[Obstacle, ...] = ()


def describe(site: OpenedSite, obstacles: Sequence[Obstacle] = ()) -> WorldDescription:
    """The description of a site with obstacles on it."""
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
    """What names the site with its robot, the obstacles, and the code that plans on it."""
    sink = hashlib.blake2b(f"{site.digest} {digest_of_code()}".encode(), digest_size=16)
    for obstacle in obstacles:
        sink.update(obstacle.model_dump_json().encode() + b"\n")
    return sink.hexdigest()


def _floor(floor: FloorSpec, storey: float, patrol: tuple[Pose, ...]) -> DescribedFloor:
    walkways = tuple(floor.walkways.values())
    plates = Deck.from_rectangles(walkways, tuple(floor.openings.values())).plates()
    x0, y0, x1, y1 = zip(*walkways, strict=True)
    return DescribedFloor(
        number=floor.number,
        name=f"Floor {floor.number}",
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
