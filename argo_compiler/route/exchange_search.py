"""Local search for problems with precedences: it exchanges two neighbouring stretches of a route.

It reverses no stretch, so it suits asymmetric times and precedences. This is the SOP-3-exchange of
L. M. Gambardella and M. Dorigo (INFORMS Journal on Computing 12, 2000), restricted to the nearest
nodes and to the parts of the route that changed last. Each iteration applies some random exchanges,
or ruin and recreate (see `argo_compiler.route.ruin_recreate`), and then all exchanges that save
cost. Simulated annealing decides whether to accept the result. Its runs, from a high to a low
temperature, double in length.

A line is a route as the search changes it, as nodes from start to end; it may still lack mandatory
steps. The state holds the current line of the annealing and the best line so far.
"""

from importlib import import_module
from importlib.util import find_spec
from threading import Lock, Thread
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.network import StepNetwork, build_network
from argo_compiler.route.problem import NEVER, Objective, RouteProblem, Visit
from argo_compiler.route.pruning import Pruned, prune
from argo_compiler.route.search import Search

_NEAR = 12
"""highest number of followers of a node with which exchanges are tried"""
_WORK_SLICE, _TIME_PER_WORK = 4_000_000, 7e-9
"""units of work between two checks of the time, and nominal s per unit"""
_FIRST_RUN = 0.5
"""length of the first annealing run in s"""
_HOT, _COLD = 2.0, 0.005
"""first and last temperature of a run, as multiples of the mean arc"""
_RUIN_SHARE = 0.7
"""share of ruin and recreate if there are optional steps, several modes, windows or a limit"""
_PRIZE_WEIGHT = 3.0
"""cost of a mean prize, as a multiple of the median arc"""


class ExchangeSearch:
    """Solver that improves the best known route, or searches for one, until the time is up."""

    name = "exchange search"

    def supports(self, problem: RouteProblem, /) -> bool:
        return problem.battery is None and problem.size > 1 and find_spec("numba") is not None

    def solve(self, search: Search, /) -> None:
        kernel = _Kernel.compiled(search)
        if kernel is None or search.network.node_count < 2:
            return
        kernel_network = _kernel_network(kernel, search.network, search.pruned)
        state = _initial_state(kernel, kernel_network, search.seed)
        worst = int(search.network.prize.sum()) + 1
        work, iterations, length = 0, 0, _FIRST_RUN
        while search.remaining_time() > 0.0:
            _restart(kernel, kernel_network, state, search)
            begun, remaining = search.elapsed_time(), search.remaining_time()
            length = remaining if remaining < 2.0 * length else length
            while (
                search.remaining_time() > 0.0
                and (passed := (search.elapsed_time() - begun) / length) < 1.0
            ):
                cost, missed = state[kernel.VALUES, 4:6].tolist()
                mean = state[kernel.VALUES, 1] / max(1, state[kernel.VALUES, 0])
                kernel.anneal(
                    kernel_network, state, _WORK_SLICE, _HOT * mean * (_COLD / _HOT) ** passed
                )
                done, tried = state[kernel.NUMBERS, [kernel.WORK, kernel.ITERATIONS]].tolist()
                search.spend((done - work) * _TIME_PER_WORK, tried - iterations)
                work, iterations = done, tried
                if (state[kernel.VALUES, 4:6].tolist() != [cost, missed]) and state[
                    kernel.VALUES, 5
                ] < worst:
                    search.offer(state[kernel.BEST, 1 : state[kernel.VALUES, 3] + 1].tolist())
            length *= 2.0


class _Kernel:
    """Compiled loops, which take some seconds to compile the first time."""

    _module: ModuleType | None = None
    _thread: Thread | None = None
    _lock = Lock()

    @classmethod
    def compiled(cls, search: Search) -> ModuleType | None:
        """Return the compiled module, or None if it is not ready within the search's time."""
        with cls._lock:
            if cls._thread is None:
                cls._thread = Thread(target=cls._compile)
                cls._thread.start()
        while cls._thread.is_alive() and (not search.timed or search.remaining_time() > 0.0):
            cls._thread.join(0.02)
        return cls._module

    @classmethod
    def _compile(cls) -> None:
        kernel = import_module("argo_compiler.route.exchange_kernel")
        example = RouteProblem((Visit(""),) * 5, np.ones((6, 6), np.int64))
        net = build_network(example, lambda step: tuple(step.parts))
        kernel_network = _kernel_network(kernel, net, prune(net))
        state = _initial_state(kernel, kernel_network, 0)
        kernel.set_line(kernel_network, state, state[kernel.LINE], 0)
        kernel.anneal(kernel_network, state, 1, 1.0)
        cls._module = kernel


