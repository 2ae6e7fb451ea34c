"""Times of WAITs in a travel matrix: the robot stays where the previous task left it."""

from dataclasses import replace

import numpy as np

from argo_compiler.il import Action
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.units import UnitChain


def with_wait_times(chain: UnitChain, matrix: TravelMatrix) -> TravelMatrix:
    """Return the matrix with the times and energies to and from WAITs filled in.

    To a WAIT it takes as long as the WAIT lasts at most; each has a duration or a limit, see
    `require_computable_times`. From a WAIT it takes as long as from the
    poses where the robot may be then; the longest time counts.
    """
    leaves = chain.flow.leaves[: len(matrix.tasks)]
    waits = [k for k, leaf in enumerate(leaves) if leaf.leaf.task.action is Action.WAIT]
    if not waits:
        return matrix
    time, energy, work = matrix.time.copy(), matrix.energy.copy(), matrix.work.copy()
    for k in waits:
        rule = leaves[k].leaf.task.wait
        assert rule is not None
        seconds = rule.limit if rule.duration is None else rule.duration
        time[:, k] = work[k] = matrix.units_rounded_up(seconds or 0.0)
        energy[:, k] = 0.0
    for k, rows_before in _possible_rows(chain, waits, len(matrix.tasks)).items():
        others = [j for j in range(time.shape[1]) if j not in waits]
        if rows_before:
            time[k, others] = np.max(time[np.ix_(sorted(rows_before), others)], axis=0)
            energy[k, others] = np.max(energy[np.ix_(sorted(rows_before), others)], axis=0)
    return replace(matrix, time=time, energy=energy, work=work)


def _possible_rows(chain: UnitChain, waits: list[int], start: int) -> dict[int, set[int]]:
    """Return for each WAIT the rows of the travel matrix at whose poses the robot may wait."""
    flow = chain.flow
    leading: dict[int, set[int]] = {k: set() for k in waits}
    if flow.initial in leading:
        leading[flow.initial].add(start)
    for node, after in _leaf_transitions(chain):
        if after in leading:
            leading[after].add(node)
    result = {k: {row for row in rows if row not in leading} for k, rows in leading.items()}
    changed = True
    while changed:
        changed = False
        for k, rows in leading.items():
            more = {origin for row in rows if row in leading for origin in result[row]}
            changed = changed or not more <= result[k]
            result[k] |= more
    return result


def _leaf_transitions(chain: UnitChain) -> list[tuple[int, int]]:
    """Return all pairs of leaves that may follow each other, also by rounds and time-outs."""
    flow = chain.flow
    result: list[tuple[int, int]] = []
    ends: dict[int, list[int]] = {}
    """by group, the leaves that a round may end with"""
    for k, leaf in enumerate(flow.leaves):
        nodes = [target for _, target in leaf.conditional]
        nodes += [
            node for node in (leaf.unconditional, leaf.failure, leaf.missed) if node is not None
        ]
        for node in nodes:
            ended = flow.group_of_round_end(node)
            if ended is not None:
                ends.setdefault(ended, []).append(k)
            elif flow.is_leaf(node):
                result.append((k, node))
    for number in reversed(range(len(flow.groups))):  # inner groups come first
        group = flow.groups[number]
        leaves = ends.get(number, [])
        result += [(k, group.start) for k in leaves]
        if group.hard:
            leaves = list(range(group.first, group.last + 1))
        around = flow.group_of_round_end(group.successor)
        if around is not None:
            ends.setdefault(around, []).extend(leaves)
        elif flow.is_leaf(group.successor):
            result += [(k, group.successor) for k in leaves]
    return result
