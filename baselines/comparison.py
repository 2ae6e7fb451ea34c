"""Comparison of policies by their episodes on the same instances."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from baselines.episodes import EpisodeOutcome
from baselines.families import InstanceSet
from baselines.intervals import Bootstrap, ConfidenceInterval
from baselines.references import BestKnown

_ROUNDING = 1e-6  # tolerance for the rounding of a sum of prizes


@dataclass(frozen=True)
class PolicyStatistics:
    """Means of a policy over the instances of a test set, with confidence intervals."""

    policy: str
    prize: ConfidenceInterval
    gap: ConfidenceInterval
    """share of the best known routes' prize that the policy did not win"""
    behind: ConfidenceInterval
    """prize by which it is behind the policy with the highest mean prize; positive: it wins less"""
    time: ConfidenceInterval
    """simulated time in s until the robot is docked"""
    feasible: ConfidenceInterval
    """share of feasible routes"""
    seconds: ConfidenceInterval
    """processor time in s for one instance"""


@dataclass(frozen=True)
class BetterRoute:
    """A policy's route that wins a higher prize than the best known route."""

    policy: str
    instance: int
    prize: float
    known: float


@dataclass(frozen=True)
class PolicyComparison:
    """Comparison of policies on the first instances of a test set."""

    test_set: str
    checksum: str
    """checksum of these instances"""
    instances: int
    """number of these instances"""
    proven: int
    """number of these instances whose best known route is proven optimal"""
    open: float
    """greatest possible gain over the best known routes, as a share of their prize; 0 if all are
    proven optimal"""
    rows: tuple[PolicyStatistics, ...]
    """statistics of each policy"""
    outcomes: dict[str, tuple[EpisodeOutcome, ...]]
    """outcomes by the name of the policy, in the order of the instances"""
    best: tuple[BestKnown, ...]
    """best known route of each instance"""

    @property
    def pareto_front(self) -> tuple[PolicyStatistics, ...]:
        """Pareto front of mean prize and mean processor time, the fastest policy first."""
        front: list[PolicyStatistics] = []
        for row in sorted(self.rows, key=lambda row: (row.seconds.value, -row.prize.value)):
            if not front or row.prize.value > front[-1].prize.value:
                front.append(row)
        return tuple(front)

    @property
    def better_routes(self) -> tuple[BetterRoute, ...]:
        """Feasible routes of policies that win more than the best known ones."""
        return tuple(
            BetterRoute(name, outcome.instance, outcome.prize, best.prize)
            for name, outcomes in self.outcomes.items()
            for outcome, best in zip(outcomes, self.best, strict=True)
            if outcome.feasible and outcome.prize > best.prize + _ROUNDING
        )


def compare_policies(
    test_set: InstanceSet,
    outcomes: dict[str, tuple[EpisodeOutcome, ...]],
    best: Sequence[BestKnown],
    seed: int,
) -> PolicyComparison:
    """Return the statistics of policies on the same instances of a test set.

    Args:
        test_set: the test set, of which the policies had the first instances.
        outcomes: outcomes of each policy, by its name, in the order of the instances.
        best: best known route of each of these instances.
        seed: seed of the bootstrap.
    """
    count = len(best)
    bootstrap = Bootstrap(count, seed)
    prizes = {name: np.array([o.prize for o in episodes]) for name, episodes in outcomes.items()}
    highest = max(prizes.values(), key=lambda values: float(values.mean()))
    known = np.array([reference.prize for reference in best])
    rows = []
    for name, episodes in outcomes.items():
        rows.append(
            PolicyStatistics(
                name,
                bootstrap.mean(prizes[name]),
                bootstrap.ratio_of_sums(known - prizes[name], known),
                bootstrap.mean(highest - prizes[name]),
                bootstrap.mean(np.array([o.time for o in episodes])),
                bootstrap.mean(np.array([o.feasible for o in episodes], dtype=float)),
                bootstrap.mean(np.array([o.seconds for o in episodes])),
            )
        )
    proven = sum(reference.proven for reference in best)
    bound = sum(reference.bound for reference in best)
    return PolicyComparison(
        test_set.name,
        test_set.checksum(count),
        count,
        proven,
        bound / float(known.sum()) - 1.0 if proven < count and known.any() else 0.0,
        tuple(rows),
        outcomes,
        tuple(best),
    )
