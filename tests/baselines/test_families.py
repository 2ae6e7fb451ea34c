"""Test sets: they never change, are separate from training, and have references."""

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_sources import TEST, TRAINING
from argo_env.site.family import parse_family
from baselines.families import TEST_SETS, UNSEEN_SITES, AlternatingSources, find_test_set
from baselines.references import load_references

CHECKSUMS = {
    "random-20-v1": "a4d37807477e73cd",
    "random-40-v1": "b6a692c861391a67",
    "ordered-20-v1": "cbbe50df798e00f6",
    "umad-20-v1": "9a9db06ba32defc5",
    "generated-40-v1": "d908155009295259",
    "noisy-20-v1": "9576d9162e35cd78",
    "noisy-40-v1": "8cfc98df6dfa81f8",
}
"""Checksums of the test sets; they never change: a changed set gets another version in its name."""


@pytest.mark.parametrize("name", TEST_SETS)
def test_a_test_set_has_not_changed(name):
    assert TEST_SETS[name].checksum() == CHECKSUMS[name]


@pytest.mark.parametrize("name", TEST_SETS)
def test_a_test_set_has_its_references(name):
    best = load_references(name)
    assert len(best) == len(TEST_SETS[name].numbers)
    assert all(0.0 <= reference.prize <= reference.bound for reference in best)
    source = TEST_SETS[name].family.source
    for number, reference in zip(TEST_SETS[name].numbers[:10], best[:10], strict=True):
        assert reference.prize <= source.draw(number).prizes.sum() + 1e-9


def test_test_sets_are_separate_from_training():
    for test_set in TEST_SETS.values():
        assert set(test_set.numbers) <= set(TEST)
        assert not set(test_set.numbers) & set(TRAINING)
    for site in UNSEEN_SITES:
        assert parse_family(site).for_testing


def test_sites_take_turns():
    source = TEST_SETS["generated-40-v1"].family.source
    assert isinstance(source, AlternatingSources)
    env = RouteEnv(source=source, full=True)
    top_floors = set()
    for number in TEST[:10]:
        observation, _ = env.reset(options={"instance": number})
        assert np.array_equal(env.instance.arrival, source.sources[number % 5].draw(number).arrival)
        assert observation["mask"].sum() > 5
        top_floors.add(env.instance.positions[:, 2].max())
    assert top_floors == {2, 3, 4, 5, 6}


def test_an_ordered_set_has_more_precedence_constraints():
    pairs = {
        name: np.mean([find_test_set(name).family.source.draw(k).before.sum() for k in TEST[:30]])
        for name in ("random-20-v1", "ordered-20-v1")
    }
    assert pairs["ordered-20-v1"] > 3 * pairs["random-20-v1"]


def test_an_unknown_test_set_is_an_error():
    with pytest.raises(ArgoError, match=r"no test set `random-20`; choose one of: random-20-v1"):
        find_test_set("random-20")
