"""Conversion of a mission to its route problem."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.quantity_text import exceeding_duration_text, limit_text
from argo_compiler.il import Mission, Order
from argo_compiler.reorder.assumptions import assumption_notes, assumption_phrases
from argo_compiler.reorder.branch_costs import BranchCosts
from argo_compiler.reorder.precedences import (
    precedence_name_pairs,
    precedences,
    required_last_visit,
)
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.task_requirements import with_requirements
from argo_compiler.reorder.travel_matrix import TravelMatrix, require_matrix_for
from argo_compiler.reorder.units import TaskUnit, Unit, find_unit_chain
from argo_compiler.reorder.visits import Visits
from argo_compiler.reorder.waits import with_wait_times
from argo_compiler.reorder.windows import Windows, require_computable_times
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, EnergyBudget, Round, RouteProblem, Tour, Visit

_NO_REQUIREMENTS = Requirements()
_ROUNDING = 1e-6  # of a unit, left by sums of floats


@dataclass(frozen=True, eq=False)
class MissionProblem:
    """Mission with its route problem. The problem numbers its visits as `visits` does."""

    mission: Mission
    """the mission with the required values of its tasks"""
    visits: Visits
    problem: RouteProblem
    written: Tour
    """the written order of the mission"""
    reasons: tuple[str, ...]
    """notes for users: parts that stay as written, and assumptions of the computed times"""
    limit: float | None = None
    """s, the shorter of the mission's maximum duration and the budget; None if there is neither"""
    before: tuple[tuple[str, str], ...] = ()
    """pairs of task names: the first has to come before the second by the requirements"""
    work: tuple[int, ...] = ()
    """units that each task takes without the drive to it"""
    assumed: tuple[str, ...] = ()
    """assumptions in words: if a run deviates from them, it may end earlier, so that an order that
    seems impossible may be possible"""

    @property
    def assumptions_clause(self) -> str:
        """Clause ` if …` for messages that rule out an order; empty if there are no assumptions."""
        return Message(" if {assumed:and}", assumed=self.assumed) if self.assumed else ""


def route_problem(
    mission: Mission, matrix: TravelMatrix, requirements: Requirements = _NO_REQUIREMENTS
) -> MissionProblem:
    """Return the problem of the best order of a mission's tasks.

    `docs/routes.md` states what may change. Actions are assumed to succeed at the first attempt,
    and no event to occur.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: its order can't be changed, or a requirement names something that it does not
            have.
    """
    require_matrix_for(matrix, mission)
    visits = Visits(find_unit_chain(mission))
    required = with_requirements(mission, visits, requirements)
    if required != mission:
        mission, visits = required, Visits(find_unit_chain(required))
    chain = visits.chain
    require_computable_times(visits)
    matrix = with_wait_times(chain, matrix)
    times, energies, inner_times = _costs(visits, matrix, _probabilities(visits, requirements))
    services = [
        _work(unit, matrix) + inner_time
        for unit, inner_time in zip(visits.task_units, inner_times, strict=True)
    ]
    battery = _battery(visits, matrix, times, energies)
    limit = _duration_limit(mission, requirements)
    windows = Windows(visits, matrix)
    latest = min((end for end in (limit, windows.end_limit_seconds()) if end), default=None)
    words = {} if latest is None else {"max_duration": latest[1]}
    for k in range(len(visits.task_units)):
        if window_words := windows.latest_end_text(k):
            words[f"window {k}"] = window_words
    reasons = [*chain.reasons, *assumption_notes(visits, matrix)]
    if battery is None:  # chargers are not needed either
        size = len(visits.task_units) + 1
        times = times[:size, :size]
    else:
        words["battery"] = Message("battery of {battery:g} Wh", battery=matrix.battery)
        reasons.append(
            Message(
                "the battery gives {battery:g} Wh, which may not be enough", battery=matrix.battery
            )
        )
    problem = RouteProblem(
        visits=tuple(_visits(visits, services, windows, requirements)),
        travel=_travel_times(visits, times, services, matrix),
        precedences=precedences(visits, mission.order is Order.PRECISE, requirements),
        rounds=tuple(_rounds(visits, matrix)),
        max_duration=None if latest is None else matrix.units_rounded_down(latest[0]),
        battery=battery,
        chargers=() if battery is None else matrix.chargers,
        unit=matrix.unit,
        words=words,
    )
    return MissionProblem(
        mission,
        visits,
        problem,
        Tour(tuple(range(len(visits.task_units)))),
        tuple(reasons),
        None if limit is None else limit[0],
        precedence_name_pairs(visits, requirements),
        tuple(map(int, matrix.work)),
        tuple(assumption_phrases(visits, matrix)),
    )


