"""Travel times and energy of a robot on a site, for the analysis of missions.

Planned paths are cached on disk, as the same missions are checked repeatedly.
"""

import hashlib
import json
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from argo_compiler.analysis import Leg, NoPath, RobotPose
from argo_compiler.base.errors import ArgoError, Unreachable
from argo_compiler.base.message import Message
from argo_compiler.base.model import Pose
from argo_compiler.base.wording import Wording, worded, wording_of
from argo_compiler.il import MAX_TIME_S, Action, Mission, Task
from argo_env.drives.timetable import count_steps
from argo_env.files.parts import Parts
from argo_env.navigation.path import Motion, Path
from argo_env.planning.start import start_pose_or_area_dock
from argo_env.robot.spec import MotionKind, RobotSpec
from argo_env.site import Site

if TYPE_CHECKING:
    from argo_env.navigation import Navigator

_MAX_FILES = 1 << 14  # in the cache, a few kB each; a new path may replace an older one

PathOrReason = Path | NoPath
"""a path, or the reason why there is none"""


def cached_path(parts: Parts, query: object, plan: Callable[[], Path]) -> PathOrReason:
    """Return the path of a query from the disk cache, or from `plan`, and then store it.

    If there is no path, the reason is returned, which is stored as well.

    Args:
        parts: Cache on disk.
        query: Everything that the path depends on, as data that JSON represents exactly.
        plan: Function that plans the path; it raises ArgoError if there is none.
    """
    key = json.dumps(query)
    digest = hashlib.blake2b(key.encode(), digest_size=8).digest()
    name = f"way-{int.from_bytes(digest) % _MAX_FILES:04x}"
    cached_key, _, content = (parts.load_text(name) or "").partition("\n")
    if cached_key == key:
        return _from_data(json.loads(content))
    try:
        path: PathOrReason = plan()
    except ArgoError as error:
        path = NoPath(str(error))
    parts.store_text(name, f"{key}\n{json.dumps(_to_data(path))}")
    return path


def pose_data(pose: Pose) -> tuple[float, float, float, float]:
    """Return a pose as data for a query: x, y, z, yaw."""
    return pose.x, pose.y, pose.z, pose.yaw


def _to_data(path: PathOrReason) -> dict[str, Any]:
    if isinstance(path, NoPath):
        return {"reason": path.reason} | _wording_data(path.reason)
    motions = [
        (*pose_data(m.start), *pose_data(m.end), m.turn, int(m.gear), bool(m.on_stairs))
        for m in path.motions
    ]
    return {"start": pose_data(path.start), "motions": motions}


def _wording_data(reason: str) -> dict[str, Any]:
    wording = wording_of(reason)
    return {} if wording is None else {"wording": wording.model_dump(mode="json")}


def _from_data(data: dict[str, Any]) -> PathOrReason:
    if "reason" in data:
        wording = data.get("wording")
        return NoPath(worded(data["reason"], wording and Wording.model_validate(wording)))
    motions = [Motion(_pose(row[:4]), _pose(row[4:8]), *row[8:]) for row in data["motions"]]
    return Path(_pose(data["start"]), tuple(motions))


def _pose(row: list[float]) -> Pose:
    x, y, z, yaw = row
    return Pose(x=x, y=y, z=z, yaw=yaw)


class NavigatedSite(Protocol):
    """A site whose navigator is made when it is first needed."""

    site: Site
    robot: RobotSpec
    parts: Parts

    @property
    def navigator(self) -> "Navigator": ...


