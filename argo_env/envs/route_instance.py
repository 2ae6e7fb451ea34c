"""A route instance: travel times, prizes, precedence and a budget, what of that the robot finds out
on its way only; and what a route is worth."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid

DOCK = 0
"""the node where every route ends"""
TICK = 1 / 64
"""s. Times are whole ticks, and below 2^18 s: so their sums are exact in single precision, in
whatever order they are made, and the environment, its batch and `score_route` agree to the bit."""
_LONGEST = 2.0**18  # s
MOST_CHECKPOINTS = 500
VISITED = MOST_CHECKPOINTS + 1
"""what a visited checkpoint waits for: more than there are"""


@dataclass(frozen=True)
class RouteInstance:
    """One problem with n checkpoints: the nodes 1 to n; node 0 is the dock; row n + 1 the start."""

    arrival: NDArray[np.float32]
    """s from the end of one visit to the end of the next, the measurement included, shape
    (n + 2, n + 1): row from, column to; inf where there is no way, and from the dock"""
    prizes: NDArray[np.float64]
    """0 to 1, shape (n + 1,); the dock has 0"""
    before: NDArray[np.bool_]
    """shape (n + 1, n + 1): whether row must be visited before column"""
    budget: float
    """s in which the robot has to be docked"""
    places: NDArray[np.float64]
    """x, y (m) and floor, for pictures, shape (n + 2, 3)"""
    hidden: "Hidden | None" = None
    """what the robot does not know when it sets off; None: it knows all"""

    @property
    def size(self) -> int:
        """The number of nodes, the dock included."""
        return len(self.prizes)

    @property
    def start(self) -> int:
        """The row of the place where the robot sets off."""
        return self.size

    @cached_property
    def home(self) -> NDArray[np.float32]:
        """The way to the dock as a share of the budget, at most 1, shape (n + 1,)."""
        home: NDArray[np.float32] = np.minimum(
            self.arrival[: self.size, DOCK] / np.float32(self.budget), np.float32(1.0)
        )
        home[DOCK] = 0.0
        return home

    @cached_property
    def need(self) -> NDArray[np.float32]:
        """s that a visit takes and the way to the dock after it, shape of `arrival`."""
        home = self.arrival[: self.size, DOCK].copy()
        home[DOCK] = 0.0
        return np.asarray(self.arrival + home, dtype=np.float32)

    @cached_property
    def travel(self) -> NDArray[np.float32]:
        """`arrival` as a share of the budget, 1 where it takes longer."""
        return np.asarray(np.minimum(self.arrival / np.float32(self.budget), np.float32(1.0)))

    @cached_property
    def missing(self) -> NDArray[np.int16]:
        """How many checkpoints must come before each node; a node is free at 0."""
        return np.asarray(self.before.sum(axis=0, dtype=np.int16))

    @cached_property
    def effect(self) -> NDArray[np.int16]:
        """What the visit of a node (row) takes from `missing`: one for each node that it must come
        before, and so much from itself that it is not free again."""
        effect = self.before.astype(np.int16)
        np.fill_diagonal(effect, -VISITED)
        return effect

    @cached_property
    def needs(self) -> list[NDArray[np.float32]]:
        """The rows of `need`."""
        return list(self.need)

    @cached_property
    def travels(self) -> list[NDArray[np.float32]]:
        """The rows of `travel`."""
        return list(self.travel)

    @cached_property
    def left(self) -> NDArray[np.float32]:
        """The budget as an array of one number."""
        return np.array([self.budget], dtype=np.float32)

    def at(self, time: float) -> "RouteInstance":
        """The instance as the robot knows it that long (s) after it set off."""
        changes = self._changes_until(time)
        return changes[-1].known if changes else self

    def blocked_at(self, time: float) -> "tuple[Stair, ...]":
        """The stairs that the robot knows to be blocked by that time (s)."""
        changes = self._changes_until(time)
        return changes[-1].blocked if changes else ()

    def _changes_until(self, time: float) -> "list[Change]":
        changes = self.hidden.changes if self.hidden else ()
        return [change for change in changes if change.since <= time]


Stair = tuple[int, int]
"""which of the ways up, and the number of the floor below"""


@dataclass(frozen=True)
class Change:
    """Stairs that are found blocked while the robot is on its way."""

    since: float
    """s after it set off; a drive that began before that takes as long as it would have"""
    known: RouteInstance
    """the instance with the travel times from then on, and nothing hidden"""
    blocked: tuple[Stair, ...]
    """all that are blocked by then"""


@dataclass(frozen=True)
class Hidden:
    """What the robot finds out on its way only. All of it is drawn beforehand: what happens in an
    episode follows from its instance and its actions."""

    failing: NDArray[np.int16]
    """how many visits of each node give no reading, and so no prize, before one does, shape
    (n + 1,): the time is spent, and the checkpoint is as if it had not been visited"""
    changes: tuple[Change, ...] = ()
    """in the order of time"""


def with_hidden(
    instance: RouteInstance,
    failing: NDArray[np.int16],
    blocked: Iterable[tuple[float, NDArray[np.float64], tuple[Stair, ...]]],
    service: NDArray[np.float64],
) -> RouteInstance:
    """The instance with something that the robot does not know: which visits fail, and from when
    (s) on travel times are others, in the order of time; times and service as `make_instance`
    takes them."""
    changes = []
    for since, times, stairs in blocked:
        arrival = _arrival(times, service)
        # A robot that is late is so by less than this: sums of times stay exact.
        arrival[arrival >= _LONGEST - instance.budget] = np.inf
        arrival.setflags(write=False)
        since = float(np.floor(since / TICK) * TICK)
        changes.append(Change(since, replace(instance, arrival=arrival), stairs))
    return replace(instance, hidden=Hidden(failing, tuple(changes)))


def make_instance(
    times: NDArray[np.float64],
    service: NDArray[np.float64],
    prizes: NDArray[np.float64],
    pairs: Iterable[tuple[int, int]],
    budget: float,
    places: NDArray[np.float64],
) -> RouteInstance:
    """An instance from travel times (s), shape (n + 2, n + 1) as in `RouteInstance`, and the time
    that the visit of each node takes (s), shape (n + 1,). Times are rounded up to whole ticks.

    Raises ArgoError if shapes don't fit, there are too many checkpoints, a prize is not from 0 to
    1, a time is negative or the dock can't be reached in time.
    """
    n = len(prizes)
    if times.shape != (n + 1, n) or service.shape != (n,) or places.shape != (n + 1, 3):
        raise Invalid(
            f"a route instance with {n - 1} checkpoints needs times of shape {(n + 1, n)}, "
            f"not {times.shape}, {n} service times and {n + 1} places"
        )
    if n - 1 > MOST_CHECKPOINTS:
        raise Invalid(f"a route has at most {MOST_CHECKPOINTS} checkpoints, not {n - 1}")
    if prizes.min() < 0.0 or prizes.max() > 1.0 or prizes[DOCK] != 0.0:
        raise Invalid("prizes are from 0 to 1, and 0 at the dock")
    if times.min() < 0.0 or service.min() < 0.0:
        raise Invalid("a travel or service time is negative")
    if not 0.0 < budget < _LONGEST:
        raise Invalid(f"a budget is more than 0 and less than {_LONGEST:.0f} s, not {budget:g}")
    arrival = _arrival(times, service)
    budget = float(np.floor(budget / TICK) * TICK)
    if arrival[n, DOCK] > budget:
        raise Invalid(f"the way from the start to the dock takes longer than {budget:g} s")
    before = np.zeros((n, n), dtype=np.bool_)
    for first, then in pairs:
        before[first, then] = True
    if np.diagonal(before).any():
        raise Invalid("a checkpoint is to be visited before itself")
    instance = RouteInstance(arrival, prizes.astype(np.float64), before, budget, places)
    for array in (instance.arrival, instance.prizes, before, places):
        array.setflags(write=False)
    return instance


def _arrival(times: NDArray[np.float64], service: NDArray[np.float64]) -> NDArray[np.float32]:
    """See `RouteInstance.arrival`."""
    arrival = np.ceil((times + service) / TICK) * TICK
    arrival[arrival >= _LONGEST] = np.inf
    arrival[DOCK] = np.inf
    return arrival.astype(np.float32)


@dataclass(frozen=True)
class Score:
    """What a route is worth."""

    prize: float
    """0 if the robot is docked too late"""
    time: float
    """s until the robot is docked"""
    visited: tuple[int, ...]
    """the checkpoints that were read"""
    illegal: int | None
    """the first node of the route that was not allowed, and not driven to"""
    late: bool = False
    """whether the robot is docked after the budget is over: only blocked stairs can do that"""


def score_route(instance: RouteInstance, route: Sequence[int]) -> Score:
    """What the route, nodes in order, is worth. The robot goes to the dock at its end, and already
    where it would break a rule: visit a node again or before its time, or be docked too late by
    what it knows when it sets off there.

    A visit that fails takes its time and counts for nothing. Stairs that are found blocked on the
    way to a checkpoint may make the way back too long: a route that is docked too late is worth 0.

    Written for reading, and on purpose without anything that the environment uses.
    """
    place, time, prize = instance.start, 0.0, 0.0
    visited: list[int] = []
    tries = [0] * instance.size
    illegal = None
    for node in route:
        if node == DOCK:
            break
        times = _times_at(instance, time)
        arrived = time + float(times[place, node])
        docked = arrived + float(times[node, DOCK])
        first = [k for k in range(instance.size) if instance.before[k, node]]
        if node in visited or docked > instance.budget or any(k not in visited for k in first):
            illegal = int(node)
            break
        place, time = node, arrived
        tries[node] += 1
        if instance.hidden is None or tries[node] > instance.hidden.failing[node]:
            prize += float(instance.prizes[node])
            visited.append(int(node))
    docked = time + float(_times_at(instance, time)[place, DOCK])
    late = docked > instance.budget
    return Score(0.0 if late else prize, docked, tuple(visited), illegal, late)


def _times_at(instance: RouteInstance, time: float) -> NDArray[np.float32]:
    """The travel times for a robot that sets off at that time."""
    if instance.hidden is None:
        return instance.arrival
    known = [change for change in instance.hidden.changes if change.since <= time]
    return known[-1].known.arrival if known else instance.arrival
