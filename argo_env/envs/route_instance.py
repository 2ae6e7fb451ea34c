"""Route instances: travel times, prizes, precedence, a budget and hidden parts; and their scores.

The robot learns the hidden parts only on its way.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid

DOCK = 0
"""node where every route ends"""
TICK = 1 / 64
"""s. Times are whole ticks below 2^18 s, so their sums are exact in single precision in any order,
and the environment, its batch and `score_route` agree bit for bit."""
_TIME_LIMIT = 2.0**18  # s
MAX_CHECKPOINTS = 500
VISITED = MAX_CHECKPOINTS + 1
"""number that marks a visited checkpoint in an episode's copy of `missing_predecessors`: more than
there are checkpoints"""


@dataclass(frozen=True)
class RouteInstance:
    """Route problem with n checkpoints: nodes 1 to n; node 0 is the dock; row n + 1 the start."""

    arrival: NDArray[np.float32]
    """time (s) from the end of a visit to the end of the next one, with its measurement; inf
    without a path, and from the dock; shape (n + 2, n + 1): row from, column to"""
    prizes: NDArray[np.float64]
    """0 to 1, shape (n + 1,); the dock has 0"""
    before: NDArray[np.bool_]
    """True if the row must be visited before the column, shape (n + 1, n + 1)"""
    budget: float
    """s within which the robot must dock"""
    positions: NDArray[np.float64]
    """x, y (m) and floor, for pictures, shape (n + 2, 3)"""
    hidden: "Hidden | None" = None
    """parts that the robot does not know at the start; None if it knows all"""

    @property
    def node_count(self) -> int:
        """Number of nodes, with the dock."""
        return len(self.prizes)

    @property
    def start_row(self) -> int:
        """Index of the start's row in `arrival`, `positions` and the tables of the same shape."""
        return self.node_count

    @cached_property
    def time_to_dock_shares(self) -> NDArray[np.float32]:
        """Time from each node to the dock as a share of the budget, at most 1, shape (n + 1,)."""
        home: NDArray[np.float32] = np.minimum(
            self.arrival[: self.node_count, DOCK] / np.float32(self.budget), np.float32(1.0)
        )
        home[DOCK] = 0.0
        return home

    @cached_property
    def time_to_dock_via(self) -> NDArray[np.float32]:
        """Time (s) from a row's node to a column's, for the visit there, and on to the dock.

        It has the shape of `arrival`.
        """
        home = self.arrival[: self.node_count, DOCK].copy()
        home[DOCK] = 0.0
        return np.asarray(self.arrival + home, dtype=np.float32)

    @cached_property
    def travel_shares(self) -> NDArray[np.float32]:
        """`arrival` as a share of the budget, at most 1, of the same shape."""
        return np.asarray(np.minimum(self.arrival / np.float32(self.budget), np.float32(1.0)))

    @cached_property
    def missing_predecessors(self) -> NDArray[np.int16]:
        """Number of checkpoints that must precede each node, before any visit, shape (n + 1,)."""
        return np.asarray(self.before.sum(axis=0, dtype=np.int16))

    @cached_property
    def missing_decrease_by_visit(self) -> NDArray[np.int16]:
        """Numbers that the visit of a node (row) subtracts from `missing_predecessors`.

        The shape is (n + 1, n + 1). A number is 1 for each node that must come after the visited
        one, and -VISITED for itself, so that it does not become legal again: a node is legal only
        while its number in `missing_predecessors` is 0.
        """
        effect = self.before.astype(np.int16)
        np.fill_diagonal(effect, -VISITED)
        return effect

    @cached_property
    def time_to_dock_via_rows(self) -> list[NDArray[np.float32]]:
        """Rows of `time_to_dock_via`."""
        return list(self.time_to_dock_via)

    @cached_property
    def travel_share_rows(self) -> list[NDArray[np.float32]]:
        """Rows of `travel_shares`."""
        return list(self.travel_shares)

    @cached_property
    def budget_array(self) -> NDArray[np.float32]:
        """Budget (s) as an array of one number."""
        return np.array([self.budget], dtype=np.float32)

    def with_known_blockages_at(self, time: float) -> "RouteInstance":
        """Return the instance as the robot knows it at a time (s) after its start.

        If stairs were found blocked by then, it is a copy without hidden parts, whose travel times
        are those without these stairs. Otherwise it is this instance itself, hidden parts included.
        """
        changes = self._changes_by(time)
        return changes[-1].known if changes else self

    def known_blocked_at(self, time: float) -> "tuple[Stair, ...]":
        """Return the stairs that the robot knows to be blocked at a time (s) after its start."""
        changes = self._changes_by(time)
        return changes[-1].blocked if changes else ()

    def _changes_by(self, time: float) -> "list[Change]":
        changes = self.hidden.changes if self.hidden else ()
        return [change for change in changes if change.since <= time]


Stair = tuple[int, int]
"""number of the stair tower or of the floor's end, and number of the floor below"""


@dataclass(frozen=True)
class Change:
    """Blocked stairs that the robot finds on its way, and the travel times from then on."""

    since: float
    """s after the start; a drive that started earlier takes as long as if nothing had changed"""
    known: RouteInstance
    """instance with the travel times from then on, without hidden parts"""
    blocked: tuple[Stair, ...]
    """all stairs that are blocked by then"""


@dataclass(frozen=True)
class Hidden:
    """Parts of an instance that the robot learns only on its way.

    All of them are drawn beforehand, so an episode depends only on its instance and its actions.
    """

    failing: NDArray[np.int16]
    """number of visits of each node that give no reading, and so no prize, before one does, shape
    (n + 1,); the time of such a visit is spent, and the checkpoint stays open"""
    changes: tuple[Change, ...] = ()
    """in the order of time"""


