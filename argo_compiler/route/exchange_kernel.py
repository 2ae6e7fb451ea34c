"""The loops of `argo_compiler.route.exchange_search`, compiled by numba, which takes a while.

A line is the start (node m), the nodes of a route and the end (node m + 1); those that are not in
it have the position -1. Cut k of a line is right after its position k.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.int64]
_Function = TypeVar("_Function", bound=Callable[..., object])
NO_WAY = 1 << 40
"""time of an arc that there is not"""
_STRETCH, _AROUND = 30, 20
"""nodes in a stretch that is exchanged at random, at most, and how far from the others it begins"""
_RUINED, _RUN = 10, 4
"""nodes that are taken out at a time, and one after the other, at most"""
State = Vector
"""what is being changed, and room to do so, shape (15, m + 8): rows as follows"""
LINE, AT, MADE, KEPT, BEST = range(5)
"""nodes by position; the position of each node; the node of each step, -1: none; the line to go
back to; the best one"""
AHEAD, ONWARD, SOONEST, LATE = range(5, 9)
"""by position: when it begins, how long it is from there to the end without waiting, when it ends
however soon it begins there, and when it must begin there"""
QUEUE, QUEUED, SPARE, BITS, WORTH, NUMBERS = range(9, 15)
"""nodes after which to try cuts, from entry 1 (0: how many); whether each is in it; room; room;
count, cost and what is missed of `KEPT`, and of `BEST`; the numbers that follow"""
COUNT, LENGTH, MISSED, RANDOM, WORK, ITERATIONS = range(6)
"""nodes in the line, its cost, what it misses; the random generator's; what was done"""


class Ways(NamedTuple):
    """A network. What is by node has m + 2 entries."""

    time: Vector
    """from the beginning of row to that of column, shape (m + 2, m + 2)"""
    near: Vector
    """by node the ones that may follow it, nearest first; -1: no more"""
    before: Vector
    """by node a bit for each that can't be made any more after it"""
    nodes: Vector
    """rows: earliest, latest, step"""
    steps: Vector
    """rows: first node (those of a step lie together), what it is worth, whether it is optional"""
    needs: Vector
    """by step the optional ones that it needs; -1: no more"""
    timed: bool
    """whether there are windows or a limit"""
    waits: bool
    """whether the cost is the time at the end, not the sum of the arcs"""
    ruins: float
    """share of ruin and recreate"""
    weight: float
    """what is missed, as cost, where a line that is worse may be taken"""


def compiled(function: _Function) -> _Function:
    """The function as machine code, which is kept for later where a folder can be written to."""
    try:
        return cast(_Function, numba.njit(nogil=True, cache=True, error_model="numpy")(function))
    except RuntimeError:
        return cast(_Function, numba.njit(nogil=True, error_model="numpy")(function))


@compiled
def _below(state: State, most: int) -> int:
    """A random number from 0 to most - 1, by G. Marsaglia's xorshift."""
    x = np.uint64(state[NUMBERS, RANDOM])
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    state[NUMBERS, RANDOM] = np.int64(x)
    return int((x >> np.uint64(12)) % np.uint64(most))


@compiled
def _precedes(ways: Ways, one: int, other: int) -> bool:
    """Whether a node can't be made any more after another."""
    return bool((ways.before[other, one >> 6] >> (one & 63)) & 1)


@compiled
def _ordered(ways: Ways, state: State, first: int, second: int, third: int) -> bool:
    """Whether the stretches between three cuts may change places."""
    line, bits = state[LINE], state[BITS]
    words = ways.before.shape[1]
    bits[:words] = 0
    for k in range(first + 1, second + 1):
        bits[line[k] >> 6] |= np.int64(1) << (line[k] & 63)
    for k in range(second + 1, third + 1):
        for word in range(words):
            if ways.before[line[k], word] & bits[word]:
                return False
    return True


@compiled
def _in_time(ways: Ways, state: State, first: int, second: int, third: int, most: int) -> bool:
    """Whether the line keeps its windows with two stretches exchanged, and costs that at most."""
    if not ways.timed:
        return True
    line, now, at = state[LINE], state[AHEAD, first], state[LINE, first]
    for low, high in ((second + 1, third + 1), (first + 1, second + 1)):
        for k in range(low, high):
            now = max(now + ways.time[at, line[k]], ways.nodes[0, line[k]])
            at = line[k]
            if now > ways.nodes[1, at]:
                return False
    now += ways.time[at, line[third + 1]]
    end = max(now + state[ONWARD, third + 1], state[SOONEST, third + 1])
    return now <= state[LATE, third + 1] and (not ways.waits or end <= most)