def _restart(kernel: ModuleType, kernel_network: Any, state: Any, search: Search) -> None:
    """Set the line from which the next annealing run starts.

    It is the best route of all solvers if this is better than the best line of the annealing.
    Otherwise the run continues from the current line. The first run starts from an empty line if no
    solver has found a route yet.
    """
    best, m = search.best, search.network.node_count
    path = best.path if best is not None else None
    if path is None:
        path = () if state[kernel.VALUES, 3] < 0 else None
    if path is None:
        return
    line = np.zeros_like(state[kernel.LINE])
    line[: len(path) + 2] = [m, *path, m + 1]
    kernel.set_line(kernel_network, state, line, len(path))
    cost, missed = state[kernel.NUMBERS, [kernel.LENGTH, kernel.MISSED]].tolist()
    if state[kernel.VALUES, 3] < 0 or (missed, cost) < (
        state[kernel.VALUES, 5],
        state[kernel.VALUES, 4],
    ):
        state[kernel.VALUES, :6] = [len(path), cost, missed] * 2
        state[kernel.CURRENT] = state[kernel.BEST] = line
        state[kernel.QUEUE, : m + 2] = [m + 1, *range(m + 1)]
        state[kernel.QUEUED, : m + 1] = True
    else:
        kernel.set_line(kernel_network, state, state[kernel.CURRENT], state[kernel.VALUES, 0])


def _kernel_network(kernel: ModuleType, net: StepNetwork, pruned: Pruned) -> Any:
    m, steps = net.node_count, len(net.prize)
    time = np.full((m + 2, m + 2), kernel.NO_ARC)
    begun = np.minimum(net.time + np.append(net.service, 0)[:, None], kernel.NO_ARC)
    begun[:, :m][:, ~pruned.arcs[:, :m].any(axis=0)] = kernel.NO_ARC
    time[: m + 1, :m], time[: m + 1, m + 1] = begun[:, :m], begun[:, m]
    # Incomplete lines may have pruned arcs, so these keep their times and only leave `near`.
    unpruned = np.full_like(time, kernel.NO_ARC)
    arcs = np.where(pruned.arcs, begun, kernel.NO_ARC)
    unpruned[: m + 1, :m], unpruned[: m + 1, m + 1] = arcs[:, :m], arcs[:, m]
    near = np.argsort(unpruned, axis=1, kind="stable")[:, :_NEAR]
    near[np.take_along_axis(unpruned, near, axis=1) >= kernel.NO_ARC] = -1
    bits = np.zeros((m + 2, 64 * (m // 64 + 1)), np.uint8)
    bits[:m, :m] = pruned.before.T[np.ix_(net.step, net.step)]
    nodes = np.zeros((3, m + 2), np.int64)
    nodes[0, :m] = net.earliest[net.step]
    nodes[1] = np.append(pruned.latest, [NEVER, net.limit])
    nodes[2, :m] = net.step
    optional = pruned.needs & ~net.mandatory[:, None]
    needs = np.full((steps, max(1, int(optional.sum(axis=0).max(initial=0)))), -1)
    for s in range(steps):
        needed = np.flatnonzero(optional[:, s])
        needs[s, : len(needed)] = needed
    first = np.searchsorted(net.step, np.arange(steps + 1))
    prizes = np.append(np.where(net.mandatory, net.prize.sum() + 1, net.prize), 0)
    timed = net.has_windows or net.limit < NEVER
    waits = net.has_windows and net.objective is Objective.DURATION
    ruins = _RUIN_SHARE if timed or net.selective or m > steps else 0.0
    arc = np.median(time[time < kernel.NO_ARC]) if (time < kernel.NO_ARC).any() else 0.0
    return kernel.KernelNetwork(
        time,
        np.ascontiguousarray(near),  # a view has another type, for which numba compiles again
        np.packbits(bits, axis=1, bitorder="little").view(np.int64),
        nodes,
        np.stack([first, prizes, np.append(~net.mandatory, 0)]),
        needs,
        timed,
        waits,
        ruins,
        _PRIZE_WEIGHT * float(arc) / max(1.0, float(net.prize.mean())),
    )


def _initial_state(kernel: ModuleType, kernel_network: Any, seed: int) -> NDArray[np.int64]:
    """Return a state with an empty line, and without a current and a best line."""
    state = np.zeros((15, len(kernel_network.time) + 6), np.int64)
    state[kernel.LINE, :2] = len(kernel_network.time) - 2, len(kernel_network.time) - 1
    state[kernel.VALUES] = -1
    state[kernel.NUMBERS, kernel.RANDOM] = np.random.default_rng(seed).integers(1, 1 << 62)
    return state
