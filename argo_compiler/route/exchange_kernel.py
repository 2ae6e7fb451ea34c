"""Loops of `argo_compiler.route.exchange_search`, compiled by numba, which takes some seconds.

A line is the start (node m), the nodes of a route and the end (node m + 1); nodes that are not in
it have the position -1. Cut k of a line is directly after its position k.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.int64]
_Function = TypeVar("_Function", bound=Callable[..., object])
NO_ARC = 1 << 40
"""time of an arc that does not exist"""
_LONGEST_STRETCH, _AROUND = 30, 20
"""highest number of nodes in a stretch of a random exchange, and highest distance of its begin
from the other random exchanges"""
_MOST_REMOVED, _LONGEST_RUN = 10, 4
"""highest number of nodes that are removed at a time, and of consecutive ones among them"""
State = Vector
"""state of the search, with buffers, shape (15, m + 8); its rows follow"""
LINE, POSITION, NODE_OF_STEP, CURRENT, BEST = range(5)
"""rows: nodes of the line by position; position of each node; node of each step, -1: none; nodes of
the current line of the annealing, to which a rejected line returns; nodes of the best line"""
BEGIN, REST, EARLIEST_END, LATEST_BEGIN = range(5, 9)
"""rows by position: begin; time from there to the end without waiting; earliest end that the
windows from there on allow; latest begin"""
QUEUE, QUEUED, SPARE, BITS, VALUES, NUMBERS = range(9, 15)
"""rows: nodes after which to try cuts, from entry 1 (entry 0: their number); 1 for each node in the
queue; buffer; buffer; node count, cost and missed prize of `CURRENT`, and of `BEST`; the numbers
that follow"""
COUNT, LENGTH, MISSED, RANDOM, WORK, ITERATIONS = range(6)
"""entries of `NUMBERS`: number of nodes in the line, its cost, the prize that it misses; state of
the random generator; work and iterations so far"""


class KernelNetwork(NamedTuple):
    """Network as arrays; those by node have m + 2 entries."""

    time: Vector
    """time from the begin of row to the begin of column, shape (m + 2, m + 2)"""
    near: Vector
    """nodes that may follow each node, the nearest first; -1: no more"""
    before: Vector
    """bits, for each node, of the nodes that can't come after it"""
    nodes: Vector
    """rows by node: earliest begin, latest begin, step"""
    steps: Vector
    """rows by step: first node (the nodes of a step are consecutive), prize (for mandatory steps
    more than all prizes together), 1 if it is optional"""
    needs: Vector
    """optional steps that each step needs; -1: no more"""
    timed: bool
    """true if there are windows or a limit"""
    waits: bool
    """true if the cost is the time at the end, not the sum of the arcs"""
    ruins: float
    """share of ruin and recreate"""
    weight: float
    """cost of a unit of missed prize, in the acceptance of worse lines"""


def numba_compiled(function: _Function) -> _Function:
    """Return the function compiled to machine code, which is cached on disk if possible."""
    try:
        return cast(_Function, numba.njit(nogil=True, cache=True, error_model="numpy")(function))
    except RuntimeError:
        return cast(_Function, numba.njit(nogil=True, error_model="numpy")(function))


@numba_compiled
def _random_below(state: State, most: int) -> int:
    """Return a random number from 0 to most - 1, by G. Marsaglia's xorshift."""
    x = np.uint64(state[NUMBERS, RANDOM])
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    state[NUMBERS, RANDOM] = np.int64(x)
    return int((x >> np.uint64(12)) % np.uint64(most))


@numba_compiled
def _precedes(network: KernelNetwork, one: int, other: int) -> bool:
    """Return True if node `one` can't come after node `other`."""
    return bool((network.before[other, one >> 6] >> (one & 63)) & 1)


@numba_compiled
def _keeps_order(network: KernelNetwork, state: State, first: int, second: int, third: int) -> bool:
    """Return True if the precedences allow to exchange the stretches of the line between cuts.

    The first stretch lies between the cuts `first` and `second`, the other one between `second` and
    `third`; cut k is directly after position k.
    """
    line, bits = state[LINE], state[BITS]
    words = network.before.shape[1]
    bits[:words] = 0
    for k in range(first + 1, second + 1):
        bits[line[k] >> 6] |= np.int64(1) << (line[k] & 63)
    for k in range(second + 1, third + 1):
        for word in range(words):
            if network.before[line[k], word] & bits[word]:
                return False
    return True


