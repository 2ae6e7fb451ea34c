"""From a mission to its route problem."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.analysis.quantities import time_words
from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.il import Mission, Order
from argo_compiler.reorder.asked import with_requirements
from argo_compiler.reorder.branches import Branches
from argo_compiler.reorder.precedences import asked_names, must_be_last, precedences
from argo_compiler.reorder.reckoning import assumptions, reckoning_notes
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.travel_matrix import TravelMatrix, require_matrix_of
from argo_compiler.reorder.units import TaskUnit, Unit, find_spine
from argo_compiler.reorder.visits import Visits
from argo_compiler.reorder.waits import standing_still
from argo_compiler.reorder.windows import Windows, require_reckonable
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, EnergyBudget, Round, RouteProblem, Tour, Visit

_NOTHING = Requirements()
_ROUNDING = 1e-6  # of a unit, left by sums of floats


@dataclass(frozen=True, eq=False)
class MissionRoute:
    """A mission, and the problem of its order. The visits of the problem are those of `visits`."""

    mission: Mission
    """with what was asked for of its tasks"""
    visits: Visits
    problem: RouteProblem
    written: Tour
    """the order in which the mission is written"""
    reasons: tuple[str, ...]
    """what stays as it is written, and how it is reckoned"""
    limit: float | None = None
    """s, the shorter of the mission's maximum duration and the budget"""
    before: tuple[tuple[str, str], ...] = ()
    """pairs of tasks that were asked to come before each other, by their names"""
    work: tuple[int, ...] = ()
    """units that each task takes itself"""
    assumed: tuple[str, ...] = ()
    """in words, what a run may do otherwise and so be over earlier: no order is ruled out for
    sure"""

    @property
    def if_assumed(self) -> str:
        """` if …`, to be said with what is ruled out; empty if that is sure."""
        return f" if {', and '.join(self.assumed)}" if self.assumed else ""


def route_problem(
    mission: Mission, ways: TravelMatrix, requirements: Requirements = _NOTHING
) -> MissionRoute:
    """The problem of the best order of a mission's tasks: what `docs/routes.md` says may change.

    Actions succeed at once, and no event occurs.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: its order can't be changed, or a requirement names something that it does not
            have.
    """
    require_matrix_of(ways, mission)
    visits = Visits(find_spine(mission))
    asked = with_requirements(mission, visits, requirements)
    if asked != mission:
        mission, visits = asked, Visits(find_spine(asked))
    spine = visits.spine
    require_reckonable(visits)
    ways = standing_still(spine, ways)
    times, energies, along = _costs(visits, ways, _likely(visits, requirements))
    services = [_work(stop, ways) + more for stop, more in zip(visits.stops, along, strict=True)]
    battery = _battery(visits, ways, times, energies)
    limit = _limit(mission, requirements)
    windows = Windows(visits, ways)
    latest = min((one for one in (limit, windows.of_the_end()) if one), default=None)
    words = {} if latest is None else {"max_duration": latest[1]}
    for k in range(len(visits.stops)):
        if said := windows.words(k):
            words[f"window {k}"] = said
    reasons = [*spine.reasons, *reckoning_notes(visits, ways)]
    if battery is None:  # and no use for chargers
        places = len(visits.stops) + 1
        times = times[:places, :places]
    else:
        words["battery"] = f"battery of {ways.battery:g} Wh"
        reasons.append(f"the battery gives {ways.battery:g} Wh, which may not be enough")
    problem = RouteProblem(
        visits=tuple(_visits(visits, services, windows, requirements)),
        travel=_travel(visits, times, services, ways),
        precedences=precedences(visits, mission.order is Order.PRECISE, requirements),
        rounds=tuple(_rounds(visits, ways)),
        max_duration=None if latest is None else ways.down(latest[0]),
        battery=battery,
        chargers=() if battery is None else ways.chargers,
        unit=ways.unit,
        words=words,
    )
    return MissionRoute(
        mission,
        visits,
        problem,
        Tour(tuple(range(len(visits.stops)))),
        tuple(reasons),
        None if limit is None else limit[0],
        asked_names(visits, requirements),
        tuple(map(int, ways.work)),
        tuple(assumptions(visits, ways)),
    )


