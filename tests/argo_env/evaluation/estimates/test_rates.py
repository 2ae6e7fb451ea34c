"""Tests of the coverage of intervals, by other implementations and by simulated evaluations."""

import math
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import (
    Stratum,
    allocate_runs,
    clopper_pearson,
    stratified_rate,
    wilson,
)

EVALUATIONS = 2_000
COVERAGE = 0.945


@given(st.integers(1, 500), st.data(), st.sampled_from([0.5, 0.9, 0.95, 0.999]))
def test_intervals_are_those_of_scipy(runs, data, level):
    count = data.draw(st.integers(0, runs))
    test = binomtest(count, runs)
    for own, method in ((clopper_pearson, "exact"), (wilson, "wilson")):
        rate, other = own(count, runs, level), test.proportion_ci(level, method)
        assert (rate.low, rate.high) == pytest.approx((other.low, other.high), abs=1e-9)
        assert rate.value == count / runs


def test_the_exact_interval_of_a_published_number():
    # R. G. Newcombe, Statistics in Medicine 17 (1998), table I: 81 of 263.
    rate = clopper_pearson(81, 263)
    assert (round(rate.low, 4), round(rate.high, 4)) == (0.2527, 0.3676)
    assert round(wilson(81, 263).low, 4) == 0.2553


def test_without_runs_the_interval_is_0_to_1():
    for interval in (clopper_pearson, wilson):
        rate = interval(0, 0)
        assert (rate.low, rate.high) == (0.0, 1.0)
        assert math.isnan(rate.value)


@pytest.mark.parametrize(("count", "runs"), [(-1, 3), (4, 3)])
def test_an_impossible_count_is_refused(count, runs):
    with pytest.raises(Invalid, match="give a count from 0 to"):
        clopper_pearson(count, runs)


def test_the_width_of_the_exact_interval_at_98_percent():
    # An interval of one percent on both sides of 98 % needs 856 runs.
    assert clopper_pearson(round(0.98 * 855), 855).width > 0.02
    assert clopper_pearson(round(0.98 * 856), 856).width <= 0.02


exact = cache(clopper_pearson)


def coverage(rng, share, stop):
    """Return the share of evaluations whose interval at the end contains the true share."""
    covered = 0
    for _ in range(EVALUATIONS):
        successes = np.cumsum(rng.random(3_000) < share)
        runs = stop(successes)
        rate = exact(int(successes[runs - 1]), runs)
        covered += rate.low <= share <= rate.high
    return covered / EVALUATIONS


@pytest.mark.parametrize("share", [0.5, 0.9, 0.98, 0.999])
def test_the_exact_interval_covers_after_a_fixed_number_of_runs(share):
    assert coverage(np.random.default_rng(1), share, lambda _: 200) >= COVERAGE


@pytest.mark.parametrize(("share", "width"), [(0.5, 0.15), (0.9, 0.08), (0.98, 0.03)])
def test_the_exact_interval_covers_if_its_width_decides_when_to_stop(share, width):
    def narrow_enough(successes):
        for runs in range(20, 3_000, 20):
            if exact(int(successes[runs - 1]), runs).width <= width:
                return runs
        return 3_000

    assert coverage(np.random.default_rng(2), share, narrow_enough) >= COVERAGE


@pytest.mark.parametrize(
    ("weights", "shares"),
    [((0.5, 0.5), (0.9, 0.6)), ((0.9, 0.07, 0.03), (0.999, 0.7, 0.2)), ((1.0,), (0.95,))],
)
def test_the_interval_of_strata_covers(weights, shares):
    rng = np.random.default_rng(3)
    true = float(np.dot(weights, shares))
    runs = (150, 60, 40)[: len(weights)]
    covered = 0
    for counts in rng.binomial(runs, shares, (EVALUATIONS, len(weights))):
        strata = [Stratum(w, int(c), n) for w, c, n in zip(weights, counts, runs, strict=True)]
        estimate = stratified_rate(strata)
        covered += estimate.low <= true <= estimate.high
    assert covered / EVALUATIONS >= COVERAGE


def test_a_single_stratum_has_the_exact_interval():
    estimate, exact_rate = stratified_rate([Stratum(1.0, 47, 50)]), clopper_pearson(47, 50)
    assert (estimate.low, estimate.high) == pytest.approx((exact_rate.low, exact_rate.high))
    with pytest.raises(Invalid, match="add up to 1"):
        stratified_rate([Stratum(0.5, 1, 2)])


@given(
    st.lists(st.tuples(st.floats(0.01, 1), st.integers(0, 30), st.integers(0, 30)), min_size=1),
    st.integers(0, 500),
)
def test_all_further_runs_are_allocated(parts, runs):
    total = math.fsum(weight for weight, _, _ in parts)
    strata = [Stratum(w / total, min(a, b), max(a, b)) for w, a, b in parts]
    counts = allocate_runs(strata, runs)
    assert sum(counts) == runs
    assert min(counts) >= (1 if runs >= len(strata) else 0)


def test_the_allocation_minimises_the_variance():
    """No other allocation of 12 runs has a variance that is much smaller."""
    strata = [Stratum(0.6, 58, 60), Stratum(0.3, 20, 40), Stratum(0.1, 5, 10)]

    def variance(counts):
        shares = [(s.count + 1) / (s.runs + 2) for s in strata]
        return sum(
            s.weight**2 * p * (1 - p) / n for s, p, n in zip(strata, shares, counts, strict=True)
        )

    allocations = [counts for counts in product(range(1, 13), repeat=3) if sum(counts) == 12]
    assert variance(allocate_runs(strata, 12)) <= 1.05 * min(map(variance, allocations))
