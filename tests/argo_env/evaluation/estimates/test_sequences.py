"""Tests of confidence sequences, which must be valid at any stopping time."""

import numpy as np
import pytest

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import clopper_pearson
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from tests.conftest import examples

EVALUATIONS = examples(2_000)
EVERY = 20


def decide(rng, share, required, most=400, values=(0.0, 1.0)):
    """Return the decision on a requirement that is checked every 20 runs, and the sequence.

    The decision is True (met), False (missed) or None (open after `most` runs).
    """
    sequence = ConfidenceSequence()
    outcomes = rng.choice(values, size=most, p=_probabilities(values, share))
    for first in range(0, most, EVERY):
        sequence.add(outcomes[first : first + EVERY])
        if sequence.is_above(required):
            return True, sequence
        if sequence.is_below(required):
            return False, sequence
    return None, sequence


def _probabilities(values, share):
    """Return probabilities of the values with the mean `share`, 0.02 for each inner value."""
    inner = np.array(values[1:-1])
    middle = np.full(len(inner), 0.02)
    top = share - float(inner @ middle)
    return np.array([1 - top - middle.sum(), *middle, top])


@pytest.mark.parametrize("share", [0.5, 0.9, 0.98])
def test_decisions_are_rarely_wrong(share):
    """In the worst case the true share is the required one, and is checked until a decision."""
    rng = np.random.default_rng(4)
    wrong = sum(decide(rng, share, share)[0] is not None for _ in range(EVALUATIONS))
    assert 1 - wrong / EVALUATIONS >= 0.945


def test_the_interval_covers_at_the_time_of_a_decision():
    rng = np.random.default_rng(5)
    covered = 0
    for _ in range(EVALUATIONS):
        _, sequence = decide(rng, 0.95, 0.9, most=200)
        low, high = sequence.interval
        covered += low <= 0.95 <= high
    assert covered / EVALUATIONS >= 0.945


def test_outcomes_between_0_and_1_count_as_well():
    """The outcomes are 0, thirds and 1, as with several sets of faults in one world."""
    rng = np.random.default_rng(6)
    values = (0.0, 1 / 3, 2 / 3, 1.0)
    wrong = sum(
        decide(rng, 0.9, 0.9, most=300, values=values)[0] is not None for _ in range(EVALUATIONS)
    )
    assert 1 - wrong / EVALUATIONS >= 0.945


def test_clear_cases_are_decided_soon():
    rng = np.random.default_rng(7)
    met = [decide(rng, 0.99, 0.9) for _ in range(200)]
    missed = [decide(rng, 0.7, 0.9) for _ in range(200)]
    assert all(decision is True for decision, _ in met)
    assert all(decision is False for decision, _ in missed)
    assert np.mean([sequence.runs for _, sequence in met]) < 150
    assert np.mean([sequence.runs for _, sequence in missed]) < 60


def test_it_is_wider_than_an_exact_interval_but_not_by_much():
    sequence = ConfidenceSequence()
    sequence.add([1.0] * 196 + [0.0] * 4)
    low, high = sequence.interval
    exact = clopper_pearson(196, 200)
    assert low < exact.low < 0.98 < exact.high < high
    assert high - low < 2.0 * exact.width


def test_decisions_agree_with_the_interval():
    sequence = ConfidenceSequence()
    sequence.add([1.0] * 90 + [0.0] * 10)
    low, high = sequence.interval
    assert sequence.is_above(low)
    assert not sequence.is_above(low + 1e-6)
    assert sequence.is_below(high)
    assert not sequence.is_below(high - 1e-6)


def test_without_outcomes_the_interval_is_0_to_1():
    assert ConfidenceSequence().interval == (0.0, 1.0)


def test_outcomes_lie_between_0_and_1():
    with pytest.raises(Invalid, match="between 0 and 1"):
        ConfidenceSequence().add([1.5])
