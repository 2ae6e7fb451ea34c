"""Tests of paired comparisons and control variates, by exact sums and by simulation."""

from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.control import ControlVariate, controlled_mean
from argo_env.evaluation.estimates.pairs import SuccessPairs, mean_first_minus_second, power

COMPARISONS = 2_000


@given(st.integers(0, 40), st.integers(0, 40), st.integers(0, 5), st.integers(0, 5))
def test_mcnemars_test_is_the_sum_over_all_tosses(first_only, second_only, both, neither):
    pairs = SuccessPairs(both, first_only, second_only, neither)
    n, k = first_only + second_only, min(first_only, second_only)
    exact = min(1.0, 2 * sum(comb(n, i) for i in range(k + 1)) / 2**n)
    assert pairs.p_value == pytest.approx(exact)


def test_a_plan_never_differs_from_itself():
    rng = np.random.default_rng(8)
    for k in range(COMPARISONS):
        done = rng.random(50) < rng.random()
        assert SuccessPairs.from_successes(done, done).p_value == 1.0
        if k % 10 == 0:  # this check is slower
            taken = rng.normal(600, 60, 50)
            assert not mean_first_minus_second(taken, taken, seed=k).is_significant_by_p_value


def test_a_difference_is_rarely_found_if_there_is_none():
    rng = np.random.default_rng(9)
    found = 0
    for _ in range(COMPARISONS):
        a, b = rng.random((2, 120)) < 0.85
        found += SuccessPairs.from_successes(a, b).p_value <= 0.05
    assert found / COMPARISONS <= 0.055


@pytest.mark.parametrize(("first_only", "second_only"), [(0.1, 0.02), (0.2, 0.1), (0.05, 0.05)])
def test_the_power_is_what_simulated_comparisons_find(first_only, second_only):
    rng = np.random.default_rng(10)
    kinds = rng.multinomial(
        100, [first_only, second_only, 1 - first_only - second_only], COMPARISONS
    )
    found = sum(SuccessPairs(int(c), int(a), int(b), 0).p_value <= 0.05 for a, b, c in kinds)
    assert power(100, first_only, second_only) == pytest.approx(found / COMPARISONS, abs=0.03)


@pytest.mark.parametrize("n", [1, 5, 12, 25])
@pytest.mark.parametrize("up", [0.0, 0.02, 0.1, 0.4])
@pytest.mark.parametrize("down", [0.0, 0.05, 0.3])
def test_the_interval_of_a_difference_in_success_covers_it(n, up, down):
    """The coverage is the sum over all possible outcomes of n pairs."""
    coverage = 0.0
    for a in range(n + 1):
        for b in range(n + 1 - a):
            low, high = SuccessPairs(n - a - b, a, b, 0).interval()
            if low <= up - down <= high:
                orders = comb(n, a) * comb(n - a, b)
                coverage += orders * up**a * down**b * (1.0 - up - down) ** (n - a - b)
    assert coverage >= 0.95 - 1e-9


def test_the_interval_of_a_difference_covers():
    rng = np.random.default_rng(11)
    covered = 0
    for k in range(200):
        worlds = rng.normal(600, 100, 60)
        a, b = worlds + rng.normal(12, 15, 60), worlds + rng.normal(0, 15, 60)
        estimate = mean_first_minus_second(a, b, seed=k)
        covered += estimate.low <= 12 <= estimate.high
    assert covered / 200 >= 0.9  # the percentile interval is a little too narrow


def test_pairing_finds_a_difference_smaller_than_that_between_worlds():
    rng = np.random.default_rng(12)
    worlds = rng.normal(600, 100, 80)
    estimate = mean_first_minus_second(worlds + 5, worlds)
    assert estimate.is_significant_by_p_value
    assert estimate.value == pytest.approx(5)


def test_pairs_need_equal_numbers_of_runs():
    with pytest.raises(Invalid, match="make no pairs"):
        mean_first_minus_second(np.zeros(3), np.zeros(4))


def draw_times(rng, n, m):
    """Return times of two drives in n worlds, and of the cheap one in m more: (n,), (n,), (m,)."""
    cheap = rng.normal(600, 50, n + m)
    return cheap[:n] * 1.1 + rng.normal(0, 10, n), cheap[:n], cheap[n:]


def test_cheap_runs_narrow_the_interval_and_keep_its_coverage():
    rng = np.random.default_rng(13)
    covered, widths, widths_without = 0, [], []
    for _ in range(COMPARISONS):
        expensive, cheap, more = draw_times(rng, 20, 400)
        estimate = controlled_mean(expensive, cheap, more)
        covered += estimate.low <= 660 <= estimate.high
        widths.append(estimate.high - estimate.low)
        widths_without.append(2 * 2.093 * np.std(expensive, ddof=1) / np.sqrt(20))
    assert covered / COMPARISONS >= 0.945
    assert np.mean(widths) < 0.4 * np.mean(widths_without)


def test_cheap_runs_pay_if_they_are_correlated_and_cheap():
    rng = np.random.default_rng(14)
    expensive, cheap, _ = draw_times(rng, 200, 0)
    control = ControlVariate.from_pairs(expensive, cheap, cost=0.01)
    assert control.correlation > 0.95
    assert control.pays
    assert not ControlVariate.from_pairs(expensive, cheap, cost=1.0).pays
    assert not ControlVariate.from_pairs(rng.normal(0, 1, 200), cheap, cost=0.01).pays
    assert not ControlVariate.from_pairs(np.ones(20), cheap[:20], cost=0.01).pays
    with pytest.raises(Invalid, match="at least 10"):
        ControlVariate.from_pairs(expensive[:5], cheap[:5], 0.1)


def test_the_gain_is_the_best_for_all_numbers_of_cheap_runs():
    """The gain agrees with a search over the number of cheap runs for each expensive run."""
    control = ControlVariate(0.9, 0.05)

    def cost(k):
        return (1 + control.cost * k) * (1 - control.correlation**2 * (1 - 1 / k))

    lowest = min(cost(k) for k in np.linspace(1, 100, 10_000))
    assert control.cost_reduction_factor == pytest.approx(1 / lowest, rel=1e-3)
