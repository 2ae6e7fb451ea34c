"""The ways between a mission's tasks on a site, and its route problem made from them."""

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
"""places between which every way is planned; among more of them only those to the nearest ones, and
the others take as long as the cheapest way over the lattice, whose corners are not cut"""
NEAREST = 12
"""places to which the ways are planned then"""
_PLANNING = "planning the ways between tasks"
_ORIGINS = 8  # from which it is looked where the robot comes to stand to read a checkpoint


def plan_mission(
    mission: Mission,
    navigator: Navigator,
    requirements: Requirements,
    travel: SiteTravel | None = None,
) -> MissionProblem:
    """The route problem of a mission on a site.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: its order can't be changed, the robot can't carry out a task, or a requirement
            names something that the mission does not have.
    """
    travel = travel or SiteTravel(navigator)
    planned = route_problem(mission, mission_ways(mission, navigator, travel), requirements)
    if planned.problem.battery is None:
        return planned
    return route_problem(mission, mission_ways(mission, navigator, travel, True), requirements)


def mission_ways(
    mission: Mission, navigator: Navigator, travel: SiteTravel, chargers: bool = False
) -> TravelMatrix:
    """Times and energies between the tasks of a mission, in steps of the drive that `travel` means,
    and with `chargers` from and to the docking stations.

    Where the robot stands to read a checkpoint depends on the way that it came; the place where it
    mostly does stands for all. Raises ArgoError if it can't carry out a task.
    """
    tasks = [task for task in mission.tasks if task.action is not Action.START]
    docks = sorted(navigator.site.docks.items()) if chargers else []
    places = [
        *tasks,
        *(Task(name=f"docking station {n}", action=Action.WAYPOINT, pose=p) for n, p in docks),
    ]
    start = travel.start(mission)
    standings = _standings(places, start, travel)
    origins = [*standings[: len(tasks)], start, *standings[len(tasks) :]]
    if len(places) <= MOST_PLANNED:
        time, energy = _planned(origins, places, travel)
    else:
        time, energy = _over_lattice(origins, places, standings, navigator, travel)
        slowed = {k for k, task in enumerate(places) if task.velocity is not None}
        for row, origin in enumerate(stage_items(_PLANNING, origins)):
            near = np.argsort(time[row], kind="stable")[:NEAREST].tolist()
            chosen = sorted(slowed.union(near))
            ways = _planned_from(origin, [places[k] for k in chosen], travel)
            time[row, chosen], energy[row, chosen] = ways
    work = np.array([travel.work(task) for task in places])
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


def _standings(places: Sequence[Task], start: Pose, travel: SiteTravel) -> list[Pose]:
    """Where the robot mostly stands when a task has ended."""
    around = [start]
    for task in places:
        leg = _leg(travel, start, task)
        around.append(leg.arrival if isinstance(leg.arrival, Pose) else start)
    origins = [around[k] for k in np.linspace(0, len(around) - 1, _ORIGINS).round().astype(int)]
    found = []
    for k, task in enumerate(stage_items("looking where each task is done", places), start=1):
        if task.action is not Action.MEASURE:
            found.append(around[k])
            continue
        legs = [travel.leg(origin, task, None) for origin in dict.fromkeys([start, *origins])]
        arrivals = Counter(leg.arrival for leg in legs if isinstance(leg, Leg))
        mostly = arrivals.most_common(1)[0][0]
        assert isinstance(mostly, Pose)
        found.append(mostly)
    return found


def _leg(travel: SiteTravel, start: Pose, task: Task) -> Leg:
    leg = travel.leg(start, task, None)
    if isinstance(leg, NoPath):
        raise Unreachable(f"the robot can't carry out task '{task.name}': {leg.reason}")
    return leg


def _planned(
    origins: Sequence[Pose], places: Sequence[Task], travel: SiteTravel
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (s) and energies (Wh) of planned ways; inf where there is none."""
    time = np.full((len(origins), len(places)), np.inf)
    energy = time.copy()
    for row, origin in enumerate(stage_items(_PLANNING, origins)):
        time[row], energy[row] = _planned_from(origin, places, travel)
    return time, energy


def _planned_from(
    origin: Pose, places: Sequence[Task], travel: SiteTravel
) -> tuple[list[float], list[float]]:
    """The same from one place."""
    legs = [travel.leg(origin, task, task.velocity) for task in places]
    time = [leg.duration if isinstance(leg, Leg) else np.inf for leg in legs]
    return time, [leg.energy if isinstance(leg, Leg) else np.inf for leg in legs]


def _over_lattice(
    origins: Sequence[Pose],
    places: Sequence[Task],
    standings: Sequence[Pose],
    navigator: Navigator,
    travel: SiteTravel,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same over the lattice, and as if all ways led up stairs, which takes most energy."""
    distinct = list(dict.fromkeys([*origins, *standings]))
    number = {pose: k for k, pose in enumerate(distinct)}
    try:
        times = navigator.travel_times(distinct)
    except Unreachable as error:  # stands there, says the path, and not the lattice
        raise Unreachable(f"the ways between the tasks can't be found: {error}") from None
    drive = times[np.ix_([number[p] for p in origins], [number[p] for p in standings])]
    step, power = travel.time_step, navigator.robot.power
    work = np.array([travel.work(task) for task in places])
    drive = np.maximum(np.ceil(drive / step - 1e-6) * step, step)
    return drive + work, (drive * power.climbing + work * power.measuring) / 3600.0
