"""What single routes and batches share: the observation space, and which instance an episode has:
options, a hash of seed and episode, and instances in arrays."""

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
    LONGEST,
    check_floors,
    check_positive,
    check_scenario,
    check_whole,
    read_options,
)
from argo_env.envs.route_instance import DOCK, MOST_CHECKPOINTS, RouteInstance
from argo_env.envs.route_noise import NO_NOISE, RouteNoise
from argo_env.envs.route_sources import (
    TEST,
    TRAINING,
    RandomRoutes,
    RouteFaults,
    RouteSource,
    SiteRoutes,
    existing,
)

FPS = 4  # of films
_NAME = "argo/Route-v0"
_KEPT = 256  # instances that a single environment keeps
_WORD = (1 << 64) - 1
Words = NDArray[np.uint64]


class RouteOptions(Model):
    """What `reset(options=...)` of Route-v0 may say."""

    scenario: str | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: RouteFaults = RouteFaults()
    instance: StrictInt | tuple[StrictInt, ...] | None = None
    test: StrictBool = False

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


@dataclass(frozen=True)
class InstancePool:
    """Instances in arrays, one row for each; see `RouteInstance` for what they are."""

    numbers: NDArray[np.int64]
    each: bool
    """whether row k belongs to environment k, in place of being drawn"""
    stages: int
    """how many states of knowledge an instance has at most: one more than stairs are blocked"""
    arrival: NDArray[np.float32]
    """this and the next two with the rows of all instances one below the other, each instance as
    often as there are stages"""
    need: NDArray[np.float32]
    travel: NDArray[np.float32]
    home: NDArray[np.float32]
    """likewise, one row for each stage of an instance"""
    before: NDArray[np.int8]
    effect: NDArray[np.int16]
    """shape (m * (n + 1), n + 1): what the visit of a node takes from `missing`"""
    missing: NDArray[np.int16]
    prizes: NDArray[np.float64]
    budget: NDArray[np.float32]
    noisy: bool
    """whether the instances have something hidden, which is:"""
    failing: NDArray[np.int16]
    since: NDArray[np.float32]
    """s, when each but the first stage begins, shape (m, stages - 1)"""

    def choose(self, rows: NDArray[np.int64], drawn: Words) -> NDArray[np.int64]:
        """The row of the pool for each environment."""
        if self.each:
            return rows
        return (drawn % np.uint64(len(self.numbers))).astype(np.int64)


class Episodes:
    """Gives the instances that the options ask for. Holds the options and what it has made."""

    def __init__(
        self,
        checkpoints: int,
        scenario: str,
        budget: float,
        source: RouteSource | None,
        noise: Mapping[str, Any] | None = None,
    ) -> None:
        """Raises ArgoError if there is no such scenario or noise."""
        self._noise = NO_NOISE if noise is None else read_options(RouteNoise, noise, _NAME)
        if source is None:
            check_scenario(_NAME, scenario)
            check_whole(_NAME, 1, MOST_CHECKPOINTS, checkpoints=checkpoints)
            check_positive(_NAME, LONGEST, budget=budget)
        elif noise is not None:
            raise Invalid(
                f"{_NAME}: `noise` and `source`: a source makes its instances with the noise that "
                "it was made with; give one of the two"
            )
        self._own = source
        self._scenario = scenario
        self._budget = budget
        self._checkpoints = source.checkpoints if source else int(checkpoints)
        self.size = self._checkpoints + 1
        self.choose(RouteOptions())

    def choose(self, options: RouteOptions) -> None:
        """From now on instances are as the options say."""
        self.options = options
        self.source = self.source_of(options)
        self.instance = lru_cache(maxsize=_KEPT)(self._draw)
        self._pool: InstancePool | None = None

    def scenario_of(self, options: RouteOptions) -> str:
        """What messages call the scenario that the options ask for."""
        if options.scenario is None and self._own is not None:
            return "of the `source`"
        return options.scenario or self._scenario

    def source_of(self, options: RouteOptions) -> RouteSource:
        """The source that the options ask for."""
        if options.scenario is None and self._own is not None:
            return self._own
        scenario = self.scenario_of(options)
        if scenario == "random":
            return RandomRoutes(self._checkpoints, budget=self._budget, noise=self._noise)
        return _site_routes(self._checkpoints, scenario, self._budget, self._noise)

    @property
    def numbers(self) -> range | tuple[int, ...]:
        """The numbers of the instances that episodes draw from."""
        if isinstance(self.options.instance, int):
            return (self.options.instance,)
        return self.options.instance or (TEST if self.options.test else TRAINING)

    @property
    def pool(self) -> InstancePool:
        """All instances that episodes draw from, made when they are asked for."""
        if self._pool is None:
            source = self.source
            # A source of somebody else's may give other instances each time.
            if type(source) is RandomRoutes:
                self._pool = _shared_pool(source, self.options, self.numbers)
            else:
                self._pool = _make_pool(source, self.options, self.numbers)
        return self._pool

    def _draw(self, number: int) -> RouteInstance:
        return _drawn(self.source, self.options, number)


