"""Policies: all registered ones obey the rules on all kinds of instances."""

from importlib.metadata import entry_points

import numpy as np
import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import suggest_route
from argo_env.envs.route_instance import score_route
from argo_env.envs.route_noise import RouteNoise
from argo_env.policies import POLICIES
from baselines import portfolio
from baselines.episodes import play
from baselines.families import TEST_SETS, InstanceFamily, InstanceSet
from baselines.heuristics.greedy import GivenOrder
from baselines.policy import OWN_POLICIES, Policy, make_policy
from baselines.problem import hindsight_problem

NUMBERS = range(1_000_000, 1_000_100)
KINDS = {
    "plain": InstanceFamily(9, budget=600.0),
    "ordered": InstanceFamily(9, budget=600.0, precedence=0.9),
    "noisy": InstanceFamily(9, budget=600.0, noise=RouteNoise(failing=0.4, blocked=3)),
    "umad": InstanceFamily(9, ("umad",)),
    "tight": InstanceFamily(3, budget=200.0),
}


def won_and_best_prizes(policy, kind, count):
    """Return a policy's prizes on the first instances of a kind, and the best possible ones."""
    test_set = InstanceSet(kind, KINDS[kind], NUMBERS)
    best = [
        suggest_route(hindsight_problem(test_set.family.source.draw(number)).problem).prize / 100
        for number in NUMBERS[:count]
    ]
    return [outcome.prize for outcome in play(policy, test_set, count)], best


def make_installed_policy(name):
    """Return a policy; without the extra `learned`, skip the test of one that needs it."""
    if name.startswith("learned"):
        pytest.importorskip("torch")
    return make_policy(name)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", OWN_POLICIES)
def test_policies_obey_the_rules(name, kind):
    policy = make_installed_policy(name)
    assert policy.name == name
    test_set = InstanceSet(kind, KINDS[kind], NUMBERS)
    count = 3
    outcomes = list(play(policy, test_set, count, seed=1))
    for outcome in outcomes:
        instance = test_set.family.source.draw(outcome.instance)
        score = score_route(instance, outcome.route)
        assert score.illegal is None
        assert (score.prize, score.time) == (outcome.prize, outcome.time)
        assert outcome.feasible == (not score.late)
        assert outcome.feasible or kind == "noisy"
        assert outcome.decisions == len(outcome.route)
        # A policy does not dock while it knows of a prize that it can still win.
        assert score.prize > 0 or kind in {"tight", "noisy"}


@pytest.mark.parametrize("name", OWN_POLICIES)
def test_policies_are_never_better_than_the_best(name):
    policy = make_installed_policy(name)
    for kind in ("plain", "noisy"):
        prizes, best = won_and_best_prizes(policy, kind, 3)
        assert all(prize <= bound + 1e-9 for prize, bound in zip(prizes, best, strict=True))


def test_the_portfolio_is_the_best():
    for name in ("portfolio", "portfolio-1s", "portfolio-resolved"):
        prizes, best = won_and_best_prizes(make_policy(name), "ordered", 8)
        assert prizes == pytest.approx(best)


def test_solving_again_helps_after_deviations():
    names = ("portfolio", "portfolio-resolved")
    once, again = (sum(won_and_best_prizes(make_policy(name), "noisy", 12)[0]) for name in names)
    assert again > once


def test_a_route_is_solved_again_only_after_a_deviation(monkeypatch):
    solved = []

    def count(problem, **limits):
        solved.append(limits)
        return suggest_route(problem, **limits)

    monkeypatch.setattr(portfolio, "suggest_route", count)
    for kind, again in (("plain", False), ("noisy", True)):
        solved.clear()
        list(play(make_policy("portfolio-resolved"), InstanceSet(kind, KINDS[kind], NUMBERS), 4))
        assert (len(solved) > 4) == again
        # The limit is one of work, so the routes do not depend on how busy the machine is.
        assert all(one["time_limit"] is None and one["work_limit"] > 0.0 for one in solved)


def test_greedy_rules_choose_as_documented():
    observation = {
        "mask": np.array([1, 0, 1, 1], np.int8),
        "travel": np.array([0.1, 0.0, 0.2, 0.3], np.float32),
        "prize": np.array([0.0, 0.9, 0.1, 0.8], np.float32),
    }
    chosen = {
        name: make_policy(name).act(observation)
        for name in ("given-order", "nearest-neighbour", "prize-over-time")
    }
    assert chosen == {"given-order": 2, "nearest-neighbour": 2, "prize-over-time": 3}
    nothing = observation | {"mask": np.array([1, 0, 0, 0], np.int8)}
    assert {make_policy(name).act(nothing) for name in chosen} == {0}


def test_insertion_is_better_than_greedy_rules():
    test_set = TEST_SETS["random-20-v1"]
    mean = {
        name: np.mean([o.prize for o in play(make_policy(name), test_set, 30)])
        for name in ("given-order", "nearest-neighbour", "prize-over-time", "insertion")
    }
    assert sorted(mean, key=mean.get) == list(mean)


class Stubborn(Policy):
    """Policy that always chooses the same checkpoint, legal or not."""

    name = "stubborn"

    def act(self, observation):  # noqa: ARG002
        return 1


def test_an_illegal_action_is_not_feasible():
    outcomes = list(play(Stubborn(), InstanceSet("plain", KINDS["plain"], NUMBERS), 5))
    assert not any(outcome.feasible for outcome in outcomes)


def test_an_action_that_is_no_node_is_an_error_with_the_policys_name():
    class Lost(Stubborn):
        name = "lost"

        def act(self, observation):
            return len(observation["mask"])

    with pytest.raises(ArgoError, match=r"policy lost, instance 1000000: .* 0 to 9"):
        list(play(Lost(), InstanceSet("plain", KINDS["plain"], NUMBERS), 1))


def test_the_names_of_argos_policies_are_those_of_its_entry_points():
    entries = entry_points(group="argo.policies")
    own = [entry.name for entry in entries if entry.dist.name == "argo-mission"]
    assert sorted(OWN_POLICIES) == sorted(own)


def test_a_policy_outside_argo_is_made_by_name():
    POLICIES.register("mine", Stubborn)
    try:
        assert make_policy("mine").name == "stubborn"
    finally:
        POLICIES.discard("mine")
    policy = make_policy("baselines.heuristics.greedy:GivenOrder")
    assert isinstance(policy, GivenOrder)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("greedy", "no policy `greedy`; choose one of: .*given-order, .*module:class"),
        ("nowhere:Policy", "nowhere"),
        ("baselines.policy:Nothing", "Nothing"),
    ],
)
def test_an_unknown_policy_is_an_error(name, words):
    with pytest.raises(ArgoError, match=words):
        make_policy(name)
