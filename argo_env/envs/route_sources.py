"""Sources of route instances: random sites with aisles, and the travel times of real sites."""

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
from argo_env.envs.route_noise import NO_NOISE, RouteNoise, draw_blocked_stairs, draw_failures
from argo_env.envs.route_site_times import SiteTimes, site_stairs, site_times, site_times_without
from argo_env.seeding import generator

WIDTH, DEPTH = 30.0, 20.0
"""m, size of the floors of random sites"""
SPEED = 0.4
"""m/s, see `urdf/robot/tracker.yaml`"""
_UP, _DOWN = 33.0, 16.0  # s per floor


def list_stairs(floors: int, ends: int) -> list[Stair]:
    """Return all stairs of a random site with so many floors, and stairs at so many of their ends.

    Each is (end, number of the lower floor, from 1). End 0 is at x = 0, end 1 at x = WIDTH.
    """
    return [(end, floor) for end in range(ends) for floor in range(1, floors)]


def aisle_times(
    positions: NDArray[np.float64], floors: int, ends: int = 1, blocked: tuple[Stair, ...] = ()
) -> NDArray[np.float64] | None:
    """Return the travel times (s) between positions on a random site, shape (n, n).

    Paths lead along the aisles, and up or down by stairs that extend along one end, or both ends,
    of the floors. Returns None if a floor can't be reached as all its stairs are blocked.

    Args:
        positions: x, y (m) and the number of the floor, from 1, shape (n, 3).
        floors: Number of floors.
        ends: Number of ends with stairs, 1 or 2.
        blocked: Stairs that can't be used.
    """
    crossings = _floor_crossings(floors, ends, frozenset(blocked))
    if not np.isfinite(crossings).all():
        return None
    x, y, number = positions.T
    floor = number.astype(np.int64) - 1
    aside = np.abs(y[:, None] - y)
    level = np.abs(x[:, None] - x) + aside
    to_end = (x, WIDTH - x)
    # From both positions to an end, and up or down between the ends.
    lengths = [
        to_end[a][:, None] + crossings[a, b][floor[:, None], floor] + to_end[b] + aside
        for a in range(ends)
        for b in range(ends)
    ]
    rise = number - number[:, None]
    length = np.where(rise == 0, level, np.minimum.reduce(lengths)) / SPEED
    return np.asarray(length + np.where(rise > 0, _UP * rise, -_DOWN * rise))


@lru_cache(maxsize=256)
def _floor_crossings(floors: int, ends: int, blocked: frozenset[Stair]) -> NDArray[np.float64]:
    """Return the lengths (m) of the shortest paths from an end of one floor to an end of another.

    The stairs themselves are not counted. The shape is (ends, ends, floors, floors): from end, to
    end, from floor, to floor, floors counted from 0; inf if there is no path.
    """
    lengths = np.full((ends, ends, floors, floors), np.inf)
    for first in range(floors):
        # The row is the end at which the path left the first floor.
        length = np.where(np.eye(ends, dtype=np.bool_), 0.0, WIDTH)
        lengths[:, :, first, first] = length
        for floor in range(first + 1, floors):
            length = length + [np.inf if (end, floor) in blocked else 0.0 for end in range(ends)]
            length = np.minimum(length, length[:, ::-1] + WIDTH if ends > 1 else length)
            lengths[:, :, first, floor] = length
            lengths[:, :, floor, first] = length.T
    return lengths


TRAINING = range(4096)
"""numbers of the instances from which episodes draw"""
TEST = range(1_000_000, 1_000_100)
"""numbers of the instances for tests, which are never drawn unless they are requested"""
PRECEDENCE = 0.2
"""share of checkpoints that another one must precede"""


class RouteFaults(Model):
    """Faults that are known before the robot starts."""

    closed: int = Field(default=0, ge=0, strict=True)
    """number of existing checkpoints that can't be reached; they are drawn with the instance"""
    battery: float = Field(default=1.0, gt=0.0, le=1.0, strict=True)
    """share of the budget that a worn battery leaves"""


