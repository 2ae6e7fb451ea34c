"""Messages that explain why a mission has no best order."""

from dataclasses import replace

import numpy as np

from argo_compiler.base.errors import Conflict, Remedy
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_env.formatting import min_sec_text
from argo_planner.use_cases.routing import SuggestedOrder


def require_order(found: SuggestedOrder, source_name: str) -> None:
    """Raise Conflict, with the reason, if there is no order or only one without tasks."""
    if why := missing_order_error(found):
        raise Conflict(f"{source_name}: {why}", remedies=why.remedies)


def missing_order_error(found: SuggestedOrder) -> Conflict | None:
    """Return an error that explains why there is no order, or only one without tasks, else None."""
    if found.suggestion.route is None:
        why = _no_route_error(found)
    elif not found.route.order and found.planned.problem.size:
        why = _empty_order_error(found)
    else:
        return None
    notes = (f"\nNote: {reason}" for reason in found.planned.reasons)
    return Conflict("".join([str(why), *notes]), remedies=why.remedies)


def _no_route_error(found: SuggestedOrder) -> Conflict:
    suggestion, problem = found.suggestion, found.planned.problem
    remedies: tuple[Remedy, ...] = ()
    assumed = found.planned.assumptions_clause
    if len(suggestion.infeasible_subset) == 1:
        text = f"this requirement can't be met{assumed}: {suggestion.infeasible_subset[0]}"
    elif suggestion.infeasible_subset:
        lines = [f"  - {words}" for words in suggestion.infeasible_subset]
        head = f"no order meets all of these{assumed}, but one does if any of them is left out:"
        text = "\n".join([head, *lines])
    elif not suggestion.infeasible:
        text = "no order was found in time; search for longer"
        remedies += (Remedy.SEARCH_LONGER,)
    elif cut_off := _unreachable_names(problem):
        text = f"the robot can't reach {cut_off}, or can't leave again: check the site there"
    else:
        text = (
            f"no order meets all requirements{assumed}, and the search did not find which of them "
            "conflict: relax time limits first, then required orders"
        )
    limit, written = problem.max_duration, found.written.duration
    if limit is not None and written > limit and not problem.selective:
        text += (
            f"\nIn its written order the mission takes {min_sec_text(found.to_seconds(written))}"
        )
        if found.written.waiting:
            text += f", {min_sec_text(found.to_seconds(found.written.waiting))} of it waiting"
        text += "; with a budget, tasks that do not fit are left out"
        remedies += (Remedy.GIVE_BUDGET,)
    return Conflict(text, remedies=remedies)


def _unreachable_names(problem: RouteProblem) -> str:
    """Return the names of mandatory visits that no path leads to, or none leads on from."""
    connected = problem.travel < NEVER
    np.fill_diagonal(connected, False)
    names = [
        visit.name
        for k, visit in enumerate(problem.visits)
        if visit.mandatory and not (connected[:, k].any() and connected[k].any())
    ]
    return ", ".join(names)


def _empty_order_error(found: SuggestedOrder) -> Conflict:
    """Return the error for an order in which all tasks are left out."""
    problem = found.planned.problem
    limit = problem.words.get("max_duration", "requirements")
    assumed = found.planned.assumptions_clause
    group = {visit: one for one in problem.rounds for visit in one.members}
    alone = [
        Tour(group[visit].members if visit in group else (visit,)) for visit in range(problem.size)
    ]
    free = replace(problem, max_duration=None)
    worth = [(evaluate(free, route), route.order[0]) for route in alone]
    takes = [(one.duration, visit) for one, visit in worth if one.feasible]
    if not takes:
        return Conflict(f"nothing fits within the {limit}{assumed}")
    least, visit = min(takes)
    which = group[visit].name if visit in group else problem.visits[visit].name
    nearest = f"the nearest, {which}, takes {min_sec_text(found.to_seconds(least))}"
    if problem.max_duration is not None and least > problem.max_duration:
        return Conflict(f"nothing fits within the {limit}{assumed}: {nearest}; allow more")
    return Conflict(
        f"no order was found that is sure to fit within the {limit}, although {nearest}: allow "
        "more, or more time to search",
        remedies=(Remedy.SEARCH_LONGER,),
    )
