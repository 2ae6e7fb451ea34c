"""Random mixes of windows, order, prizes and battery, of which each has a route."""

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import EnergyBudget, Objective, Precedence, RouteProblem, Visit

KINDS = ("windows", "order", "prizes", "battery")


def mix(seed: int, n: int, kinds: frozenset[str], *, travel: bool = False) -> RouteProblem:
    """`n` checkpoints on three floors with what `kinds` of `KINDS` asks for; times in 0.1 s.
    `travel`: waiting does not count. What is asked for fits a hidden route, which is feasible."""
    rng = np.random.default_rng([seed, n])
    chargers = 2 if "battery" in kinds else 0
    times = _times(rng, n + 1 + chargers)
    service = rng.integers(50, 150, n)
    hidden = _hidden(rng, times[: n + 1, : n + 1])
    energy = times // 3 + 10
    total, longest = int(energy[: n + 1, : n + 1].mean() * n), int(energy.max())
    capacity = max(total // 4, 4 * longest)
    begins = _begins(times, service, hidden, energy, capacity if chargers else 0)
    end = int(begins[hidden[-1]] + service[hidden[-1]] + times[hidden[-1], n])
    earliest, latest = np.zeros(n, np.int64), np.full(n, -1)
    if "windows" in kinds:
        some, width = rng.random(n) < 0.5, end // 6
        early = np.maximum(begins - rng.integers(0, width, n), 0)
        earliest[some], latest[some] = early[some], (begins + rng.integers(0, width, n))[some]
    optional = rng.random(n) < 0.9 if "prizes" in kinds else np.zeros(n, np.bool_)
    visits = tuple(
        Visit(
            f"checkpoint {k}",
            int(service[k]),
            not optional[k],
            int(rng.integers(1, 101)),
            int(earliest[k]),
            None if latest[k] < 0 else int(latest[k]),
        )
        for k in range(n)
    )
    limit = None
    if "prizes" in kinds:
        # Time for all that must be made, as the hidden route makes it, and for half of the rest.
        must = [k for k in hidden if not optional[k]]
        begun = _begins(times, service, must, energy, capacity if chargers else 0, earliest)
        last = must[-1] if must else n
        least = int(begun[last] + service[last] + times[last, n]) if must else 0
        limit = max(2 * least, end // 2)
    return RouteProblem(
        visits,
        times,
        _orders(rng, hidden) if "order" in kinds else (),
        (),
        limit,
        EnergyBudget(energy, capacity, 0, 100) if chargers else None,
        tuple(f"dock {k}" for k in range(chargers)),
        Objective.TRAVEL if travel else Objective.DURATION,
        0.1,
    )


def _times(rng: np.random.Generator, count: int) -> NDArray[np.int64]:
    x, y = rng.uniform(0, 40, count), rng.uniform(0, 25, count)
    floor = rng.integers(0, 3, count)
    level = np.abs(x[:, None] - x) + np.abs(y[:, None] - y)
    stairs = x[:, None] + x + np.abs(y[:, None] - y)
    rise = floor[None, :] - floor[:, None]
    seconds = np.where(rise == 0, level, stairs) / 0.4
    seconds += np.where(rise > 0, 33.0 * rise, -16.0 * rise)
    return np.ceil(10.0 * seconds).astype(np.int64)


def _hidden(rng: np.random.Generator, times: NDArray[np.int64]) -> list[int]:
    """A route that mostly goes on to one of the nearest."""
    at, left, route = len(times) - 1, list(range(len(times) - 1)), []
    while left:
        left.sort(key=lambda k: int(times[at, k]))
        at = left.pop(int(rng.integers(0, min(3, len(left)))))
        route.append(at)
    return route


def _begins(
    times: NDArray[np.int64],
    service: NDArray[np.int64],
    route: list[int],
    energy: NDArray[np.int64],
    capacity: int,
    earliest: NDArray[np.int64] | None = None,
) -> NDArray[np.int64]:
    """When each of a route's visits begins, with a charge at the first dock wherever the battery
    might not last to the next and from there to the dock. `capacity`: 0 without a battery."""
    n, now, used = len(service), 0, 0
    at, begins, dock = n, np.zeros(n, np.int64), n + 1
    for k in route:
        if capacity and used + energy[at, k] + energy[k, dock] > capacity:
            now += int(times[at, dock] + 100 + used + energy[at, dock])
            at, used = dock, 0
        now += int(times[at, k])
        used += int(energy[at, k])
        now = now if earliest is None else max(now, int(earliest[k]))
        begins[k] = now
        now, at = now + int(service[k]), k
    return begins


def _orders(rng: np.random.Generator, hidden: list[int]) -> tuple[Precedence, ...]:
    found = []
    for _ in range(len(hidden) // 2):
        first, then = np.sort(rng.choice(len(hidden), 2, replace=False))
        pair = hidden[first], hidden[then]
        found.append(Precedence(pair, f"checkpoint {pair[0]} before {pair[1]}"))
    return tuple(found)
