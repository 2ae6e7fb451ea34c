"""Route problems of observations: nothing is lost, and optima are those of brute force."""

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
from baselines.problem import hindsight_problem, problem_from_observation
from tests.conftest import examples

NUMBERS = st.sampled_from(TRAINING) | st.sampled_from(TEST)


def all_routes(env_instance):
    """Return all legal routes on an instance without noise, with their prizes, by depth first.

    The code is independent of the problem's own evaluation and of the solver.
    """
    routes = []

    def extend(route, time, place, prize):
        routes.append((tuple(route), prize))
        for node in range(1, env_instance.node_count):
            if node in route:
                continue
            if any(env_instance.before[k, node] and k not in route for k in range(node_count)):
                continue
            arrived = time + float(env_instance.arrival[place, node])
            if arrived + float(env_instance.arrival[node, DOCK]) <= env_instance.budget:
                won = prize + round(100 * env_instance.prizes[node])
                extend([*route, node], arrived, node, won)

    node_count = env_instance.node_count
    extend([], 0.0, env_instance.start_row, 0)
    return routes


@settings(max_examples=examples(25))
@given(NUMBERS, st.integers(1, 6), st.sampled_from([200.0, 500.0, 900.0]), st.floats(0.0, 1.0))
def test_optimum_is_that_of_brute_force(number, checkpoints, budget, precedence):
    instance = RandomRoutes(checkpoints, 3, budget, precedence=precedence).draw(number)
    routes = all_routes(instance)
    best = max(prize for _, prize in routes)
    env = RouteEnv(source=RandomRoutes(checkpoints, 3, budget, precedence=precedence), full=True)
    observation, _ = env.reset(options={"instance": number})
    for open_problem in (
        problem_from_observation(observation, budget),
        hindsight_problem(instance),
    ):
        suggestion = suggest_route(open_problem.problem, 5.0)
        assert suggestion.proven
        assert suggestion.prize == suggestion.prize_bound == best
        route = open_problem.to_nodes(suggestion.order)
        assert round(100 * score_route(instance, route).prize) == best
    # Insertion gives a feasible route with the prize that it claims, at most the optimum.
    open_problem = problem_from_observation(observation, budget)
    problem = open_problem.problem
    order = insert_and_improve(problem)
    assert evaluate(problem, Tour(order)).feasible
    score = score_route(instance, open_problem.to_nodes(order))
    assert score.illegal is None
    assert round(100 * score.prize) == sum(problem.visits[v].prize for v in order) <= best
    # So it does when it starts with the best route of the relaxation without precedence.
    relaxed = suggest_route(replace(problem, precedences=()), 5.0)
    repaired = insert_and_improve(problem, relaxed.order)
    assert evaluate(problem, Tour(repaired)).feasible
    assert sum(problem.visits[v].prize for v in repaired) <= best <= relaxed.prize


@settings(max_examples=examples(30))
@given(NUMBERS, st.integers(1, 20), st.floats(0.0, 0.8), st.integers(0, 2**32))
def test_the_problem_of_a_later_state_loses_nothing(number, checkpoints, failing, seed):
    noise = RouteNoise(failing=failing, blocked=2)
    env = RouteEnv(source=RandomRoutes(checkpoints, noise=noise), full=True)
    rng = np.random.default_rng(seed)
    observation, _ = env.reset(options={"instance": number})
    instance, done, time, over = env.instance, [], 0.0, False
    while not over:
        open_problem = problem_from_observation(observation, instance.budget, Objective.PRIZE)
        known, place = instance.with_known_blockages_at(time), int(observation["place"])
        assert open_problem.nodes == tuple(
            k for k in range(1, instance.node_count) if k not in done
        )
        problem, nodes = open_problem.problem, [*open_problem.nodes, DOCK]
        assert problem.max_duration * TICK == instance.budget - time
        for row, a in enumerate([*open_problem.nodes, place]):
            times = known.arrival[a, nodes].astype(np.float64)
            near = (times < instance.budget) & (np.arange(len(nodes)) != row)
            assert np.array_equal(problem.travel[row, near] * TICK, times[near])
            assert (problem.travel[row, times >= instance.budget] * TICK >= instance.budget).all()
        pairs = {precedence.sequence for precedence in problem.precedences}
        assert {(open_problem.nodes[a], open_problem.nodes[b]) for a, b in pairs} == {
            (a, b) for a, b in np.argwhere(instance.before).tolist() if a not in done
        }
        node = int(rng.choice(np.flatnonzero(observation["mask"])[-3:]))
        observation, _, over, _, info = env.step(node)
        time = info["time"]
        if node != DOCK and not info["failed"]:
            done.append(node)


@settings(max_examples=examples(25))
@given(NUMBERS, st.integers(1, 5), st.integers(0, 2**32))
def test_no_route_beats_hindsight(number, checkpoints, seed):
    source = RandomRoutes(checkpoints, 3, 500.0, RouteNoise(failing=0.4, blocked=1))
    instance = source.draw(number)
    open_problem = hindsight_problem(instance)
    bound = suggest_route(open_problem.problem, 5.0)
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
    # Without blocked stairs the route is legal: each checkpoint is visited until its reading
    # succeeds.
    open_stairs = replace(instance, hidden=replace(instance.hidden, changes=()))
    route = [
        node
        for node in open_problem.to_nodes(bound.order)
        for _ in range(1 + instance.hidden.failing[node])
    ]
    score = score_route(open_stairs, route)
    assert score.illegal is None
    assert round(100 * score.prize) == bound.prize