def late_visits(planned: MissionRoute, route: Tour) -> Iterator[str]:
    """In words, which visits of a route end after the `latest` of a soft window."""
    visits = planned.visits
    for k, begun in zip(route.order, evaluate(planned.problem, route).arrivals, strict=True):
        entry = visits.stops[k].entry
        window = visits.task(entry).window
        if window is None or window.hard or window.latest is None:
            continue
        done = (begun + planned.work[entry]) * planned.problem.unit
        if done > window.latest + _ROUNDING:
            yield (
                f"{visits.names[k]} is done at {time_words(done)}, after its soft time window: "
                f"{time_words(window.latest)}"
            )


def _limit(mission: Mission, requirements: Requirements) -> tuple[float, str] | None:
    """The longest duration (s), and how it is said."""
    limits = []
    if mission.max_duration is not None:
        words = f"maximum duration {time_words(mission.max_duration)}"
        limits.append((mission.max_duration, words))
    if requirements.budget is not None:
        limits.append((requirements.budget, f"budget {time_words(requirements.budget)}"))
    return min(limits, default=None)


def require_known(mission: Mission, requirements: Requirements) -> None:
    """Raises ArgoError if a requirement names something that the mission does not have."""
    visits = Visits(find_spine(mission))
    named = [
        *requirements.mandatory,
        *(one.what for one in requirements.optional),
        *(one.what for one in requirements.windows),
    ]
    for what in named:
        visits.find(what)
    asked_names(visits, requirements)
    _likely(visits, requirements)


def _likely(visits: Visits, requirements: Requirements) -> dict[tuple[int, int], float]:
    """How likely conditional ways are, by leaves."""
    flow = visits.spine.flow
    number = {leaf.name: i for i, leaf in enumerate(flow.leaves)}
    likely: dict[tuple[int, int], float] = {}
    for one in requirements.likelihoods:
        leaf, target = number.get(one.task), number.get(one.target)
        if leaf is None or target not in {t for _, t in flow.leaves[leaf].conditional}:
            raise NotFound(
                f"no condition of a task '{one.task}' leads to '{one.target}': name a task and "
                "where one of its conditions leads to"
            )
        assert target is not None
        likely[leaf, target] = one.probability
    for leaf in {leaf for leaf, _ in likely}:
        total = sum(p for (from_, _), p in likely.items() if from_ == leaf)
        if total > 1.0 + _ROUNDING:
            raise Invalid(
                f"the ways on from '{flow.leaves[leaf].name}' are {total:g} likely together: "
                "at most 1 is possible"
            )
    return likely