@compiled
def _measure(ways: Ways, state: State) -> None:
    """Looks at the whole line again."""
    line, last, length, missed = state[LINE], state[NUMBERS, COUNT] + 1, 0, 0
    for k in range(last):
        length += ways.time[line[k], line[k + 1]]
    if ways.timed:
        for k in range(last):
            begun = state[AHEAD, k] + ways.time[line[k], line[k + 1]]
            state[AHEAD, k + 1] = max(begun, ways.nodes[0, line[k + 1]])
        state[ONWARD, last] = state[SOONEST, last] = 0
        state[LATE, last] = ways.nodes[1, line[last]]
        for k in range(last - 1, -1, -1):
            arc = ways.time[line[k], line[k + 1]]
            state[ONWARD, k] = arc + state[ONWARD, k + 1]
            soonest = ways.nodes[0, line[k]] + state[ONWARD, k]
            state[SOONEST, k] = max(soonest, state[SOONEST, k + 1])
            state[LATE, k] = min(ways.nodes[1, line[k]], state[LATE, k + 1] - arc)
        if ways.waits:
            length = state[AHEAD, last]
    for s in range(ways.needs.shape[0]):
        if state[MADE, s] < 0:
            missed += ways.steps[1, s]
    state[NUMBERS, LENGTH], state[NUMBERS, MISSED] = length, missed


@compiled
def _push(state: State, node: int) -> None:
    if not state[QUEUED, node]:
        state[QUEUED, node] = True
        state[QUEUE, 0] += 1
        state[QUEUE, state[QUEUE, 0]] = node


@compiled
def _exchange(ways: Ways, state: State, first: int, second: int, third: int) -> None:
    line, gap, size = state[LINE], second - first, third - second
    state[SPARE, :gap] = line[first + 1 : second + 1]
    for k in range(first + 1, first + 1 + size):
        line[k] = line[k + gap]
    line[first + 1 + size : third + 1] = state[SPARE, :gap]
    for k in range(first + 1, third + 1):
        state[AT, line[k]] = k
    for k in (first, first + size, third):
        _push(state, line[k])
    if ways.timed:
        _measure(ways, state)


@compiled
def _cuts(ways: Ways, state: State, a: int) -> tuple[int, int, int, int]:
    """The exchange with a shorter arc from a node that saves most: how much, and its cuts."""
    line, time = state[LINE], ways.time
    i, last, most = state[AT, a], state[NUMBERS, COUNT] + 1, state[NUMBERS, LENGTH]
    best = 0, 0, 0, 0
    for b in ways.near[a]:
        if b < 0 or time[a, b] >= time[a, line[i + 1]]:
            break
        p = state[AT, b]
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
                if not _ordered(ways, state, x, y, z):
                    if kind == 2:
                        continue
                    break  # longer stretches won't be either
                if _in_time(ways, state, x, y, z, most):
                    best = more, x, y, z
    return best


@compiled
def _improve(ways: Ways, state: State) -> None:
    """Exchanges that pay, until there is none with a cut after a node of the queue."""
    while state[QUEUE, 0]:
        a = state[QUEUE, state[QUEUE, 0]]
        state[QUEUE, 0] -= 1
        state[QUEUED, a] = False
        saved, first, second, third = _cuts(ways, state, a)
        if saved < 0:
            _exchange(ways, state, first, second, third)
            _push(state, a)


