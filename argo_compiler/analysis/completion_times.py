"""Completion times of the tasks, and the energy used until then, on all paths without failures."""

import math

from argo_compiler.analysis.path_lengths import LevelGraph, PathLengths, is_group_entry
from argo_compiler.base.records import dataclass


@dataclass(frozen=True, slots=True)
class TimeAndEnergyAtEnd:
    """Bounds on the end of a task over all its visits; times count from the mission's start."""

    soonest: float = math.inf
    """s; infinite if the task can't end in time, or is not reached"""
    latest: float = -math.inf
    """s; infinite if there is no bound, or if the task's window may close before"""
    energy: float = -math.inf
    """greatest energy in Wh"""

    def __or__(self, other: "TimeAndEnergyAtEnd") -> "TimeAndEnergyAtEnd":
        return TimeAndEnergyAtEnd(
            min(self.soonest, other.soonest),
            max(self.latest, other.latest),
            max(self.energy, other.energy),
        )


def task_end_bounds(lengths: PathLengths, mission: LevelGraph) -> tuple[TimeAndEnergyAtEnd, ...]:
    """Return for each leaf the bounds on the time of its end and on the energy used until then.

    `mission` is the graph of the mission's level. For a leaf in a group, the upper bounds are those
    for the end of all rounds of the outermost group around it.
    """
    ends = [TimeAndEnergyAtEnd() for _ in lengths.flow.leaves]
    # A level, the soonest time at which it is entered, and the bounds on all that happens in it;
    # None at the mission's own level.
    pending: list[tuple[LevelGraph, float, TimeAndEnergyAtEnd | None]] = [(mission, 0.0, None)]
    seen: dict[int, tuple[float, TimeAndEnergyAtEnd | None]] = {}
    while pending:
        graph, soonest, inside = pending.pop()
        known = seen.get(id(graph))
        if known is not None and known[0] <= soonest and _covers(known[1], inside):
            continue
        seen[id(graph)] = soonest, inside
        for node, key in enumerate(graph.keys):
            least = soonest + graph.least["time"][node]
            here = inside or TimeAndEnergyAtEnd(
                least, graph.most["time"][node], graph.most["energy"][node]
            )
            if is_group_entry(key):
                rounds = lengths.rounds[key]
                all_rounds = inside or TimeAndEnergyAtEnd(
                    least, here.latest + rounds.time, here.energy + rounds.energy
                )
                pending += [
                    (g, least, all_rounds) for g in lengths.first_and_later_round_graphs(key)
                ]
            elif isinstance(key, int):
                if lengths.flow.is_leaf(key):
                    ends[key] |= TimeAndEnergyAtEnd(least, here.latest, here.energy)
            elif inside is None and math.isfinite(least):
                ends[key[1]] |= TimeAndEnergyAtEnd(latest=math.inf)
    return tuple(ends)


def _covers(known: TimeAndEnergyAtEnd | None, inside: TimeAndEnergyAtEnd | None) -> bool:
    return known == inside or (
        known is not None
        and inside is not None
        and known.latest >= inside.latest
        and known.energy >= inside.energy
    )
