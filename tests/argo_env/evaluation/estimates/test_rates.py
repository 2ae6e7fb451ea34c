"""Intervals hold what they claim: by other implementations, and by thousands of simulated
evaluations."""

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
    allocation,
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
        found, other = own(count, runs, level), test.proportion_ci(level, method)
        assert (found.low, found.high) == pytest.approx((other.low, other.high), abs=1e-9)
        assert found.value == count / runs


def test_the_exact_interval_of_a_published_number():
    # R. G. Newcombe, Statistics in Medicine 17 (1998), table I: 81 of 263.
    rate = clopper_pearson(81, 263)
    assert (round(rate.low, 4), round(rate.high, 4)) == (0.2527, 0.3676)
    assert round(wilson(81, 263).low, 4) == 0.2553


def test_of_no_runs_nothing_is_known():
    for interval in (clopper_pearson, wilson):
        rate = interval(0, 0)
        assert (rate.low, rate.high) == (0.0, 1.0)
        assert math.isnan(rate.value)


@pytest.mark.parametrize(("count", "runs"), [(-1, 3), (4, 3)])
def test_no_more_succeed_than_ran(count, runs):
    with pytest.raises(Invalid, match="give a count from 0 to"):
        clopper_pearson(count, runs)


def test_intervals_are_as_wide_as_is_known():
    # It takes 856 runs for one percent on both sides at 98 %.
    assert clopper_pearson(round(0.98 * 855), 855).width > 0.02
    assert clopper_pearson(round(0.98 * 856), 856).width <= 0.02


exact = cache(clopper_pearson)


def covered(rng, share, stop):
    """Of how many evaluations the interval at their end has the true share."""
    held = 0
    for _ in range(EVALUATIONS):
        successes = np.cumsum(rng.random(3_000) < share)
        runs = stop(successes)
        rate = exact(int(successes[runs - 1]), runs)
        held += rate.low <= share <= rate.high
    return held / EVALUATIONS


@pytest.mark.parametrize("share", [0.5, 0.9, 0.98, 0.999])
def test_the_exact_interval_covers_after_a_fixed_number_of_runs(share):
    assert covered(np.random.default_rng(1), share, lambda _: 200) >= COVERAGE


@pytest.mark.parametrize(("share", "width"), [(0.5, 0.15), (0.9, 0.08), (0.98, 0.03)])
def test_the_exact_interval_covers_where_its_width_decides_when_to_stop(share, width):
    def narrow_enough(successes):
        for runs in range(20, 3_000, 20):
            if exact(int(successes[runs - 1]), runs).width <= width:
                return runs
        return 3_000

    assert covered(np.random.default_rng(2), share, narrow_enough) >= COVERAGE


@pytest.mark.parametrize(
    ("weights", "shares"),
    [((0.5, 0.5), (0.9, 0.6)), ((0.9, 0.07, 0.03), (0.999, 0.7, 0.2)), ((1.0,), (0.95,))],
)
def test_the_interval_of_strata_covers(weights, shares):
    rng = np.random.default_rng(3)
    true = float(np.dot(weights, shares))
    runs = (150, 60, 40)[: len(weights)]
    held = 0
    for counts in rng.binomial(runs, shares, (EVALUATIONS, len(weights))):
        strata = [Stratum(w, int(c), n) for w, c, n in zip(weights, counts, runs, strict=True)]
        found = stratified_rate(strata)
        held += found.low <= true <= found.high
    assert held / EVALUATIONS >= COVERAGE


def test_one_stratum_is_the_whole():
    found, whole = stratified_rate([Stratum(1.0, 47, 50)]), clopper_pearson(47, 50)
    assert (found.low, found.high) == pytest.approx((whole.low, whole.high))
    with pytest.raises(Invalid, match="add up to 1"):
        stratified_rate([Stratum(0.5, 1, 2)])


@given(
    st.lists(st.tuples(st.floats(0.01, 1), st.integers(0, 30), st.integers(0, 30)), min_size=1),
    st.integers(0, 500),
)
def test_all_further_runs_are_given_out(parts, runs):
    whole = math.fsum(weight for weight, _, _ in parts)
    strata = [Stratum(w / whole, min(a, b), max(a, b)) for w, a, b in parts]
    given_out = allocation(strata, runs)
    assert sum(given_out) == runs
    assert min(given_out) >= (1 if runs >= len(strata) else 0)


def test_further_runs_go_where_they_tell_most():
    """Beside all ways to give out 12 runs: none has a smaller variance."""
    strata = [Stratum(0.6, 58, 60), Stratum(0.3, 20, 40), Stratum(0.1, 5, 10)]

    def variance(ways):
        shares = [(s.count + 1) / (s.runs + 2) for s in strata]
        return sum(
            s.weight**2 * p * (1 - p) / n for s, p, n in zip(strata, shares, ways, strict=True)
        )

    ways = [w for w in product(range(1, 13), repeat=3) if sum(w) == 12]
    assert variance(allocation(strata, 12)) <= 1.05 * min(map(variance, ways))