def with_hidden(
    instance: RouteInstance,
    failing: NDArray[np.int16],
    blocked: Iterable[tuple[float, NDArray[np.float64], tuple[Stair, ...]]],
    service: NDArray[np.float64],
) -> RouteInstance:
    """Return a copy of the instance that has parts which the robot does not know at the start.

    Args:
        instance: The instance without them.
        failing: See `Hidden.failing`.
        blocked: Times (s) at which stairs are found blocked, in order, each with the travel times
            from then on and all stairs that are blocked by then.
        service: As for `make_instance`; the travel times are as there, too.
    """
    changes = []
    for since, times, stairs in blocked:
        arrival = _make_arrival(times, service)
        # So even a robot that is late docks before the limit, and sums of times stay exact.
        arrival[arrival >= _TIME_LIMIT - instance.budget] = np.inf
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
    positions: NDArray[np.float64],
) -> RouteInstance:
    """Make an instance, with times rounded up to whole ticks.

    Args:
        times: Travel times (s), shape (n + 2, n + 1), with the rows and columns of `RouteInstance`.
        service: Time (s) that the visit of each node takes, shape (n + 1,).
        prizes: See `RouteInstance.prizes`.
        pairs: Numbers (1 to n) of two checkpoints, the first of which must be visited before the
            second.
        budget: s within which the robot must dock.
        positions: See `RouteInstance.positions`.

    Raises:
        ArgoError: Shapes don't fit, there are too many checkpoints, a prize is not from 0 to 1, a
            time is negative, a checkpoint must precede itself, or the dock can't be reached in
            time.
    """
    n = len(prizes)
    if times.shape != (n + 1, n) or service.shape != (n,) or positions.shape != (n + 1, 3):
        raise Invalid(
            f"a route instance with {n - 1} checkpoints needs times of shape {(n + 1, n)}, "
            f"not {times.shape}, {n} service times and {n + 1} places"
        )
    if n - 1 > MAX_CHECKPOINTS:
        raise Invalid(f"a route has at most {MAX_CHECKPOINTS} checkpoints, not {n - 1}")
    if prizes.min() < 0.0 or prizes.max() > 1.0 or prizes[DOCK] != 0.0:
        raise Invalid("prizes are from 0 to 1, and 0 at the dock")
    if times.min() < 0.0 or service.min() < 0.0:
        raise Invalid("a travel or service time is negative")
    if not 0.0 < budget < _TIME_LIMIT:
        raise Invalid(f"a budget is more than 0 and less than {_TIME_LIMIT:.0f} s, not {budget:g}")
    arrival = _make_arrival(times, service)
    budget = float(np.floor(budget / TICK) * TICK)
    if arrival[n, DOCK] > budget:
        raise Invalid(f"the path from the start to the dock takes longer than {budget:g} s")
    before = np.zeros((n, n), dtype=np.bool_)
    for first, second in pairs:
        before[first, second] = True
    if np.diagonal(before).any():
        raise Invalid("the pairs require a checkpoint to be visited before itself")
    instance = RouteInstance(arrival, prizes.astype(np.float64), before, budget, positions)
    for array in (instance.arrival, instance.prizes, before, positions):
        array.setflags(write=False)
    return instance


def _make_arrival(times: NDArray[np.float64], service: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return `RouteInstance.arrival`."""
    arrival = np.ceil((times + service) / TICK) * TICK
    arrival[arrival >= _TIME_LIMIT] = np.inf
    arrival[DOCK] = np.inf
    return arrival.astype(np.float32)


@dataclass(frozen=True)
class Score:
    """Value of a route."""

    prize: float
    """0 if the robot docks too late"""
    time: float
    """s until the robot has docked"""
    visited: tuple[int, ...]
    """checkpoints that were read"""
    illegal: int | None
    """first node of the route that was illegal, and so not visited; None if all were legal"""
    late: bool = False
    """True if the robot docks after the end of the budget, which only blocked stairs can cause"""


def score_route(instance: RouteInstance, route: Sequence[int]) -> Score:
    """Return what a route, a sequence of checkpoints' nodes, wins on an instance, and its time.

    The robot goes to the dock at the end of the route, at a 0 (the dock) in it, or earlier if the
    next node would break a rule: it was visited already without failure, or it comes before a node
    that must precede it, or the robot would dock too late by what it knows when it leaves for that
    node.

    A visit that fails takes its time and gives no prize. Stairs that are found blocked on the way
    to a checkpoint may make the way back too long: a route that docks too late has prize 0.

    This is written to be read, and deliberately shares no code with the environment.
    """
    place, time, prize = instance.start_row, 0.0, 0.0
    visited: list[int] = []
    attempts = [0] * instance.node_count
    illegal = None
    for node in route:
        if node == DOCK:
            break
        times = _times_at(instance, time)
        arrived = time + float(times[place, node])
        docked = arrived + float(times[node, DOCK])
        predecessors = [k for k in range(instance.node_count) if instance.before[k, node]]
        if (
            node in visited
            or docked > instance.budget
            or any(k not in visited for k in predecessors)
        ):
            illegal = int(node)
            break
        place, time = node, arrived
        attempts[node] += 1
        if instance.hidden is None or attempts[node] > instance.hidden.failing[node]:
            prize += float(instance.prizes[node])
            visited.append(int(node))
    docked = time + float(_times_at(instance, time)[place, DOCK])
    late = docked > instance.budget
    return Score(0.0 if late else prize, docked, tuple(visited), illegal, late)


def _times_at(instance: RouteInstance, time: float) -> NDArray[np.float32]:
    """Return the travel times for a robot that leaves at this time (s)."""
    if instance.hidden is None:
        return instance.arrival
    known = [change for change in instance.hidden.changes if change.since <= time]
    return known[-1].known.arrival if known else instance.arrival
