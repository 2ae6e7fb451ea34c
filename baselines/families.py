"""Families of instances, and the test sets on which policies are compared."""

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
from baselines.stored_times import load_site_times

UNSEEN_SITES = tuple(
    f"generated:floors={floors},size={size},checkpoints=48,seed={seed}"
    for floors, size, seed in (
        (2, "24x16", 1_000_001), (3, "20x14", 1_000_002), (4, "20x14", 1_000_003),
        (5, "24x16", 1_000_004), (6, "20x14", 1_000_005),
    )
)  # fmt: skip
"""Generated sites on which no policy is trained: their seeds are reserved for tests. They are few
because computing the travel times of one takes a quarter of a minute."""


@dataclass(frozen=True)
class InstanceFamily:
    """Parameters of instances of one kind."""

    checkpoints: int = 20
    """number of checkpoints of each instance"""
    sites: tuple[str, ...] = ("random",)
    """sites from which the instances are taken in turn: `random`, or names of sites"""
    budget: float = 1200.0
    """time budget of a route in s"""
    precedence: float = PRECEDENCE
    """share of checkpoints that must follow another one"""
    noise: RouteNoise = NO_NOISE

    @cached_property
    def source(self) -> RouteSource:
        """Source of the instances, which an environment of this family takes as its `source`.

        It has the travel times that are stored with the test sets, for the sites that have some.
        """
        sources = tuple(self._source(site) for site in self.sites)
        return sources[0] if len(sources) == 1 else AlternatingSources(sources)

    def _source(self, site: str) -> RouteSource:
        if site == "random":
            return RandomRoutes(
                self.checkpoints, budget=self.budget, noise=self.noise, precedence=self.precedence
            )
        return SiteRoutes(
            self.checkpoints, site, self.budget, self.noise, self.precedence, load_site_times(site)
        )


@dataclass(frozen=True)
class AlternatingSources:
    """A source that takes its instances in turn from n sources with equally many checkpoints.

    The instance with number k comes from the source with index k modulo n.
    """

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
        """Return the instance with this number; see `RouteSource.draw`."""
        return self.source_for(number).draw(number, floors, faults)

    def source_for(self, number: int) -> RouteSource:
        """Return the source that makes the instance with this number."""
        return self.sources[number % len(self.sources)]


@dataclass(frozen=True)
class InstanceSet:
    """A fixed set of instances of a family; a changed set gets another name."""

    name: str
    """name, with a version at the end"""
    family: InstanceFamily
    numbers: range = TEST
    """numbers of the instances"""

    def checksum(self, instances: int | None = None) -> str:
        """Return a digest of the first instances, hidden data included; None: of all instances."""
        digest = hashlib.sha256()
        for number in self.numbers[:instances]:
            _update_digest(digest, self.family.source.draw(number))
        return digest.hexdigest()[:16]


def _update_digest(digest: "hashlib._Hash", instance: RouteInstance) -> None:
    for array in (instance.arrival, instance.prizes, instance.before):
        digest.update(array.tobytes())
    digest.update(repr(instance.budget).encode())
    if instance.hidden is not None:
        digest.update(instance.hidden.failing.tobytes())
        for change in instance.hidden.changes:
            digest.update(repr(change.since).encode() + change.known.arrival.tobytes())


_NOISE = RouteNoise(failing=0.2, blocked=2)

TEST_SETS = {
    test_set.name: test_set
    for test_set in (
        InstanceSet("random-20-v1", InstanceFamily()),
        InstanceSet("random-40-v1", InstanceFamily(40)),
        InstanceSet("ordered-20-v1", InstanceFamily(precedence=0.8)),
        InstanceSet("umad-20-v1", InstanceFamily(sites=("umad",))),
        InstanceSet("generated-40-v1", InstanceFamily(40, UNSEEN_SITES)),
        InstanceSet("noisy-20-v1", InstanceFamily(noise=_NOISE)),
        InstanceSet("noisy-40-v1", InstanceFamily(40, noise=_NOISE)),
    )
}
"""Test sets by name. A changed set gets a new version, and the old one stays."""


def find_test_set(name: str) -> InstanceSet:
    """Return the test set with this name; raise ArgoError if there is none."""
    if name not in TEST_SETS:
        raise NotFound(f"no test set `{name}`; choose one of: {', '.join(TEST_SETS)}")
    return TEST_SETS[name]
