"""What the learned policy trains on: routes with different numbers of checkpoints and sites."""

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
"""Generated sites to train on; all seeds are below those for testing."""
_NOISE = RouteNoise(failing=0.2, blocked=2)
_NOISY = 0.3  # share of the routes that are not plain
_PRECEDENCES = (0.0, 0.2, 0.5, 0.8)  # of them, share of checkpoints that another must come before


@dataclass(frozen=True)
class TrainingRoutes:
    """Routes of many kinds in as many slots: slots that an instance does not need can't be reached.

    Half of them are random routes as `RandomRoutes` makes them with all slots and six floors. In
    the others things go wrong on the way; or there are fewer checkpoints or floors, another budget,
    more or less to be kept in order, or a generated site.
    """

    checkpoints: int = 20
    budget: float = 1200.0
    """s"""
    sites: Sequence[str] = SITES
    plain: float = 0.5
    """the share that has all checkpoints on six floors"""
    offset: int = 0
    """added to the numbers, for other instances than before"""

    @property
    def floors(self) -> int:
        return 6

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """See RouteSource."""
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
        return padded(source.draw(number, floors, faults), self.checkpoints)


def padded(instance: RouteInstance, checkpoints: int) -> RouteInstance:
    """The same instance with more checkpoints, which can't be reached and are worth nothing."""
    more = checkpoints + 1 - instance.size
    if more == 0:
        return instance
    arrival = np.insert(instance.arrival, [instance.size] * more, np.inf, axis=0)
    return replace(
        instance,
        arrival=np.pad(arrival, ((0, 0), (0, more)), constant_values=np.inf),
        prizes=np.pad(instance.prizes, (0, more)),
        before=np.pad(instance.before, (0, more)),
        places=np.insert(instance.places, [instance.size] * more, 0.0, axis=0),
    )