class SiteTravel:
    """Paths of the navigator, with the times and energies of a drive that follows them.

    It implements `argo_compiler.analysis.travel.Travel`; a `RobotPose` is a `Pose`. All paths are
    kept in memory, and on disk if the site has a cache. Times are rounded up to whole time steps
    of the drive, as the drive's times are.
    """

    def __init__(self, on: "Navigator | NavigatedSite", time_step: float = 0.1) -> None:
        """Create the travel times on a site; `time_step` is that of the drive, in s."""
        self._on = on
        self._robot = on.robot
        self._parts = on.parts
        self.time_step = time_step
        self._paths: dict[tuple[Pose, str | Pose | None], Path | NoPath] = {}
        self._legs: dict[tuple[Pose, str | Pose | None, Action, float | None], Leg | NoPath] = {}

    @property
    def _navigator(self) -> "Navigator":
        # Imported for paths that are not cached only, as the import takes a while.
        from argo_env.navigation import Navigator

        return self._on if isinstance(self._on, Navigator) else self._on.navigator

    @property
    def battery(self) -> float:
        """Energy of one battery charge in Wh."""
        return self._robot.battery

    @property
    def standing_power(self) -> float:
        """Power in W that the robot draws while it stands."""
        return self._robot.power.standing

    @property
    def charging_power(self) -> float:
        """Power in W that charges the battery at a dock."""
        return self._robot.power.charging

    @property
    def longest_cancellation_time(self) -> float:
        """Greatest time in s from the cancellation of an action until the arm is stowed."""
        return self._round_up(self._robot.sensor.stowing_time) + self.time_step

    def start_pose(self, mission: Mission) -> Pose:
        """Return the pose at which the robot starts: that of START, or of the starting area's dock.

        It is moved to the nearest position at which the robot can stand. Raises Unreachable if none
        is near.
        """
        pose = start_pose_or_area_dock(mission, self._on.site.docks)
        path = cached_path(
            self._parts,
            ["stand", pose_data(pose)],
            lambda: Path(self._navigator.snap_keeping_heading(pose), ()),
        )
        if isinstance(path, NoPath):
            raise Unreachable(path.reason)
        return path.start

    def action_duration(self, task: Task) -> float:
        """Return the seconds that a task's action takes without the drive; 0 unless it measures."""
        measures = task.action is Action.MEASURE
        return self._round_up(self._robot.sensor.measuring_time) if measures else 0.0

    def plan_path(self, origin: Pose, task: Task) -> Path:
        """Return the path from `origin` to a task's pose, or to where its checkpoint can be read.

        Raises Unreachable if there is none.
        """
        path = self._find_path(origin, task.pose or task.object_id)
        if isinstance(path, NoPath):
            raise Unreachable(
                Message(
                    "the robot can't carry out task '{task}': {reason}",
                    task=task.name,
                    reason=path.reason,
                )
            )
        return path

    def leg_with_action(
        self, origin: RobotPose, task: Task, velocity: float | None
    ) -> Leg | NoPath:
        """Return the time and energy of the path from `origin` to a task, and of its action there.

        A WAIT takes no time and leaves the robot where it is. If there is no path, or it takes
        longer than any mission may, the result is a NoPath with the reason.

        Args:
            origin: Pose from which the robot starts.
            task: Task to execute.
            velocity: Speed in m/s; None: the robot's own speed.
        """
        assert isinstance(origin, Pose)
        if task.action is Action.WAIT:
            return Leg(0.0, 0.0, origin)
        goal = task.pose or task.object_id
        key = origin, goal, task.action, velocity
        if key not in self._legs:
            path = self._find_path(origin, goal)
            work = self.action_duration(task)
            self._legs[key] = path if isinstance(path, NoPath) else self._leg(path, velocity, work)
        return self._legs[key]

    def _find_path(self, origin: Pose, goal: str | Pose | None) -> Path | NoPath:
        """Return the path to a pose, or to a viewing pose of a checkpoint by its `object_id`.

        If there is no path, or `goal` is None, it is a NoPath with the reason.
        """
        key = origin, goal
        if key not in self._paths:
            goal_data = pose_data(goal) if isinstance(goal, Pose) else goal
            self._paths[key] = cached_path(
                self._parts, ["way", pose_data(origin), goal_data], lambda: self._plan(origin, goal)
            )
        return self._paths[key]

    def _plan(self, origin: Pose, goal: str | Pose | None) -> Path:
        if isinstance(goal, Pose):
            return self._navigator.plan(origin, goal)
        checkpoint = self._on.site.checkpoint_for(goal)
        return self._navigator.plan_to_view(origin, checkpoint.id)

    def _leg(self, path: Path, velocity: float | None, work: float) -> Leg | NoPath:
        robot, power = self._robot, self._robot.power
        seconds = path.duration(robot, velocity)
        if seconds > MAX_TIME_S:
            return NoPath(
                Message(
                    "at {velocity} m/s the path takes longer than any mission may",
                    velocity=velocity,
                )
            )
        drive = max(self.time_step, self._round_up(seconds))
        energy = (
            math.fsum(m.duration(robot, velocity) * self._power(m) for m in path.motions) / 3600
        )
        work_energy = work * power.measuring / 3600
        return Leg(drive + work, energy + work_energy, path.end, work, work_energy)

    def _power(self, motion: Motion) -> float:
        """Return the power in W that the robot draws during a motion."""
        power = self._robot.power
        return {
            MotionKind.TURN: power.turning,
            MotionKind.UP: power.climbing,
            MotionKind.DOWN: power.descending,
        }.get(motion.kind, power.driving)

    def _round_up(self, seconds: float) -> float:
        """Return a time rounded up to whole time steps."""
        return count_steps(seconds, self.time_step) * self.time_step
