"""What a policy sees, as a route problem: nothing is lost, and optima are those of brute force."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.route import Objective, Tour, evaluate, suggest_route
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_instance import DOCK, TICK, score_route
from argo_env.envs.route_noise import RouteNoise
from argo_env.envs.route_sources import TEST, TRAINING, RandomRoutes
from baselines.heuristics.insertion import insert_and_improve
from baselines.problem import hindsight, problem_of
from tests.conftest import examples

NUMBERS = st.sampled_from(TRAINING) | st.sampled_from(TEST)


def routes_of(env_instance):
    """All routes on an instance without noise that keep to its rules, by depth first, with their
    prizes: independent of the problem's own evaluation and of the solver."""
    found = []

    def go(route, time, place, prize):
        found.append((tuple(route), prize))
        for node in range(1, env_instance.size):
            if node in route:
                continue
            if any(env_instance.before[k, node] and k not in route for k in range(node_count)):
                continue
            arrived = time + float(env_instance.arrival[place, node])
            if arrived + float(env_instance.arrival[node, DOCK]) <= env_instance.budget:
                go([*route, node], arrived, node, prize + round(100 * env_instance.prizes[node]))

    node_count = env_instance.size
    go([], 0.0, env_instance.start, 0)
    return found


@settings(max_examples=examples(25))
@given(NUMBERS, st.integers(1, 6), st.sampled_from([200.0, 500.0, 900.0]), st.floats(0.0, 1.0))
def test_optimum_is_that_of_brute_force(number, checkpoints, budget, precedence):
    instance = RandomRoutes(checkpoints, 3, budget, precedence=precedence).draw(number)
    routes = routes_of(instance)
    best = max(prize for _, prize in routes)
    env = RouteEnv(source=RandomRoutes(checkpoints, 3, budget, precedence=precedence), full=True)
    seen, _ = env.reset(options={"instance": number})
    for found in (problem_of(seen, budget), hindsight(instance)):
        suggestion = suggest_route(found.problem, 5.0)
        assert suggestion.proven
        assert suggestion.prize == suggestion.prize_bound == best
        route = found.order_of(suggestion.order)
        assert round(100 * score_route(instance, route).prize) == best
    # Never better than the best, and what it claims is so.
    found = problem_of(seen, budget)
    order = insert_and_improve(found.problem)
    assert evaluate(found.problem, Tour(order)).feasible
    score = score_route(instance, found.order_of(order))
    assert score.illegal is None
    assert round(100 * score.prize) == sum(found.problem.visits[v].prize for v in order) <= best
    # The same, begun with the best route of somebody whom no order is asked of.
    free = suggest_route(replace(found.problem, precedences=()), 5.0)
    mended = insert_and_improve(found.problem, free.order)
    assert evaluate(found.problem, Tour(mended)).feasible
    assert sum(found.problem.visits[v].prize for v in mended) <= best <= free.prize


@settings(max_examples=examples(30))
@given(NUMBERS, st.integers(1, 20), st.floats(0.0, 0.8), st.integers(0, 2**32))
def test_a_state_on_the_way_is_seen_without_loss(number, checkpoints, failing, seed):
    noise = RouteNoise(failing=failing, blocked=2)
    env = RouteEnv(source=RandomRoutes(checkpoints, noise=noise), full=True)
    rng = np.random.default_rng(seed)
    observation, _ = env.reset(options={"instance": number})
    instance, done, time, over = env.instance, [], 0.0, False
    while not over:
        found = problem_of(observation, instance.budget, Objective.PRIZE)
        known, place = instance.at(time), int(observation["place"])
        assert found.nodes == tuple(k for k in range(1, instance.size) if k not in done)
        problem, nodes = found.problem, [*found.nodes, DOCK]
        assert problem.max_duration * TICK == instance.budget - time
        for row, a in enumerate([*found.nodes, place]):
            times = known.arrival[a, nodes].astype(np.float64)
            near = (times < instance.budget) & (np.arange(len(nodes)) != row)
            assert np.array_equal(problem.travel[row, near] * TICK, times[near])
            assert (problem.travel[row, times >= instance.budget] * TICK >= instance.budget).all()
        pairs = {precedence.sequence for precedence in problem.precedences}
        assert {(found.nodes[a], found.nodes[b]) for a, b in pairs} == {
            (a, b) for a, b in np.argwhere(instance.before).tolist() if a not in done
        }
        node = int(rng.choice(np.flatnonzero(observation["mask"])[-3:]))
        observation, _, over, _, info = env.step(node)
        time = info["time"]
        if node != DOCK and not info["failed"]:
            done.append(node)


@settings(max_examples=examples(25))
@given(NUMBERS, st.integers(1, 5), st.integers(0, 2**32))
def test_nobody_beats_hindsight(number, checkpoints, seed):
    source = RandomRoutes(checkpoints, 3, 500.0, RouteNoise(failing=0.4, blocked=1))
    instance = source.draw(number)
    found = hindsight(instance)
    bound = suggest_route(found.problem, 5.0)
    assert bound.proven
    env = RouteEnv(source=source)
    rng = np.random.default_rng(seed)
    for _ in range(10):
        observation, _ = env.reset(options={"instance": number})
        total, over = 0.0, False
        while not over:
            allowed = np.flatnonzero(observation["mask"])
            observation, reward, over, _, _ = env.step(int(rng.choice(allowed[-2:])))
            total += reward
        assert round(100 * total) <= bound.prize
    # It can be driven where no stairs are blocked: each checkpoint as often as its reading takes.
    open_stairs = replace(instance, hidden=replace(instance.hidden, changes=()))
    route = [
        node
        for node in found.order_of(bound.order)
        for _ in range(1 + instance.hidden.failing[node])
    ]
    score = score_route(open_stairs, route)
    assert score.illegal is None
    assert round(100 * score.prize) == bound.prize
