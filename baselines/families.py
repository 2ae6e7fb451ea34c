"""Families of instances, and the test sets that policies are compared on."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.base.errors import NotFound
from argo_env.envs.route_instance import RouteInstance
from argo_env.envs.route_noise import NO_NOISE, RouteNoise
from argo_env.envs.route_sources import (
    NO_FAULTS,
    PRECEDENCE,
    TEST,
    RandomRoutes,
    RouteFaults,
    RouteSource,
    SiteRoutes,
)
from baselines.kept_times import kept_times

UNSEEN_SITES = tuple(
    f"generated:floors={floors},size={size},checkpoints=48,seed={seed}"
    for floors, size, seed in (
        (2, "24x16", 1_000_001), (3, "20x14", 1_000_002), (4, "20x14", 1_000_003),
        (5, "24x16", 1_000_004), (6, "20x14", 1_000_005),
    )
)  # fmt: skip
"""Generated sites that no policy is trained on: their seeds are those for testing. They are few, as
the ways of each take a quarter of a minute to find."""


@dataclass(frozen=True)
class InstanceFamily:
    """Instances of one kind."""

    checkpoints: int = 20
    sites: tuple[str, ...] = ("random",)
    """`random`, or names of sites, which take turns"""
    budget: float = 1200.0
    """s"""
    precedence: float = PRECEDENCE
    """share of checkpoints that another one must come before"""
    noise: RouteNoise = NO_NOISE

    @cached_property
    def source(self) -> RouteSource:
        """Makes the instances: also what an environment of this family is made with. The travel
        times of sites are those that are kept with the test sets, if they are."""
        sources = tuple(self._source(site) for site in self.sites)
        return sources[0] if len(sources) == 1 else TurnTaking(sources)

    def _source(self, site: str) -> RouteSource:
        if site == "random":
            return RandomRoutes(
                self.checkpoints, budget=self.budget, noise=self.noise, precedence=self.precedence
            )
        return SiteRoutes(
            self.checkpoints, site, self.budget, self.noise, self.precedence, kept_times(site)
        )


@dataclass(frozen=True)
class TurnTaking:
    """Several sources with the same number of checkpoints: instance k is of source k modulo their
    number."""

    sources: tuple[RouteSource, ...]

    @property
    def checkpoints(self) -> int:
        return self.sources[0].checkpoints

    @property
    def floors(self) -> int:
        return max(source.floors for source in self.sources)

    def draw(
        self, number: int, floors: Sequence[int] = (), faults: RouteFaults = NO_FAULTS
    ) -> RouteInstance:
        """See RouteSource."""
        return self.of(number).draw(number, floors, faults)

    def of(self, number: int) -> RouteSource:
        """The source that makes the instance of that number."""
        return self.sources[number % len(self.sources)]


@dataclass(frozen=True)
class InstanceSet:
    """Instances of a family that never change: another choice gets another name."""

    name: str
    """with its version at the end"""
    family: InstanceFamily
    numbers: range = TEST

    def checksum(self, instances: int | None = None) -> str:
        """A digest of all that the first instances (all) are, hidden things included."""
        sink = hashlib.sha256()
        for number in self.numbers[:instances]:
            _feed(sink, self.family.source.draw(number))
        return sink.hexdigest()[:16]


def _feed(sink: "hashlib._Hash", instance: RouteInstance) -> None:
    for array in (instance.arrival, instance.prizes, instance.before):
        sink.update(array.tobytes())
    sink.update(repr(instance.budget).encode())
    if instance.hidden is not None:
        sink.update(instance.hidden.failing.tobytes())
        for change in instance.hidden.changes:
            sink.update(repr(change.since).encode() + change.known.arrival.tobytes())


_NOISE = RouteNoise(failing=0.2, blocked=2)

TEST_SETS = {
    one.name: one
    for one in (
        InstanceSet("random-20-v1", InstanceFamily()),
        InstanceSet("random-40-v1", InstanceFamily(40)),
        InstanceSet("ordered-20-v1", InstanceFamily(precedence=0.8)),
        InstanceSet("umad-20-v1", InstanceFamily(sites=("umad",))),
        InstanceSet("generated-40-v1", InstanceFamily(40, UNSEEN_SITES)),
        InstanceSet("noisy-20-v1", InstanceFamily(noise=_NOISE)),
        InstanceSet("noisy-40-v1", InstanceFamily(40, noise=_NOISE)),
    )
}
"""By name. A set that is to be different gets a new version, and the old one stays."""


def find_set(name: str) -> InstanceSet:
    """The test set of that name; ArgoError if there is none."""
    if name not in TEST_SETS:
        raise NotFound(f"no test set `{name}`; there are: {', '.join(TEST_SETS)}")
    return TEST_SETS[name]
