"""Tests of requirements on detections, for which only runs with faults count."""

import math

import pytest

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.file import decode_evaluation
from argo_env.evaluation.plan import Stopping
from argo_env.evaluation.rates import Decision
from argo_env.evaluation.report.sections import other_rates_by_quantity_and_plan
from argo_env.evaluation.requirement import parse_requirement
from argo_env.faults.loading import decode_faults
from tests.argo_env.evaluation import conftest
from tests.argo_env.evaluation.conftest import results_with

ALARM = decode_faults(b"faults: [{kind: platform_alarm, at: 5}]", "test").faults
FOUND = FaultDetection(fault="platform_alarm", began=5.0, delay=3.0)
MISSED = FOUND.model_copy(update={"delay": None})
WORLDS = 40


def plan_of(mission, faults, **options):
    """Return a plan with a case for each name of faults: `none` or others."""
    return conftest.plan_of(mission, range(WORLDS), faults, "kinematic", given=ALARM, **options)


def results_of(plan, found_in):
    """Return results in which the faults are found in the worlds of `found_in` only."""

    def detections_of(run):
        faultless = plan.cases[run.case].faults == "none"
        return {"detections": () if faultless else (FOUND if run.seed in found_in else MISSED,)}

    return results_with(plan, detections_of)


@pytest.mark.parametrize("faults", [["alarm"], ["none", "alarm"], ["none", "alarm", "again"]])
@pytest.mark.parametrize(
    ("found_in", "rate", "verdict"),
    [
        (range(0), 0.0, Decision.MISSED),
        (range(WORLDS), 1.0, Decision.MET),
        (range(0, WORLDS, 2), 0.5, Decision.OPEN),
    ],
)
def test_runs_without_faults_do_not_count(mission, faults, found_in, rate, verdict):
    stopping = Stopping(require=(parse_requirement("detected >= 0.5"),))
    plan = plan_of(mission, faults, stopping=stopping)
    results = results_of(plan, found_in)
    detected = results.rate(plan.plans[0], "detected")
    assert detected.value == rate
    assert detected.runs == WORLDS * sum(name != "none" for name in faults)
    assert detected.low <= rate <= detected.high
    (judged,) = results.verdicts
    assert judged.verdict is verdict
    assert judged.worlds == WORLDS
    assert set(results.frame["detected"].dropna()) == {seed in found_in for seed in range(WORLDS)}


@pytest.mark.parametrize("strata", [False, True])
def test_without_faults_there_is_no_rate_of_detections(mission, strata):
    plan = plan_of(mission, ["none"], strata=strata)
    results = results_of(plan, range(WORLDS))
    rate = results.rate(plan.plans[0], "detected")
    assert math.isnan(rate.value)
    assert rate.runs == 0
    assert not any(
        "faults were found" in name for name, _, _ in other_rates_by_quantity_and_plan(results)
    )


def test_strata_without_faults_have_no_weight(mission):
    plan = plan_of(mission, ["none", "alarm"], strata=True)
    results = results_of(plan, range(WORLDS // 4))
    assert results.rate(plan.plans[0], "detected").value == 0.25
    assert results.rate(plan.plans[0]).value == 1.0


def test_strata_allow_no_requirement(mission):
    """No world has a run of each case, so that it would never be decided."""
    stopping = Stopping(require=(parse_requirement("success >= 0.5"),))
    plan = plan_of(mission, ["none", "alarm"], strata=True, stopping=stopping)
    with pytest.raises(Invalid, match="strata have no worlds in common"):
        plan.check()
    plan.with_changes(stopping=Stopping(width=0.1)).check()


def test_a_run_with_a_fault_that_was_never_found_has_no_delay(mission):
    plan = plan_of(mission, ["none", "alarm", "both"])
    late = FOUND.model_copy(update={"delay": 8.0})
    by_case = {"none": (), "alarm": (FOUND, late), "both": (FOUND, MISSED)}
    results = results_with(plan, lambda run: {"detections": by_case[plan.cases[run.case].faults]})
    delays = results.frame.groupby("faults")["delay"]
    assert delays.max().dropna().to_dict() == {"alarm": 8.0}
    assert delays.count().to_dict() == {"none": 0, "alarm": WORLDS, "both": 0}


def test_a_requirement_on_detections_needs_faults(mission):
    stopping = Stopping(require=(parse_requirement("detected >= 0.5"),))
    with pytest.raises(Invalid, match="there are none"):
        plan_of(mission, ["none"], stopping=stopping).check()
    plan_of(mission, ["none", "alarm"], stopping=stopping).check()


def test_a_single_requirement_needs_no_list():
    file = decode_evaluation(b"missions: [m.txt]\nrequire: success >= 98 %\n", "file")
    assert file.require == ("success >= 98 %",)
