"""Test sets: fixed for ever, apart from training, with references that are theirs."""

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_sources import TEST, TRAINING
from argo_env.site.family import parse_family
from baselines.families import TEST_SETS, UNSEEN_SITES, TurnTaking, find_set
from baselines.references import references

CHECKSUMS = {
    "random-20-v1": "a4d37807477e73cd",
    "random-40-v1": "b6a692c861391a67",
    "ordered-20-v1": "cbbe50df798e00f6",
    "umad-20-v1": "9a9db06ba32defc5",
    "generated-40-v1": "d908155009295259",
    "noisy-20-v1": "9576d9162e35cd78",
    "noisy-40-v1": "8cfc98df6dfa81f8",
}
"""These never change: a set that is to be different gets another version in its name."""


@pytest.mark.parametrize("name", TEST_SETS)
def test_a_test_set_is_what_it_was(name):
    assert TEST_SETS[name].checksum() == CHECKSUMS[name]


@pytest.mark.parametrize("name", TEST_SETS)
def test_a_test_set_has_its_references(name):
    best = references(name)
    assert len(best) == len(TEST_SETS[name].numbers)
    assert all(0.0 <= reference.prize <= reference.bound for reference in best)
    source = TEST_SETS[name].family.source
    for number, reference in zip(TEST_SETS[name].numbers[:10], best[:10], strict=True):
        assert reference.prize <= source.draw(number).prizes.sum() + 1e-9


def test_test_sets_are_apart_from_training():
    for tests in TEST_SETS.values():
        assert set(tests.numbers) <= set(TEST)
        assert not set(tests.numbers) & set(TRAINING)
    for site in UNSEEN_SITES:
        assert parse_family(site).for_testing


def test_sites_take_turns():
    source = TEST_SETS["generated-40-v1"].family.source
    assert isinstance(source, TurnTaking)
    env = RouteEnv(source=source, full=True)
    frames = set()
    for number in TEST[:10]:
        observation, _ = env.reset(options={"instance": number})
        assert np.array_equal(env.instance.arrival, source.sources[number % 5].draw(number).arrival)
        assert observation["mask"].sum() > 5
        frames.add(env.instance.places[:, 2].max())
    assert frames == {2, 3, 4, 5, 6}


def test_an_ordered_set_has_more_order():
    pairs = {
        name: np.mean([find_set(name).family.source.draw(k).before.sum() for k in TEST[:30]])
        for name in ("random-20-v1", "ordered-20-v1")
    }
    assert pairs["ordered-20-v1"] > 3 * pairs["random-20-v1"]


def test_a_test_set_that_is_not_there_is_refused():
    with pytest.raises(ArgoError, match=r"no test set `random-20`; there are: random-20-v1"):
        find_set("random-20")
