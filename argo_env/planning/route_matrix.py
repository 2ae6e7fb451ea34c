"""Travel times between a mission's tasks on a site, and the mission's route problem."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.base.stages import stage_items
from argo_compiler.il import Action, Mission, Task
from argo_compiler.reorder.mission_problem import MissionProblem, route_problem
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_env.navigation import Navigator
from argo_env.planning.travel import SiteTravel

MOST_PLANNED = 40
"""number of tasks up to which the paths between all of them are planned

With more tasks, only the paths to the nearest ones are planned. The times of the others are those
of the cheapest paths on the lattice, which are not smoothed.
"""
NEAREST = 12
"""number of nearest tasks to which paths are planned in that case"""
_PLANNING = "planning the paths between tasks"
_ORIGINS = 8  # number of poses from which the most frequent viewing pose of a checkpoint is found


def make_mission_problem(
    mission: Mission,
    navigator: Navigator,
    requirements: Requirements,
    travel: SiteTravel | None = None,
) -> MissionProblem:
    """Return the route problem of a mission, whose travel times are those on the navigator's site.

    Args:
        mission: Mission whose tasks may change places.
        navigator: Navigator of the site.
        requirements: Requirements on the new order of tasks.
        travel: Travel times on the site; None: they are computed.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: The order of the tasks can't be changed, the robot can't execute a task, or a
            requirement names something that the mission does not have.
    """
    travel = travel or SiteTravel(navigator)
    planned = route_problem(mission, mission_travel(mission, navigator, travel), requirements)
    if planned.problem.battery is None:
        return planned
    return route_problem(mission, mission_travel(mission, navigator, travel, True), requirements)


def mission_travel(
    mission: Mission, navigator: Navigator, travel: SiteTravel, chargers: bool = False
) -> TravelMatrix:
    """Return the travel times and energies between the tasks of a mission.

    The matrix's unit of time is a time step of the drive. The pose from which the robot reads a
    checkpoint depends on where it comes from; the matrix uses the most frequent one. Raises
    ArgoError if the robot can't execute a task.

    Args:
        mission: Mission whose tasks, without START, are the rows and columns; the pose at which it
            starts is a further row, after those of the tasks.
        navigator: Navigator of the site.
        travel: Travel times on the site.
        chargers: True if the docking stations are the last rows and columns.
    """
    tasks = [task for task in mission.tasks if task.action is not Action.START]
    docks = sorted(navigator.site.docks.items()) if chargers else []
    goals = [
        *tasks,
        *(Task(name=f"docking station {n}", action=Action.WAYPOINT, pose=p) for n, p in docks),
    ]
    start = travel.start_pose(mission)
    end_poses = _end_poses(goals, start, travel)
    origins = [*end_poses[: len(tasks)], start, *end_poses[len(tasks) :]]
    if len(goals) <= MOST_PLANNED:
        time, energy = _plan_all(origins, goals, travel)
    else:
        time, energy = _estimate_on_lattice(origins, goals, end_poses, navigator, travel)
        with_velocity = {k for k, task in enumerate(goals) if task.velocity is not None}
        for row, origin in enumerate(stage_items(_PLANNING, origins)):
            nearest = np.argsort(time[row], kind="stable")[:NEAREST].tolist()
            columns = sorted(with_velocity.union(nearest))
            costs = _plan_from(origin, [goals[k] for k in columns], travel)
            time[row, columns], energy[row, columns] = costs
    work = np.array([travel.action_duration(task) for task in goals])
    return TravelMatrix(
        tuple(task.name for task in tasks),
        np.rint(time / travel.time_step),
        energy,
        np.rint(work / travel.time_step),
        tuple(f"docking station {n}" for n, _ in docks),
        travel.battery,
        navigator.robot.power.charging,
        travel.time_step,
    )


def _end_poses(goals: Sequence[Task], start: Pose, travel: SiteTravel) -> list[Pose]:
    """Return the most frequent pose of the robot at the end of each task, from several origins."""
    from_start = [start]
    for task in goals:
        leg = _require_leg(travel, start, task)
        from_start.append(leg.arrival if isinstance(leg.arrival, Pose) else start)
    samples = np.linspace(0, len(from_start) - 1, _ORIGINS).round().astype(int)
    origins = [from_start[k] for k in samples]
    end_poses = []
    for k, task in enumerate(stage_items("finding the pose of each task", goals), start=1):
        if task.action is not Action.MEASURE:
            end_poses.append(from_start[k])
            continue
        legs = [
            travel.leg_with_action(origin, task, None)
            for origin in dict.fromkeys([start, *origins])
        ]
        arrivals = Counter(leg.arrival for leg in legs if isinstance(leg, Leg))
        most_frequent = arrivals.most_common(1)[0][0]
        assert isinstance(most_frequent, Pose)
        end_poses.append(most_frequent)
    return end_poses


def _require_leg(travel: SiteTravel, start: Pose, task: Task) -> Leg:
    """Return the leg from the start to a task; raises Unreachable if there is none."""
    leg = travel.leg_with_action(start, task, None)
    if isinstance(leg, NoPath):
        raise Unreachable(f"the robot can't carry out task '{task.name}': {leg.reason}")
    return leg


def _plan_all(
    origins: Sequence[Pose], goals: Sequence[Task], travel: SiteTravel
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times (s) and energies (Wh) from origins (rows) to goals, with the actions there.

    They are those of planned paths; inf where there is no path.
    """
    time = np.full((len(origins), len(goals)), np.inf)
    energy = time.copy()
    for row, origin in enumerate(stage_items(_PLANNING, origins)):
        time[row], energy[row] = _plan_from(origin, goals, travel)
    return time, energy


def _plan_from(
    origin: Pose, goals: Sequence[Task], travel: SiteTravel
) -> tuple[list[float], list[float]]:
    """Return times (s) and energies (Wh) from one origin to each goal, with the actions there.

    They are those of planned paths; inf where there is no path.
    """
    legs = [travel.leg_with_action(origin, task, task.velocity) for task in goals]
    time = [leg.duration if isinstance(leg, Leg) else np.inf for leg in legs]
    return time, [leg.energy if isinstance(leg, Leg) else np.inf for leg in legs]


def _estimate_on_lattice(
    origins: Sequence[Pose],
    goals: Sequence[Task],
    end_poses: Sequence[Pose],
    navigator: Navigator,
    travel: SiteTravel,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times (s) and energies (Wh) from origins (rows) to goals, with the actions there.

    They are those of paths on the lattice; inf where there is no path. All driving is counted with
    the power of driving up stairs, which is the highest, so that energies are not too low.
    """
    distinct = list(dict.fromkeys([*origins, *end_poses]))
    index = {pose: k for k, pose in enumerate(distinct)}
    try:
        times = navigator.travel_times(distinct)
    except Unreachable as error:  # a planned path ends at a pose that the lattice does not have
        raise Unreachable(f"the paths between the tasks can't be found: {error}") from None
    drive = times[np.ix_([index[p] for p in origins], [index[p] for p in end_poses])]
    step, power = travel.time_step, navigator.robot.power
    work = np.array([travel.action_duration(task) for task in goals])
    drive = np.maximum(np.ceil(drive / step - 1e-6) * step, step)
    return drive + work, (drive * power.climbing + work * power.measuring) / 3600.0
