"""Travel times and energy of a robot on a site, for the analysis of missions; ways that were
planned are kept on disk, as the same missions are checked again and again."""

import hashlib
import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from argo_compiler.analysis import Leg, NoPath, RobotPose
from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.il import MAX_TIME_S, Action, Mission, Task
from argo_env.drives.timetable import count_steps
from argo_env.files.parts import Parts
from argo_env.navigation.path import Motion, Path
from argo_env.planning.start import start_pose
from argo_env.robot.spec import MotionKind, RobotSpec
from argo_env.site import Site

if TYPE_CHECKING:
    from argo_env.navigation import Navigator

_PLACES = 1 << 14  # files at most, a few kB each; a new way takes the place of an older one

Way = Path | NoPath


def kept_way(parts: Parts, asked: object, plan: Callable[[], Path]) -> Way:
    """What `plan` gives, or why it gives nothing; from `parts` if the same was `asked` before.

    `asked` is what the way depends on, as data that JSON can say exactly.
    """
    question = json.dumps(asked)
    digest = hashlib.blake2b(question.encode(), digest_size=8).digest()
    name = f"way-{int.from_bytes(digest) % _PLACES:04x}"
    found, _, answer = (parts.load_text(name) or "").partition("\n")
    if found == question:
        return _to_way(json.loads(answer))
    try:
        way: Way = plan()
    except ArgoError as error:
        way = NoPath(str(error))
    parts.store_text(name, f"{question}\n{json.dumps(_to_data(way))}")
    return way


def as_data(pose: Pose) -> tuple[float, float, float, float]:
    """A pose to ask with."""
    return pose.x, pose.y, pose.z, pose.yaw


def _to_data(way: Way) -> dict[str, Any]:
    if isinstance(way, NoPath):
        return {"reason": way.reason}
    motions = [
        (*as_data(m.start), *as_data(m.end), m.turn, int(m.gear), bool(m.on_stairs))
        for m in way.motions
    ]
    return {"start": as_data(way.start), "motions": motions}


def _to_way(data: dict[str, Any]) -> Way:
    if "reason" in data:
        return NoPath(data["reason"])
    motions = [Motion(_pose(row[:4]), _pose(row[4:8]), *row[8:]) for row in data["motions"]]
    return Path(_pose(data["start"]), tuple(motions))


def _pose(row: list[float]) -> Pose:
    x, y, z, yaw = row
    return Pose(x=x, y=y, z=z, yaw=yaw)


class NavigatedSite(Protocol):
    """A site whose navigator is made when it is first asked for."""

    site: Site
    robot: RobotSpec
    parts: Parts

    @property
    def navigator(self) -> "Navigator": ...


class SiteTravel:
    """The ways that the navigator plans, with the times of a drive that follows them.

    A standing is a pose. Keeps every way that it was asked for, on an opened site also on disk.
    With the `time_step` (s) of the drive that is meant, times are rounded up to whole steps, as the
    drive's are.
    """

    def __init__(self, on: "Navigator | NavigatedSite", time_step: float = 0.1) -> None:
        self._on = on
        self._robot = on.robot
        self._parts = on.parts
        self.time_step = time_step
        self._ways: dict[tuple[Pose, str | Pose | None], Path | NoPath] = {}
        self._legs: dict[tuple[Pose, str | Pose | None, Action, float | None], Leg | NoPath] = {}

    @property
    def _navigator(self) -> "Navigator":
        # Not before a way is asked for that is not kept: it takes a while to import.
        from argo_env.navigation import Navigator

        return self._on if isinstance(self._on, Navigator) else self._on.navigator

    @property
    def battery(self) -> float:
        """Wh."""
        return self._robot.battery

    @property
    def standing_power(self) -> float:
        """W."""
        return self._robot.power.standing

    @property
    def clean_up(self) -> float:
        """s, to stow the arm."""
        return self._stepped(self._robot.sensor.stowing_time) + self.time_step

    def start(self, mission: Mission) -> Pose:
        """Where the robot is put: the pose of START, or the dock of the starting area.

        Raises Unreachable if the robot can't stand there.
        """
        pose = start_pose(mission, self._on.site.docks)
        standing = kept_way(
            self._parts, ["stand", as_data(pose)], lambda: Path(self._navigator.snap(pose), ())
        )
        if isinstance(standing, NoPath):
            raise Unreachable(standing.reason)
        return standing.start

    def work(self, task: Task) -> float:
        """s of a task's action that the robot takes even if it is there already."""
        measures = task.action is Action.MEASURE
        return self._stepped(self._robot.sensor.measuring_time) if measures else 0.0

    def way(self, origin: Pose, task: Task) -> Path:
        """The way to the task's place. Raises ArgoError if there is none."""
        way = self._way(origin, task.pose or task.object_id)
        if isinstance(way, NoPath):
            raise Unreachable(f"the robot can't carry out task '{task.name}': {way.reason}")
        return way

    def leg(self, origin: RobotPose, task: Task, velocity: float | None) -> Leg | NoPath:
        """The way to the task's place at `velocity` (m/s), and its action."""
        assert isinstance(origin, Pose)
        if task.action is Action.WAIT:
            return Leg(0.0, 0.0, origin)
        place = task.pose or task.object_id
        key = origin, place, task.action, velocity
        if key not in self._legs:
            way = self._way(origin, place)
            work = self.work(task)
            self._legs[key] = way if isinstance(way, NoPath) else self._leg(way, velocity, work)
        return self._legs[key]

    def _way(self, origin: Pose, place: str | Pose | None) -> Path | NoPath:
        key = origin, place
        if key not in self._ways:
            asked = as_data(place) if isinstance(place, Pose) else place
            self._ways[key] = kept_way(
                self._parts, ["way", as_data(origin), asked], lambda: self._plan(origin, place)
            )
        return self._ways[key]

    def _plan(self, origin: Pose, place: str | Pose | None) -> Path:
        if isinstance(place, Pose):
            return self._navigator.plan(origin, place)
        checkpoint = self._on.site.checkpoint_for(place)
        return self._navigator.plan_to_view(origin, checkpoint.id)

    def _leg(self, way: Path, velocity: float | None, work: float) -> Leg | NoPath:
        robot, power = self._robot, self._robot.power
        seconds = way.duration(robot, velocity)
        if seconds > MAX_TIME_S:
            return NoPath(f"at {velocity} m/s the way there takes longer than any mission")
        drive = max(self.time_step, self._stepped(seconds))
        energy = sum(m.duration(robot, velocity) * self._watts(m) for m in way.motions) / 3600
        work_energy = work * power.measuring / 3600
        return Leg(drive + work, energy + work_energy, way.end, work, work_energy)

    def _watts(self, motion: Motion) -> float:
        power = self._robot.power
        return {
            MotionKind.TURN: power.turning,
            MotionKind.UP: power.climbing,
            MotionKind.DOWN: power.descending,
        }.get(motion.kind, power.driving)

    def _stepped(self, seconds: float) -> float:
        return count_steps(seconds, self.time_step) * self.time_step
