"""Comparisons of evaluations: what is paired, and between what the difference lies."""

import pytest

from argo_env.evaluation.comparison import compare_plans
from argo_env.evaluation.plan import Stopping
from argo_env.evaluation.report.page import comparison_page
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.row import RunOutcome
from tests.argo_env.evaluation.conftest import came_to, plan_of


def results_of(mission, seeds, faults=("none",), failing=(), stopping=None):
    """Results in which the runs of some worlds fail."""
    plan = plan_of(mission, seeds, faults, stopping=stopping or Stopping())
    outcomes = {False: RunOutcome.SUCCESS, True: RunOutcome.FAILURE}
    return came_to(plan, lambda r: {"outcome": outcomes[r.seed in failing], "duration": 100.0})


@pytest.mark.parametrize("faults", [("none",), ("a", "b")])
def test_where_no_pair_differs_there_may_still_be_a_difference(mission, faults):
    one = results_of(mission, range(10), faults)
    success = compare_plans(one, one).success
    assert success.value == 0.0
    assert success.low == -success.high < -0.2


@pytest.mark.parametrize("faults", [("none",), ("a", "b")])
def test_one_pair_that_differs_shows_nothing(mission, faults):
    found = compare_plans(
        results_of(mission, range(20), faults), results_of(mission, range(20), faults, failing={3})
    )
    assert found.success.value == pytest.approx(0.05)
    assert found.success.low < 0.0 < 0.2 < found.success.high < 1.0
    assert found.p_value == pytest.approx(1.0, abs=0.01)


def test_runs_without_a_partner_are_counted(mission):
    found = compare_plans(
        results_of(mission, range(8), ("none", "a")), results_of(mission, range(4, 15))
    )
    assert found.successes.pairs == 4
    assert found.unpaired == (12, 7)


@pytest.mark.parametrize(("failing", "shown"), [(range(6), False), (range(30), True)])
@pytest.mark.parametrize(
    "stopping", [Stopping(require=(parse_requirement("success >= 0.9"),)), Stopping(width=0.1)]
)
def test_where_outcomes_ended_an_evaluation_the_interval_decides(mission, failing, shown, stopping):
    """By a test that is made for a number of pairs that was said before both are a difference."""
    one = results_of(mission, range(60), stopping=stopping)
    other = results_of(mission, range(60), failing=failing)
    found, fixed = compare_plans(one, other), compare_plans(results_of(mission, range(60)), other)
    assert found.success.high > fixed.success.high
    assert (found.success.low > 0.0) is shown
    assert fixed.conclusion == "A succeeds more often."
    assert (found.conclusion == fixed.conclusion) is shown
    assert "the interval of the difference allows for that" in comparison_page(found)
    assert "nan" not in comparison_page(found).lower()
    power = "What this number of pairs can show"  # by a test that does not decide here
    assert power in comparison_page(fixed)
    assert power not in comparison_page(found)
