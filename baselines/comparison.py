"""What outcomes of policies on the same instances say."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from baselines.episodes import EpisodeOutcome
from baselines.families import InstanceSet
from baselines.intervals import Bootstrap, ConfidenceInterval
from baselines.references import BestKnown


@dataclass(frozen=True)
class Row:
    """A policy on a test set."""

    policy: str
    prize: ConfidenceInterval
    gap: ConfidenceInterval
    """share of the best routes' prize that it did not win"""
    behind: ConfidenceInterval
    """by how much its prize is below that of the policy with the highest mean"""
    time: ConfidenceInterval
    """s until the robot is docked"""
    feasible: ConfidenceInterval
    """share of the routes"""
    thinking: ConfidenceInterval
    """s for a decision, preparation included"""


@dataclass(frozen=True)
class PolicyComparison:
    """Policies on the first instances of a test set."""

    test_set: str
    checksum: str
    """of those instances"""
    instances: int
    proven: int
    """for how many of them the best route is proven to be that"""
    rows: tuple[Row, ...]
    outcomes: dict[str, tuple[EpisodeOutcome, ...]]
    """by policy"""
    best: tuple[BestKnown, ...]


def compare(
    tests: InstanceSet,
    outcomes: dict[str, tuple[EpisodeOutcome, ...]],
    best: Sequence[BestKnown],
    seed: int,
) -> PolicyComparison:
    """The figures of policies on the same instances of a test set, whose best routes are given."""
    count = len(best)
    bootstrap = Bootstrap(count, seed)
    prizes = {name: np.array([o.prize for o in found]) for name, found in outcomes.items()}
    highest = max(prizes.values(), key=lambda values: float(values.mean()))
    optimum = np.array([reference.prize for reference in best])
    rows = []
    for name, found in outcomes.items():
        decisions = np.array([o.decisions for o in found], dtype=float)
        rows.append(
            Row(
                name,
                bootstrap.mean(prizes[name]),
                bootstrap.ratio(optimum - prizes[name], optimum),
                bootstrap.mean(highest - prizes[name]),
                bootstrap.mean(np.array([o.time for o in found])),
                bootstrap.mean(np.array([o.feasible for o in found], dtype=float)),
                bootstrap.ratio(np.array([o.seconds for o in found]), decisions),
            )
        )
    proven = sum(reference.proven for reference in best)
    return PolicyComparison(
        tests.name, tests.checksum(count), count, proven, tuple(rows), outcomes, tuple(best)
    )
