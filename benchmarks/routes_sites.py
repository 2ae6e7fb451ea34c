"""Time to prove the best route on sites: `python -m benchmarks.routes_sites`.

The problems are random missions with any mix of constraints on UMAD and generated sites, 80
checkpoints in any order, 40 optional checkpoints with a maximum duration, and 1,000 checkpoints
compared with PyVRP. One worker searches.
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
from benchmarks.options import parse_seed

UNIT = 0.1  # s
SITES = ("umad", "generated:floors=3,seed=7", "generated:floors=5,seed=1")


@dataclass(frozen=True)
class SiteMatrix:
    """Travel times of a site in units of UNIT: first its checkpoints, then its docks."""

    name: str
    times: NDArray[np.int64]
    checkpoints: int


def make_site_matrix(name: str) -> SiteMatrix:
    """Compute the travel times of a site."""
    from argo_env.planning import open_site

    navigator = open_site(name).navigator
    site = navigator.site
    docks = [navigator.snap_keeping_heading(site.docks[number]) for number in sorted(site.docks)]
    seconds = navigator.travel_times([*(c.id for c in site.checkpoints), *docks])
    times = np.where(np.isfinite(seconds), np.ceil(seconds / UNIT), NEVER).astype(np.int64)
    return SiteMatrix(name, times, len(site.checkpoints))


def random_mission_problem(
    rng: np.random.Generator, site: SiteMatrix, largest: int = 20
) -> RouteProblem:
    """Draw a route problem of 2 to `largest` checkpoints of a site, with any mix of constraints."""
    n = int(rng.integers(2, min(largest, site.checkpoints) + 1))
    chosen = rng.permutation(site.checkpoints)[:n]
    docks = np.arange(site.checkpoints, len(site.times))
    start, end = rng.choice(docks, 2)
    has_battery = rng.random() < 0.25
    chargers = docks if has_battery else docks[:0]
    rows = np.concatenate([chosen, [start], chargers])
    columns = np.concatenate([chosen, [end], chargers])
    travel = site.times[np.ix_(rows, columns)]
    hop = int(np.median(travel[travel < NEVER])) // 2 + 100
    selective, windowed = rng.random() < 0.35, rng.random() < 0.3
    rounds = _random_rounds(rng, n, hop) if rng.random() < 0.3 else ()
    in_rounds = {member for each in rounds for member in each.members}
    visits = []
    for k in range(n):
        earliest, latest = 0, None
        if windowed and k not in in_rounds and rng.random() < 0.3:
            earliest = int(rng.integers(0, hop * n))
            latest = earliest + int(rng.integers(hop * n // 4, hop * n))
        optional = selective and rng.random() < 0.8
        service = int(rng.integers(50, 150))
        name = f"checkpoint {chosen[k] + 1}"
        visits.append(
            Visit(name, service, not optional, int(rng.integers(1, 101)), earliest, latest)
        )
    battery = None
    if has_battery:
        energy = np.where(travel >= NEVER, 0, travel // 3 + 10)
        battery = EnergyBudget(energy, int(rng.uniform(0.3, 1.2) * hop * n / 3) + 2 * hop, hop, 100)
    limit = int(rng.uniform(0.3, 1.0) * hop * n) + 6 * hop if selective else None
    return RouteProblem(
        tuple(visits),
        travel,
        _random_precedences(rng, n) if rng.random() < 0.5 else (),
        rounds,
        limit,
        battery,
        tuple(f"dock {k}" for k in range(len(chargers))),
        Objective.DURATION,
        UNIT,
    )


def _random_precedences(rng: np.random.Generator, n: int) -> tuple[Precedence, ...]:
    order = rng.permutation(n)  # which satisfies all precedences
    precedences = []
    for _ in range(int(rng.integers(1, n + 1))):
        size = int(rng.integers(2, min(5, n) + 1))
        sequence = order[np.sort(rng.permutation(n)[:size])]
        words = " before ".join(str(k) for k in sequence)
        precedences.append(Precedence(tuple(sequence.tolist()), words, bool(rng.random() < 0.3)))
    return tuple(precedences)


def _random_rounds(rng: np.random.Generator, n: int, hop: int) -> tuple[Round, ...]:
    remaining, rounds = rng.permutation(n).tolist(), []
    while len(remaining) > 1 and rng.random() < 0.7:
        size = int(rng.integers(2, min(6, len(remaining)) + 1))
        members, remaining = remaining[:size], remaining[size:]
        time_search = rng.random() < 0.3
        rounds.append(
            Round(
                f"round {len(rounds)}",
                tuple(members),
                0 if time_search else int(rng.integers(1, 4)),
                hop * int(rng.integers(2, 12)) if time_search else 0,
                bool(rng.random() < 0.5),
            )
        )
    return tuple(rounds)


def constraint_letters(problem: RouteProblem) -> str:
    """Return five characters: for each kind of constraint its letter, or `-` if there is none."""
    return "".join(
        letter if present else "-"
        for letter, present in [
            ("o", problem.selective),
            ("p", bool(problem.precedences)),
            ("w", any(v.latest is not None for v in problem.visits)),
            ("r", bool(problem.rounds)),
            ("b", problem.battery is not None),
        ]
    )


def random_checkpoint_problem(
    rng: np.random.Generator, n: int, *, max_duration: int | None = None
) -> RouteProblem:
    """Draw a route problem of `n` checkpoints on six floors with aisles, and stairs at one end.

    Stairs take longer up than down. With a maximum duration, in units of UNIT, each checkpoint is
    optional and has a prize.
    """
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
        Visit(f"checkpoint {k + 1}", int(rng.integers(50, 150)), max_duration is None, int(prize))
        for k, prize in enumerate(rng.integers(1, 101, n))
    )
    objective = Objective.DURATION if max_duration is None else Objective.PRIZE
    return RouteProblem(
        visits,
        whole[np.ix_(rows, columns)],
        max_duration=max_duration,
        objective=objective,
        unit=UNIT,
    )


@dataclass(frozen=True)
class Row:
    """Time and result of one problem."""

    seconds: float
    constraints: str
    size: int
    suggestion: RouteSuggestion


def time_search(problem: RouteProblem, time_limit: float) -> Row:
    """Search for a route, and time that; conflicts of constraints are not searched for."""
    begun = time.perf_counter()
    suggestion = suggest_route(problem, time_limit, explain=False)
    seconds = time.perf_counter() - begun
    return Row(seconds, constraint_letters(problem), problem.size, suggestion)


def summary_text(rows: Sequence[Row]) -> str:
    """Return the number of proofs, and percentiles of the time, as text."""
    seconds = [row.seconds for row in rows]
    without = sum(row.suggestion.infeasible for row in rows)
    proven = without + sum(row.suggestion.proven for row in rows)
    middle, percentile, worst = np.percentile(seconds, [50, 99, 100])
    return (
        f"{proven} of {len(rows)} proven ({without} have no route); "
        f"median {middle:.3f} s, 99 % {percentile:.2f} s, worst {worst:.2f} s"
    )


def measure_missions(names: Sequence[str], count: int, seed: int, time_limit: float) -> None:
    """Print how fast random missions on sites are proven."""
    sites = [make_site_matrix(name) for name in names]
    rows = []
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        rows.append(
            time_search(random_mission_problem(rng, sites[number % len(sites)]), time_limit)
        )
    print(f"missions of 2 to 20 checkpoints, any mix of constraints: {summary_text(rows)}")
    for name in ("optional", "precedence", "windows", "rounds", "battery"):
        if chosen := [row for row in rows if name[0] in row.constraints]:
            print(f"  with {name:<10} {summary_text(chosen)}")
    methods = Counter(row.suggestion.method for row in rows)
    print("  " + ", ".join(f"{method} {n}" for method, n in methods.most_common()))


def measure_large_problems(seed: int, count: int) -> None:
    """Print how fast 80 checkpoints, and 40 optional ones within 20 minutes, are proven."""
    rng = np.random.default_rng(seed)
    rows = [time_search(random_checkpoint_problem(rng, 80), 60.0) for _ in range(count)]
    print(f"80 checkpoints in any order: {summary_text(rows)}")
    rows = [
        time_search(random_checkpoint_problem(rng, 40, max_duration=12_000), 120.0)
        for _ in range(count)
    ]
    print(f"40 checkpoints, 20 minutes: {summary_text(rows)}")


def compare_with_pyvrp(seed: int, time_limit: float) -> None:
    """Print the durations of Argo's and PyVRP's routes for 1,000 checkpoints in any order."""
    from benchmarks import peer_pyvrp

    problem = random_checkpoint_problem(np.random.default_rng(seed), 1000)
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
    route = peer_pyvrp.search_with_pyvrp(problem, time_limit, seed)
    if route is None:
        print("  PyVRP found no route")
        return
    theirs = evaluate(problem, route).duration
    print(
        f"  PyVRP {theirs * UNIT:.0f} s in the same time: Argo's has {ours.cost / theirs:.3f} of it"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the parts that the command line asks for, or all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--missions", type=int, default=1000, help="number of random missions on sites; 0: none"
    )
    parser.add_argument("--sites", nargs="+", default=SITES, help="sites of these missions")
    parser.add_argument(
        "--large", type=int, default=11, help="number of problems of 80 and of 40 checkpoints"
    )
    parser.add_argument(
        "--peer", type=float, default=30.0, help="seconds of the comparison with PyVRP; 0: none"
    )
    parser.add_argument("--time-limit", type=float, default=20.0, help="seconds for each mission")
    parser.add_argument("--seed", type=parse_seed, default=1)
    options = parser.parse_args(arguments)
    if options.missions:
        measure_missions(options.sites, options.missions, options.seed, options.time_limit)
    if options.large:
        measure_large_problems(options.seed, options.large)
    if options.peer:
        compare_with_pyvrp(options.seed, options.peer)


if __name__ == "__main__":
    main()
