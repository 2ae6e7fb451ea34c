"""Local search where order counts: two neighbouring stretches of a route change places.

No stretch is turned round, so that neither one-way times nor precedence stand in the way: the
SOP-3-exchange of L. M. Gambardella and M. Dorigo (INFORMS Journal on Computing 12, 2000), with the
nearest nodes and the last changes only. Some random exchanges, or ruin and recreate (see
`argo_compiler.route.ruin_recreate`), then all that pay: what comes out is taken by simulated
annealing, in rounds of which each is twice as long.
"""

from importlib import import_module
from importlib.util import find_spec
from threading import Lock, Thread
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork, network
from argo_compiler.route.problem import NEVER, Objective, RouteProblem, Visit
from argo_compiler.route.pruning import Pruned, prune
from argo_compiler.route.search import Search

_NEAR = 12
"""nodes that may follow another one, with which exchanges are tried"""
_SLICE, _NOMINAL = 4_000_000, 7e-9
"""work at a time, and s for each of it"""
_ROUND = 0.5
"""s of the first round"""
_HOT, _COLD = 2.0, 0.005
"""by how much a route that is taken is worse on average, in mean arcs"""
_RUINS = 0.7
"""share of ruin and recreate where there is a choice of nodes, or time"""
_PRIZE = 3.0
"""what a mean prize weighs, in mean arcs"""


class ExchangeSearch:
    """Improves the best route that is known, or looks for one, until the time is over."""

    name = "exchange search"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.battery is None and problem.size > 1 and find_spec("numba") is not None

    def solve(self, search: Search, /) -> None:
        kernel = _Kernel.compiled(search)
        if kernel is None or search.network.size < 2:
            return
        ways = _ways(kernel, search.network, search.pruned)
        state = _state(kernel, ways, search.seed)
        worst = int(search.network.prize.sum()) + 1
        work, iterations, length = 0, 0, _ROUND
        while search.remaining() > 0.0:
            _begin(kernel, ways, state, search)
            begun, left = search.now(), search.remaining()
            length = left if left < 2.0 * length else length
            while search.remaining() > 0.0 and (passed := (search.now() - begun) / length) < 1.0:
                cost, missed = state[kernel.WORTH, 4:6].tolist()
                mean = state[kernel.WORTH, 1] / max(1, state[kernel.WORTH, 0])
                kernel.run(ways, state, _SLICE, _HOT * mean * (_COLD / _HOT) ** passed)
                done, tried = state[kernel.NUMBERS, [kernel.WORK, kernel.ITERATIONS]].tolist()
                search.spend((done - work) * _NOMINAL, tried - iterations)
                work, iterations = done, tried
                if (state[kernel.WORTH, 4:6].tolist() != [cost, missed]) and state[
                    kernel.WORTH, 5
                ] < worst:
                    search.offer(state[kernel.BEST, 1 : state[kernel.WORTH, 3] + 1].tolist())
            length *= 2.0


class _Kernel:
    """The compiled loops, which take some seconds the first time."""

    _module: ModuleType | None = None
    _thread: Thread | None = None
    _lock = Lock()

    @classmethod
    def compiled(cls, search: Search) -> ModuleType | None:
        """Them; None if they are not ready within the search's time."""
        with cls._lock:
            if cls._thread is None:
                cls._thread = Thread(target=cls._compile)
                cls._thread.start()
        while cls._thread.is_alive() and (not search.timed or search.remaining() > 0.0):
            cls._thread.join(0.02)
        return cls._module

    @classmethod
    def _compile(cls) -> None:
        kernel = import_module("argo_compiler.route.exchange_kernel")
        some = RouteProblem((Visit(""),) * 5, np.ones((6, 6), np.int64))
        net = network(some, lambda step: tuple(step.parts))
        ways = _ways(kernel, net, prune(net))
        state = _state(kernel, ways, 0)
        kernel.put(ways, state, state[kernel.LINE], 0)
        kernel.run(ways, state, 1, 1.0)
        cls._module = kernel