@numba_compiled
def _is_in_time(
    network: KernelNetwork, state: State, first: int, second: int, third: int, most: int
) -> bool:
    """Return True if the line with two stretches exchanged is in time, and costs at most `most`.

    The cost is checked only if it is the time at the end.
    """
    if not network.timed:
        return True
    line, now, at = state[LINE], state[BEGIN, first], state[LINE, first]
    for low, high in ((second + 1, third + 1), (first + 1, second + 1)):
        for k in range(low, high):
            now = max(now + network.time[at, line[k]], network.nodes[0, line[k]])
            at = line[k]
            if now > network.nodes[1, at]:
                return False
    now += network.time[at, line[third + 1]]
    end = max(now + state[REST, third + 1], state[EARLIEST_END, third + 1])
    return now <= state[LATEST_BEGIN, third + 1] and (not network.waits or end <= most)


@numba_compiled
def _update(network: KernelNetwork, state: State) -> None:
    """Recompute the times, the cost and the missed prize of the state's line."""
    line, last, length, missed = state[LINE], state[NUMBERS, COUNT] + 1, 0, 0
    for k in range(last):
        length += network.time[line[k], line[k + 1]]
    if network.timed:
        for k in range(last):
            begun = state[BEGIN, k] + network.time[line[k], line[k + 1]]
            state[BEGIN, k + 1] = max(begun, network.nodes[0, line[k + 1]])
        state[REST, last] = state[EARLIEST_END, last] = 0
        state[LATEST_BEGIN, last] = network.nodes[1, line[last]]
        for k in range(last - 1, -1, -1):
            arc = network.time[line[k], line[k + 1]]
            state[REST, k] = arc + state[REST, k + 1]
            end = network.nodes[0, line[k]] + state[REST, k]
            state[EARLIEST_END, k] = max(end, state[EARLIEST_END, k + 1])
            state[LATEST_BEGIN, k] = min(
                network.nodes[1, line[k]], state[LATEST_BEGIN, k + 1] - arc
            )
        if network.waits:
            length = state[BEGIN, last]
    for s in range(network.needs.shape[0]):
        if state[NODE_OF_STEP, s] < 0:
            missed += network.steps[1, s]
    state[NUMBERS, LENGTH], state[NUMBERS, MISSED] = length, missed


@numba_compiled
def _push(state: State, node: int) -> None:
    if not state[QUEUED, node]:
        state[QUEUED, node] = True
        state[QUEUE, 0] += 1
        state[QUEUE, state[QUEUE, 0]] = node


@numba_compiled
def _exchange(network: KernelNetwork, state: State, first: int, second: int, third: int) -> None:
    line, gap, size = state[LINE], second - first, third - second
    state[SPARE, :gap] = line[first + 1 : second + 1]
    for k in range(first + 1, first + 1 + size):
        line[k] = line[k + gap]
    line[first + 1 + size : third + 1] = state[SPARE, :gap]
    for k in range(first + 1, third + 1):
        state[POSITION, line[k]] = k
    for k in (first, first + size, third):
        _push(state, line[k])
    if network.timed:
        _update(network, state)


@numba_compiled
def _best_exchange(network: KernelNetwork, state: State, a: int) -> tuple[int, int, int, int]:
    """Return the exchange that shortens the line most, among those with a shorter arc from `a`.

    An exchange swaps the two stretches of the line between three cuts. The first number is the
    change of the sum of arcs, which is negative, or 0 if there is no such exchange; the others are
    the cuts.
    """
    line, time = state[LINE], network.time
    i, last, most = state[POSITION, a], state[NUMBERS, COUNT] + 1, state[NUMBERS, LENGTH]
    best = 0, 0, 0, 0
    for b in network.near[a]:
        if b < 0 or time[a, b] >= time[a, line[i + 1]]:
            break
        p = state[POSITION, b]
        if p < 0:
            continue
        state[NUMBERS, WORK] += 10 + (last - p + i if p > i else i - p)
        for kind in range(3):
            if (p > i) == (kind == 2):
                continue
            for k in (range(p, last), range(i - 1, -1, -1), range(p, i))[kind]:
                x, y, z = (i, p - 1, k) if kind == 0 else (k, i, p - 1)
                if kind == 2:
                    x, y, z = p - 1, k, i
                more = time[line[x], line[y + 1]] - time[line[x], line[x + 1]]
                more += time[line[z], line[x + 1]] - time[line[y], line[y + 1]]
                more += time[line[y], line[z + 1]] - time[line[z], line[z + 1]]
                if more >= best[0]:
                    continue
                if not _keeps_order(network, state, x, y, z):
                    if kind == 2:
                        continue
                    break  # longer stretches violate the same precedence
                if _is_in_time(network, state, x, y, z, most):
                    best = more, x, y, z
    return best


