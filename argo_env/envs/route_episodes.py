"""Parts that single routes and batches share: the observation space, and the choice of instances.

An instance is chosen by the options and by a hash of seed and episode. Pools hold instances as
arrays.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, overload

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pydantic import StrictBool, StrictInt

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.options import (
    MAX_DURATION,
    check_floors,
    check_integer,
    check_positive,
    check_scenario_is_string,
    options_from_dict,
)
from argo_env.envs.route_instance import DOCK, MAX_CHECKPOINTS, RouteInstance
from argo_env.envs.route_noise import NO_NOISE, RouteNoise
from argo_env.envs.route_sources import (
    TEST,
    TRAINING,
    RandomRoutes,
    RouteFaults,
    RouteSource,
    SiteRoutes,
    existing_checkpoints_per_instance,
)

FPS = 4  # frames per second of films
_NAME = "argo/Route-v0"
_CACHED_INSTANCES = 256  # instances that a single environment caches
_UINT64_MASK = (1 << 64) - 1
UInt64Array = NDArray[np.uint64]


class RouteOptions(Model):
    """Options for `reset(options=...)` of Route-v0."""

    scenario: str | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: RouteFaults = RouteFaults()
    instance: StrictInt | tuple[StrictInt, ...] | None = None
    test: StrictBool = False

    @property
    def given_floors(self) -> tuple[int, ...]:
        """Floors that the option `floor` names; empty if it names none."""
        return (self.floor,) if isinstance(self.floor, int) else self.floor


@dataclass(frozen=True)
class InstancePool:
    """Instances as arrays with one row for each; `RouteInstance` describes their parts."""

    numbers: NDArray[np.int64]
    one_per_env: bool
    """True if row k belongs to environment k; otherwise rows are drawn"""
    stages: int
    """largest number of stages of knowledge of an instance: one more than the stairs that are found
    blocked"""
    arrival: NDArray[np.float32]
    """rows of all instances one below the other, each instance once for each stage"""
    time_to_dock_via: NDArray[np.float32]
    """as `arrival`"""
    travel_shares: NDArray[np.float32]
    """as `arrival`"""
    time_to_dock_shares: NDArray[np.float32]
    """one row for each stage of each instance"""
    before: NDArray[np.int8]
    missing_decrease_by_visit: NDArray[np.int16]
    """numbers that the visit of a node subtracts from `missing_predecessors`,
    shape (m * (n + 1), n + 1)"""
    missing_predecessors: NDArray[np.int16]
    prizes: NDArray[np.float64]
    budget: NDArray[np.float32]
    noisy: bool
    """True if the instances have hidden parts: the next two fields"""
    failing: NDArray[np.int16]
    since: NDArray[np.float32]
    """time (s) at which each stage but the first begins, shape (m, stages - 1)"""

    def pool_rows_for_envs(
        self, env_numbers: NDArray[np.int64], random_numbers: UInt64Array
    ) -> NDArray[np.int64]:
        """Return the row of the pool with the next episode's instance, for each environment given.

        Args:
            env_numbers: Numbers of the environments.
            random_numbers: One for each of them; unused if `one_per_env` is True.
        """
        if self.one_per_env:
            return env_numbers
        return (random_numbers % np.uint64(len(self.numbers))).astype(np.int64)


class Episodes:
    """Instances of the episodes, as the options choose them; it holds the options and a cache."""

    def __init__(
        self,
        checkpoints: int,
        scenario: str,
        budget: float,
        source: RouteSource | None,
        noise: Mapping[str, Any] | None = None,
    ) -> None:
        """Check the arguments; raise ArgoError if there is no such scenario or noise."""
        self._noise = NO_NOISE if noise is None else options_from_dict(RouteNoise, noise, _NAME)
        if source is None:
            check_scenario_is_string(_NAME, scenario)
            check_integer(_NAME, 1, MAX_CHECKPOINTS, checkpoints=checkpoints)
            check_positive(_NAME, MAX_DURATION, budget=budget)
        elif noise is not None:
            raise Invalid(
                f"{_NAME}: `noise` and `source`: a source has a noise of its own; "
                "give one of the two"
            )
        self._given_source = source
        self._scenario = scenario
        self._budget = budget
        self._checkpoints = source.checkpoints if source else int(checkpoints)
        self.size = self._checkpoints + 1
        self.apply_options(RouteOptions())

    def apply_options(self, options: RouteOptions) -> None:
        """Set the options for the instances of the episodes that begin from now on."""
        self.options = options
        self.source = self.source_for(options)
        self.instance = lru_cache(maxsize=_CACHED_INSTANCES)(self._draw)
        self._pool: InstancePool | None = None

    def scenario_name_for_messages(self, options: RouteOptions) -> str:
        """Return the name of the scenario with these options, for messages."""
        if options.scenario is None and self._given_source is not None:
            return "of the `source`"
        return options.scenario or self._scenario

    def source_for(self, options: RouteOptions) -> RouteSource:
        """Return the source of the instances: the one that the options name, or the usual one.

        The usual one is that of the arguments with which the environment was made.
        """
        if options.scenario is None and self._given_source is not None:
            return self._given_source
        scenario = self.scenario_name_for_messages(options)
        if scenario == "random":
            return RandomRoutes(self._checkpoints, budget=self._budget, noise=self._noise)
        return _site_routes(self._checkpoints, scenario, self._budget, self._noise)

    @property
    def instance_numbers(self) -> range | tuple[int, ...]:
        """Numbers from which episodes draw: the option's, TEST if options say so, else TRAINING."""
        if isinstance(self.options.instance, int):
            return (self.options.instance,)
        return self.options.instance or (TEST if self.options.test else TRAINING)

    @property
    def pool(self) -> InstancePool:
        """Pool of all instances from which episodes draw; made anew after `apply_options`."""
        if self._pool is None:
            source = self.source
            # A source from elsewhere may give different instances each time.
            if type(source) is RandomRoutes:
                self._pool = _shared_pool(source, self.options, self.instance_numbers)
            else:
                self._pool = _make_pool(source, self.options, self.instance_numbers)
        return self._pool

    def _draw(self, number: int) -> RouteInstance:
        return _draw_instance(self.source, self.options, number)


