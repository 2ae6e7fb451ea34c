"""The least and the most that a mission takes from start to end, with the paths that do so."""

import math
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.analysis.facts import Bound, Bounds, Stretch
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.legs import Legs
from argo_compiler.analysis.levels import LevelGraph, Levels, Loop
from argo_compiler.analysis.moments import TaskEnd, moments
from argo_compiler.analysis.rounds import Out
from argo_compiler.analysis.values import Paths

_CUTS = 200_000  # pairs of a task and a time-out that may cut it, as far as they are looked at
_STRETCHES = 200  # of a path that are kept, at its beginning and at its end


@dataclass(frozen=True)
class Extent:
    """What the levels of a mission say."""

    duration: Bounds | None
    energy: Bounds | None
    loops: tuple[Loop, ...]
    levels: Levels
    level: LevelGraph
    """the mission's"""

    @cached_property
    def moments(self) -> tuple[TaskEnd, ...]:
        """When each leaf has ended, where durations are known."""
        return moments(self.levels, self.level)


def too_many_cuts(flow: Flow) -> bool:
    """Whether groups nest too deeply to look at what each time-out may cut."""
    pairs = 0
    hard: list[int] = []
    for group in flow.groups:
        hard.append(group.hard + (hard[group.parent] if group.parent >= 0 else 0))
    for leaf in flow.leaves:
        pairs += hard[leaf.parent] if leaf.parent >= 0 else 0
    return pairs > _CUTS


def measure(flow: Flow, paths: Paths, legs: Legs, endless: bool) -> Extent:
    """The bounds of a mission and its loops; none above if some path is `endless`, or has a loop
    that no time limits: also one that no way leads out of, so that no end comes after it. Raises
    BoundsTooLargeError."""
    levels = Levels(flow, paths, legs)
    level = levels.mission()
    duration = energy = None
    ends = [way for way in level.outs if way[1][1] == flow.done]
    # What can't be done as planned fails: then nothing is known of a path without failures.
    if ends and legs.travel is not None and not legs.too_slow:
        endless = endless or bool(levels.loops)
        duration = _bounds(flow, legs, level, "time", endless)
        energy = _bounds(flow, legs, level, "energy", endless)
    return Extent(duration, energy, tuple(levels.loops.values()), levels, level)


def longest(flow: Flow, paths: Paths, legs: Legs) -> float:
    """s at most from the mission's start to its end; infinite if there is no bound. Raises
    BoundsTooLargeError."""
    levels = Levels(flow, paths, legs)
    level = levels.mission()
    if levels.loops:
        return math.inf
    most = 0.0
    for node, (source, target), cost, _ in level.outs:
        if target == flow.done:
            end = level.most["time"][node] + cost.time.most + legs.last_clean_up(source)
            most = max(most, end)
    return most


def _bounds(
    flow: Flow, legs: Legs, level: LevelGraph, quantity: str, endless: bool
) -> Bounds | None:
    """None if no path comes to its end: rounds in which no time passes never fill a duration."""
    least = min(
        (level.least[quantity][node] + getattr(cost, quantity).least, k)
        for k, (node, _, cost, _) in enumerate(level.outs)
    )
    most = max(
        (
            level.most[quantity][node]
            + getattr(cost, quantity).most
            + (legs.last_clean_up(source) if quantity == "time" else 0.0),
            k,
        )
        for k, (node, (source, _), cost, _) in enumerate(level.outs)
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
    before = (level.least_before if shortest else level.most_before)[quantity]
    distance = (level.least if shortest else level.most)[quantity]
    node, _, _, out = level.outs[end]
    reversed_path: list[Stretch] = []
    at: tuple[int, Out | None] | None = (node, out)
    while at is not None:
        node, out = at
        key = level.keys[node]
        if isinstance(key, int):
            if flow.is_leaf(key):
                reversed_path.append(Stretch(task=flow.leaves[key].name, until=distance[node]))
        elif len(key) == 2:
            name = flow.leaves[key[1]].name
            reversed_path.append(Stretch(task=name, missed=True, until=distance[node]))
        else:
            assert out is not None
            span = getattr(out.cost, quantity)
            taken = span.least if shortest else span.most
            rounds = out.fewest if shortest else out.most
            reversed_path.append(
                Stretch(
                    group=flow.groups[key[0]].name,
                    rounds=int(rounds) if math.isfinite(rounds) else 0,
                    until=distance[node] + taken,
                )
            )
        at = before[node]
    path = reversed_path[::-1]
    if len(path) > 2 * _STRETCHES:
        path = path[:_STRETCHES] + path[-_STRETCHES:]
    return tuple(path)