def late_visit_texts(planned: MissionProblem, route: Tour) -> Iterator[str]:
    """Yield, in words, the visits of a route that end after the `latest` of a soft window."""
    visits = planned.visits
    for k, start in zip(route.order, evaluate(planned.problem, route).arrivals, strict=True):
        entry = visits.task_units[k].entry
        window = visits.leaf_task(entry).window
        if window is None or window.hard or window.latest is None:
            continue
        end = (start + planned.work[entry]) * planned.problem.unit
        if end > window.latest + _ROUNDING:
            done = exceeding_duration_text(end, window.latest)
            yield (
                Message(
                    "{name} is done at {done}, after its soft time window: {limit}",
                    name=visits.names[k],
                    done=done,
                    limit=limit_text(window.latest),
                )
            )


def _duration_limit(mission: Mission, requirements: Requirements) -> tuple[float, str] | None:
    """Return the shorter of maximum duration and budget, in s, with its description.

    Returns None if there is neither.
    """
    limits = []
    if mission.max_duration is not None:
        words = Message("maximum duration {limit}", limit=limit_text(mission.max_duration))
        limits.append((mission.max_duration, words))
    if requirements.budget is not None:
        limits.append(
            (requirements.budget, Message("budget {limit}", limit=limit_text(requirements.budget)))
        )
    return min(limits, default=None)


def require_known(mission: Mission, requirements: Requirements) -> None:
    """Raise ArgoError if a requirement names something that the mission does not have."""
    visits = Visits(find_unit_chain(mission))
    named = [
        *requirements.mandatory,
        *(requirement.what for requirement in requirements.optional),
        *(requirement.what for requirement in requirements.windows),
    ]
    for what in named:
        visits.resolve_visits(what)
    precedence_name_pairs(visits, requirements)
    _probabilities(visits, requirements)


def _probabilities(visits: Visits, requirements: Requirements) -> dict[tuple[int, int], float]:
    """Return the probabilities given in the requirements, by the leaves that they connect."""
    flow = visits.chain.flow
    number = {leaf.name: i for i, leaf in enumerate(flow.leaves)}
    probabilities: dict[tuple[int, int], float] = {}
    for requirement in requirements.likelihoods:
        leaf, target = number.get(requirement.task), number.get(requirement.target)
        if leaf is None or target not in {t for _, t in flow.leaves[leaf].conditional}:
            raise NotFound(
                Message(
                    "no condition of a task '{task}' leads to '{target}': name a task and the "
                    "target of one of its conditions",
                    task=requirement.task,
                    target=requirement.target,
                )
            )
        assert target is not None
        probabilities[leaf, target] = requirement.probability
    for leaf in {leaf for leaf, _ in probabilities}:
        total = sum(p for (from_, _), p in probabilities.items() if from_ == leaf)
        if total > 1.0 + _ROUNDING:
            raise Invalid(
                Message(
                    "the probabilities of the transitions from '{leave}' add up to {total:g}: "
                    "at most 1 is possible",
                    leave=flow.leaves[leaf].name,
                    total=total,
                )
            )
    return probabilities


