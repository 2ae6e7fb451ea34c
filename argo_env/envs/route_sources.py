"""Where route instances come from: random sites, and the travel times of a real one."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from argo_compiler.model import Model
from argo_env.envs.route_instance import RouteInstance, make_instance
from argo_env.envs.sites import navigator_of
from argo_env.seeding import generator

TRAINING = range(4096)
"""the numbers of the instances that episodes draw from"""
TEST = range(1_000_000, 1_000_100)
"""the numbers of the instances that are kept for tests: never drawn unless asked for"""
WIDTH, DEPTH = 30.0, 20.0
"""m, of the floors of sites that do not exist"""
_PRECEDENCE = 0.2  # share of checkpoints that another one must come before


class RouteFaults(Model):
    """Faults that are known before the robot sets off."""

    closed: int = Field(default=0, ge=0, strict=True)
    """of the checkpoints that exist, drawn with the instance: so many can't be reached"""
    battery: float = Field(default=1.0, gt=0.0, le=1.0, strict=True)
    """share of the budget that a worn battery leaves"""


NO_FAULTS = RouteFaults()


class RouteSource(Protocol):
    """Makes instances, each by its number. All have the same number of checkpoints."""

    @property
    def checkpoints(self) -> int:
        """How many, those included that a site does not have."""
        ...

    @property
    def floors(self) -> int:
        """How many."""
        ...

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """The instance of that number. Checkpoints on other floors than `floors` can't be reached,
        if any are given. Equal arguments give equal instances."""
        ...


@dataclass(frozen=True)
class RandomRoutes:
    """Sites that do not exist: checkpoints anywhere on floors with aisles, stairs at one end.

    Way along the aisles, 0.4 m/s (see `urdf/robot/tracker.yaml`); stairs take longer up than down.
    """

    checkpoints: int = 20
    floors: int = 6
    budget: float = 1200.0
    """s"""

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """See RouteSource."""
        rng = generator(number, "random route", self.checkpoints, self.floors)
        n = self.checkpoints + 2
        places = np.column_stack(
            [
                rng.uniform(0, WIDTH, n),
                rng.uniform(0, DEPTH, n),
                rng.integers(1, self.floors + 1, n),
            ]
        )
        # The dock, and the start in another place; both on the ground.
        places[[0, n - 1], 2] = 1
        x, y, floor = places.T
        level = np.abs(x[:, None] - x) + np.abs(y[:, None] - y)
        # By the stairs at x = 0: in from both sides, and up or down between.
        stairs = x[:, None] + x + np.abs(y[:, None] - y)
        rise = floor - floor[:, None]
        way = np.where(rise == 0, level, stairs) / 0.4
        times = way + np.where(rise > 0, 33.0 * rise, -16.0 * rise)
        service = np.concatenate([[0.0], rng.uniform(5.0, 15.0, self.checkpoints)])
        return _finished(times[:, :-1], service, self.budget, places, rng, floors, faults)


@dataclass(frozen=True)
class SiteRoutes:
    """Checkpoints of a real site, from its docking station 1 and back there.

    Where the site has more checkpoints than wanted, an instance has some of them; where it has
    fewer, the rest can't be reached.
    """

    checkpoints: int
    scenario: str
    budget: float = 1200.0
    """s"""

    @property
    def floors(self) -> int:
        return _matrix(self.scenario).floors

    @property
    def existing(self) -> int:
        """How many of the checkpoints the site has."""
        return min(self.checkpoints, len(_matrix(self.scenario).places) - 1)

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """See RouteSource."""
        site = _matrix(self.scenario)
        rng = generator(number, "site route", self.checkpoints, self.scenario)
        there = len(site.places) - 1
        chosen = rng.permutation(there)[: self.checkpoints] + 1
        n = self.checkpoints + 2
        nodes = np.concatenate([[0], np.sort(chosen), [0]])
        slots = np.concatenate([np.arange(len(nodes) - 1), [n - 1]])
        times = np.full((n, n), np.inf)
        times[np.ix_(slots, slots)] = site.times[np.ix_(nodes, nodes)]
        places = np.zeros((n, 3))
        places[slots] = site.places[nodes]
        service = np.full(n - 1, site.measuring_time)
        service[0] = 0.0
        return _finished(times[:, :-1], service, self.budget, places, rng, floors, faults)


@dataclass(frozen=True)
class _Matrix:
    times: NDArray[np.float64]
    """s, the dock first"""
    places: NDArray[np.float64]
    """x, y (m) and floor"""
    floors: int
    measuring_time: float


@lru_cache(maxsize=8)
def _matrix(scenario: str) -> _Matrix:
    """The travel times between the first dock and all checkpoints of a site."""
    navigator = navigator_of(scenario)
    site = navigator.site
    number = min(site.docks)
    dock = navigator.snap(site.docks[number])
    times = navigator.travel_times([dock, *(c.id for c in site.checkpoints)])
    places = [(dock.x, dock.y, site.floor_at(dock.z))]
    places += [(c.position[0], c.position[1], c.floor) for c in site.checkpoints]
    measuring = navigator.robot.sensor.measuring_time
    return _Matrix(times, np.array(places), len(site.spec.floors), measuring)


def _finished(
    times: NDArray[np.float64],
    service: NDArray[np.float64],
    budget: float,
    places: NDArray[np.float64],
    rng: np.random.Generator,
    floors: Sequence[int],
    faults: RouteFaults,
) -> RouteInstance:
    """The instance, its prizes and precedence drawn, and what can't be reached closed."""
    count = len(service) - 1
    prizes = np.concatenate([[0.0], rng.integers(1, 101, count) / 100])
    order = rng.permutation(count) + 1
    later = np.flatnonzero(rng.random(count) < _PRECEDENCE)
    pairs = [(int(order[rng.integers(k)]), int(order[k])) for k in later if k > 0]
    drawn = rng.permutation(count) + 1
    drawn = drawn[places[drawn, 2] > 0]  # those that exist: an empty slot is on no floor
    times = times.copy()
    times[:, drawn[: faults.closed]] = np.inf
    if floors:
        elsewhere = np.flatnonzero(~np.isin(places[1:-1, 2], floors)) + 1
        times[:, elsewhere] = np.inf
    # What waits for a checkpoint that nobody gets to would wait for ever.
    pairs = [(first, then) for first, then in pairs if np.isfinite(times[-1, first])]
    return make_instance(times, service, prizes, pairs, budget * faults.battery, places)


def existing(source: RouteSource) -> int:
    """How many of a source's checkpoints exist: a site may have fewer than there are slots for."""
    return source.existing if isinstance(source, SiteRoutes) else source.checkpoints
