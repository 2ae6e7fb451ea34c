"""Messages that explain why a mission has no best order."""

from dataclasses import replace

import numpy as np

from argo_compiler.base.errors import Conflict, Remedy
from argo_compiler.base.message import Message, as_message
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_env.formatting import min_sec_text
from argo_planner.use_cases.routing import SuggestedOrder


def require_order(found: SuggestedOrder, source_name: str) -> None:
    """Raise Conflict, with the reason, if there is no order or only one without tasks."""
    if why := missing_order_error(found):
        raise Conflict(
            Message("{source_name}: {why}", source_name=source_name, why=why), remedies=why.remedies
        )


def missing_order_error(found: SuggestedOrder) -> Conflict | None:
    """Return an error that explains why there is no order, or only one without tasks, else None."""
    if found.suggestion.route is None:
        why = _no_route_error(found)
    elif not found.route.order and found.planned.problem.size:
        why = _empty_order_error(found)
    else:
        return None
    message = as_message(str(why))
    for reason in found.planned.reasons:
        message += Message("\nNote: {reason}", reason=reason)
    return Conflict(message, remedies=why.remedies)


def _no_route_error(found: SuggestedOrder) -> Conflict:
    suggestion, problem = found.suggestion, found.planned.problem
    remedies: tuple[Remedy, ...] = ()
    assumed = found.planned.assumptions_clause
    if len(suggestion.infeasible_subset) == 1:
        text = Message(
            "this requirement can't be met{assumed}: {infeasible_subset}",
            assumed=assumed,
            infeasible_subset=suggestion.infeasible_subset[0],
        )
    elif suggestion.infeasible_subset:
        text = Message(
            "no order meets all of these{assumed}, but one does if any of them is left out:",
            assumed=assumed,
        )
        for words in suggestion.infeasible_subset:
            text += Message("\n  - {words}", words=words)
    elif not suggestion.infeasible:
        text = Message("no order was found in time; search for longer")
        remedies += (Remedy.SEARCH_LONGER,)
    elif cut_off := _unreachable_names(problem):
        text = Message(
            "the robot can't reach {cut_off}, or can't leave again: check the site there",
            cut_off=cut_off,
        )
    else:
        text = Message(
            "no order meets all requirements{assumed}, and the search did not find "
            "which of them conflict: relax time limits first, then required orders",
            assumed=assumed,
        )
    limit, written = problem.max_duration, found.written.duration
    if limit is not None and written > limit and not problem.selective:
        text += Message(
            "\nIn its written order the mission takes {min_sec}",
            min_sec=min_sec_text(found.to_seconds(written)),
        )
        if found.written.waiting:
            text += Message(
                ", {min_sec} of it waiting",
                min_sec=min_sec_text(found.to_seconds(found.written.waiting)),
            )
        text += Message("; with a budget, tasks that do not fit are left out")
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
    return Message("{names}", names=tuple(names))


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
        return Conflict(
            Message("nothing fits within the {limit}{assumed}", limit=limit, assumed=assumed)
        )
    least, visit = min(takes)
    which = group[visit].name if visit in group else problem.visits[visit].name
    nearest = Message(
        "the nearest, {which}, takes {min_sec}",
        which=which,
        min_sec=min_sec_text(found.to_seconds(least)),
    )
    if problem.max_duration is not None and least > problem.max_duration:
        return Conflict(
            Message(
                "nothing fits within the {limit}{assumed}: {nearest}; allow more",
                limit=limit,
                assumed=assumed,
                nearest=nearest,
            )
        )
    return Conflict(
        Message(
            "no order was found that is sure to fit within the {limit}, although "
            "{nearest}: allow more, or more time to search",
            limit=limit,
            nearest=nearest,
        ),
        remedies=(Remedy.SEARCH_LONGER,),
    )
