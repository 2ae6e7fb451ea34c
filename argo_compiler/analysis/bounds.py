"""The least and the most that a mission takes from start to end, with the paths that do so."""

import math
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.analysis.completion_times import TaskEnd, completion_times
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.path_lengths import LevelGraph, Loop, PathLengths
from argo_compiler.analysis.reachability import Reachability
from argo_compiler.analysis.results import Bound, Bounds, Stretch
from argo_compiler.analysis.rounds import GroupExit
from argo_compiler.analysis.step_costs import StepCosts

_MOST_CUTS = 200_000  # pairs of a task and a time-out that may cut it, as far as they are looked at
_MOST_STRETCHES = 200  # of a path that are kept, at its beginning and at its end


@dataclass(frozen=True)
class MissionBounds:
    """What the levels of a mission say."""

    duration: Bounds | None
    energy: Bounds | None
    loops: tuple[Loop, ...]
    lengths: PathLengths
    mission_level: LevelGraph
    """the mission's"""

    @cached_property
    def completion_times(self) -> tuple[TaskEnd, ...]:
        """When each leaf has ended, where durations are known."""
        return completion_times(self.lengths, self.mission_level)


def has_too_many_cuts(flow: Flow) -> bool:
    """Whether groups nest too deeply to look at what each time-out may cut."""
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
    """The bounds of a mission and its loops; none above if some path is `endless`, or has a loop
    that no time limits: also one that no way leads out of, so that no end comes after it. Raises
    BoundsTooLargeError."""
    lengths = PathLengths(flow, reachability, costs)
    level = lengths.mission_level()
    duration = energy = None
    ends = [exit for exit in level.exits if exit[1][1] == flow.end_node]
    # What can't be done as planned fails: then nothing is known of a path without failures.
    if ends and costs.travel is not None and not costs.too_slow:
        endless = endless or bool(lengths.loops)
        duration = _bounds(flow, costs, level, "time", endless)
        energy = _bounds(flow, costs, level, "energy", endless)
    return MissionBounds(duration, energy, tuple(lengths.loops.values()), lengths, level)


def longest_duration(flow: Flow, reachability: Reachability, costs: StepCosts) -> float:
    """s at most from the mission's start to its end; infinite if there is no bound. Raises
    BoundsTooLargeError."""
    lengths = PathLengths(flow, reachability, costs)
    level = lengths.mission_level()
    if lengths.loops:
        return math.inf
    most = 0.0
    for node, (source, target), cost, _ in level.exits:
        if target == flow.end_node:
            end = level.most["time"][node] + cost.time.most + costs.last_clean_up(source)
            most = max(most, end)
    return most


def _bounds(
    flow: Flow, costs: StepCosts, level: LevelGraph, quantity: str, endless: bool
) -> Bounds | None:
    """None if no path comes to its end: rounds in which no time passes never fill a duration."""
    least = min(
        (level.least[quantity][node] + getattr(cost, quantity).least, k)
        for k, (node, _, cost, _) in enumerate(level.exits)
    )
    most = max(
        (
            level.most[quantity][node]
            + getattr(cost, quantity).most
            + (costs.last_clean_up(source) if quantity == "time" else 0.0),
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
    """The path to one of the ends of a level, the middle of a very long one left out."""
    predecessors = (level.least_predecessors if shortest else level.most_predecessors)[quantity]
    distance = (level.least if shortest else level.most)[quantity]
    node, _, _, group_exit = level.exits[end]
    reversed_path: list[Stretch] = []
    pending: tuple[int, GroupExit | None] | None = (node, group_exit)
    while pending is not None:
        node, group_exit = pending
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
        pending = predecessors[node]
    path = reversed_path[::-1]
    if len(path) > 2 * _MOST_STRETCHES:
        path = path[:_MOST_STRETCHES] + path[-_MOST_STRETCHES:]
    return tuple(path)
