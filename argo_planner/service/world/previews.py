"""The ways that the robot will take, by the planner that drives, without running anything."""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from itertools import pairwise

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.base.model import Model, Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.grouping import group_ranges
from argo_compiler.il.transitions import default_target, failure_targets, initial_task
from argo_env.navigation import Path
from argo_env.planning.opening import OpenedSite
from argo_env.planning.travel import SiteTravel
from argo_env.robot.spec import RobotSpec
from argo_planner.service.world.obstacles import Obstacle, require_on_site, with_obstacles

MOST_WAYS = 20_000
"""of a mission; more are not looked for"""
_DIGITS = 4  # of metres, radians and seconds


class PreviewedWay(Model):
    """A way to a place, and the action there."""

    points: tuple[tuple[float, float, float, float, float], ...] = ()
    """t (s since the robot sets off), x, y, z (m) and yaw (rad) wherever the motion changes; in
    between it is straight, or a turn in place"""
    time: float | None = None
    """s, of the way and the action; None: there is no way, and `problem` says why"""
    work: float = 0.0
    """s of the time that the action takes"""
    distance: float = 0.0
    """m along the ground"""
    climb: float = 0.0
    """m upwards, all ascents together"""
    energy: float = 0.0
    """Wh, of the way and the action"""
    end: Pose | None = None
    """where the robot stands then"""
    problem: str | None = None


class WayKind(StrEnum):
    """When a mission takes a way."""

    DEFAULT = "default"
    """nothing goes wrong and no condition holds, each round driven once"""
    BRANCH = "branch"
    """conditions hold"""
    FAILURE = "failure"
    """the task has failed, or missed its window"""
    ROUND = "round"
    """back to the first task of a round"""
    OTHER = "other"
    """as by default, but from a task that the default way does not come to"""


class MissionWay(Model):
    """A way of a mission."""

    source: str | None
    """the task that it comes from; None: where the robot begins"""
    target: str
    kind: WayKind
    way: PreviewedWay


class PreviewedMission(Model):
    """All ways of a mission but those after a time-out, the default ones first, in their order."""

    ways: tuple[MissionWay, ...] = ()
    time: float = 0.0
    """s, of the default way driven once, waits of a given length included"""
    distance: float = 0.0
    """m"""
    climb: float = 0.0
    """m"""
    energy: float = 0.0
    """Wh"""
    at_least: tuple[str, ...] = ()
    """why the totals may be less than what one pass takes; none: they are what it takes"""
    problems: tuple[str, ...] = ()
    """what can't be reached, and why"""
    complete: bool = True
    """whether all ways were looked at, and not only the first MOST_WAYS"""


def preview_way(
    site: OpenedSite, start: Pose, goal: Task | Pose, obstacles: Sequence[Obstacle] = ()
) -> PreviewedWay:
    """The way from `start` to a pose, or to a task's place with its action.

    Raises Invalid for a pose that is on no site, or a task to which no way can lead, and
    DiagnosticError for one that makes no sense whatever comes before and after it.
    """
    require_on_site(start, "the start")
    if isinstance(goal, Task):
        _require_sound(goal, site.catalog)
    else:
        require_on_site(goal, "the goal")
    return _Ways(site, obstacles).way(start, goal)


def preview_mission(
    site: OpenedSite, mission: Mission, obstacles: Sequence[Obstacle] = ()
) -> PreviewedMission:
    """The ways of a mission that has no errors. Raises Unreachable if the robot can't stand where
    it begins, NotFound or Invalid for a mission whose tasks lead to none that is there."""
    ways = _Ways(site, obstacles)
    tasks = {task.name: task for task in mission.tasks}
    start, first = ways.travel.start(mission), initial_task(mission)
    if first is None:
        return PreviewedMission()
    order = _default_order(tasks, first)
    standing: dict[str, Pose] = {}
    found: list[MissionWay] = []
    source: str | None = None
    here = start
    for name in order:
        way = ways.way(here, tasks[name])
        found.append(MissionWay(source=source, target=name, kind=WayKind.DEFAULT, way=way))
        here = standing[name] = way.end or here  # as after a failure: it stays where it is
        source = name
    driven = len(found)
    complete = True
    for source_name, target, kind in _other_ways(mission, tasks, order):
        if len(found) >= MOST_WAYS:
            complete = False
            break
        way = ways.way(standing.get(source_name, start), tasks[target])
        standing.setdefault(target, way.end or standing.get(source_name, start))
        found.append(MissionWay(source=source_name, target=target, kind=kind, way=way))
    passed = [f.way for f in found[:driven]]
    waits = {name: _wait(tasks[name]) for name in order}
    waited = sum(seconds or 0.0 for seconds in waits.values())
    return PreviewedMission(
        ways=tuple(found),
        time=round(sum(way.time or 0.0 for way in passed) + waited, _DIGITS),
        distance=round(sum(way.distance for way in passed), _DIGITS),
        climb=round(sum(way.climb for way in passed), _DIGITS),
        energy=round(
            sum(way.energy for way in passed) + waited * site.robot.power.standing / 3600, _DIGITS
        ),
        at_least=tuple(_left_open(order, tasks, waits, found[:driven])),
        problems=tuple(dict.fromkeys(f.way.problem for f in found if f.way.problem)),
        complete=complete,
    )


