"""Least and greatest duration and energy of a mission, with the paths that attain them."""

import math
from functools import cached_property

from argo_compiler.analysis.completion_times import TimeAndEnergyAtEnd, task_end_bounds
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.path_lengths import LevelGraph, Loop, PathLengths
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.results import Bound, Bounds, Stretch
from argo_compiler.analysis.rounds import GroupExit
from argo_compiler.analysis.step_costs import StepCosts
from argo_compiler.base.records import dataclass

_MOST_CUTS = 200_000  # pairs of a task and a time-out that may cancel it
_MOST_STRETCHES = 200  # parts of a path that are returned, from its start and from its end each


@dataclass(frozen=True)
class MissionBounds:
    """Bounds of a mission on duration and energy, its loops, and its path lengths."""

    duration: Bounds | None
    energy: Bounds | None
    loops: tuple[Loop, ...]
    lengths: PathLengths
    mission_level: LevelGraph
    """graph of the level of the mission"""

    @cached_property
    def task_end_bounds(self) -> tuple[TimeAndEnergyAtEnd, ...]:
        """Bounds on the time and energy at the end of each leaf, over all its visits.

        They say little if `duration` is None: without travel times, for example, most are infinite.
        """
        return task_end_bounds(self.lengths, self.mission_level)


def has_too_many_cancellations(flow: Flow) -> bool:
    """Return True if there are too many pairs of a task and a time limit that may cancel it.

    Bounds are not computed then. The time limits are the hard ones of the groups around the task;
    up to `_MOST_CUTS` pairs are allowed.
    """
    pairs = 0
    hard: list[int] = []
    for group in flow.groups:
        hard.append(group.hard + (hard[group.parent] if group.parent >= 0 else 0))
    for leaf in flow.leaves:
        pairs += hard[leaf.parent] if leaf.parent >= 0 else 0
    return pairs > _MOST_CUTS


def compute_bounds(
    flow: Flow, reachability: Reachability, costs: StepCosts, endless: bool
) -> MissionBounds:
    """Return the bounds of a mission on duration and energy, and its loops without limit.

    There is no upper bound (its value is None) if `endless` (some execution path never ends), or if
    a loop may be repeated without limit, even if no transition leads from that loop to the
    mission's end.

    Raises:
        BoundsTooLargeError: The computation would take too long.
    """
    lengths = PathLengths(flow, reachability, costs)
    level = lengths.mission_level()
    duration = energy = None
    ends = [exit for exit in level.exits if exit[1][1] == flow.end_node]
    # A task that takes longer than its time limit fails: no path is then free of failures.
    if ends and costs.travel is not None and not costs.too_slow:
        endless = endless or bool(lengths.loops)
        duration = _bounds(flow, costs, level, "time", endless)
        energy = _bounds(flow, costs, level, "energy", endless)
    return MissionBounds(duration, energy, tuple(lengths.loops.values()), lengths, level)


def longest_duration(flow: Flow, reachability: Reachability, costs: StepCosts) -> float:
    """Return an upper bound on the time in s from a mission's start to its end; infinite if none.

    It holds for all execution paths of `reachability`; reactions are not included.

    Raises:
        BoundsTooLargeError: The computation would take too long.
    """
    lengths = PathLengths(flow, reachability, costs)
    level = lengths.mission_level()
    if lengths.loops:
        return math.inf
    most = 0.0
    for node, (source, target), cost, _ in level.exits:
        if target == flow.end_node:
            end = (
                level.most["time"][node]
                + cost.time.most
                + costs.cancelled_action_clean_up_time(source)
            )
            most = max(most, end)
    return most


def _bounds(
    flow: Flow, costs: StepCosts, level: LevelGraph, quantity: str, endless: bool
) -> Bounds | None:
    """Return the bounds on the `time` (s) or `energy` (Wh) of a mission, over all paths to its end.

    `level` is the graph of the whole mission; if `endless`, the upper bound is None.
    Returns None if no path reaches the end: rounds that take no time never use up a time limit.
    """
    least = min(
        (level.least[quantity][node] + getattr(cost, quantity).least, k)
        for k, (node, _, cost, _) in enumerate(level.exits)
    )
    most = max(
        (
            level.most[quantity][node]
            + getattr(cost, quantity).most
            + (costs.cancelled_action_clean_up_time(source) if quantity == "time" else 0.0),
            k,
        )
        for k, (node, (source, _), cost, _) in enumerate(level.exits)
    )
    if math.isinf(least[0]):
        return None
    return Bounds(
        least=Bound(value=least[0], path=_path(flow, level, quantity, least[1], shortest=True)),
        most=Bound(value=None)
        if endless or math.isinf(most[0])
        else Bound(value=most[0], path=_path(flow, level, quantity, most[1], shortest=False)),
    )


def _path(
    flow: Flow, level: LevelGraph, quantity: str, end: int, shortest: bool
) -> tuple[Stretch, ...]:
    """Return the execution path of the least or greatest time or energy to one exit of a level.

    `end` is the index of the exit in the level's list. The middle parts of a very long path are
    left out.
    """
    predecessors = (level.least_predecessors if shortest else level.most_predecessors)[quantity]
    distance = (level.least if shortest else level.most)[quantity]
    node, _, _, group_exit = level.exits[end]
    reversed_path: list[Stretch] = []
    current: tuple[int, GroupExit | None] | None = (node, group_exit)
    while current is not None:
        node, group_exit = current
        key = level.keys[node]
        if isinstance(key, int):
            if flow.is_leaf(key):
                reversed_path.append(Stretch(task=flow.leaves[key].name, until=distance[node]))
        elif len(key) == 2:
            name = flow.leaves[key[1]].name
            reversed_path.append(Stretch(task=name, missed=True, until=distance[node]))
        else:
            assert group_exit is not None
            cost = getattr(group_exit.cost, quantity)
            taken = cost.least if shortest else cost.most
            rounds = group_exit.fewest if shortest else group_exit.most
            reversed_path.append(
                Stretch(
                    group=flow.groups[key[0]].name,
                    rounds=int(rounds) if math.isfinite(rounds) else 0,
                    until=distance[node] + taken,
                )
            )
        current = predecessors[node]
    path = reversed_path[::-1]
    if len(path) > 2 * _MOST_STRETCHES:
        path = path[:_MOST_STRETCHES] + path[-_MOST_STRETCHES:]
    return tuple(path)
