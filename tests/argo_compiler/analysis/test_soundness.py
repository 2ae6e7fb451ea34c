"""Nothing that the analysis calls impossible happens in random runs of random missions."""

import pytest
from hypothesis import HealthCheck, assume, event, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import Verdict, analyse
from argo_compiler.base.catalog import Area, Catalog
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Cause, lower
from argo_compiler.hfsm.conditions import condition_text
from argo_compiler.il import Group, Stop
from tests.argo_compiler.analysis.building import mission, task, transition
from tests.argo_compiler.analysis.worlds import (
    MadeUpTravel,
    catalogs,
    missions,
    run,
)
from tests.conftest import examples
from tests.mission_parts import HERE
from tests.mission_writing import checkpoint, measure

SOON = 1e-6
STEPS = (
    Cause.START,
    Cause.CONDITION,
    Cause.REPEAT,
    Cause.DEFAULT,
    Cause.TIMEOUT,
    Cause.FAILURE,
    Cause.MISSED,
)


def steps_of(done):
    return [entry for entry in done.executor.trace if entry.cause in STEPS]


def require_allowed(mission, analysis, done, failures):
    """Require that the run has no task, transition or round that the analysis excludes."""
    facts = {t.task: t for t in analysis.tasks}
    groups = {g.group: g for g in analysis.groups}
    excluded = {Verdict.NEVER} if failures else {Verdict.NEVER, Verdict.AFTER_FAILURE}
    for entry in steps_of(done):
        if entry.target in facts:
            assert facts[entry.target].verdict not in excluded, entry
        if entry.repeated is not None:
            assert groups[entry.repeated].repeats not in excluded, entry
        if entry.timed_out is not None:
            assert groups[entry.timed_out].ends not in excluded, entry
        if entry.source in facts:
            require_transition(mission.task(entry.source), facts[entry.source], entry, excluded)
            if not failures:
                require_not_passed_over(mission, facts[entry.source], entry)
    if done.executor.outcome in ("completed", "completed with failures"):
        assert analysis.ends not in excluded


def taken(task, entry):
    """Return the indices of the transitions that a step may have taken."""
    if entry.cause is Cause.CONDITION:
        return [
            k
            for k, t in enumerate(task.transitions)
            if t.target == entry.target
            and tuple(map(condition_text, t.conditions)) == entry.conditions
        ]
    if entry.cause is Cause.DEFAULT and entry.target is not None:
        return [k for k, t in enumerate(task.transitions) if not t.conditions]
    return []


def require_transition(task, facts, entry, excluded):
    candidates = taken(task, entry)
    assert not candidates or any(
        facts.transitions[k].verdict not in excluded for k in candidates
    ), entry


def require_not_passed_over(mission, facts, entry):
    """Require that no transition before the one taken is called always taken."""
    task = mission.task(entry.source)
    if entry.cause not in (Cause.CONDITION, Cause.DEFAULT, Cause.REPEAT):
        return
    last = len(task.transitions)
    if entry.cause is Cause.CONDITION:
        last = min(taken(task, entry))
    for earlier in facts.transitions[:last]:
        if task.transitions[earlier.index].conditions:
            assert earlier.verdict is not Verdict.ALWAYS, entry


def within(bounds, value, finished):
    if finished:
        assert value >= bounds.least.value - SOON, (value, bounds)
    if bounds.most.value is not None:
        assert value <= bounds.most.value + SOON, (value, bounds)


def require_within(analysis, done):
    """Require a run between the bounds, unless something failed or a reaction started."""
    if not done.nominal or not done.in_time:
        return
    if analysis.duration is None or analysis.energy is None:
        return
    event(f"finished {done.finished}, bounded {analysis.duration.most.value is not None}")
    within(analysis.duration, done.now, done.finished)
    within(analysis.energy, done.energy, done.finished)


def require_within_worst(analysis, done):
    """Require a run within the bound with failures, whatever failed and occurred."""
    worst = analysis.duration_with_failures
    if worst is not None and worst.value is not None and not done.astray:
        event(f"worst, finished {done.finished}")
        assert done.now <= worst.value + SOON, (done.now, worst)


@settings(
    max_examples=examples(40),
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
@given(
    missions(),
    catalogs(),
    st.integers(0, 10**6),
    st.sampled_from([0.0, 0.5, 2.0]),
    st.sampled_from([0.0, 3600.0]),
)
@pytest.mark.rule("W1", "W3", "W4", "W5", "C3", "C4", "C7", "G8", "G13", "M4")
def test_nothing_impossible_happens(mission, catalog, seed, clean_up, standing_power):
    assume(not has_errors(check(mission)))
    travel = MadeUpTravel(seed, clean_up, standing_power=standing_power)
    analysis = analyse(mission, catalog, travel)
    hfsm = lower(mission)
    for k in range(4):
        done = run(mission, hfsm, catalog, travel, seed + k)
        require_allowed(mission, analysis, done, failures=not done.nominal)
        require_within(analysis, done)
        require_within_worst(analysis, done)
        done = run(mission, hfsm, catalog, travel, seed + k, mode="failing")
        require_allowed(mission, analysis, done, failures=True)
        require_within_worst(analysis, done)
        done = run(mission, hfsm, catalog, travel, seed + k, mode="wild")
        require_allowed(mission, analysis, done, failures=True)


def test_a_loop_whose_way_out_always_comes_too_late_is_never_over():
    """The drive from W3 to the group takes longer than the group lasts.

    The value that would lead out of the group is then never measured again.
    """
    group = Group(name="0", start="M1x0", end="M1x1", max_repeat_duration=1, stop=Stop.HARD)
    plan = mission(
        measure("M1x0", "M1x1", object_id="1"),
        measure(
            "M1x1", "W2", transition("M1x0", "1 < 0"), transition("W4", "1 > 0"), object_id="1"
        ),
        task("W2", "W3"),
        task("W3", "M1x0"),
        task("W4", "W5"),
        task("W5"),
        groups=[group],
        dock=HERE,
    )
    catalog = Catalog(
        site="made up",
        checkpoints=(checkpoint(1, 0, 1),),
        areas=(Area(number=1, dock=HERE),),
        floors=(),
    )
    travel = MadeUpTravel(244)
    analysis = analyse(plan, catalog, travel)
    done = run(plan, lower(plan), catalog, travel, 244)
    assert not done.finished
    assert analysis.duration.most.value is None
    assert done.now > 10 * analysis.duration.least.value
    (loop,) = [d for d in analysis.diagnostics if d.code == "analysis.unbounded-loop"]
    assert "the transitions out of them come too late for a hard stop" in loop.message