def route_options_from_dict(
    given: Mapping[str, Any], episodes: Episodes, batch_size: int | None = None
) -> RouteOptions:
    """Return the options of a `reset` as an object, checked for the environment's `episodes`.

    `batch_size` is the number of environments; None: it is a single one without a batch. Raises
    ArgoError if the options are invalid. They are not applied yet.
    """
    options = options_from_dict(RouteOptions, given, _NAME)
    if options.instance is not None:
        _check_instance(options, batch_size)
    source, scenario = episodes.source_for(options), episodes.scenario_name_for_messages(options)
    check_floors(scenario, range(1, source.floors + 1), options.given_floors)
    available, slots = existing_checkpoints_per_instance(source), episodes.size - 1
    if options.faults.closed > available:
        of = f"scenario {scenario}" if available < slots else "a route"
        more = "" if available < slots else ", or make the environment with more `checkpoints`"
        raise Invalid(
            f"option `faults.closed` of {_NAME} is {options.faults.closed}, and has to be 0 to "
            f"{available}: {of} has {available} checkpoints; close fewer{more}"
        )
    return options


def _check_instance(options: RouteOptions, count: int | None) -> None:
    """Raise ArgoError if `options.instance` is wrong, or if other options choose instances too.

    `count` is the number of environments; None: it is a single one without a batch.
    """
    given = options.instance
    numbers = given if isinstance(given, tuple) else (given,)
    if isinstance(given, tuple) and len(given) != count:
        expected = "one number" if count is None else f"one number, or one for each of {count}"
        raise Invalid(f"option `instance` of {_NAME} is {expected}, not {len(given)} numbers")
    for number in numbers:
        if number not in TRAINING and number not in TEST:
            raise NotFound(
                f"option `instance` of {_NAME}: there is no instance {number}, only "
                f"{TRAINING[0]} to {TRAINING[-1]} (training) and {TEST[0]} to {TEST[-1]} (test); "
                "leave `instance` out to have one drawn"
            )
    if options.test:
        raise Invalid(
            f"options `instance` and `test` of {_NAME}: `instance` says which it is, and `test` "
            f"draws one of {TEST[0]} to {TEST[-1]}; give one of the two"
        )
    if options.scenario is not None:
        raise Invalid(
            f"options `instance` and `scenario` of {_NAME}: `instance` is one of the instances of "
            "the scenario that the environment was made with; give one of the two, or make the "
            f"environment with scenario={options.scenario!r}"
        )