@compiled
def _shuffle(ways: Ways, state: State) -> None:
    """Some random exchanges near each other."""
    count = state[NUMBERS, COUNT]
    around, length = _below(state, count), min(_STRETCH, count // 2)
    for _ in range(2 + _below(state, 3)):
        for _ in range(20):
            one, other = 1 + _below(state, length), 1 + _below(state, length)
            cut = around + _below(state, 2 * _AROUND) - _AROUND
            cut = min(max(cut, 0), count - one - other)
            if _ordered(ways, state, cut, cut + one, cut + one + other) and (
                _in_time(ways, state, cut, cut + one, cut + one + other, NO_WAY)
            ):
                _exchange(ways, state, cut, cut + one, cut + one + other)
                break


@compiled
def _made(ways: Ways, state: State, s: int) -> bool:
    """Whether what an optional step must not be made without is made."""
    missing = 0
    for other in ways.needs[s]:
        missing += other >= 0 and state[MADE, other] < 0
    return missing == 0


@compiled
def _ruin(ways: Ways, state: State) -> None:
    """Takes nodes near each other out of the line, and what needs their steps."""
    line, at, made, count = state[LINE], state[AT], state[MADE], state[NUMBERS, COUNT]
    left, node = 1 + _below(state, min(_RUINED, count)), line[1 + _below(state, count)]
    while left > 0:
        run = min(at[node] + 1 + _below(state, _RUN), count + 1)
        for k in range(at[node], run):
            if made[ways.nodes[2, line[k]]] >= 0:
                made[ways.nodes[2, line[k]]] = -1
                left -= 1
        node = ways.near[node, _below(state, ways.near.shape[1])]
        if (
            node < 0
            or node >= ways.time.shape[0] - 2
            or at[node] < 0
            or made[ways.nodes[2, node]] < 0
        ):
            break
    place = 1
    for k in range(1, count + 2):
        node = line[k]
        s = -1 if k > count else ways.nodes[2, node]
        if s >= 0 and (made[s] < 0 or not _made(ways, state, s)):
            at[node] = made[s] = -1
            _push(state, line[place - 1])
        else:
            line[place], at[node] = node, place
            place += 1
    state[NUMBERS, COUNT] = place - 2
    _measure(ways, state)


@compiled
def _place(ways: Ways, state: State, s: int) -> tuple[int, int, int]:
    """The best place for a step: what it costs more, the node, and after which position."""
    line, time = state[LINE], ways.time
    best = NO_WAY, -1, -1
    for node in range(ways.steps[0, s], ways.steps[0, s + 1]):
        here, over = best, False
        for k in range(state[NUMBERS, COUNT] + 1):
            at, then = line[k], line[k + 1]
            if k and _precedes(ways, at, node):
                here = best
            over |= k > 0 and _precedes(ways, node, at)
            if over:
                continue
            more = time[at, node] + time[node, then] - time[at, then]
            if more >= NO_WAY // 2 or _below(state, 64) == 0:
                continue
            if ways.timed:
                now = max(state[AHEAD, k] + time[at, node], ways.nodes[0, node])
                arrived = now + time[node, then]
                if now > ways.nodes[1, node] or arrived > state[LATE, k + 1]:
                    continue
                if ways.waits:
                    end = max(arrived + state[ONWARD, k + 1], state[SOONEST, k + 1])
                    more += 4 * (end - state[NUMBERS, LENGTH])
            if more < here[0]:
                here = more, node, k
        best = here
    return best


@compiled
def _recreate(ways: Ways, state: State) -> None:
    """Puts steps that are not in the line where they cost least: those that must be in it in any
    order, then of the others always the one that costs least for what it is worth."""
    line, spare, missing = state[LINE], state[SPARE], 0
    for optional in (False, True):
        begin = missing
        for s in range(ways.needs.shape[0]):
            some = ways.steps[1, s] > 0 or _below(state, 4) == 0
            if some and state[MADE, s] < 0 and ways.steps[2, s] == optional:
                spare[missing] = s
                other = begin + _below(state, missing + 1 - begin)
                spare[missing], spare[other] = spare[other], spare[missing]
                missing += 1
    while True:
        least, chosen, position = np.inf, -1, -1
        for s in spare[:missing]:
            if state[MADE, s] < 0 and _made(ways, state, s):
                more, node, k = _place(ways, state, s)
                state[NUMBERS, WORK] += state[NUMBERS, COUNT]
                ratio = (more + 1) * (1 + _below(state, 64) / 128) / (ways.steps[1, s] + 1)
                if node >= 0 and ratio < least:
                    least, chosen, position = ratio, node, k
                    if not ways.steps[2, s]:
                        break
        if chosen < 0:
            break
        last = state[NUMBERS, COUNT] + 1
        for k in range(last, position, -1):
            line[k + 1] = line[k]
            state[AT, line[k]] = k + 1
        line[position + 1], state[AT, chosen] = chosen, position + 1
        state[MADE, ways.nodes[2, chosen]] = chosen
        state[NUMBERS, COUNT] = last
        _push(state, line[position])
        _push(state, chosen)
        _measure(ways, state)


@compiled
def run(ways: Ways, state: State, budget: int, warm: float) -> None:
    """Changes the line until that much work is done. `warm`: by how much a line that is kept may be
    worse, on average."""
    numbers, worth = state[NUMBERS], state[WORTH]
    end = numbers[WORK] + budget
    while numbers[WORK] < end:
        count = numbers[COUNT]
        if count < 4 or _below(state, 1000) < 1000 * ways.ruins:
            if count:
                _ruin(ways, state)
            _recreate(ways, state)
        else:
            _shuffle(ways, state)
        _improve(ways, state)
        _measure(ways, state)
        count, length, missed = numbers[COUNT], numbers[LENGTH], numbers[MISSED]
        numbers[WORK] += 200 + 4 * ways.time.shape[0]
        numbers[ITERATIONS] += 1
        worse = length - worth[1] + ways.weight * (missed - worth[2])
        if worse <= -warm * np.log((1 + _below(state, 1 << 30)) / (1 << 30)):
            state[KEPT] = state[LINE]
            worth[0], worth[1], worth[2] = count, length, missed
            if missed < worth[5] or (missed == worth[5] and length < worth[4]):
                state[BEST] = state[LINE]
                worth[3:6] = worth[:3]
        else:
            put(ways, state, state[KEPT], worth[0])


@compiled
def put(ways: Ways, state: State, line: Vector, count: int) -> None:
    """Goes on from a line."""
    state[LINE] = line
    state[AT] = -1
    state[MADE] = -1
    for k in range(count + 2):
        state[AT, state[LINE, k]] = k
        if 0 < k <= count:
            state[MADE, ways.nodes[2, state[LINE, k]]] = state[LINE, k]
    state[NUMBERS, COUNT] = count
    _measure(ways, state)
