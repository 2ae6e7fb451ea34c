"""Assumptions about a run that the times of an order are computed with.

A leaf is a state of the mission's state machine that executes one task; leaves are named by their
numbers in the flow (see `argo_compiler.analysis.flow`).
"""

from collections.abc import Iterator

import numpy as np

from argo_compiler.base.message import Message
from argo_compiler.base.quantity_text import limit_text
from argo_compiler.il import Action
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.visits import Visits


def assumption_notes(visits: Visits, matrix: TravelMatrix) -> Iterator[str]:
    """Yield the notes for users about assumptions on single tasks and groups.

    They concern rounds and WAITs that may end earlier, rounds that may end in the middle, and
    actions that may not end within their time limits.
    """
    for leaf in _waits_of_unknown_length(visits):
        yield Message(
            "'{leaf_task}' is assumed to take its whole limit",
            leaf_task=visits.leaf_task(leaf).name,
        )
    for leaf in _leaves_beyond_limit(visits, matrix):
        limit = limit_text(visits.leaf_task(leaf).time_limit or 0.0)
        yield (
            Message(
                "'{leaf_task}' may take longer than its time limit, {limit}, depending on "
                "where the robot comes from: computed as if it had none",
                leaf_task=visits.leaf_task(leaf).name,
                limit=limit,
            )
        )
    for group_unit, _ in visits.group_units:
        group = visits.chain.flow.groups[group_unit.group]
        if group.hard:
            yield Message(
                "'{group}' is left where its time is up: computed from its farthest task",
                group=group.name,
            )
        if group.until:
            yield Message(
                "'{group}' is assumed to have as many rounds as it may have", group=group.name
            )


def assumption_phrases(visits: Visits, matrix: TravelMatrix) -> Iterator[str]:
    """Yield, in words, the conditions under which a run takes the computed time of its order."""
    if _waits_of_unknown_length(visits):
        yield Message("each WAIT takes its whole limit")
    if _leaves_beyond_limit(visits, matrix):
        yield Message("no time limit ends an action")
    if any(
        visits.chain.flow.groups[group_unit.group].until for group_unit, _ in visits.group_units
    ):
        yield Message("each group has as many rounds as it may have")


def _waits_of_unknown_length(visits: Visits) -> list[int]:
    """Return the leaves whose tasks are WAITs that may end before their limit."""
    waits = ((leaf, visits.leaf_task(leaf).wait) for leaf in visits.visit_of_leaf)
    return [leaf for leaf, wait in waits if wait is not None and wait.duration is None]


def _leaves_beyond_limit(visits: Visits, matrix: TravelMatrix) -> list[int]:
    """Return the leaves whose tasks exceed their time limits from at least one origin.

    The time of a task includes the drive to it, and so depends on where the robot comes from.
    """
    longest = np.max(matrix.time, axis=0, where=np.isfinite(matrix.time), initial=0.0)
    leaves = []
    for leaf in range(len(matrix.tasks)):
        task = visits.leaf_task(leaf)
        limit = None if task.action is Action.WAIT else task.time_limit
        if limit is not None and longest[leaf] > matrix.units_rounded_down(limit):
            leaves.append(leaf)
    return leaves