def read_route_options(
    given: Mapping[str, Any], episodes: Episodes, count: int | None = None
) -> RouteOptions:
    """The options, checked, for one environment or for a batch of `count`; else ArgoError."""
    options = read_options(RouteOptions, given, _NAME)
    if options.instance is not None:
        _check_instance(options, count)
    source, scenario = episodes.source_of(options), episodes.scenario_of(options)
    check_floors(scenario, range(1, source.floors + 1), options.floors)
    there, slots = existing(source), episodes.size - 1
    if options.faults.closed > there:
        of = f"scenario {scenario}" if there < slots else "a route"
        more = "" if there < slots else ", or make the environment with more `checkpoints`"
        raise Invalid(
            f"option `faults.closed` of {_NAME} is {options.faults.closed}, and has to be 0 to "
            f"{there}: {of} has {there} checkpoints; close fewer{more}"
        )
    return options


def _check_instance(options: RouteOptions, count: int | None) -> None:
    """Raises ArgoError if there are no such instances, or other options choose instances too."""
    given = options.instance
    numbers = given if isinstance(given, tuple) else (given,)
    if isinstance(given, tuple) and len(given) != count:
        wanted = "one number" if count is None else f"one number, or one for each of {count}"
        raise Invalid(f"option `instance` of {_NAME} is {wanted}, not {len(given)} numbers")
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
def episode_number(key: int, episode: int) -> int: ...
@overload
def episode_number(key: Words, episode: Words) -> Words: ...
def episode_number(key: Any, episode: Any) -> Any:
    """A number of 64 bits for each episode of an environment: the outputs of splitmix64 (Steele,
    Lea and Flood, "Fast splittable pseudorandom number generators", 2014) that began at `key`."""
    if isinstance(key, int):
        z = (key + (episode + 1) * 0x9E3779B97F4A7C15) & _WORD
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _WORD
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _WORD
        return z ^ (z >> 31)
    # Arrays of words wrap around by themselves.
    z = key + (episode + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def _drawn(source: RouteSource, options: RouteOptions, number: int) -> RouteInstance:
    return source.draw(number, options.floors, options.faults)


def _make_pool(
    source: RouteSource, options: RouteOptions, numbers: range | tuple[int, ...]
) -> InstancePool:
    """The instances with these numbers in arrays."""
    made = [_drawn(source, options, number) for number in numbers]
    each = isinstance(options.instance, tuple)
    changes = [m.hidden.changes if m.hidden else () for m in made]
    stages = 1 + max(map(len, changes))
    since = np.full((len(made), stages - 1), np.inf, np.float32)
    known = []
    for row, (instance, found) in enumerate(zip(made, changes, strict=True)):
        since[row, : len(found)] = [change.since for change in found]
        known += [instance, *(change.known for change in found)]
        known += [known[-1]] * (stages - 1 - len(found))
    nothing = np.zeros(made[0].size, np.int16)
    return InstancePool(
        numbers=np.array(numbers, dtype=np.int64),
        each=each,
        stages=stages,
        arrival=np.concatenate([_resting(k) for k in known]),
        need=np.concatenate([k.need for k in known]),
        travel=np.concatenate([k.travel for k in known]),
        home=np.stack([k.home for k in known]),
        before=np.stack([m.before for m in made]).astype(np.int8),
        effect=np.concatenate([m.effect for m in made]),
        missing=np.stack([m.before.sum(axis=0, dtype=np.int16) for m in made]),
        prizes=np.stack([m.prizes for m in made]),
        budget=np.array([m.budget for m in made], dtype=np.float32),
        noisy=any(m.hidden is not None for m in made),
        failing=np.stack([m.hidden.failing if m.hidden else nothing for m in made]),
        since=since,
    )


_shared_pool = lru_cache(maxsize=2)(_make_pool)
"""What takes seconds to make and nobody changes, once for all batches of a process."""


def _resting(instance: RouteInstance) -> NDArray[np.float32]:
    """`arrival`, with no time passing for a robot that is docked already."""
    arrival = instance.arrival.copy()
    arrival[DOCK, DOCK] = 0.0
    return arrival


@lru_cache(maxsize=16)
def _site_routes(checkpoints: int, scenario: str, budget: float, noise: RouteNoise) -> SiteRoutes:
    source = SiteRoutes(checkpoints, scenario, budget, noise)
    source.check()
    return source


def observation_space(size: int, full: bool) -> spaces.Space[Observation]:
    """The space of the observations with `size` nodes."""
    share = spaces.Box(0.0, 1.0, (size,), np.float32)
    parts: dict[str, spaces.Space[Any]] = {
        "travel": share,
        "home": share,
        "prize": share,
        "left": spaces.Box(0.0, 1.0, (1,), np.float32),
        "mask": spaces.MultiBinary(size),
    }
    if full:
        parts["matrix"] = spaces.Box(0.0, 1.0, (size + 1, size), np.float32)
        parts["before"] = spaces.MultiBinary((size, size))
        parts["place"] = spaces.Discrete(size + 1)
    return dict_space(parts)
