"""Most of what the analysis calls possible happens in many runs of random missions."""

import random
from collections import Counter

import hypothesis
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import Verdict, analyse
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Cause, lower
from tests.argo_compiler.analysis.worlds import MadeUpTravel, catalogs, missions, run
from tests.conftest import EXAMPLES, examples

NOMINAL = 25
"""runs of each mission in which only the events occur that it waits for, as the bounds assume"""
EVENTFUL = 50
"""greatest number of further runs, until everything that is called possible has happened"""

SHARES = (
    ("tasks entered", "tasks", 30, 0.75, 0.89, 0.04),
    ("ways taken", "ways", 5, 0.65, 0.66, 0.09),
    ("least met", "bounds", 5, 0.6, 0.84, 0.10),
    ("most met", "bounds", 5, 0.6, 0.85, 0.10),
)
"""Name of the count of what happens; name of the count of what is called possible; a number that
the latter count must exceed; the least share in the suite's 40 examples, which are always the same;
and for other examples the share among 1,440, with the standard deviation between samples of 40,
which is smaller for more examples.

Of 88 transitions that no nominal run took, eventful runs took 47, some only in thousands of runs.
Some of the others can't be taken: the analysis does not consider that ages exclude each other,
that windows and rounds are too short, or that a WAIT waits in vain. It also assumes that late
readings of cancelled measurements may come from tasks that are never reached, and by transitions
that only a failure opens."""


def test_most_of_what_is_called_possible_happens():
    counts, seen = Counter(), set()

    # Ten at a time: Hypothesis draws the first ones anew and then only varies them, so that further
    # ones would hardly add anything to the counts.
    @settings(max_examples=10, suppress_health_check=list(HealthCheck))
    @given(missions(least=4, most=6), catalogs(), st.integers(0, 1000))
    def explore(mission, catalog, seed):
        assume(not has_errors(check(mission)))
        if mission not in seen:
            seen.add(mission)
            counts.update(happening(mission, catalog, seed))

    first = random.randrange(2**32) if EXAMPLES else 0
    for tens in range(-(-examples(160) // 10)):
        hypothesis.seed(first + tens)(explore)()
    for what, of, fewest, least, measured, spread in SHARES:
        if EXAMPLES:
            least = measured - 4 * spread * (40 / examples(160)) ** 0.5
        assert counts[what] >= least * counts[of] > fewest, (what, counts)


def happening(mission, catalog, seed):
    """Count what is called possible of a mission, and what of it happens."""
    counts = Counter()
    travel = MadeUpTravel(seed)
    analysis = analyse(mission, catalog, travel)
    tasks = {facts.task for facts in analysis.tasks if facts.verdict is Verdict.POSSIBLE}
    ways = [
        (facts.task, way.target)
        for facts in analysis.tasks
        for way in facts.transitions
        if way.verdict is Verdict.POSSIBLE
        and mission.task(facts.task).transitions[way.index].conditions
    ]
    hfsm = lower(mission)
    ended, entered, taken = [], set(), set()
    for k in range(NOMINAL + EVENTFUL):
        if k >= NOMINAL and tasks <= entered and taken.issuperset(ways):
            break
        mode = "nominal" if k < NOMINAL else "eventful"
        done = run(mission, hfsm, catalog, travel, seed + k, mode=mode, steps=40)
        entered |= {e.target for e in done.executor.trace}
        taken |= {(e.source, e.target) for e in done.executor.trace if e.cause is Cause.CONDITION}
        if mode == "nominal" and done.executor.outcome == "completed":
            ended.append(done.now)
    looked_at = [way for way in ways if way[0] in entered]
    counts["tasks"] = len(tasks)
    counts["tasks entered"] = len(tasks & entered)
    counts["ways"] = len(looked_at)
    counts["ways taken"] = sum(way in taken for way in looked_at)
    if ended and analysis.duration and analysis.duration.most.value is not None:
        counts["bounds"] = 1
        counts["least met"] = min(ended) == analysis.duration.least.value
        counts["most met"] = max(ended) == analysis.duration.most.value
    return counts
