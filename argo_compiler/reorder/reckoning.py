"""What an order is reckoned with that a run need not do."""

from collections.abc import Iterator

import numpy as np

from argo_compiler.analysis.quantities import time_words
from argo_compiler.il import Action
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.reorder.visits import Visits


def reckoning_notes(visits: Visits, ways: TravelMatrix) -> Iterator[str]:
    """What is said of rounds and WAITs that may end earlier, of rounds left in the middle, and of
    actions that may not be over within their limits."""
    for leaf in _cut_short(visits):
        yield f"'{visits.task(leaf).name}' is reckoned with all of its limit"
    for leaf in _too_far(visits, ways):
        limit = time_words(visits.task(leaf).time_limit or 0.0)
        yield (
            f"'{visits.task(leaf).name}' may take longer than its time limit, {limit}, depending "
            "on where the robot comes from: reckoned as if it had none"
        )
    for circuit, _ in visits.circuits:
        group = visits.spine.flow.groups[circuit.group]
        if group.hard:
            yield f"'{group.name}' is left where its time is up: reckoned from its farthest task"
        if group.until:
            yield f"'{group.name}' is reckoned with as many rounds as it may have"


def assumptions(visits: Visits, ways: TravelMatrix) -> Iterator[str]:
    """In words, what has to hold for a run to take as long as its order is reckoned with."""
    if _cut_short(visits):
        yield "each WAIT takes its whole limit"
    if _too_far(visits, ways):
        yield "no time limit ends an action"
    if any(visits.spine.flow.groups[circuit.group].until for circuit, _ in visits.circuits):
        yield "each group has as many rounds as it may have"


def _cut_short(visits: Visits) -> list[int]:
    """The leaves of WAITs that may be over before their limit."""
    waits = ((leaf, visits.task(leaf).wait) for leaf in visits.of_leaf)
    return [leaf for leaf, wait in waits if wait is not None and wait.duration is None]


def _too_far(visits: Visits, ways: TravelMatrix) -> list[int]:
    """The leaves that take longer than their time limits from somewhere."""
    longest = np.max(ways.time, axis=0, where=np.isfinite(ways.time), initial=0.0)
    found = []
    for leaf in range(len(ways.tasks)):
        task = visits.task(leaf)
        limit = None if task.action is Action.WAIT else task.time_limit
        if limit is not None and longest[leaf] > ways.down(limit):
            found.append(leaf)
    return found
