"""Why a mission has no best order, in its own words."""

from dataclasses import replace

import numpy as np

from argo_compiler.base.errors import Conflict, Remedy
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_env.formatting import clock
from argo_planner.use_cases.routing import Suggested


def require_order(found: Suggested, source_name: str) -> None:
    """Raises Conflict, with the reason, if there is no order."""
    if why := why_none(found):
        raise Conflict(f"{source_name}: {why}", remedies=why.remedies)


def why_none(found: Suggested) -> Conflict | None:
    """Why there is no order, or none with anything in it; None: there is one."""
    if found.suggestion.route is None:
        why = _why_no_route(found)
    elif not found.suggestion.order and found.planned.problem.size:
        why = _why_empty(found)
    else:
        return None
    notes = (f"\nNote: {reason}" for reason in found.planned.reasons)
    return Conflict("".join([str(why), *notes]), remedies=why.remedies)


def _why_no_route(found: Suggested) -> Conflict:
    suggestion, problem = found.suggestion, found.planned.problem
    remedies: tuple[Remedy, ...] = ()
    assumed = found.planned.if_assumed
    if len(suggestion.infeasible_subset) == 1:
        text = f"this can't be met{assumed}: {suggestion.infeasible_subset[0]}"
    elif suggestion.infeasible_subset:
        lines = [f"  - {words}" for words in suggestion.infeasible_subset]
        head = f"no order meets all of this{assumed}, though it would without any one of it:"
        text = "\n".join([head, *lines])
    elif not suggestion.proven:
        text = "no order was found in time; allow more"
        remedies += (Remedy.SEARCH_LONGER,)
    elif cut_off := _cut_off(problem):
        text = f"no way leads to {cut_off}, or none on from there: look at the site's map there"
    else:
        text = (
            f"no order meets all that is asked for{assumed}, and what of it clashes was not found: "
            "look at the time limits first, then at what has to come before what, and leave some "
            "of it out"
        )
    limit, written = problem.max_duration, found.written.duration
    if limit is not None and written > limit and not problem.selective:
        text += f"\nAs it is written, the mission takes {clock(found.seconds(written))}"
        if found.written.waiting:
            text += f", {clock(found.seconds(found.written.waiting))} of it spent waiting"
        text += "; with a budget, what does not fit is left out"
        remedies += (Remedy.GIVE_BUDGET,)
    return Conflict(text, remedies=remedies)


def _cut_off(problem: RouteProblem) -> str:
    """What has to be visited and can't, or can't be left, wherever the robot is before or after."""
    some = problem.travel < NEVER
    np.fill_diagonal(some, False)
    names = [
        visit.name
        for k, visit in enumerate(problem.visits)
        if visit.mandatory and not (some[:, k].any() and some[k].any())
    ]
    return ", ".join(names)


def _why_empty(found: Suggested) -> Conflict:
    """All may be left out, and is."""
    problem = found.planned.problem
    limit = problem.words.get("max_duration", "what is asked for")
    assumed = found.planned.if_assumed
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
    nearest = f"the nearest, {which}, takes {clock(found.seconds(least))}"
    if problem.max_duration is not None and least > problem.max_duration:
        return Conflict(f"nothing fits within the {limit}{assumed}: {nearest}; allow more")
    return Conflict(
        f"nothing was found that is sure to fit within the {limit}, though {nearest}: allow more, "
        "or more time to search",
        remedies=(Remedy.SEARCH_LONGER,),
    )