@numba_compiled
def _improve(network: KernelNetwork, state: State) -> None:
    """Apply exchanges that save cost, until there is none for any node of the queue.

    The queue has the nodes after which cuts of the line are tried.
    """
    while state[QUEUE, 0]:
        a = state[QUEUE, state[QUEUE, 0]]
        state[QUEUE, 0] -= 1
        state[QUEUED, a] = False
        saved, first, second, third = _best_exchange(network, state, a)
        if saved < 0:
            _exchange(network, state, first, second, third)
            _push(state, a)


@numba_compiled
def _shuffle(network: KernelNetwork, state: State) -> None:
    """Exchange some random pairs of neighbouring stretches of the line, near each other."""
    count = state[NUMBERS, COUNT]
    around, length = _random_below(state, count), min(_LONGEST_STRETCH, count // 2)
    for _ in range(2 + _random_below(state, 3)):
        for _ in range(20):
            one, other = 1 + _random_below(state, length), 1 + _random_below(state, length)
            cut = around + _random_below(state, 2 * _AROUND) - _AROUND
            cut = min(max(cut, 0), count - one - other)
            if _keeps_order(network, state, cut, cut + one, cut + one + other) and (
                _is_in_time(network, state, cut, cut + one, cut + one + other, NO_ARC)
            ):
                _exchange(network, state, cut, cut + one, cut + one + other)
                break


@numba_compiled
def _needs_met(network: KernelNetwork, state: State, s: int) -> bool:
    """Return True if the line has all optional steps that a step needs."""
    missing = 0
    for other in network.needs[s]:
        missing += other >= 0 and state[NODE_OF_STEP, other] < 0
    return missing == 0


@numba_compiled
def _ruin(network: KernelNetwork, state: State) -> None:
    """Remove some nodes near each other from the line, and those that need a removed step."""
    line, at, made, count = state[LINE], state[POSITION], state[NODE_OF_STEP], state[NUMBERS, COUNT]
    remaining, node = (
        1 + _random_below(state, min(_MOST_REMOVED, count)),
        line[1 + _random_below(state, count)],
    )
    while remaining > 0:
        run = min(at[node] + 1 + _random_below(state, _LONGEST_RUN), count + 1)
        for k in range(at[node], run):
            if made[network.nodes[2, line[k]]] >= 0:
                made[network.nodes[2, line[k]]] = -1
                remaining -= 1
        node = network.near[node, _random_below(state, network.near.shape[1])]
        if (
            node < 0
            or node >= network.time.shape[0] - 2
            or at[node] < 0
            or made[network.nodes[2, node]] < 0
        ):
            break
    position = 1
    for k in range(1, count + 2):
        node = line[k]
        s = -1 if k > count else network.nodes[2, node]
        if s >= 0 and (made[s] < 0 or not _needs_met(network, state, s)):
            at[node] = made[s] = -1
            _push(state, line[position - 1])
        else:
            line[position], at[node] = node, position
            position += 1
    state[NUMBERS, COUNT] = position - 2
    _update(network, state)


@numba_compiled
def _best_insertion(network: KernelNetwork, state: State, s: int) -> tuple[int, int, int]:
    """Return the cheapest insertion of a step: extra cost, node, index of the node before it.

    The index is one in the line. Without a possible insertion, the node is -1.
    """
    line, time = state[LINE], network.time
    best = NO_ARC, -1, -1
    for node in range(network.steps[0, s], network.steps[0, s + 1]):
        best_here, must_precede = best, False
        for k in range(state[NUMBERS, COUNT] + 1):
            before, after = line[k], line[k + 1]
            if k and _precedes(network, before, node):
                best_here = best
            must_precede |= k > 0 and _precedes(network, node, before)
            if must_precede:
                continue
            extra = time[before, node] + time[node, after] - time[before, after]
            if extra >= NO_ARC // 2 or _random_below(state, 64) == 0:
                continue
            if network.timed:
                begin = max(state[BEGIN, k] + time[before, node], network.nodes[0, node])
                arrival = begin + time[node, after]
                if begin > network.nodes[1, node] or arrival > state[LATEST_BEGIN, k + 1]:
                    continue
                if network.waits:
                    end = max(arrival + state[REST, k + 1], state[EARLIEST_END, k + 1])
                    extra += 4 * (end - state[NUMBERS, LENGTH])
            if extra < best_here[0]:
                best_here = extra, node, k
        best = best_here
    return best


@numba_compiled
def _recreate(network: KernelNetwork, state: State) -> None:
    """Insert missing steps where they cost least.

    Mandatory steps come first, in random order. Then, again and again, the optional step with
    the lowest ratio of cost to prize is inserted, until none fits in.
    """
    line, spare, missing = state[LINE], state[SPARE], 0
    for optional in (False, True):
        first = missing
        for s in range(network.needs.shape[0]):
            is_tried = network.steps[1, s] > 0 or _random_below(state, 4) == 0
            if is_tried and state[NODE_OF_STEP, s] < 0 and network.steps[2, s] == optional:
                spare[missing] = s
                other = first + _random_below(state, missing + 1 - first)
                spare[missing], spare[other] = spare[other], spare[missing]
                missing += 1
    while True:
        least, chosen, position = np.inf, -1, -1
        for s in spare[:missing]:
            if state[NODE_OF_STEP, s] < 0 and _needs_met(network, state, s):
                extra, node, k = _best_insertion(network, state, s)
                state[NUMBERS, WORK] += state[NUMBERS, COUNT]
                ratio = (
                    (extra + 1) * (1 + _random_below(state, 64) / 128) / (network.steps[1, s] + 1)
                )
                if node >= 0 and ratio < least:
                    least, chosen, position = ratio, node, k
                    if not network.steps[2, s]:
                        break
        if chosen < 0:
            break
        last = state[NUMBERS, COUNT] + 1
        for k in range(last, position, -1):
            line[k + 1] = line[k]
            state[POSITION, line[k]] = k + 1
        line[position + 1], state[POSITION, chosen] = chosen, position + 1
        state[NODE_OF_STEP, network.nodes[2, chosen]] = chosen
        state[NUMBERS, COUNT] = last
        _push(state, line[position])
        _push(state, chosen)
        _update(network, state)


@numba_compiled
def anneal(
    network: KernelNetwork, state: State, work_units: int, constant_temperature: float
) -> None:
    """Search by simulated annealing, and change `state`, for `work_units` of its count of work.

    `constant_temperature`: the mean of the random limits on the increase in cost, over the
    current line, of a line that is accepted.
    """
    numbers, values = state[NUMBERS], state[VALUES]
    end = numbers[WORK] + work_units
    while numbers[WORK] < end:
        count = numbers[COUNT]
        if count < 4 or _random_below(state, 1000) < 1000 * network.ruins:
            if count:
                _ruin(network, state)
            _recreate(network, state)
        else:
            _shuffle(network, state)
        _improve(network, state)
        _update(network, state)
        count, length, missed = numbers[COUNT], numbers[LENGTH], numbers[MISSED]
        numbers[WORK] += 200 + 4 * network.time.shape[0]
        numbers[ITERATIONS] += 1
        worse = length - values[1] + network.weight * (missed - values[2])
        if worse <= -constant_temperature * np.log((1 + _random_below(state, 1 << 30)) / (1 << 30)):
            state[CURRENT] = state[LINE]
            values[0], values[1], values[2] = count, length, missed
            if missed < values[5] or (missed == values[5] and length < values[4]):
                state[BEST] = state[LINE]
                values[3:6] = values[:3]
        else:
            set_line(network, state, state[CURRENT], values[0])


@numba_compiled
def set_line(network: KernelNetwork, state: State, line: Vector, count_without_ends: int) -> None:
    """Replace the state's line by the first `count_without_ends` + 2 entries of `line`.

    They are the start, the nodes and the end.
    """
    state[LINE] = line
    state[POSITION] = -1
    state[NODE_OF_STEP] = -1
    for k in range(count_without_ends + 2):
        state[POSITION, state[LINE, k]] = k
        if 0 < k <= count_without_ends:
            state[NODE_OF_STEP, network.nodes[2, state[LINE, k]]] = state[LINE, k]
    state[NUMBERS, COUNT] = count_without_ends
    _update(network, state)
