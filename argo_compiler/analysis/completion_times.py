"""When each task has ended, and what was used by then, over all paths without failures."""

import math
from dataclasses import dataclass

from argo_compiler.analysis.path_lengths import LevelGraph, PathLengths, is_entry


@dataclass(frozen=True, slots=True)
class TaskEnd:
    """The end of a task, in any of its visits. Times count from the mission's start."""

    soonest: float = math.inf
    """s; infinite if it can't end in time, or is not come to"""
    latest: float = -math.inf
    """s; infinite if there is no bound, or its window may be over before"""
    energy: float = -math.inf
    """Wh at most"""

    def __or__(self, other: "TaskEnd") -> "TaskEnd":
        return TaskEnd(
            min(self.soonest, other.soonest),
            max(self.latest, other.latest),
            max(self.energy, other.energy),
        )


def completion_times(lengths: PathLengths, mission: LevelGraph) -> tuple[TaskEnd, ...]:
    """For each leaf. Visits in later rounds of a group are bounded by all that it takes."""
    ends = [TaskEnd() for _ in lengths.flow.leaves]
    # What a level is entered with, and what bounds all that happens in it.
    pending: list[tuple[LevelGraph, float, TaskEnd | None]] = [(mission, 0.0, None)]
    seen: dict[int, tuple[float, TaskEnd | None]] = {}
    while pending:
        graph, soonest, inside = pending.pop()
        known = seen.get(id(graph))
        if known is not None and known[0] <= soonest and _covers(known[1], inside):
            continue
        seen[id(graph)] = soonest, inside
        for node, key in enumerate(graph.keys):
            least = soonest + graph.least["time"][node]
            here = inside or TaskEnd(least, graph.most["time"][node], graph.most["energy"][node])
            if is_entry(key):
                rounds = lengths.rounds[key]
                all_rounds = inside or TaskEnd(
                    least, here.latest + rounds.time, here.energy + rounds.energy
                )
                pending += [(g, least, all_rounds) for g in lengths.graphs_for(key)]
            elif isinstance(key, int):
                if lengths.flow.is_leaf(key):
                    ends[key] |= TaskEnd(least, here.latest, here.energy)
            elif inside is None and math.isfinite(least):
                ends[key[1]] |= TaskEnd(latest=math.inf)
    return tuple(ends)


def _covers(known: TaskEnd | None, inside: TaskEnd | None) -> bool:
    return known == inside or (
        known is not None
        and inside is not None
        and known.latest >= inside.latest
        and known.energy >= inside.energy
    )