def _begin(kernel: ModuleType, ways: Any, state: Any, search: Search) -> None:
    """Goes on from the best route that is known, if that is better than the search's own."""
    best, m = search.best, search.network.size
    path = best.path if best is not None else None
    if path is None:
        path = () if state[kernel.WORTH, 3] < 0 else None
    if path is None:
        return
    line = np.zeros_like(state[kernel.LINE])
    line[: len(path) + 2] = [m, *path, m + 1]
    kernel.put(ways, state, line, len(path))
    cost, missed = state[kernel.NUMBERS, [kernel.LENGTH, kernel.MISSED]].tolist()
    if state[kernel.WORTH, 3] < 0 or (missed, cost) < (
        state[kernel.WORTH, 5],
        state[kernel.WORTH, 4],
    ):
        state[kernel.WORTH, :6] = [len(path), cost, missed] * 2
        state[kernel.KEPT] = state[kernel.BEST] = line
        state[kernel.QUEUE, : m + 2] = [m + 1, *range(m + 1)]
        state[kernel.QUEUED, : m + 1] = True
    else:
        kernel.put(ways, state, state[kernel.KEPT], state[kernel.WORTH, 0])


def _ways(kernel: ModuleType, net: StepNetwork, pruned: Pruned) -> Any:
    m, steps = net.size, len(net.prize)
    time = np.full((m + 2, m + 2), kernel.NO_WAY)
    begun = np.minimum(net.time + np.append(net.service, 0)[:, None], kernel.NO_WAY)
    begun[:, :m][:, ~pruned.arcs[:, :m].any(axis=0)] = kernel.NO_WAY
    time[: m + 1, :m], time[: m + 1, m + 1] = begun[:, :m], begun[:, m]
    # Arcs that no whole route has are still those of lines in which something is missing.
    likely = np.full_like(time, kernel.NO_WAY)
    arcs = np.where(pruned.arcs, begun, kernel.NO_WAY)
    likely[: m + 1, :m], likely[: m + 1, m + 1] = arcs[:, :m], arcs[:, m]
    near = np.argsort(likely, axis=1, kind="stable")[:, :_NEAR]
    near[np.take_along_axis(likely, near, axis=1) >= kernel.NO_WAY] = -1
    bits = np.zeros((m + 2, 64 * (m // 64 + 1)), np.uint8)
    bits[:m, :m] = pruned.before.T[np.ix_(net.step, net.step)]
    nodes = np.zeros((3, m + 2), np.int64)
    nodes[0, :m] = net.earliest[net.step]
    nodes[1] = np.append(pruned.latest, [NEVER, net.limit])
    nodes[2, :m] = net.step
    optional = pruned.needs & ~net.mandatory[:, None]
    needs = np.full((steps, max(1, int(optional.sum(axis=0).max(initial=0)))), -1)
    for s in range(steps):
        some = np.flatnonzero(optional[:, s])
        needs[s, : len(some)] = some
    first = np.searchsorted(net.step, np.arange(steps + 1))
    worth = np.append(np.where(net.mandatory, net.prize.sum() + 1, net.prize), 0)
    timed = net.windowed or net.limit < NEVER
    waits = net.windowed and net.objective is Objective.DURATION
    ruins = _RUINS if timed or net.selective or m > steps else 0.0
    arc = np.median(time[time < kernel.NO_WAY]) if (time < kernel.NO_WAY).any() else 0.0
    return kernel.Ways(
        time,
        np.ascontiguousarray(near),  # a part of rows is another type, and compiled again
        np.packbits(bits, axis=1, bitorder="little").view(np.int64),
        nodes,
        np.stack([first, worth, np.append(~net.mandatory, 0)]),
        needs,
        timed,
        waits,
        ruins,
        _PRIZE * float(arc) / max(1.0, float(net.prize.mean())),
    )


def _state(kernel: ModuleType, ways: Any, seed: int) -> NDArray[np.int64]:
    """With an empty line, and none that is the best."""
    state = np.zeros((15, len(ways.time) + 6), np.int64)
    state[kernel.LINE, :2] = len(ways.time) - 2, len(ways.time) - 1
    state[kernel.WORTH] = -1
    state[kernel.NUMBERS, kernel.RANDOM] = np.random.default_rng(seed).integers(1, 1 << 62)
    return state