def _costs(
    visits: Visits, ways: TravelMatrix, likely: dict[tuple[int, int], float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[int]]:
    """Times (units) and energies (Wh) of the problem's rows and columns, with what goes along with
    the row and what is done at the column, inf: there is no way; and whole units of what goes
    along with each visit."""
    tasks, end = len(ways.tasks), visits.spine.end
    nowhere = np.zeros((len(ways.time), 1))  # to end where the robot is, and with nothing to do
    time, energy = np.hstack([ways.time, nowhere]), np.hstack([ways.energy, nowhere])
    branches = Branches(visits.spine, time, energy, ways.unit, likely)
    times = [branches.time(stop) for stop in visits.stops] + list(time[tasks:])
    energies = [branches.energy(stop) for stop in visits.stops] + list(energy[tasks:])
    for row, stop in zip(times, visits.stops, strict=False):
        if np.isneginf(row).any():
            name = visits.spine.name(stop.entry)
            raise Invalid(
                f"how long it takes from '{name}' to what follows can't be reckoned: only the time "
                "of a group around it ends it"
            )
    chargers = range(tasks, tasks + len(ways.chargers))
    columns = [stop.entry for stop in visits.stops]
    columns += [len(time[0]) - 1 if end is None else end, *chargers]
    along = [int(branches.along(stop) + _ROUNDING) for stop in visits.stops]
    return np.array(times)[:, columns], np.array(energies)[:, columns], along


def _travel(
    visits: Visits, times: NDArray[np.float64], services: list[int], ways: TravelMatrix
) -> NDArray[np.int64]:
    """The times as the problem has them: whole units, without what the visits themselves take."""
    found = np.isfinite(times)
    whole = np.ceil(np.where(found, times, 0.0) - _ROUNDING).astype(np.int64)
    for k, stop in enumerate(visits.stops):
        whole[:, k] -= _work(stop, ways)
        whole[k] -= services[k] - _work(stop, ways)
    return np.where(found, np.maximum(whole, 0), NEVER)


def _work(stop: TaskUnit, ways: TravelMatrix) -> int:
    """Units that the first task takes."""
    return int(ways.work[stop.entry])


def _visits(
    visits: Visits, services: list[int], windows: Windows, requirements: Requirements
) -> Iterator[Visit]:
    everything = range(len(visits.stops))
    optional = {k for k in everything if all(map(visits.optional, visits.whole([k])))}
    if requirements.budget is not None:
        asked = {k for what in requirements.mandatory for k in visits.whole(visits.find(what))}
        optional = set(everything) - asked
    last = must_be_last(visits)
    if last is not None:
        optional -= set(visits.whole([last]))
    for k in everything:
        earliest, latest = windows.of_visit(k)
        yield Visit(
            visits.names[k],
            service=services[k],
            mandatory=k not in optional,
            prize=visits.task(visits.stops[k].entry).priority if k in optional else 0,
            earliest=earliest,
            latest=latest,
        )


def _rounds(visits: Visits, ways: TravelMatrix) -> Iterator[Round]:
    for circuit, members in visits.circuits:
        group = visits.spine.flow.groups[circuit.group]
        yield Round(
            f"group '{group.name}'",
            members,
            repeat=group.count,
            duration=ways.up(group.duration),
            soft=not group.hard,
        )


def _battery(
    visits: Visits, ways: TravelMatrix, times: NDArray[np.float64], energies: NDArray[np.float64]
) -> EnergyBudget | None:
    """The battery, if there is an order in which it does not last to the end for sure."""
    if ways.battery is None or ways.charging <= 0.0:
        return None
    if _most_energy(visits, ways, times, energies) <= ways.battery:
        return None
    used = np.where(np.isfinite(energies), energies, 0.0)
    used = np.ceil(ways.units_of_energy(used) - _ROUNDING).astype(np.int64)
    return EnergyBudget(used, int(ways.units_of_energy(np.array(ways.battery))))


def _most_energy(
    visits: Visits, ways: TravelMatrix, times: NDArray[np.float64], energies: NDArray[np.float64]
) -> float:
    """Wh that no order needs more than, the way to the end included."""
    n = len(visits.stops)
    there = np.isfinite(energies) & (times > 0.0)
    worst = np.where(there, energies, 0.0).max(axis=0, initial=0.0)
    longest = np.where(there, times, 0.0).max(axis=0, initial=0.0)
    power = float((energies[there] / times[there]).max(initial=0.0))  # Wh a unit

    def most(units: tuple[Unit, ...]) -> float:
        total = 0.0
        for unit in units:
            if isinstance(unit, TaskUnit):
                total += worst[visits.of_leaf[unit.entry]]
                continue
            group = visits.spine.flow.groups[unit.group]
            all_rounds = (group.count or np.inf) * most(unit.inside)
            if group.duration:  # and the round that has begun by then
                round_ = float(longest[visits.numbers(unit.inside)].sum())
                all_rounds = min(all_rounds, power * (group.duration / ways.unit + round_))
            total += all_rounds
        return float(total)

    return most(visits.spine.units) + float(worst[n])
