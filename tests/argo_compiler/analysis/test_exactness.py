"""What the analysis calls possible does happen, in most cases: random missions, run many times."""

from collections import Counter

from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import Verdict, analyse
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Cause, lower
from tests.argo_compiler.analysis.worlds import MadeUpTravel, catalogs, missions, run

RUNS = 50


def test_most_of_what_is_called_possible_happens():
    counts = Counter()

    @settings(
        max_examples=40,
        deadline=None,
        database=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    @given(missions(least=4, most=6), catalogs(), st.integers(0, 1000))
    def explore(mission, catalog, seed):
        assume(not has_errors(check(mission)))
        travel = MadeUpTravel(seed)
        analysis = analyse(mission, catalog, travel)
        hfsm = lower(mission)
        runs = [run(mission, hfsm, catalog, travel, seed + k, steps=40) for k in range(RUNS)]
        entries = [e for done in runs for e in done.executor.trace]
        entered = {e.target for e in entries}
        taken = {(e.source, e.target) for e in entries if e.cause is Cause.CONDITION}
        for facts in analysis.tasks:
            if facts.verdict is Verdict.POSSIBLE:
                counts["tasks"] += 1
                counts["tasks entered"] += facts.task in entered
            for way in facts.transitions:
                conditional = mission.task(facts.task).transitions[way.index].conditions
                if conditional and facts.task in entered and way.verdict is Verdict.POSSIBLE:
                    counts["ways"] += 1
                    counts["ways taken"] += (facts.task, way.target) in taken
        ended = [done.now for done in runs if done.executor.outcome == "completed"]
        if ended and analysis.duration and analysis.duration.most.value is not None:
            counts["bounds"] += 1
            counts["least met"] += min(ended) == analysis.duration.least.value
            counts["most met"] += max(ended) == analysis.duration.most.value

    explore()
    assert counts["tasks entered"] >= 0.75 * counts["tasks"] > 30
    assert counts["ways taken"] >= 0.65 * counts["ways"] > 5
    assert counts["least met"] >= 0.6 * counts["bounds"] > 5
    assert counts["most met"] >= 0.6 * counts["bounds"]
