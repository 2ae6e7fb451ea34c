"""Comparisons of two plans in the same worlds."""

from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.control import ControlVariate, controlled_mean
from argo_env.evaluation.estimates.pairs import SuccessPairs, difference, power

COMPARISONS = 2_000


@given(st.integers(0, 40), st.integers(0, 40), st.integers(0, 5), st.integers(0, 5))
def test_mcnemars_test_is_the_sum_over_all_tosses(first_only, second_only, both, neither):
    pairs = SuccessPairs(both, first_only, second_only, neither)
    n, k = first_only + second_only, min(first_only, second_only)
    exact = min(1.0, 2 * sum(comb(n, i) for i in range(k + 1)) / 2**n)
    assert pairs.p_value == pytest.approx(exact)


def test_a_plan_beside_itself_never_differs():
    rng = np.random.default_rng(8)
    for k in range(COMPARISONS):
        done = rng.random(50) < rng.random()
        assert SuccessPairs.from_successes(done, done).p_value == 1.0
        if k % 10 == 0:  # the same again, and slower
            taken = rng.normal(600, 60, 50)
            assert not difference(taken, taken, seed=k).is_significant


def test_a_difference_that_is_none_is_rarely_found():
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
    """Over all that can come of n pairs."""
    held = 0.0
    for a in range(n + 1):
        for b in range(n + 1 - a):
            low, high = SuccessPairs(n - a - b, a, b, 0).interval()
            if low <= up - down <= high:
                ways = comb(n, a) * comb(n - a, b)
                held += ways * up**a * down**b * (1.0 - up - down) ** (n - a - b)
    assert held >= 0.95 - 1e-9


def test_the_interval_of_a_difference_covers():
    rng = np.random.default_rng(11)
    held = 0
    for k in range(200):
        worlds = rng.normal(600, 100, 60)
        a, b = worlds + rng.normal(12, 15, 60), worlds + rng.normal(0, 15, 60)
        found = difference(a, b, seed=k)
        held += found.low <= 12 <= found.high
    assert held / 200 >= 0.9  # by percentiles it is a little too narrow


def test_pairing_finds_what_is_small_beside_what_worlds_differ_by():
    rng = np.random.default_rng(12)
    worlds = rng.normal(600, 100, 80)
    found = difference(worlds + 5, worlds)
    assert found.is_significant
    assert found.value == pytest.approx(5)


def test_there_is_one_run_of_each_a_world():
    with pytest.raises(Invalid, match="make no pairs"):
        difference(np.zeros(3), np.zeros(4))


def drawn(rng, n, m):
    """Times of an expensive and a cheap drive in n worlds, and of the cheap one in m more."""
    cheap = rng.normal(600, 50, n + m)
    return cheap[:n] * 1.1 + rng.normal(0, 10, n), cheap[:n], cheap[n:]


def test_cheap_runs_make_an_estimate_surer_and_keep_its_coverage():
    rng = np.random.default_rng(13)
    held, widths, alone = 0, [], []
    for _ in range(COMPARISONS):
        expensive, cheap, more = drawn(rng, 20, 400)
        found = controlled_mean(expensive, cheap, more)
        held += found.low <= 660 <= found.high
        widths.append(found.high - found.low)
        alone.append(2 * 2.093 * np.std(expensive, ddof=1) / np.sqrt(20))
    assert held / COMPARISONS >= 0.945
    assert np.mean(widths) < 0.4 * np.mean(alone)


def test_whether_it_pays_is_measured():
    rng = np.random.default_rng(14)
    expensive, cheap, _ = drawn(rng, 200, 0)
    known = ControlVariate.from_pairs(expensive, cheap, cost=0.01)
    assert known.correlation > 0.95
    assert known.pays
    assert not ControlVariate.from_pairs(expensive, cheap, cost=1.0).pays
    assert not ControlVariate.from_pairs(rng.normal(0, 1, 200), cheap, cost=0.01).pays
    assert not ControlVariate.from_pairs(np.ones(20), cheap[:20], cost=0.01).pays
    with pytest.raises(Invalid, match="at least 10"):
        ControlVariate.from_pairs(expensive[:5], cheap[:5], 0.1)


def test_the_gain_is_that_of_all_ways_to_spend():
    """Beside a search over how many cheap runs there are for each expensive one."""
    known = ControlVariate(0.9, 0.05)

    def cost(k):
        return (1 + known.cost * k) * (1 - known.correlation**2 * (1 - 1 / k))

    least = min(cost(k) for k in np.linspace(1, 100, 10_000))
    assert known.gain == pytest.approx(1 / least, rel=1e-3)
