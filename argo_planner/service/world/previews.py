"""Paths that the robot will take on a mission, with their times, without a run.

They come from the same planner as the paths of runs.
"""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from itertools import pairwise

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model, Pose
from argo_compiler.base.quantity_text import rounded_down
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.grouping import valid_ranges_parents_first
from argo_compiler.il.transitions import default_target, failure_targets_by_field, initial_task
from argo_env.formatting import rounded_time_text
from argo_env.navigation import Path
from argo_env.planning.opening import OpenedSite
from argo_env.planning.travel import SiteTravel
from argo_env.robot.spec import RobotSpec
from argo_planner.service.world.obstacles import (
    Obstacle,
    require_pose_within_limits,
    with_obstacles,
)

MOST_WAYS = 20_000
"""maximum number of paths in the preview of a mission"""
_DIGITS = 4  # decimal places of all numbers


class PreviewedWay(Worded):
    """Path to a pose, and the action there."""

    points: tuple[tuple[float, float, float, float, float], ...] = ()
    """t (s from the start of the path), x, y, z (m) and yaw (rad) at each change of motion; between
    two points the robot drives straight or turns in place"""
    time: float | None = None
    """duration of the path and the action, in s; None: there is no path"""
    work: float = 0.0
    """duration of the action, in s; part of `time`"""
    distance: float = 0.0
    """length along the ground, in m"""
    climb: float = 0.0
    """sum of all ascents, in m"""
    energy: float = 0.0
    """energy for the path and the action, in Wh"""
    end: Pose | None = None
    """pose of the robot at the end; None: there is no path"""
    problem: Text | None = None
    """why there is no path; None: there is one"""
    problem_wording: Wording | None = wording_field("problem")


class WayKind(StrEnum):
    """Condition under which a mission takes a path."""

    DEFAULT = "default"
    """the path is taken if nothing goes wrong and no condition is satisfied; rounds count once"""
    BRANCH = "branch"
    """the path is taken if conditions are satisfied"""
    FAILURE = "failure"
    """the path is taken if the task has failed or missed its window"""
    ROUND = "round"
    """the path leads back to the first task of a round"""
    OTHER = "other"
    """the path has no conditions, but starts at a task that the default paths do not reach"""


class MissionWay(Model):
    """Path of a mission from one task to another."""

    source: str | None
    """name of the task that it starts from; None: it starts where the robot starts"""
    target: str
    """name of the task that it leads to"""
    kind: WayKind
    way: PreviewedWay


class PreviewedMission(Model):
    """All paths of a mission except those after a time-out, the default ones first, in order."""

    ways: tuple[MissionWay, ...] = ()
    time: float = 0.0
    """duration of the default paths, their actions and waits of a given length, in s"""
    distance: float = 0.0
    """length of the default paths, in m"""
    climb: float = 0.0
    """sum of all ascents of the default paths, in m"""
    energy: float = 0.0
    """energy for the default paths, their actions and waits, in Wh"""
    at_least: tuple[Text, ...] = ()
    """why the mission may take more than these totals; empty: it takes exactly these"""
    at_least_wording: tuple[Wording | None, ...] = wording_field("at_least")
    problems: tuple[Text, ...] = ()
    """why tasks can't be reached"""
    problems_wording: tuple[Wording | None, ...] = wording_field("problems")
    complete: bool = True
    """whether `ways` has all paths; False: it has only the first MOST_WAYS"""


def preview_path(
    site: OpenedSite, start: Pose, goal: Task | Pose, obstacles: Sequence[Obstacle] = ()
) -> PreviewedWay:
    """Return the path from `start` to a pose or a task, with its time, climb and energy.

    For a task, time and energy include its action. If there is no path, the result's `problem`
    states why.

    Raises:
        Invalid: A pose is too far away for any site, or the task is a START task.
        DiagnosticError: The task itself has an error.
    """
    require_pose_within_limits(start, Message("the start"))
    if isinstance(goal, Task):
        _require_sound(goal, site.catalog)
    else:
        require_pose_within_limits(goal, Message("the goal"))
    return _PathPreviewer(site, obstacles).preview_path(start, goal)