def _costs(
    visits: Visits, matrix: TravelMatrix, probabilities: dict[tuple[int, int], float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[int]]:
    """Return times (units), energies (Wh) and the inner times of visits.

    Times and energies have the problem's rows and columns. They include the conditional tasks after
    the first task of the row's visit, and the action at the column; inf if there is no path. The
    inner time of a visit is that of its conditional tasks, in whole units of time.
    """
    tasks, end = len(matrix.tasks), visits.chain.end
    nowhere = np.zeros((len(matrix.time), 1))  # column of a mission that ends where the robot is
    time, energy = np.hstack([matrix.time, nowhere]), np.hstack([matrix.energy, nowhere])
    branch_costs = BranchCosts(visits.chain, time, energy, matrix.unit, probabilities)
    times = [branch_costs.times_to_destinations(unit) for unit in visits.task_units] + list(
        time[tasks:]
    )
    energies = [branch_costs.energies_to_destinations(unit) for unit in visits.task_units] + list(
        energy[tasks:]
    )
    for row, unit in zip(times, visits.task_units, strict=False):
        if np.isneginf(row).any():
            name = visits.chain.name(unit.entry)
            raise Invalid(
                Message(
                    "how long it takes from '{name}' to the next task can't be computed: only "
                    "the time of a group around it ends it",
                    name=name,
                )
            )
    chargers = range(tasks, tasks + len(matrix.chargers))
    columns = [unit.entry for unit in visits.task_units]
    columns += [len(time[0]) - 1 if end is None else end, *chargers]
    inner_times = [
        int(branch_costs.time_units_after_first_task(unit) + _ROUNDING)
        for unit in visits.task_units
    ]
    return np.array(times)[:, columns], np.array(energies)[:, columns], inner_times


def _travel_times(
    visits: Visits, times: NDArray[np.float64], services: list[int], matrix: TravelMatrix
) -> NDArray[np.int64]:
    """Return the problem's travel times in whole units, without the service times of the visits.

    `times` are those of `_costs`, which include parts of the service times.
    """
    is_path = np.isfinite(times)
    rounded = np.ceil(np.where(is_path, times, 0.0) - _ROUNDING).astype(np.int64)
    for k, unit in enumerate(visits.task_units):
        rounded[:, k] -= _work(unit, matrix)
        rounded[k] -= services[k] - _work(unit, matrix)
    return np.where(is_path, np.maximum(rounded, 0), NEVER)


def _work(unit: TaskUnit, matrix: TravelMatrix) -> int:
    """Return the time that the action of a task unit's first task takes, in units of time."""
    return int(matrix.work[unit.entry])


def _visits(
    visits: Visits, services: list[int], windows: Windows, requirements: Requirements
) -> Iterator[Visit]:
    everything = range(len(visits.task_units))
    optional_visits = {
        k for k in everything if all(map(visits.is_optional, visits.with_whole_groups([k])))
    }
    if requirements.budget is not None:
        required = {
            k
            for what in requirements.mandatory
            for k in visits.with_whole_groups(visits.resolve_visits(what))
        }
        optional_visits = set(everything) - required
    last = required_last_visit(visits)
    if last is not None:
        optional_visits -= set(visits.with_whole_groups([last]))
    for k in everything:
        earliest, latest = windows.start_limits(k)
        first_task = visits.leaf_task(visits.task_units[k].entry)
        yield Visit(
            visits.names[k],
            service=services[k],
            mandatory=k not in optional_visits,
            prize=first_task.priority if k in optional_visits else 0,
            earliest=earliest,
            latest=latest,
        )


def _rounds(visits: Visits, matrix: TravelMatrix) -> Iterator[Round]:
    for group_unit, members in visits.group_units:
        group = visits.chain.flow.groups[group_unit.group]
        yield Round(
            Message("group '{group}'", group=group.name),
            members,
            repeat=group.count,
            duration=matrix.units_rounded_up(group.duration),
            soft=not group.hard,
        )


def _battery(
    visits: Visits, matrix: TravelMatrix, times: NDArray[np.float64], energies: NDArray[np.float64]
) -> EnergyBudget | None:
    """Return the energy budget; None if it is unknown, or if one charge lasts in every order."""
    if matrix.battery is None or matrix.charging <= 0.0:
        return None
    if _max_energy(visits, matrix, times, energies) <= matrix.battery:
        return None
    used = np.where(np.isfinite(energies), energies, 0.0)
    used = np.ceil(matrix.charging_time_units(used) - _ROUNDING).astype(np.int64)
    return EnergyBudget(used, int(matrix.charging_time_units(np.array(matrix.battery))))


def _max_energy(
    visits: Visits, matrix: TravelMatrix, times: NDArray[np.float64], energies: NDArray[np.float64]
) -> float:
    """Return an upper bound in Wh on the energy of any order, with the drive to the end."""
    n = len(visits.task_units)
    is_path = np.isfinite(energies) & (times > 0.0)
    worst = np.where(is_path, energies, 0.0).max(axis=0, initial=0.0)
    longest = np.where(is_path, times, 0.0).max(axis=0, initial=0.0)
    power = float((energies[is_path] / times[is_path]).max(initial=0.0))  # Wh per unit

    def max_energy(units: tuple[Unit, ...]) -> float:
        total = 0.0
        for unit in units:
            if isinstance(unit, TaskUnit):
                total += worst[visits.visit_of_leaf[unit.entry]]
                continue
            group = visits.chain.flow.groups[unit.group]
            all_rounds = (group.count or np.inf) * max_energy(unit.inside)
            if group.duration:  # plus the round that is under way at that time
                round_ = float(longest[visits.visits_in(unit.inside)].sum())
                all_rounds = min(all_rounds, power * (group.duration / matrix.unit + round_))
            total += all_rounds
        return float(total)

    return max_energy(visits.chain.units) + float(worst[n])
