"""Tests of comparisons of plans: pairs of runs, and intervals of differences."""

import pytest

from argo_env.evaluation.comparison import compare_plans
from argo_env.evaluation.plan import Stopping, single_seed_note
from argo_env.evaluation.report.page import comparison_page
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.row import RunOutcome
from tests.argo_env.evaluation.conftest import plan_of, results_with


def results_of(mission, seeds, faults=("none",), failing=(), stopping=None):
    """Return results in which the runs of the worlds in `failing` fail."""
    plan = plan_of(mission, seeds, faults, stopping=stopping or Stopping())
    outcomes = {False: RunOutcome.SUCCESS, True: RunOutcome.FAILURE}
    return results_with(plan, lambda r: {"outcome": outcomes[r.seed in failing], "duration": 100.0})


@pytest.mark.parametrize("faults", [("none",), ("a", "b")])
def test_the_interval_is_wide_if_no_pair_differs(mission, faults):
    results = results_of(mission, range(10), faults)
    success = compare_plans(results, results).success
    assert success.value == 0.0
    assert success.low == -success.high < -0.2


@pytest.mark.parametrize("faults", [("none",), ("a", "b")])
def test_one_pair_that_differs_shows_nothing(mission, faults):
    compared = compare_plans(
        results_of(mission, range(20), faults), results_of(mission, range(20), faults, failing={3})
    )
    assert compared.success.value == pytest.approx(0.05)
    assert compared.success.low < 0.0 < 0.2 < compared.success.high < 1.0
    assert compared.p_value == pytest.approx(1.0, abs=0.01)


def test_runs_without_a_partner_are_counted(mission):
    compared = compare_plans(
        results_of(mission, range(8), ("none", "a")), results_of(mission, range(4, 15))
    )
    assert compared.successes.pairs == 4
    assert compared.unpaired == (12, 7)


@pytest.mark.parametrize(("failing", "shown"), [(range(6), False), (range(30), True)])
@pytest.mark.parametrize(
    "stopping", [Stopping(require=(parse_requirement("success >= 0.9"),)), Stopping(width=0.1)]
)
def test_where_outcomes_ended_an_evaluation_the_interval_decides(mission, failing, shown, stopping):
    """A test for a fixed number of pairs would find a difference in both cases."""
    one = results_of(mission, range(60), stopping=stopping)
    other = results_of(mission, range(60), failing=failing)
    fixed_first = results_of(mission, range(60))
    open_end, fixed = compare_plans(one, other), compare_plans(fixed_first, other)
    assert open_end.success.high > fixed.success.high
    assert (open_end.success.low > 0.0) is shown
    assert fixed.conclusion == "A succeeds more often."
    assert (open_end.conclusion == fixed.conclusion) is shown
    assert "the interval of the difference allows for that" in comparison_page(open_end)
    assert "nan" not in comparison_page(open_end).lower()
    power = "What this number of pairs can show"  # by a test, which does not decide here
    assert power in comparison_page(fixed)
    assert power not in comparison_page(open_end)


def test_the_text_of_a_comparison_and_of_results_fits_one_screen(mission):
    results = results_of(mission, range(300))
    compared = compare_plans(results, results_of(mission, range(300), failing=range(30)))
    for thing in (compared, results, results.plan):
        assert len(repr(thing)) < 600
    assert "300 pairs" in str(compared)
    assert compared.conclusion in str(compared)
    assert "300 rows" in str(results)


@pytest.mark.parametrize(
    ("seeds", "note"),
    [
        ("5", "seed 5 only; for 5 seeds: 0..4"),
        (" 20 ", "seed 20 only; for 20 seeds: 0..19"),
        ("0", None), ("1", None), ("0..4", None), ("3,7", None),
    ],
)  # fmt: skip
def test_a_single_seed_that_may_be_meant_as_a_number_is_named(seeds, note):
    assert single_seed_note(seeds) == note
