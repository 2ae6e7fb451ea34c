"""How fast the best route is proven on sites: `python -m benchmarks.routes_sites`.

Random missions with any mix of constraints on UMAD and generated sites; any order of 80; routes in
a budget with 40; and 1,000 checkpoints beside PyVRP. One worker, unless said otherwise.
"""

import argparse
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    RouteSuggestion,
    Visit,
    evaluate,
    suggest_route,
)
from benchmarks.options import seed_number

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
    from argo_env.planning import open_site

    navigator = open_site(name).navigator
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
        battery = EnergyBudget(energy, int(rng.uniform(0.3, 1.2) * hop * n / 3) + 2 * hop, hop, 100)
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


@dataclass(frozen=True)
class Row:
    """What one problem took."""

    seconds: float
    mixture: str
    size: int
    suggestion: RouteSuggestion


def timed(problem: RouteProblem, time_limit: float) -> Row:
    """The suggestion for a problem, without the search for an infeasible subset."""
    begun = time.perf_counter()
    made = suggest_route(problem, time_limit, explain=False)
    return Row(time.perf_counter() - begun, mixture(problem), problem.size, made)


def summary(rows: Sequence[Row]) -> str:
    """How many were proven, and how fast."""
    seconds = [row.seconds for row in rows]
    proven = sum(row.suggestion.proven for row in rows)
    without = sum(row.suggestion.proven and row.suggestion.route is None for row in rows)
    half, most, worst = np.percentile(seconds, [50, 99, 100])
    return (
        f"{proven} of {len(rows)} proven ({without} have no route); "
        f"median {half:.3f} s, 99 % {most:.2f} s, worst {worst:.2f} s"
    )


def missions(names: Sequence[str], count: int, seed: int, time_limit: float) -> None:
    """Prints how fast random missions on sites are proven."""
    sites = [site_matrix(name) for name in names]
    rows = []
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        rows.append(timed(mission(rng, sites[number % len(sites)]), time_limit))
    print(f"missions of 2 to 20 checkpoints, any mix of constraints: {summary(rows)}")
    for name in ("optional", "precedence", "windows", "rounds", "battery"):
        if some := [row for row in rows if name[0] in row.mixture]:
            print(f"  with {name:<10} {summary(some)}")
    methods = Counter(row.suggestion.method for row in rows)
    print("  " + ", ".join(f"{method} {n}" for method, n in methods.most_common()))


def large(seed: int, count: int) -> None:
    """Prints how fast 80 checkpoints in any order, and 40 with a budget, are proven."""
    rng = np.random.default_rng(seed)
    rows = [timed(any_order(rng, 80), 60.0) for _ in range(count)]
    print(f"80 checkpoints in any order: {summary(rows)}")
    rows = [timed(any_order(rng, 40, budget=12_000), 120.0) for _ in range(count)]
    print(f"40 checkpoints, 20 minutes: {summary(rows)}")


def beside_pyvrp(seed: int, time_limit: float) -> None:
    """Prints what 1,000 checkpoints in any order come to, and what PyVRP makes of them."""
    from benchmarks import peer_pyvrp

    problem = any_order(np.random.default_rng(seed), 1000)
    quick = suggest_route(problem, 2.0, seed)
    first = quick.history[0]
    ours = suggest_route(problem, time_limit, seed)
    print(f"1,000 checkpoints: a first route after {first.time:.2f} s")
    print(f"  after 2 s {quick.cost * UNIT:.0f} s")
    print(
        f"  after {time_limit:g} s {ours.cost * UNIT:.0f} s with a certified gap of {ours.gap:.1%}"
    )
    if find_spec("pyvrp") is None:
        print("  PyVRP is not installed: it is left out")
        return
    route = peer_pyvrp.search(problem, time_limit, seed)
    if route is None:
        print("  PyVRP found none")
        return
    theirs = evaluate(problem, route).duration
    print(f"  PyVRP {theirs * UNIT:.0f} s in the same time: ours is {ours.cost / theirs:.3f} of it")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what was asked for, or all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--missions", type=int, default=1000, help="random missions on sites")
    parser.add_argument("--sites", nargs="+", default=SITES, help="of these missions")
    parser.add_argument("--large", type=int, default=11, help="problems of 80 and of 40")
    parser.add_argument("--peer", type=float, default=30.0, help="s beside PyVRP; 0: not")
    parser.add_argument("--time-limit", type=float, default=20.0, help="s for a mission")
    parser.add_argument("--seed", type=seed_number, default=1)
    given = parser.parse_args(arguments)
    if given.missions:
        missions(given.sites, given.missions, given.seed, given.time_limit)
    if given.large:
        large(given.seed, given.large)
    if given.peer:
        beside_pyvrp(given.seed, given.peer)


if __name__ == "__main__":
    main()
