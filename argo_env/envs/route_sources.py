"""Sources of route instances: random sites, which have aisles and stairs along their ends, and the
travel times of a real one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from argo_compiler.base.errors import NotFound
from argo_compiler.base.model import Model
from argo_env.envs.route_instance import RouteInstance, Stair, make_instance, with_hidden
from argo_env.envs.route_noise import NO_NOISE, RouteNoise, draw_blocked, draw_failing
from argo_env.envs.route_site_times import SiteTimes, site_times, stairs_of_site, times_without
from argo_env.seeding import generator

WIDTH, DEPTH = 30.0, 20.0
"""m, of the floors of sites that do not exist"""
SPEED = 0.4
"""m/s, see `urdf/robot/tracker.yaml`"""
_UP, _DOWN = 33.0, 16.0  # s for a floor


def stairs_of(floors: int, ends: int) -> list[Stair]:
    """All stairs between so many floors: at the end x = 0 (number 0), and at x = WIDTH (1) if there
    are two."""
    return [(end, floor) for end in range(ends) for floor in range(1, floors)]


def aisle_times(
    places: NDArray[np.float64], floors: int, ends: int = 1, blocked: tuple[Stair, ...] = ()
) -> NDArray[np.float64] | None:
    """Seconds from each of the places (x, y in m, and floor) to each other, shape (n, n): along the
    aisles, and up or down by stairs that reach all along one end, or both ends, of the floors.

    None if a floor can't be reached, as all its stairs are blocked.
    """
    crossing = _crossing(floors, ends, frozenset(blocked))
    if not np.isfinite(crossing).all():
        return None
    x, y, number = places.T
    floor = number.astype(np.int64) - 1
    aside = np.abs(y[:, None] - y)
    level = np.abs(x[:, None] - x) + aside
    to_end = (x, WIDTH - x)
    # In from both sides, and up or down between.
    ways = [
        to_end[a][:, None] + crossing[a, b][floor[:, None], floor] + to_end[b] + aside
        for a in range(ends)
        for b in range(ends)
    ]
    rise = number - number[:, None]
    way = np.where(rise == 0, level, np.minimum.reduce(ways)) / SPEED
    return np.asarray(way + np.where(rise > 0, _UP * rise, -_DOWN * rise))


@lru_cache(maxsize=256)
def _crossing(floors: int, ends: int, blocked: frozenset[Stair]) -> NDArray[np.float64]:
    """m that a way goes from end to end of floors between leaving the first floor at one end and
    coming to the last floor at another, shape (ends, ends, floors, floors); inf: there is none."""
    lengths = np.full((ends, ends, floors, floors), np.inf)
    for first in range(floors):
        way = np.where(np.eye(ends, dtype=np.bool_), 0.0, WIDTH)  # row: where it left from
        lengths[:, :, first, first] = way
        for floor in range(first + 1, floors):
            way = way + [np.inf if (end, floor) in blocked else 0.0 for end in range(ends)]
            way = np.minimum(way, way[:, ::-1] + WIDTH if ends > 1 else way)
            lengths[:, :, first, floor] = way
            lengths[:, :, floor, first] = way.T
    return lengths


TRAINING = range(4096)
"""the numbers of the instances that episodes draw from"""
TEST = range(1_000_000, 1_000_100)
"""the numbers of the instances that are kept for tests: never drawn unless asked for"""
PRECEDENCE = 0.2
"""share of checkpoints that another one must come before"""


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
    """Sites that do not exist: checkpoints anywhere on floors with aisles, stairs at one end; at
    both ends where stairs may be found blocked.

    Way along the aisles, 0.4 m/s (see `urdf/robot/tracker.yaml`); stairs take longer up than down.
    """

    checkpoints: int = 20
    floors: int = 6
    budget: float = 1200.0
    """s"""
    noise: RouteNoise = NO_NOISE
    precedence: float = PRECEDENCE

    @property
    def ends(self) -> int:
        """At how many ends of the floors there are stairs."""
        return 2 if self.noise.blocked else 1

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
        service = np.concatenate([[0.0], rng.uniform(5.0, 15.0, self.checkpoints)])
        asked = _Asked(self.budget, self.noise, self.precedence, floors, faults)
        return _finished(
            partial(aisle_times, places, self.floors, self.ends),
            stairs_of(self.floors, self.ends),
            service,
            places,
            asked,
            rng,
            generator(number, "route noise", self.checkpoints, self.floors),
        )


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
    noise: RouteNoise = NO_NOISE
    precedence: float = PRECEDENCE
    kept: SiteTimes | None = field(default=None, compare=False)
    """the site's travel times, where they are kept; None: they are found out"""

    @property
    def floors(self) -> int:
        return self._site.floors

    @property
    def existing(self) -> int:
        """How many of the checkpoints the site has."""
        return min(self.checkpoints, len(self._site.places) - 1)

    @property
    def _site(self) -> SiteTimes:
        return self.kept or site_times(self.scenario)

    def check(self) -> None:
        """Raises ArgoError if there is no such site, or stairs are to be found blocked where there
        is no other way."""
        name, _ = self.scenario, self.floors
        if self.noise.blocked and not any(
            times_without(name, (stair,)) is not None for stair in stairs_of_site(name)
        ):
            raise NotFound(
                f"scenario {name} has no stairs that can be blocked: there is no other way; take a "
                "site with two stair towers, or noise without `blocked`"
            )

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """See RouteSource."""
        site = self._site
        purpose = (self.checkpoints, self.scenario)
        rng = generator(number, "site route", *purpose)
        there = len(site.places) - 1
        chosen = rng.permutation(there)[: self.checkpoints] + 1
        n = self.checkpoints + 2
        nodes = np.concatenate([[0], np.sort(chosen), [0]])
        slots = np.concatenate([np.arange(len(nodes) - 1), [n - 1]])
        places = np.zeros((n, 3))
        places[slots] = site.places[nodes]
        service = np.full(n - 1, site.measuring_time)
        service[0] = 0.0

        def times(blocked: tuple[Stair, ...] = ()) -> NDArray[np.float64] | None:
            found = times_without(self.scenario, blocked) if blocked else site.times
            if found is None:
                return None
            spread = np.full((n, n), np.inf)
            # A way round is never shorter, but for the rounding of what is rather avoided.
            longer = np.maximum(found, site.times)
            spread[np.ix_(slots, slots)] = longer[np.ix_(nodes, nodes)]
            return spread

        stairs = stairs_of_site(self.scenario) if self.noise.blocked else ()
        asked = _Asked(self.budget, self.noise, self.precedence, floors, faults)
        noise = generator(number, "route noise", *purpose)
        return _finished(times, stairs, service, places, asked, rng, noise)


