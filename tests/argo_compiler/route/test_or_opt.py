"""Exchanges of neighbouring stretches, against trying all of them one by one."""

from itertools import combinations, pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.route import Precedence, RouteProblem, Visit
from argo_compiler.route.network import network
from argo_compiler.route.or_opt import Exchange
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import prune


def made(seed: int, count: int, orders: int) -> tuple[RouteProblem, Exchange]:
    rng = np.random.default_rng(seed)
    travel = rng.integers(1, 50, (count + 1, count + 1))
    travel[rng.random(travel.shape) < 0.05] = NEVER
    precedences = []
    for k in range(orders):
        first, then = sorted(rng.choice(count, 2, replace=False).tolist())
        precedences.append(Precedence((first, then), f"order {k}"))
    visits = tuple(Visit(f"checkpoint {k}", 1) for k in range(count))
    problem = RouteProblem(visits, travel, tuple(precedences))
    net = network(problem, lambda step: tuple(step.parts))
    return problem, Exchange(net, prune(net))


def length(exchange: Exchange, path: tuple[int, ...]) -> int:
    depot = len(exchange.times) - 1
    return sum(int(exchange.times[arc]) for arc in pairwise((depot, *path, depot)))


def keeps_order(exchange: Exchange, path: tuple[int, ...]) -> bool:
    return not any(exchange.before[later, earlier] for earlier, later in combinations(path, 2))


def neighbours(path: tuple[int, ...]) -> list[tuple[int, ...]]:
    return [
        path[:a] + path[b:c] + path[a:b] + path[c:]
        for a, b, c in combinations(range(len(path) + 1), 3)
    ]


CASES = st.tuples(st.integers(0, 10**6), st.integers(3, 9), st.integers(0, 8))


@given(CASES)
def test_no_exchange_makes_an_improved_path_shorter(case: tuple[int, int, int]) -> None:
    problem, exchange = made(*case)
    path = tuple(range(problem.size))
    better, before = exchange.improved(path, range(problem.size + 1)), path
    while better != before:
        better, before = exchange.improved(better, range(problem.size + 1)), better
    assert sorted(better) == list(path)
    assert keeps_order(exchange, better)
    assert length(exchange, better) <= length(exchange, path)
    shorter = [
        other
        for other in neighbours(better)
        if keeps_order(exchange, other) and length(exchange, other) < length(exchange, better)
    ]
    assert not shorter


@given(CASES, st.integers(1, 4), st.integers(1, 9))
def test_what_is_shuffled_keeps_the_order(
    case: tuple[int, int, int], times: int, longest: int
) -> None:
    problem, exchange = made(*case)
    path = tuple(range(problem.size))
    other, near = exchange.shuffled(path, np.random.default_rng(case[0]), times, longest)
    assert sorted(other) == list(path)
    assert keeps_order(exchange, other)
    assert bool(near) or other == path
