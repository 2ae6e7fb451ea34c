"""What outcomes of policies on the same instances say."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from baselines.episodes import EpisodeOutcome
from baselines.families import InstanceSet
from baselines.intervals import Bootstrap, ConfidenceInterval
from baselines.references import BestKnown

_ROUNDING = 1e-6  # of a sum of prizes


@dataclass(frozen=True)
class Row:
    """A policy on a test set."""

    policy: str
    prize: ConfidenceInterval
    gap: ConfidenceInterval
    """share of the best known routes' prize that it did not win"""
    behind: ConfidenceInterval
    """by how much its prize is below that of the policy with the highest mean"""
    time: ConfidenceInterval
    """s until the robot is docked"""
    feasible: ConfidenceInterval
    """share of the routes"""
    seconds: ConfidenceInterval
    """s of processor time for an instance"""


@dataclass(frozen=True)
class Beaten:
    """A route that is better than the best known one."""

    policy: str
    instance: int
    prize: float
    known: float


@dataclass(frozen=True)
class PolicyComparison:
    """Policies on the first instances of a test set."""

    test_set: str
    checksum: str
    """of those instances"""
    instances: int
    proven: int
    """for how many of them the best known route is proven to be the best"""
    open: float
    """by what share of the best known routes' prize others can be better at most: 0 where all are
    proven"""
    rows: tuple[Row, ...]
    outcomes: dict[str, tuple[EpisodeOutcome, ...]]
    """by policy"""
    best: tuple[BestKnown, ...]

    @property
    def front(self) -> tuple[Row, ...]:
        """The policies than which no other wins as much in less time, the fastest first (the
        Pareto front of mean prize and mean time)."""
        kept: list[Row] = []
        for row in sorted(self.rows, key=lambda row: (row.seconds.value, -row.prize.value)):
            if not kept or row.prize.value > kept[-1].prize.value:
                kept.append(row)
        return tuple(kept)

    @property
    def beaten(self) -> tuple[Beaten, ...]:
        """The routes that show that the best known ones are not the best."""
        return tuple(
            Beaten(name, outcome.instance, outcome.prize, best.prize)
            for name, outcomes in self.outcomes.items()
            for outcome, best in zip(outcomes, self.best, strict=True)
            if outcome.feasible and outcome.prize > best.prize + _ROUNDING
        )


def compare(
    tests: InstanceSet,
    outcomes: dict[str, tuple[EpisodeOutcome, ...]],
    best: Sequence[BestKnown],
    seed: int,
) -> PolicyComparison:
    """The figures of policies on the same instances of a test set, whose best known routes are
    given."""
    count = len(best)
    bootstrap = Bootstrap(count, seed)
    prizes = {name: np.array([o.prize for o in found]) for name, found in outcomes.items()}
    highest = max(prizes.values(), key=lambda values: float(values.mean()))
    known = np.array([reference.prize for reference in best])
    rows = []
    for name, found in outcomes.items():
        rows.append(
            Row(
                name,
                bootstrap.mean(prizes[name]),
                bootstrap.ratio(known - prizes[name], known),
                bootstrap.mean(highest - prizes[name]),
                bootstrap.mean(np.array([o.time for o in found])),
                bootstrap.mean(np.array([o.feasible for o in found], dtype=float)),
                bootstrap.mean(np.array([o.seconds for o in found])),
            )
        )
    proven = sum(reference.proven for reference in best)
    bound = sum(reference.bound for reference in best)
    return PolicyComparison(
        tests.name,
        tests.checksum(count),
        count,
        proven,
        bound / float(known.sum()) - 1.0 if proven < count and known.any() else 0.0,
        tuple(rows),
        outcomes,
        tuple(best),
    )