def preview_mission(
    site: OpenedSite, mission: Mission, obstacles: Sequence[Obstacle] = ()
) -> PreviewedMission:
    """Return the paths between the tasks of a mission that has no errors, with times and energy.

    If a task can't be reached, this is one of the result's `problems`, not an error.

    Raises:
        Unreachable: The robot can't stand where the mission starts.
        NotFound: A task leads to one that does not exist.
        Invalid: A task leads to the START task.
    """
    previewer = _PathPreviewer(site, obstacles)
    tasks = {task.name: task for task in mission.tasks}
    start, first = previewer.travel.start_pose(mission), initial_task(mission)
    if first is None:
        return PreviewedMission()
    order = _default_order(tasks, first)
    end_poses: dict[str, Pose] = {}  # of the robot after each task
    paths: list[MissionWay] = []
    source: str | None = None
    pose = start
    for name in order:
        path = previewer.preview_path(pose, tasks[name])
        paths.append(MissionWay(source=source, target=name, kind=WayKind.DEFAULT, way=path))
        pose = end_poses[name] = path.end or pose  # as after a failure: the robot does not move
        source = name
    default_count = len(paths)
    complete = True
    for source_name, target, kind in _other_transitions(mission, tasks, order):
        if len(paths) >= MOST_WAYS:
            complete = False
            break
        path = previewer.preview_path(end_poses.get(source_name, start), tasks[target])
        end_poses.setdefault(target, path.end or end_poses.get(source_name, start))
        paths.append(MissionWay(source=source_name, target=target, kind=kind, way=path))
    default = [mission_path.way for mission_path in paths[:default_count]]
    waits = {name: _wait_duration(tasks[name]) for name in order}
    waiting_time = sum(seconds or 0.0 for seconds in waits.values())
    waiting_energy = waiting_time * site.robot.power.standing / 3600
    problems = (mission_path.way.problem for mission_path in paths)
    return PreviewedMission(
        ways=tuple(paths),
        time=round(sum(path.time or 0.0 for path in default) + waiting_time, _DIGITS),
        distance=round(sum(path.distance for path in default), _DIGITS),
        climb=round(sum(path.climb for path in default), _DIGITS),
        energy=round(sum(path.energy for path in default) + waiting_energy, _DIGITS),
        at_least=tuple(_uncertainties(order, tasks, waits, paths[:default_count])),
        problems=tuple(dict.fromkeys(problem for problem in problems if problem)),
        complete=complete,
    )


class _PathPreviewer:
    """Previews of single paths on a site with obstacles, with the times of the drive `route`."""

    def __init__(self, site: OpenedSite, obstacles: Sequence[Obstacle]) -> None:
        self._site = with_obstacles(site, obstacles)
        self.travel: SiteTravel = self._site.travel

    def preview_path(self, start: Pose, goal: Task | Pose) -> PreviewedWay:
        """Return the path to a pose or a task; one without points if there is no path."""
        task = _as_task(goal)
        if task.action is Action.WAIT:
            point = (0.0, start.x, start.y, start.z, start.yaw)
            return PreviewedWay(time=0.0, points=(point,), end=start)
        try:
            if task.pose is not None:
                require_pose_within_limits(task.pose, Message("its pose"))
            leg = self.travel.leg_with_action(start, task, task.velocity)
            if isinstance(leg, NoPath):
                return PreviewedWay(problem=_problem_text(goal, leg.reason))
            path = self.travel.plan_path(start, task)
        except ArgoError as error:
            return PreviewedWay(problem=_problem_text(goal, str(error)))
        return _to_preview(leg, path, task.velocity, self._site.robot)


def _to_preview(leg: Leg, path: Path, velocity: float | None, robot: RobotSpec) -> PreviewedWay:
    rows = path.timed_poses(robot, velocity).round(_DIGITS).tolist()
    return PreviewedWay(
        points=tuple((t, x, y, z, yaw) for t, x, y, z, yaw in rows),
        time=round(leg.duration, _DIGITS),
        work=round(leg.work, _DIGITS),
        distance=round(path.length, _DIGITS),
        climb=round(path.total_ascent, _DIGITS),
        energy=round(leg.energy, _DIGITS),
        end=path.end,
    )


def _as_task(goal: Task | Pose) -> Task:
    if isinstance(goal, Task):
        return goal
    return Task(name="there", action=Action.WAYPOINT, pose=goal)