@dataclass(frozen=True)
class _Asked:
    """What an instance is to be like, wherever it is."""

    budget: float
    noise: RouteNoise
    precedence: float
    floors: Sequence[int]
    faults: RouteFaults


def _finished(
    times_without: Callable[[tuple[Stair, ...]], NDArray[np.float64] | None],
    stairs: Sequence[Stair],
    service: NDArray[np.float64],
    places: NDArray[np.float64],
    asked: _Asked,
    rng: np.random.Generator,
    noise: np.random.Generator,
) -> RouteInstance:
    """The instance, its prizes, precedence and noise drawn, and what can't be reached closed.

    `times_without` says the travel times (s) between all places without some of the stairs, None
    where these are indispensable.
    """
    count = len(service) - 1
    prizes = np.concatenate([[0.0], rng.integers(1, 101, count) / 100])
    order = rng.permutation(count) + 1
    later = np.flatnonzero(rng.random(count) < asked.precedence)
    pairs = [(int(order[rng.integers(k)]), int(order[k])) for k in later if k > 0]
    drawn = rng.permutation(count) + 1
    drawn = drawn[places[drawn, 2] > 0]  # those that exist: an empty slot is on no floor
    closed = drawn[: asked.faults.closed]
    if asked.floors:
        elsewhere = np.flatnonzero(~np.isin(places[1:-1, 2], asked.floors)) + 1
        closed = np.concatenate([closed, elsewhere])

    def reachable(blocked: tuple[Stair, ...]) -> NDArray[np.float64] | None:
        found = times_without(blocked)
        if found is None:
            return None
        found = found[:, :-1].copy()
        found[:, closed] = np.inf
        return found

    times = reachable(())
    assert times is not None
    # What waits for a checkpoint that nobody gets to would wait for ever.
    pairs = [(first, then) for first, then in pairs if np.isfinite(times[-1, first])]
    budget = asked.budget * asked.faults.battery
    instance = make_instance(times, service, prizes, pairs, budget, places)
    if asked.noise == NO_NOISE:
        return instance
    failing = draw_failing(asked.noise, count, noise)
    blocked = draw_blocked(asked.noise, instance.budget, stairs, reachable, noise)
    return with_hidden(instance, failing, blocked, service)


def existing(source: RouteSource) -> int:
    """How many of a source's checkpoints exist: a site may have fewer than there are slots for."""
    return source.existing if isinstance(source, SiteRoutes) else source.checkpoints