class _Ways:
    """Ways on a site with obstacles, with the times of the drive that knows no forces."""

    def __init__(self, site: OpenedSite, obstacles: Sequence[Obstacle]) -> None:
        self._site = with_obstacles(site, obstacles)
        self.travel: SiteTravel = self._site.travel

    def way(self, start: Pose, goal: Task | Pose) -> PreviewedWay:
        task = _task_of(goal)
        if task.action is Action.WAIT:
            standing = (0.0, start.x, start.y, start.z, start.yaw)
            return PreviewedWay(time=0.0, points=(standing,), end=start)
        try:
            if task.pose is not None:
                require_on_site(task.pose, "its pose")
            leg = self.travel.leg(start, task, task.velocity)
            if isinstance(leg, NoPath):
                return PreviewedWay(problem=_not_there(goal, leg.reason))
            path = self.travel.way(start, task)
        except ArgoError as error:
            return PreviewedWay(problem=_not_there(goal, str(error)))
        return _previewed(leg, path, task.velocity, self._site.robot)


def _previewed(leg: Leg, path: Path, velocity: float | None, robot: RobotSpec) -> PreviewedWay:
    rows = path.timed_poses(robot, velocity).round(_DIGITS).tolist()
    return PreviewedWay(
        points=tuple((t, x, y, z, yaw) for t, x, y, z, yaw in rows),
        time=round(leg.duration, _DIGITS),
        work=round(leg.work, _DIGITS),
        distance=round(path.length, _DIGITS),
        climb=round(path.climb, _DIGITS),
        energy=round(leg.energy, _DIGITS),
        end=path.end,
    )


def _task_of(goal: Task | Pose) -> Task:
    if isinstance(goal, Task):
        return goal
    return Task(name="there", action=Action.WAYPOINT, pose=goal)


def _require_sound(task: Task, catalog: Catalog) -> None:
    """Raises Invalid or DiagnosticError for a task to which no way can lead. What it leads to is
    not looked at."""
    if task.action is Action.START:
        raise Invalid(f"task '{task.name}' only says where a mission begins: no way leads there")
    if task.pose is not None:
        require_on_site(task.pose, f"the pose of task '{task.name}'")
    onward = {"transitions": (), "on_failure": OnFailure.CONTINUE, "failure_target": None}
    alone = task.model_copy(update={**onward, "group": ""})
    if has_errors(found := check(Mission(tasks=(alone,)), catalog)):
        raise DiagnosticError(f"task '{task.name}'", found)


def _not_there(goal: Task | Pose, reason: str) -> str:
    return reason if isinstance(goal, Pose) else f"task '{goal.name}': {reason}"


def _default_order(tasks: dict[str, Task], first: str) -> list[str]:
    """The tasks that come one after the other by their unconditional transitions, each once."""
    order: dict[str, None] = {}
    name: str | None = first
    while name is not None and name not in order:
        order[_known(tasks, name).name] = None
        name = default_target(tasks[name])
    return list(order)


def _known(tasks: dict[str, Task], name: str) -> Task:
    if name not in tasks:
        raise NotFound(f"the mission has no task '{name}', and one leads there")
    if tasks[name].action is Action.START:
        raise Invalid(f"task '{name}' only says where the mission begins, and one leads there")
    return tasks[name]


def _other_ways(
    mission: Mission, tasks: dict[str, Task], order: Sequence[str]
) -> Iterator[tuple[str, str, WayKind]]:
    """The ways beside the default one, those from tasks that have been come to first."""
    onward: dict[str, list[tuple[str, WayKind]]] = {name: [] for name in tasks}
    for task in mission.tasks:
        if task.action is Action.START:
            continue
        for transition in task.transitions:
            kind = WayKind.BRANCH if transition.conditions else WayKind.OTHER
            onward[task.name].append((transition.target, kind))
        onward[task.name] += [
            (target, WayKind.FAILURE) for target in failure_targets(task).values()
        ]
    for around in group_ranges(mission):
        onward[around.group.end].append((around.group.start, WayKind.ROUND))
    driven = set(pairwise(order))
    come_to = dict.fromkeys(order)
    waiting = list(order)
    for name in waiting:  # grows while it is gone through
        for target, kind in dict.fromkeys(onward[name]):
            _known(tasks, target)
            if kind is not WayKind.OTHER or (name, target) not in driven:
                yield name, target, kind
            if target not in come_to:
                come_to[target] = None
                waiting.append(target)


def _wait(task: Task) -> float | None:
    """s that a task waits; None: nobody knows."""
    if task.action is not Action.WAIT or task.wait is None:
        return 0.0
    return task.wait.duration


def _left_open(
    order: Sequence[str],
    tasks: dict[str, Task],
    waits: dict[str, float | None],
    ways: Sequence[MissionWay],
) -> Iterator[str]:
    for name in order:
        if waits[name] is None:
            yield f"task '{name}' waits for something that happens at its own time"
        window = tasks[name].window
        if window is not None and window.earliest > 0:
            yield f"task '{name}' may not begin before {window.earliest:g} s"
    for way in ways:
        if way.way.problem:
            yield f"there is no way to task '{way.target}'"
    if default_target(tasks[order[-1]]) is not None:
        yield "the default way has no end: it comes back to a task"