NO_FAULTS = RouteFaults()


class RouteSource(Protocol):
    """Protocol of sources, which make instances by their numbers.

    All instances of a source have the same number of checkpoints.
    """

    @property
    def checkpoints(self) -> int:
        """Number of checkpoints in each instance; those that a site lacks can't be reached."""
        ...

    @property
    def floors(self) -> int:
        """Number of floors."""
        ...

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """Return the instance with this number; equal arguments give equal instances.

        If `floors` are given, checkpoints on other floors can't be reached.
        """
        ...


@dataclass(frozen=True)
class RandomRoutes:
    """Random sites: checkpoints anywhere on floors with aisles, and stairs at one end.

    There are stairs at both ends if some may be found blocked. The robot drives along the aisles at
    0.4 m/s (see `urdf/robot/tracker.yaml`); stairs take longer up than down.
    """

    checkpoints: int = 20
    floors: int = 6
    budget: float = 1200.0
    """s"""
    noise: RouteNoise = NO_NOISE
    precedence: float = PRECEDENCE

    @property
    def ends_with_stairs(self) -> int:
        """Number of ends of the floors at which there are stairs."""
        return 2 if self.noise.blocked else 1

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """Return the instance with this number: see `RouteSource.draw`."""
        rng = generator(number, "random route", self.checkpoints, self.floors)
        n = self.checkpoints + 2
        positions = np.column_stack(
            [
                rng.uniform(0, WIDTH, n),
                rng.uniform(0, DEPTH, n),
                rng.integers(1, self.floors + 1, n),
            ]
        )
        # The dock, and the start at another position, both on the ground.
        positions[[0, n - 1], 2] = 1
        service = np.concatenate([[0.0], rng.uniform(5.0, 15.0, self.checkpoints)])
        spec = _InstanceSpec(self.budget, self.noise, self.precedence, floors, faults)
        return _complete_instance(
            partial(aisle_times, positions, self.floors, self.ends_with_stairs),
            list_stairs(self.floors, self.ends_with_stairs),
            service,
            positions,
            spec,
            rng,
            generator(number, "route noise", self.checkpoints, self.floors),
        )


@dataclass(frozen=True)
class SiteRoutes:
    """Checkpoints of a real site, from its docking station 1 and back there.

    If the site has more checkpoints than requested, an instance has some of them; if it has fewer,
    the others can't be reached.
    """

    checkpoints: int
    scenario: str
    budget: float = 1200.0
    """s"""
    noise: RouteNoise = NO_NOISE
    precedence: float = PRECEDENCE
    stored_times: SiteTimes | None = field(default=None, compare=False)
    """stored travel times of the site; None if they are to be computed"""

    @property
    def floors(self) -> int:
        return self._site.floors

    @property
    def existing_checkpoint_count(self) -> int:
        """Number of checkpoints in an instance that exist, as the site may have fewer."""
        return min(self.checkpoints, len(self._site.positions) - 1)

    @property
    def _site(self) -> SiteTimes:
        return self.stored_times or site_times(self.scenario)

    def require_site_and_blockable_stairs(self) -> None:
        """Raise ArgoError if there is no such site, or if its stairs can't be blocked as requested.

        They can't if the noise asks for blocked stairs and no stairs of the site have a detour.
        """
        name, _ = self.scenario, self.floors
        if self.noise.blocked and not any(
            site_times_without(name, (stair,)) is not None for stair in site_stairs(name)
        ):
            raise NotFound(
                f"scenario {name} has no stairs that can be blocked, as there is no detour: choose "
                "a site with two stair towers, or noise without `blocked`"
            )

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """Return the instance with this number: see `RouteSource.draw`."""
        site = self._site
        purpose = (self.checkpoints, self.scenario)
        rng = generator(number, "site route", *purpose)
        available = len(site.positions) - 1
        chosen = rng.permutation(available)[: self.checkpoints] + 1
        n = self.checkpoints + 2
        nodes = np.concatenate([[0], np.sort(chosen), [0]])
        slots = np.concatenate([np.arange(len(nodes) - 1), [n - 1]])
        positions = np.zeros((n, 3))
        positions[slots] = site.positions[nodes]
        service = np.full(n - 1, site.measuring_time)
        service[0] = 0.0

        def times(blocked: tuple[Stair, ...] = ()) -> NDArray[np.float64] | None:
            known_times = site_times_without(self.scenario, blocked) if blocked else site.times
            if known_times is None:
                return None
            spread = np.full((n, n), np.inf)
            # A detour is never faster, except for the rounding of costs of what paths rather avoid.
            longer = np.maximum(known_times, site.times)
            spread[np.ix_(slots, slots)] = longer[np.ix_(nodes, nodes)]
            return spread

        stairs = site_stairs(self.scenario) if self.noise.blocked else ()
        spec = _InstanceSpec(self.budget, self.noise, self.precedence, floors, faults)
        noise = generator(number, "route noise", *purpose)
        return _complete_instance(times, stairs, service, positions, spec, rng, noise)


