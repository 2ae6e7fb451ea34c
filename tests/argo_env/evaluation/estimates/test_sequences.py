"""A confidence sequence may be looked at after each run."""

import numpy as np
import pytest

from argo_compiler.base.errors import Invalid
from argo_env.evaluation.estimates.rates import clopper_pearson
from argo_env.evaluation.estimates.sequences import ConfidenceSequence
from tests.conftest import examples

EVALUATIONS = examples(2_000)
EVERY = 20


def decided(rng, share, required, most=400, values=(0.0, 1.0)):
    """What an evaluation against a requirement says that looks every twenty runs: True, False or
    None."""
    sequence = ConfidenceSequence()
    outcomes = rng.choice(values, size=most, p=_chances(values, share))
    for first in range(0, most, EVERY):
        sequence.add(outcomes[first : first + EVERY])
        if sequence.is_above(required):
            return True, sequence
        if sequence.is_below(required):
            return False, sequence
    return None, sequence


def _chances(values, share):
    """Of values from 0 to 1 with that mean: the ends, and a tenth each of what is between."""
    inner = np.array(values[1:-1])
    middle = np.full(len(inner), 0.02)
    top = share - float(inner @ middle)
    return np.array([1 - top - middle.sum(), *middle, top])


@pytest.mark.parametrize("share", [0.5, 0.9, 0.98])
def test_what_is_said_at_the_time_of_a_decision_holds(share):
    """The worst case: the truth is just what is asked for, and one looks until it is decided."""
    rng = np.random.default_rng(4)
    wrong = sum(decided(rng, share, share)[0] is not None for _ in range(EVALUATIONS))
    assert 1 - wrong / EVALUATIONS >= 0.945


def test_the_whole_sequence_holds_and_so_it_does_where_it_stopped():
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(EVALUATIONS):
        _, sequence = decided(rng, 0.95, 0.9, most=200)
        low, high = sequence.interval
        held += low <= 0.95 <= high
    assert held / EVALUATIONS >= 0.945


def test_shares_between_are_counted_as_well():
    """Outcomes as those of several faults in one world: 0, thirds and 1."""
    rng = np.random.default_rng(6)
    values = (0.0, 1 / 3, 2 / 3, 1.0)
    wrong = sum(
        decided(rng, 0.9, 0.9, most=300, values=values)[0] is not None for _ in range(EVALUATIONS)
    )
    assert 1 - wrong / EVALUATIONS >= 0.945


def test_it_decides():
    """What is clearly met or missed is said, and soon."""
    rng = np.random.default_rng(7)
    met = [decided(rng, 0.99, 0.9) for _ in range(200)]
    missed = [decided(rng, 0.7, 0.9) for _ in range(200)]
    assert all(said is True for said, _ in met)
    assert all(said is False for said, _ in missed)
    assert np.mean([sequence.runs for _, sequence in met]) < 150
    assert np.mean([sequence.runs for _, sequence in missed]) < 60


def test_it_is_wider_than_an_interval_for_one_look_but_not_by_much():
    sequence = ConfidenceSequence()
    sequence.add([1.0] * 196 + [0.0] * 4)
    low, high = sequence.interval
    once = clopper_pearson(196, 200)
    assert low < once.low < 0.98 < once.high < high
    assert high - low < 2.0 * once.width


def test_what_is_shown_agrees_with_the_interval():
    sequence = ConfidenceSequence()
    sequence.add([1.0] * 90 + [0.0] * 10)
    low, high = sequence.interval
    assert sequence.is_above(low)
    assert not sequence.is_above(low + 1e-6)
    assert sequence.is_below(high)
    assert not sequence.is_below(high - 1e-6)


def test_of_nothing_seen_all_is_possible():
    assert ConfidenceSequence().interval == (0.0, 1.0)


def test_outcomes_lie_between_0_and_1():
    with pytest.raises(Invalid, match="between 0 and 1"):
        ConfidenceSequence().add([1.5])
