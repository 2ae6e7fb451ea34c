"""Training instances: routes with different numbers of checkpoints, on different sites."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from argo_env.envs.route_instance import RouteInstance
from argo_env.envs.route_noise import RouteNoise
from argo_env.envs.route_sources import (
    NO_FAULTS,
    TEST,
    RandomRoutes,
    RouteFaults,
    RouteSource,
    SiteRoutes,
)
from argo_env.seeding import generator

SITES = tuple(
    f"generated:floors={floors},size={size},checkpoints=48,seed={seed}"
    for floors, size, seed in [
        (2, "24x16", 11), (3, "20x14", 12), (4, "20x14", 14), (6, "20x14", 16)
    ]
)  # fmt: skip
"""Generated sites for training; all seeds are below those reserved for tests."""
_NOISE = RouteNoise(failing=0.2, blocked=2)
_NOISY = 0.3  # share of noisy routes among those that are not plain
_PRECEDENCES = (0.0, 0.2, 0.5, 0.8)  # shares of checkpoints that must follow another one


@dataclass(frozen=True)
class TrainingRoutes:
    """A source of routes of many kinds with the same number of slots for checkpoints.

    Slots that an instance does not need can't be reached. A share `plain` of the routes are random
    ones with all checkpoints on six floors. Of the others, 30 % are like these, but with noise; the
    rest have fewer checkpoints or floors, another budget, another share of precedence constraints,
    or a generated site.
    """

    checkpoints: int = 20
    """number of slots"""
    budget: float = 1200.0
    """time budget in s"""
    sites: Sequence[str] = SITES
    """sites that some of the routes are on"""
    plain: float = 0.5
    """share of routes with all checkpoints on six floors, without noise"""
    offset: int = 0
    """number added to the instance numbers, to get other instances"""

    @property
    def floors(self) -> int:
        return 6

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """Return the instance with this number; see `RouteSource.draw`."""
        number = (number + self.offset) % TEST.start
        rng = generator(number, "training route", self.checkpoints)
        source: RouteSource
        if rng.random() < self.plain:
            source = RandomRoutes(self.checkpoints, budget=self.budget)
        elif rng.random() < _NOISY:
            source = RandomRoutes(self.checkpoints, budget=self.budget, noise=_NOISE)
        else:
            count = int(rng.integers(self.checkpoints // 2, self.checkpoints, endpoint=True))
            budget = float(self.budget * rng.uniform(0.6, 1.2))
            precedence = float(rng.choice(_PRECEDENCES))
            if rng.random() < 0.5 or not self.sites:
                decks = int(rng.integers(1, 7))
                source = RandomRoutes(count, decks, budget, precedence=precedence)
            else:
                site = self.sites[int(rng.integers(len(self.sites)))]
                source = SiteRoutes(count, site, budget, precedence=precedence)
        return pad_instance(source.draw(number, floors, faults), self.checkpoints)


def pad_instance(instance: RouteInstance, checkpoints: int) -> RouteInstance:
    """Return an instance filled up to `checkpoints` with unreachable ones that have no prize."""
    more = checkpoints + 1 - instance.node_count
    if more == 0:
        return instance
    arrival = np.insert(instance.arrival, [instance.node_count] * more, np.inf, axis=0)
    return replace(
        instance,
        arrival=np.pad(arrival, ((0, 0), (0, more)), constant_values=np.inf),
        prizes=np.pad(instance.prizes, (0, more)),
        before=np.pad(instance.before, (0, more)),
        positions=np.insert(instance.positions, [instance.node_count] * more, 0.0, axis=0),
    )