@dataclass(frozen=True)
class _InstanceSpec:
    """Requirements on an instance that do not depend on its site."""

    budget: float
    noise: RouteNoise
    precedence: float
    floors: Sequence[int]
    faults: RouteFaults


def _complete_instance(
    times_without: Callable[[tuple[Stair, ...]], NDArray[np.float64] | None],
    stairs: Sequence[Stair],
    service: NDArray[np.float64],
    positions: NDArray[np.float64],
    spec: _InstanceSpec,
    rng: np.random.Generator,
    noise: np.random.Generator,
) -> RouteInstance:
    """Return the instance; draw its prizes, precedence, closed checkpoints and noise.

    Closed checkpoints, and those on floors other than `spec.floors`, can't be reached.
    `times_without` returns the travel times (s) between all positions without some of the stairs,
    None if these are indispensable.
    """
    count = len(service) - 1
    prizes = np.concatenate([[0.0], rng.integers(1, 101, count) / 100])
    order = rng.permutation(count) + 1
    later = np.flatnonzero(rng.random(count) < spec.precedence)
    pairs = [(int(order[rng.integers(k)]), int(order[k])) for k in later if k > 0]
    drawn = rng.permutation(count) + 1
    drawn = drawn[positions[drawn, 2] > 0]  # existing ones: an empty slot is on no floor
    closed = drawn[: spec.faults.closed]
    if spec.floors:
        elsewhere = np.flatnonzero(~np.isin(positions[1:-1, 2], spec.floors)) + 1
        closed = np.concatenate([closed, elsewhere])

    def reachable(blocked: tuple[Stair, ...]) -> NDArray[np.float64] | None:
        known_times = times_without(blocked)
        if known_times is None:
            return None
        known_times = known_times[:, :-1].copy()
        known_times[:, closed] = np.inf
        return known_times

    times = reachable(())
    assert times is not None
    # A checkpoint could never be visited after one that can't be reached.
    pairs = [(first, second) for first, second in pairs if np.isfinite(times[-1, first])]
    budget = spec.budget * spec.faults.battery
    instance = make_instance(times, service, prizes, pairs, budget, positions)
    if spec.noise == NO_NOISE:
        return instance
    failing = draw_failures(spec.noise, count, noise)
    blocked = draw_blocked_stairs(spec.noise, instance.budget, stairs, reachable, noise)
    return with_hidden(instance, failing, blocked, service)


def existing_checkpoints_per_instance(source: RouteSource) -> int:
    """Return the number of checkpoints in a source's instances that exist.

    It is lower than `source.checkpoints` if the site does not have as many.
    """
    return (
        source.existing_checkpoint_count if isinstance(source, SiteRoutes) else source.checkpoints
    )
