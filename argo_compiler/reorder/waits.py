"""WAITs: they take their time where the robot stands, where the task before has left it."""

from dataclasses import replace

import numpy as np

from argo_compiler.il import Action
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.units import Spine


def standing_still(spine: Spine, ways: TravelMatrix) -> TravelMatrix:
    """The ways with those to and from WAITs: to one it takes as long as it lasts at most, and from
    there as long as from wherever the robot may stand then; the longest counts."""
    leaves = spine.flow.leaves[: len(ways.tasks)]
    waits = [k for k, leaf in enumerate(leaves) if leaf.leaf.task.action is Action.WAIT]
    if not waits:
        return ways
    time, energy, work = ways.time.copy(), ways.energy.copy(), ways.work.copy()
    for k in waits:
        rule = leaves[k].leaf.task.wait
        assert rule is not None
        seconds = rule.limit if rule.duration is None else rule.duration
        time[:, k] = work[k] = ways.up(seconds or 0.0)
        energy[:, k] = 0.0
    for k, places in _places(spine, waits, len(ways.tasks)).items():
        others = [j for j in range(time.shape[1]) if j not in waits]
        if places:
            time[k, others] = np.max(time[np.ix_(sorted(places), others)], axis=0)
            energy[k, others] = np.max(energy[np.ix_(sorted(places), others)], axis=0)
    return replace(ways, time=time, energy=energy, work=work)


def _places(spine: Spine, waits: list[int], start: int) -> dict[int, set[int]]:
    """For each WAIT the rows of the matrix that the robot may stand at."""
    flow = spine.flow
    leading: dict[int, set[int]] = {k: set() for k in waits}
    if flow.initial in leading:
        leading[flow.initial].add(start)
    for node, after in _ways(spine):
        if after in leading:
            leading[after].add(node)
    found = {k: {row for row in rows if row not in leading} for k, rows in leading.items()}
    changed = True
    while changed:
        changed = False
        for k, rows in leading.items():
            more = {place for row in rows if row in leading for place in found[row]}
            changed = changed or not more <= found[k]
            found[k] |= more
    return found


def _ways(spine: Spine) -> list[tuple[int, int]]:
    """From which leaf to which leaf the mission may go on, rounds and time-outs included."""
    flow = spine.flow
    found: list[tuple[int, int]] = []
    ends: dict[int, list[int]] = {}
    """by group, the leaves that its round may end with"""
    for k, leaf in enumerate(flow.leaves):
        nodes = [target for _, target in leaf.conditional]
        nodes += [node for node in (leaf.tail, leaf.failure, leaf.missed) if node is not None]
        for node in nodes:
            ended = flow.group_of_round_end(node)
            if ended is not None:
                ends.setdefault(ended, []).append(k)
            elif flow.is_leaf(node):
                found.append((k, node))
    for number in reversed(range(len(flow.groups))):  # those inside come before those around
        group = flow.groups[number]
        leaves = ends.get(number, [])
        found += [(k, group.start) for k in leaves]
        if group.hard:
            leaves = list(range(group.first, group.last + 1))
        around = flow.group_of_round_end(group.onward)
        if around is not None:
            ends.setdefault(around, []).extend(leaves)
        elif flow.is_leaf(group.onward):
            found += [(k, group.onward) for k in leaves]
    return found