def _require_sound(task: Task, catalog: Catalog) -> None:
    """Raise an error for a task to which no path can lead; its transitions are not checked.

    Raises:
        Invalid: The task is a START task, or its pose is too far away for any site.
        DiagnosticError: The task has another error.
    """
    if task.action is Action.START:
        raise Invalid(
            Message(
                "task '{task}' only states where a mission begins: no path can lead there",
                task=task.name,
            )
        )
    if task.pose is not None:
        require_pose_within_limits(task.pose, Message("the pose of task '{task}'", task=task.name))
    no_successors = {"transitions": (), "on_failure": OnFailure.CONTINUE, "failure_target": None}
    alone = task.model_copy(update={**no_successors, "group": ""})
    if has_errors(diagnostics := check(Mission(tasks=(alone,)), catalog)):
        raise DiagnosticError(Message("task '{task}'", task=task.name), diagnostics)


def _problem_text(goal: Task | Pose, reason: str) -> str:
    return (
        reason
        if isinstance(goal, Pose)
        else Message("task '{goal}': {reason}", goal=goal.name, reason=reason)
    )


def _default_order(tasks: dict[str, Task], first: str) -> list[str]:
    """Return `first` and the tasks that follow unconditionally, up to the first repeated one."""
    order: dict[str, None] = {}
    name: str | None = first
    while name is not None and name not in order:
        order[_find_target(tasks, name).name] = None
        name = default_target(tasks[name])
    return list(order)


def _find_target(tasks: dict[str, Task], name: str) -> Task:
    """Return the task with that name, which another task leads to.

    Raises NotFound if there is none, Invalid for a START task.
    """
    if name not in tasks:
        raise NotFound(
            Message("the mission has no task '{name}', but another task leads to it", name=name)
        )
    if tasks[name].action is Action.START:
        raise Invalid(
            Message(
                "task '{name}' only states where the mission begins, but another task leads to it",
                name=name,
            )
        )
    return tasks[name]


def _other_transitions(
    mission: Mission, tasks: dict[str, Task], order: Sequence[str]
) -> Iterator[tuple[str, str, WayKind]]:
    """Yield source, target and kind of the transitions beside the default `order`.

    The search is breadth-first from the tasks in `order`.
    """
    successors: dict[str, list[tuple[str, WayKind]]] = {name: [] for name in tasks}
    for task in mission.tasks:
        if task.action is Action.START:
            continue
        for transition in task.transitions:
            kind = WayKind.BRANCH if transition.conditions else WayKind.OTHER
            successors[task.name].append((transition.target, kind))
        successors[task.name] += [
            (target, WayKind.FAILURE) for target in failure_targets_by_field(task).values()
        ]
    for around in valid_ranges_parents_first(mission):
        successors[around.group.end].append((around.group.start, WayKind.ROUND))
    default = set(pairwise(order))
    reached = dict.fromkeys(order)
    queue = list(order)
    for name in queue:  # grows during the iteration
        for target, kind in dict.fromkeys(successors[name]):
            _find_target(tasks, target)
            if kind is not WayKind.OTHER or (name, target) not in default:
                yield name, target, kind
            if target not in reached:
                reached[target] = None
                queue.append(target)


def _wait_duration(task: Task) -> float | None:
    """Return the time in s that a task waits; 0 if it does not wait; None: it is not known."""
    if task.action is not Action.WAIT or task.wait is None:
        return 0.0
    return task.wait.duration


def _uncertainties(
    order: Sequence[str],
    tasks: dict[str, Task],
    waits: dict[str, float | None],
    paths: Sequence[MissionWay],
) -> Iterator[str]:
    """Yield the reasons why the mission may take more than the totals of its default paths."""
    for name in order:
        if waits[name] is None:
            yield Message("task '{name}' waits for something whose time is not known", name=name)
        window = tasks[name].window
        if window is not None and window.earliest > 0:
            earliest = rounded_time_text(window.earliest, rounded_down)
            yield Message(
                "task '{name}' may not begin before {earliest}", name=name, earliest=earliest
            )
    for path in paths:
        if path.way.problem:
            yield Message("there is no path to task '{target}'", target=path.target)
    if default_target(tasks[order[-1]]) is not None:
        yield Message("the default path has no end: it returns to an earlier task")
