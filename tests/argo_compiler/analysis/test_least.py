"""Claims on lower bounds have a witness, and the checker accepts no wrong witness."""

import json
import math
from dataclasses import asdict, fields, replace

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from argo_compiler.analysis import analyse, unproved_bounds
from argo_compiler.analysis.bound_verification import is_valid, least_steps_if_computable
from argo_compiler.analysis.bound_witness_search import find_least_witness
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Cause, lower
from argo_compiler.il import Group, Stop, TimeWindow
from tests.argo_compiler.analysis.building import CATALOG, ConstantTravel, mission, task, transition
from tests.argo_compiler.analysis.worlds import MadeUpTravel, catalogs, missions, run
from tests.conftest import examples

SLOW = [HealthCheck.filter_too_much, HealthCheck.too_slow]
SOON = 1e-6


def witnessed(plan, catalog, travel):
    """Return the witness of a mission, and the steps that check it; None twice if there is none."""
    witnesses = analyse(plan, catalog, travel).witnesses
    if witnesses is None:
        return None, None
    steps = least_steps_if_computable(plan, catalog, travel, witnesses.nominal)
    return find_least_witness(steps), steps


@settings(max_examples=examples(30), suppress_health_check=SLOW)
@given(
    missions(),
    catalogs(),
    st.integers(0, 10**6),
    st.sampled_from([0.0, 0.5, 2.0]),
    st.sampled_from([0.0, 3600.0]),
)
def test_no_run_takes_less_than_what_is_accepted(plan, catalog, seed, clean_up, standing_power):
    # A reaction may end a mission before.
    plan = plan.model_copy(update={"reactions": ()})
    assume(not has_errors(check(plan)))
    travel = MadeUpTravel(seed, clean_up, standing_power=standing_power)
    witness, steps = witnessed(plan, catalog, travel)
    assume(witness is not None)
    assert is_valid(steps, witness)
    position = {one.name: i for i, one in enumerate(plan.tasks)}
    hfsm = lower(plan)
    for k in range(4):
        done = run(plan, hfsm, catalog, travel, seed + k)
        if not done.nominal or not done.in_time:
            continue
        for entry in done.executor.trace:
            if entry.source in position and entry.cause in ENDS:
                at = position[entry.source]
                known = witness.time.tasks[at], witness.time.missed[at]
                assert entry.time >= min(k for k in known if k is not None) - SOON
        if done.finished:
            assert done.now >= witness.time.end - SOON
            assert done.energy >= witness.energy.end - SOON


# Causes of leaving a task that has ended by itself, failed, or missed its window.
ENDS = {Cause.CONDITION, Cause.REPEAT, Cause.DEFAULT, Cause.FAILURE, Cause.MISSED}


def rounds(**limits):
    """Return a mission of A, two measurements in a group, and D."""
    group = Group(name="G", start="Bm1", end="Cm2", **limits)
    return mission("A", "Bm1", "Cm2", "D", groups=[group], max_duration=60)


COUNTED = rounds(max_repeat_count=4)
OUTER = Group(name="G", start="A", end="D", max_repeat_count=3)
USUAL = {
    "rounds by count": COUNTED,
    "a patrol by duration": rounds(max_repeat_duration=600, stop=Stop.SOFT),
    "a patrol until its time is up": rounds(max_repeat_duration=600),
    "rounds by a plan": rounds(max_repeat_count=4, every=100),
    "rounds in rounds": mission(
        *["A", "Bm1", "Cm2", "D", "E"],
        groups=[OUTER, Group(name="G/H", start="Bm1", end="Cm2", max_repeat_count=4)],
        max_duration=60,
    ),
    "a branch that leaves out a task": mission(
        task("Am1", transition("C", "1 < 5"), "B"),
        task("B", "C"),
        task("C", "D"),
        task("D", window=TimeWindow(earliest=500)),
        max_duration=60,
    ),
}


@pytest.mark.parametrize("name", USUAL)
def test_the_lower_bounds_of_usual_missions_are_proved(name):
    plan, travel = USUAL[name], ConstantTravel()
    analysis = analyse(plan, CATALOG, travel)
    assert "analysis.too-long" in {d.code for d in analysis.diagnostics}
    assert unproved_bounds(plan, CATALOG, travel, analysis) == ()
    assert analysis.unjudged == ()
    least = analysis.witnesses.least
    assert least.time.end == pytest.approx(analysis.duration.least.value)
    json.dumps(asdict(least))


def test_claims_on_battery_and_windows_are_proved():
    windowed = task("D", window=TimeWindow(latest=20))
    plan = mission(*COUNTED.tasks[:3], windowed, groups=COUNTED.groups)
    travel = ConstantTravel(battery=5.0)
    analysis = analyse(plan, CATALOG, travel)
    found = {d.code for d in analysis.diagnostics}
    assert {"analysis.window-missed", "analysis.battery-exceeded"} <= found
    assert unproved_bounds(plan, CATALOG, travel, analysis) == ()


def corrupted(spent):
    """Yield the witness with one value greater, missing or no number, or with a value too few."""
    for field in fields(spent):
        column = getattr(spent, field.name)
        if not isinstance(column, tuple):
            others = (column + 0.01, math.nan)
        else:
            others = [column[:-1]] if column else []
            for at, value in enumerate(column):
                if value is not None:
                    wrong = (value + 0.01, math.nan, math.inf)
                    wrong += (-1.0,) if field.name == "periods" else (None,)
                    others += [(*column[:at], one, *column[at + 1 :]) for one in wrong]
        for other in others:
            yield field.name, replace(spent, **{field.name: other})


@pytest.mark.parametrize("name", USUAL)
def test_a_witness_that_claims_more_is_rejected(name):
    plan, travel = USUAL[name], ConstantTravel()
    witness, steps = witnessed(plan, CATALOG, travel)
    assert is_valid(steps, witness)
    for field, other in corrupted(witness.time):
        assert not is_valid(steps, replace(witness, time=other)), (field, other)
    for field, other in corrupted(witness.energy):
        assert not is_valid(steps, replace(witness, energy=other)), (field, other)


def test_claims_without_a_valid_witness_are_unproved():
    """A valid witness that proves too little, a wrong one, and none at all prove no claim."""
    travel = ConstantTravel()
    analysis = analyse(COUNTED, CATALOG, travel)
    (claim,) = [d for d in analysis.diagnostics if d.code == "analysis.too-long"]
    least = analysis.witnesses.least
    for time in (
        replace(least.time, end=least.time.end - 1),
        replace(least.time, end=least.time.end + 1),
        None,
    ):
        other = None if time is None else replace(least, time=time)
        witnesses = replace(analysis.witnesses, least=other)
        weak = analysis.model_copy(update={"witnesses": witnesses})
        assert unproved_bounds(COUNTED, CATALOG, travel, weak) == (claim,)


class WanderingTravel(ConstantTravel):
    """Travel in which the robot never stands at the same pose again."""

    def leg_with_action(self, origin, task, velocity):
        leg = super().leg_with_action(origin, task, velocity)
        return replace(leg, arrival=f"{origin}+")


def test_a_claim_that_cannot_be_proved_is_withdrawn():
    analysis = analyse(COUNTED, CATALOG, WanderingTravel())
    assert analysis.duration.least.value > COUNTED.max_duration
    assert "analysis.too-long" not in {d.code for d in analysis.diagnostics}
    assert analysis.unjudged == ("whether the mission takes too long on all paths",)
