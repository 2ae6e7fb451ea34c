"""How fast the best route is proven on sites: `python -m benchmarks.routes_sites`.

Random missions with any mix of constraints on UMAD and generated sites; any order of 80; routes in
a budget with 40; and 1,000 checkpoints beside PyVRP. One worker, unless said otherwise.
"""

import argparse
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import (
    NEVER,
    Battery,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    RouteSuggestion,
    Visit,
    suggest_route,
)

UNIT = 0.1  # s
SITES = ("umad", "generated:floors=3,seed=7", "generated:floors=5,seed=1")


@dataclass(frozen=True)
class SiteMatrix:
    """Travel times of a site in units: its checkpoints first, then its docks."""

    name: str
    times: NDArray[np.int64]
    checkpoints: int


def site_matrix(name: str) -> SiteMatrix:
    """The matrix of a site."""
    from argo_env.envs.sites import navigator_of

    navigator = navigator_of(name)
    site = navigator.site
    docks = [navigator.snap(site.docks[number]) for number in sorted(site.docks)]
    seconds = navigator.travel_times([*(c.id for c in site.checkpoints), *docks])
    times = np.where(np.isfinite(seconds), np.ceil(seconds / UNIT), NEVER).astype(np.int64)
    return SiteMatrix(name, times, len(site.checkpoints))


def mission(rng: np.random.Generator, site: SiteMatrix, most: int = 20) -> RouteProblem:
    """A mission with some of the site's checkpoints and any mix of constraints."""
    n = int(rng.integers(2, min(most, site.checkpoints) + 1))
    chosen = rng.permutation(site.checkpoints)[:n]
    docks = np.arange(site.checkpoints, len(site.times))
    start, end = rng.choice(docks, 2)
    charged = rng.random() < 0.25
    chargers = docks if charged else docks[:0]
    rows = np.concatenate([chosen, [start], chargers])
    columns = np.concatenate([chosen, [end], chargers])
    travel = site.times[np.ix_(rows, columns)]
    hop = int(np.median(travel[travel < NEVER])) // 2 + 100
    selective, windowed = rng.random() < 0.35, rng.random() < 0.3
    rounds = _rounds(rng, n, hop) if rng.random() < 0.3 else ()
    inside = {member for one in rounds for member in one.members}
    visits = []
    for k in range(n):
        earliest, latest = 0, None
        if windowed and k not in inside and rng.random() < 0.3:
            earliest = int(rng.integers(0, hop * n))
            latest = earliest + int(rng.integers(hop * n // 4, hop * n))
        optional = selective and rng.random() < 0.8
        service = int(rng.integers(50, 150))
        name = f"checkpoint {chosen[k] + 1}"
        visits.append(
            Visit(name, service, not optional, int(rng.integers(1, 101)), earliest, latest)
        )
    battery = None
    if charged:
        energy = np.where(travel >= NEVER, 0, travel // 3 + 10)
        battery = Battery(energy, int(rng.uniform(0.3, 1.2) * hop * n / 3) + 2 * hop, hop, 100)
    limit = int(rng.uniform(0.3, 1.0) * hop * n) + 6 * hop if selective else None
    return RouteProblem(
        tuple(visits),
        travel,
        _precedences(rng, n) if rng.random() < 0.5 else (),
        rounds,
        limit,
        battery,
        tuple(f"dock {k}" for k in range(len(chargers))),
        Objective.DURATION,
        UNIT,
    )


def _precedences(rng: np.random.Generator, n: int) -> tuple[Precedence, ...]:
    hidden = rng.permutation(n)
    found = []
    for _ in range(int(rng.integers(1, n + 1))):
        size = int(rng.integers(2, min(5, n) + 1))
        sequence = hidden[np.sort(rng.permutation(n)[:size])]
        words = " before ".join(str(k) for k in sequence)
        found.append(Precedence(tuple(sequence.tolist()), words, bool(rng.random() < 0.3)))
    return tuple(found)


def _rounds(rng: np.random.Generator, n: int, hop: int) -> tuple[Round, ...]:
    left, found = rng.permutation(n).tolist(), []
    while len(left) > 1 and rng.random() < 0.7:
        size = int(rng.integers(2, min(6, len(left)) + 1))
        members, left = left[:size], left[size:]
        timed = rng.random() < 0.3
        found.append(
            Round(
                f"round {len(found)}",
                tuple(members),
                0 if timed else int(rng.integers(1, 4)),
                hop * int(rng.integers(2, 12)) if timed else 0,
                bool(rng.random() < 0.5),
            )
        )
    return tuple(found)


def mixture(problem: RouteProblem) -> str:
    """What constraints a problem has, a letter each."""
    return "".join(
        letter if there else "-"
        for letter, there in [
            ("o", problem.selective),
            ("p", bool(problem.precedences)),
            ("w", any(v.latest is not None for v in problem.visits)),
            ("r", bool(problem.rounds)),
            ("b", problem.battery is not None),
        ]
    )


def any_order(rng: np.random.Generator, n: int, *, budget: int | None = None) -> RouteProblem:
    """Checkpoints anywhere on six floors with aisles, stairs at one end, which take longer up than
    down; with a budget (units) each is optional and has a prize."""
    x, y = rng.uniform(0, 30, n + 2), rng.uniform(0, 20, n + 2)
    floor = rng.integers(1, 7, n + 2)
    floor[n:] = 1
    level = np.abs(x[:, None] - x) + np.abs(y[:, None] - y)
    stairs = x[:, None] + x + np.abs(y[:, None] - y)
    rise = floor[None, :] - floor[:, None]
    seconds = np.where(rise == 0, level, stairs) / 0.4
    seconds += np.where(rise > 0, 33.0 * rise, -16.0 * rise)
    whole = np.ceil(seconds / UNIT).astype(np.int64)
    rows = np.concatenate([np.arange(n), [n]])
    columns = np.concatenate([np.arange(n), [n + 1]])
    visits = tuple(
        Visit(f"checkpoint {k + 1}", int(rng.integers(50, 150)), budget is None, int(prize))
        for k, prize in enumerate(rng.integers(1, 101, n))
    )
    objective = Objective.DURATION if budget is None else Objective.PRIZE
    return RouteProblem(
        visits, whole[np.ix_(rows, columns)], max_duration=budget, objective=objective, unit=UNIT
    )