@overload
def episode_hash(key: int, episode: int) -> int: ...
@overload
def episode_hash(key: UInt64Array, episode: UInt64Array) -> UInt64Array: ...
def episode_hash(key: Any, episode: Any) -> Any:
    """Return a random-like 64-bit number that determines which instance an episode gets.

    It is output number `episode`, from 0, of splitmix64 that started at `key` (Steele, Lea and
    Flood, "Fast splittable pseudorandom number generators", 2014).
    """
    if isinstance(key, int):
        z = (key + (episode + 1) * 0x9E3779B97F4A7C15) & _UINT64_MASK
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _UINT64_MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _UINT64_MASK
        return z ^ (z >> 31)
    # Arrays of 64-bit words wrap around by themselves.
    z = key + (episode + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def _draw_instance(source: RouteSource, options: RouteOptions, number: int) -> RouteInstance:
    return source.draw(number, options.given_floors, options.faults)


def _make_pool(
    source: RouteSource, options: RouteOptions, numbers: range | tuple[int, ...]
) -> InstancePool:
    """Return a pool of the instances with these numbers."""
    instances = [_draw_instance(source, options, number) for number in numbers]
    one_per_env = isinstance(options.instance, tuple)
    changes = [m.hidden.changes if m.hidden else () for m in instances]
    stages = 1 + max(map(len, changes))
    since = np.full((len(instances), stages - 1), np.inf, np.float32)
    known = []
    for row, (instance, instance_changes) in enumerate(zip(instances, changes, strict=True)):
        since[row, : len(instance_changes)] = [change.since for change in instance_changes]
        known += [instance, *(change.known for change in instance_changes)]
        known += [known[-1]] * (stages - 1 - len(instance_changes))
    no_failures = np.zeros(instances[0].node_count, np.int16)
    return InstancePool(
        numbers=np.array(numbers, dtype=np.int64),
        one_per_env=one_per_env,
        stages=stages,
        arrival=np.concatenate([_arrival_at_rest(k) for k in known]),
        time_to_dock_via=np.concatenate([k.time_to_dock_via for k in known]),
        travel_shares=np.concatenate([k.travel_shares for k in known]),
        time_to_dock_shares=np.stack([k.time_to_dock_shares for k in known]),
        before=np.stack([m.before for m in instances]).astype(np.int8),
        missing_decrease_by_visit=np.concatenate([m.missing_decrease_by_visit for m in instances]),
        missing_predecessors=np.stack([m.before.sum(axis=0, dtype=np.int16) for m in instances]),
        prizes=np.stack([m.prizes for m in instances]),
        budget=np.array([m.budget for m in instances], dtype=np.float32),
        noisy=any(m.hidden is not None for m in instances),
        failing=np.stack([m.hidden.failing if m.hidden else no_failures for m in instances]),
        since=since,
    )


_shared_pool = lru_cache(maxsize=2)(_make_pool)
"""`_make_pool` with a cache: pools take seconds to make and do not change, so that all batches of a
process can share them"""


def _arrival_at_rest(instance: RouteInstance) -> NDArray[np.float32]:
    """Return `arrival`, but with no time from dock to dock, for a robot that has docked."""
    arrival = instance.arrival.copy()
    arrival[DOCK, DOCK] = 0.0
    return arrival


@lru_cache(maxsize=16)
def _site_routes(checkpoints: int, scenario: str, budget: float, noise: RouteNoise) -> SiteRoutes:
    source = SiteRoutes(checkpoints, scenario, budget, noise)
    source.require_site_and_blockable_stairs()
    return source


def observation_space(node_count: int, full: bool) -> spaces.Space[Observation]:
    """Return the observation space of Route-v0 for `node_count` nodes, with the dock.

    With `full`, observations also have `matrix`, `before` and `place`.
    """
    share = spaces.Box(0.0, 1.0, (node_count,), np.float32)
    parts: dict[str, spaces.Space[Any]] = {
        "travel": share,
        "home": share,
        "prize": share,
        "left": spaces.Box(0.0, 1.0, (1,), np.float32),
        "mask": spaces.MultiBinary(node_count),
    }
    if full:
        parts["matrix"] = spaces.Box(0.0, 1.0, (node_count + 1, node_count), np.float32)
        parts["before"] = spaces.MultiBinary((node_count, node_count))
        parts["place"] = spaces.Discrete(node_count + 1)
    return dict_space(parts)
