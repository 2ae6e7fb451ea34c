"""Rounds as single steps: in which ways a round can be made, and what each takes from anywhere.

A round is left where it was entered to leave, and nothing comes between its members. So for the
rest of the route it is one step with some modes: an order of its members, the time and energy that
all of its rounds take from each place that it may be entered from, and where it ends.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import NEVER, Round, RouteProblem

Vector = NDArray[np.int64]

MOST_MEMBERS = 9
"""of a round, those inside others counted as one, up to which all orders are weighed"""


@dataclass(frozen=True, eq=False)
class Mode:
    """One way to make a visit or a round."""

    time: Vector
    """from the end of what was done at each place (visits, start, chargers) to its end"""
    energy: Vector
    """likewise"""
    exit: tuple[int, ...]
    """the visits where the robot may then be; it is reckoned with the worst"""
    order: tuple[int, ...]


@dataclass
class Step:
    """A visit, or a round with what lies directly in it. A node of the tree of rounds."""

    visits: frozenset[int]
    round: Round | None = None
    parts: list["Step"] = field(default_factory=list)


def steps(problem: RouteProblem) -> list[Step]:
    """The visits and outermost rounds, in the order of their first visits."""
    top = [Step(frozenset([visit])) for visit in range(problem.size)]
    # From the innermost round outwards; of equal ones the last is inside.
    numbers = sorted(range(len(problem.rounds)), key=lambda k: (len(problem.rounds[k].members), -k))
    for number in numbers:
        one = problem.rounds[number]
        inside = [step for step in top if step.visits <= set(one.members)]
        around = Step(frozenset(one.members), one, inside)
        top = [step for step in top if not step.visits <= around.visits] + [around]
    return sorted(top, key=lambda step: min(step.visits))


def modes(
    problem: RouteProblem, step: Step, order_of: Callable[[Step], tuple[Step, ...]]
) -> tuple[list[Mode], bool]:
    """The ways to make a step that may be the best, and whether they are all of those.

    A round of more than MOST_MEMBERS parts is made in the cyclic order that `order_of` gives.
    """
    if step.round is None:
        (visit,) = step.visits
        return [_visit(problem, visit)], True
    exact, choices = True, []
    for part in step.parts:
        some, all_of_them = modes(problem, part, order_of)
        choices.append(some)
        exact &= all_of_them
    waits = _waits(problem, step.parts)
    if len(step.parts) <= MOST_MEMBERS:
        passes = _all_passes(choices, waits)
    else:
        exact = False
        order = [step.parts.index(part) for part in order_of(step)]
        passes = _rotations(choices, waits, order)
    if step.round.duration:
        shortest = min((p.again for p in passes), default=0)
        passes = [p for p in passes if p.again == shortest]
    found = [mode for one in passes for mode in _repeated(step, one)]
    return _not_dominated(found), exact


def enter(mode: Mode, places: Sequence[int]) -> int:
    """The time that a mode takes from the worst of the places."""
    return int(mode.time[list(places)].max())


@dataclass(frozen=True, eq=False)
class _Pass:
    """One round: entered from anywhere, and again from where it ends."""

    time: Vector
    energy: Vector
    again: int
    again_energy: int
    exit: tuple[int, ...]
    order: tuple[int, ...]


def _visit(problem: RouteProblem, visit: int) -> Mode:
    time = plus(problem.travel[:, visit], problem.visits[visit].service)
    battery = problem.battery
    energy = np.zeros_like(time) if battery is None else battery.energy[:, visit]
    return Mode(time, energy, (visit,), (visit,))


def plus(times: Vector, more: int | Vector) -> Vector:
    """A sum of times that is NEVER where a part is."""
    total: Vector = np.minimum(times + more, NEVER)
    return total


def _waits(problem: RouteProblem, parts: list[Step]) -> list[int]:
    """For each part, as bits, the parts that must come before it."""
    waits = [0] * len(parts)
    home = {visit: k for k, part in enumerate(parts) for visit in part.visits}
    for precedence in problem.precedences:
        there = [home[visit] for visit in precedence.sequence if visit in home]
        for later, part in enumerate(there):
            for earlier in there[:later]:
                if earlier != part:
                    waits[part] |= 1 << earlier
    return waits


@dataclass(frozen=True)
class _Label:
    time: int
    energy: int
    last: Mode
    order: tuple[int, ...]


def _all_passes(choices: list[list[Mode]], waits: list[int]) -> list[_Pass]:
    """Dynamic programming over the parts done, from each first mode, with the labels of time and
    energy of which neither is the smaller."""
    found = []
    every = (1 << len(choices)) - 1
    for k, first in _free(choices, waits, 0):
        layer = {(1 << k, id(first)): [_Label(0, 0, first, first.order)]}
        for _ in range(len(choices) - 1):
            following: dict[tuple[int, int], list[_Label]] = {}
            for (done, _), labels in layer.items():
                for part, mode in _free(choices, waits, done):
                    key = (done | 1 << part, id(mode))
                    for label in labels:
                        _add(following.setdefault(key, []), _extended(label, mode))
            layer = following
        for (done, _), labels in layer.items():
            assert done == every
            found += [_closed(first, label) for label in labels]
    return found


def _free(choices: list[list[Mode]], waits: list[int], done: int) -> list[tuple[int, Mode]]:
    return [
        (part, mode)
        for part, some in enumerate(choices)
        if not done >> part & 1 and waits[part] & ~done == 0
        for mode in some
    ]


def _extended(label: _Label, mode: Mode) -> _Label:
    places = list(label.last.exit)
    return _Label(
        min(label.time + int(mode.time[places].max()), NEVER),
        min(label.energy + int(mode.energy[places].max()), NEVER),
        mode,
        label.order + mode.order,
    )


def _add(labels: list[_Label], new: _Label) -> None:
    if new.time >= NEVER or any(
        one.time <= new.time and one.energy <= new.energy for one in labels
    ):
        return
    labels[:] = [one for one in labels if one.time < new.time or one.energy < new.energy]
    labels.append(new)


def _rotations(choices: list[list[Mode]], waits: list[int], cycle: list[int]) -> list[_Pass]:
    """A cyclic order of the parts, entered at each part that may be the first."""
    found = []
    for k in range(len(cycle)):
        order, done = cycle[k:] + cycle[:k], 0
        for part in order:
            if waits[part] & ~done:
                break
            done |= 1 << part
        else:
            # Of the modes of inner rounds the one that is left soonest.
            picked = [min(choices[part], key=lambda mode: int(mode.time.min())) for part in order]
            label = _Label(0, 0, picked[0], picked[0].order)
            for mode in picked[1:]:
                label = _extended(label, mode)
            found.append(_closed(picked[0], label))
    return found


def _closed(first: Mode, label: _Label) -> _Pass:
    places = list(label.last.exit)
    return _Pass(
        plus(first.time, label.time),
        np.minimum(first.energy + label.energy, NEVER),
        min(label.time + int(first.time[places].max()), NEVER),
        min(label.energy + int(first.energy[places].max()), NEVER),
        label.last.exit,
        label.order,
    )


def _repeated(step: Step, one: _Pass) -> list[Mode]:
    """All rounds of a pass: where the time may be up in the middle, that is a mode of its own."""
    asked = step.round
    assert asked is not None
    first, limit = one.time, asked.duration
    count = np.full(first.shape, asked.repeat or NEVER, np.int64)
    if limit:
        # The first round after which the clock is not below the limit; without time, the second.
        lacking = np.maximum(limit - first, 0)
        needed = 1 + (-(-lacking // one.again) if one.again else np.minimum(lacking, 1))
        count = np.minimum(count, needed)
    if one.again >= NEVER:
        first = np.where(count > 1, NEVER, first)
    time = np.where(first >= NEVER, NEVER, first + (count - 1) * (one.again % NEVER))
    energy = np.minimum(one.energy + (count - 1) * (one.again_energy % NEVER), NEVER)
    if not limit or asked.soft or not (cut := (time > limit) & (time < NEVER)).any():
        return [Mode(time, energy, one.exit, one.order)]
    left = Mode(np.where(cut, limit, NEVER), energy, tuple(sorted(step.visits)), one.order)
    if (cut | (time >= NEVER)).all():
        return [left]
    return [left, Mode(np.where(cut, NEVER, time), energy, one.exit, one.order)]


def _not_dominated(modes: list[Mode]) -> list[Mode]:
    """Those modes than which no other with the same exit is as good from everywhere."""
    kept: list[Mode] = []
    for mode in sorted(modes, key=lambda mode: (int(mode.time.sum()), int(mode.energy.sum()))):
        if not (mode.time < NEVER).any():
            continue
        if not any(
            set(one.exit) <= set(mode.exit)
            and (one.time <= mode.time).all()
            and (one.energy <= mode.energy).all()
            for one in kept
        ):
            kept.append(mode)
    return kept
