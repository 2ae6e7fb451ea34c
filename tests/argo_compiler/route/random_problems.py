"""Random route problems with any mix of constraints, many of them barely feasible or infeasible."""

import numpy as np

from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    Visit,
)


def random_problem(rng: np.random.Generator, most: int = 8) -> RouteProblem:
    """Return a problem of at most `most` visits, and at most 5 with a battery.

    Charges multiply the number of routes, so that problems with a battery are smaller.
    """
    has_battery = rng.random() < 0.25
    n = int(
        rng.integers(0 if rng.random() < 0.05 else 1, (min(most, 5) if has_battery else most) + 1)
    )
    c = int(rng.integers(0, 3)) if has_battery else 0
    points = rng.uniform(0, 100, (n + 1 + c, 2))
    distance = np.abs(points[:, None] - points).sum(axis=2)
    uphill = rng.uniform(0.5, 2.0) * np.maximum(points[None, :, 1] - points[:, None, 1], 0.0)
    travel = np.rint(distance + uphill).astype(np.int64)
    if rng.random() < 0.2:
        travel[:n, n] = 0  # the route may end anywhere
    if rng.random() < 0.2:
        travel[rng.random(travel.shape) < 0.05] = NEVER
    selective, windowed = rng.random() < 0.4, rng.random() < 0.3
    rounds = _rounds(rng, n) if rng.random() < 0.4 else ()
    in_rounds = {member for round_ in rounds for member in round_.members}
    horizon = 110 * (n + 1)
    visits = []
    for k in range(n):
        earliest, latest = 0, None
        if windowed and k not in in_rounds and rng.random() < 0.5:
            earliest = int(rng.integers(0, horizon))
            latest = earliest + int(rng.integers(0, horizon))
            if rng.random() < 0.3:
                earliest = 0
        optional = selective and rng.random() < 0.7
        visits.append(
            Visit(
                f"checkpoint {k}",
                int(rng.integers(0, 20)),
                not optional,
                int(rng.integers(0, 5)),
                earliest,
                latest,
            )
        )
    battery = None
    if has_battery:
        energy = np.minimum(travel + rng.integers(0, 30, travel.shape), NEVER)
        energy[travel == NEVER] = 0
        battery = EnergyBudget(
            energy,
            int(rng.integers(150, 300)) + 30 * n,
            int(rng.integers(0, 60)),
            int(rng.integers(0, 10)),
        )
    limit = int(rng.uniform(0.4, 1.2) * horizon) if selective or rng.random() < 0.4 else None
    return RouteProblem(
        tuple(visits),
        travel,
        _precedences(rng, n) if rng.random() < 0.5 else (),
        rounds,
        limit,
        battery,
        tuple(f"dock {k}" for k in range(c)),
        list(Objective)[int(rng.choice(3, p=[0.6, 0.3, 0.1]))],
    )


def _precedences(rng: np.random.Generator, n: int) -> tuple[Precedence, ...]:
    precedences = []
    for _ in range(int(rng.integers(1, 4))):
        size = int(rng.integers(2, max(3, n + 1)))
        if n < 2:
            break
        sequence = rng.permutation(n)[:size]
        if rng.random() < 0.85:
            sequence = np.sort(sequence)
        words = " before ".join(f"checkpoint {k}" for k in sequence)
        precedences.append(
            Precedence(tuple(int(k) for k in sequence), words, bool(rng.random() < 0.4))
        )
    return tuple(precedences)


def _rounds(rng: np.random.Generator, n: int) -> tuple[Round, ...]:
    rounds, remaining = [], [int(k) for k in rng.permutation(n)]
    while remaining and rng.random() < 0.7:
        size = int(rng.integers(1, min(4, len(remaining)) + 1))
        members, remaining = remaining[:size], remaining[size:]
        rounds.append(_round(rng, f"round {len(rounds)}", tuple(members)))
        if size > 1 and rng.random() < 0.4:
            inner = tuple(members[: int(rng.integers(1, size + 1))])
            rounds.append(_round(rng, f"round {len(rounds)}", inner))
    return tuple(rounds)


def _round(rng: np.random.Generator, name: str, members: tuple[int, ...]) -> Round:
    kind = rng.random()
    # Two consecutive rounds with durations, and nested ones, are the hard cases.
    repeat = int(rng.integers(1, 4)) if kind < 0.6 else 0
    duration = int(rng.integers(1, 500)) if kind > 0.4 else 0
    return Round(name, members, repeat, duration, bool(rng.random() < 0.5))
