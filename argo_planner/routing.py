"""A mission's best order: asked for, and applied."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.errors import ArgoError
from argo_compiler.il import Mission
from argo_compiler.reorder.mission import MissionRoute
from argo_compiler.reorder.precedences import require_known
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route.evaluation import Evaluation, evaluate
from argo_compiler.route.problem import NEVER, RouteProblem, Tour
from argo_compiler.route.robust import suggest_robust_route
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.suggestion import RouteSuggestion, suggest_route
from argo_env.files.yaml_file import read_yaml
from argo_env.formatting import clock
from argo_env.navigation import Navigator
from argo_env.planning.route_matrix import plan_mission
from argo_env.planning.travel import SiteTravel
from argo_env.run.record import Reordering

TIME_LIMIT = 5.0
"""s that a search takes at most, if nothing else is said"""


@dataclass(frozen=True, eq=False)
class Suggested:
    """What was found for a mission on a site."""

    planned: MissionRoute
    suggestion: RouteSuggestion
    travel: SiteTravel

    @property
    def written(self) -> Evaluation:
        """What the order is worth in which the mission is written."""
        return evaluate(self.planned.problem, self.planned.written)

    @property
    def route(self) -> Tour:
        """Raises ArgoError, in the mission's words, where there is no order."""
        if self.suggestion.route is None:
            raise ArgoError(why_none(self) or "there is no order")
        return self.suggestion.route

    @property
    def mission(self) -> Mission:
        """The mission in its new order. Raises ArgoError if there is none."""
        return apply_route(self.planned, self.route)

    @property
    def reordering(self) -> Reordering:
        """For the record of a run. Raises ArgoError if there is no order."""
        visits, route, problem = self.planned.visits, self.route, self.planned.problem
        tasks = [visits.spine.name(stop.entry) for stop in visits.stops]
        return Reordering(
            written=tuple(tasks),
            order=tuple(tasks[visit] for visit in route.order),
            written_duration=self.seconds(self.written.duration),
            duration=self.seconds(evaluate(problem, route).duration),
            bound=self.seconds(self.suggestion.bound),
            proven=self.suggestion.proven,
        )

    def seconds(self, units: int) -> float:
        return round(units * self.planned.problem.unit, 6)


def read_requirements(path: Path) -> Requirements:
    """The requirements in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it holds something else.
    """
    return read_yaml(
        path,
        Requirements,
        "requirements",
        not_yaml="route.not-yaml",
        duplicate_key="route.duplicate-key",
        wrong_field="route.wrong-field",
    )


def suggest(
    source: Path,
    mission: Mission,
    navigator: Navigator,
    requirements: Requirements,
    time_limit: float,
    seed: int,
) -> Suggested:
    """The best order of the mission that is found within the time limit (s). `source` is where it
    was read from, for messages.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: its order can't be changed, or a requirement does not fit it.
    """
    travel = SiteTravel(navigator)
    try:
        require_known(mission, requirements)  # before all ways are planned, which takes long
        planned = plan_mission(mission, navigator, requirements, travel)
    except DiagnosticError as error:
        raise DiagnosticError(str(source), error.diagnostics) from None
    except ArgoError as error:
        raise ArgoError(f"{source}: {error}") from None
    return Suggested(planned, suggest_route(planned.problem, time_limit, seed), travel)


def require_limit(mission: Mission, requirements: Requirements) -> None:
    """Raises ArgoError if nothing limits the mission's time."""
    limits = [mission.max_duration, requirements.budget, *(w.latest for w in requirements.windows)]
    if all(limit is None for limit in limits):
        raise ArgoError(
            "nothing limits this mission's time, so every order is completed in time: give "
            "--budget, or the mission a maximum duration"
        )


def suggest_robust(
    found: Suggested, spread: TravelSpread, time_limit: float, seed: int
) -> Suggested:
    """The order that is most probably kept to within all limits of time, instead.

    Raises ArgoError if there is no order.
    """
    problem = found.planned.problem
    robust = suggest_robust_route(problem, spread, time_limit, seed)
    nominal, route = robust.nominal, robust.route
    made = set(route.order)
    shortest = nominal.route == route
    text = f"robust: the best of {robust.tried} orders that were tried"
    if not shortest:
        text += f"; the shortest one is in time with {robust.nominal_completion.probability:.1%}"
    suggestion = replace(
        nominal,
        route=route,
        prize=robust.prize,
        cost=evaluate(problem, route).cost(problem.objective),
        proven=nominal.proven and shortest,
        dropped=tuple(k for k in range(problem.size) if k not in made),
        reasons=(*nominal.reasons, text),
    )
    return replace(found, suggestion=suggestion)


def optimised(source: Path, mission: Mission, navigator: Navigator) -> tuple[Mission, Reordering]:
    """The mission in its best order, and what is said of it. Prints how much time that saves.

    Raises ArgoError if its order can't be changed, or there is none that meets all that it asks
    for.
    """
    found = suggest(source, mission, navigator, Requirements(), TIME_LIMIT, 0)
    if why := why_none(found):
        raise ArgoError(f"{source}: {why}")
    done = found.reordering
    order = ", ".join(done.order)
    text = (
        f"Order: {order}\nPredicted: {clock(done.duration)}, as written "
        f"{clock(done.written_duration)}{'; no order is better' if done.proven else ''}"
    )
    Console(highlight=False).print(escape(text), soft_wrap=True)
    return found.mission, done


def why_none(found: Suggested) -> str | None:
    """Why there is no order, or none with anything in it; None: there is one."""
    if found.suggestion.route is None:
        return _why_no_route(found)
    if not found.suggestion.order and found.planned.problem.size:
        return _why_empty(found)
    return None


def _why_no_route(found: Suggested) -> str:
    suggestion, problem = found.suggestion, found.planned.problem
    if len(suggestion.infeasible_subset) == 1:
        text = f"this can't be met: {suggestion.infeasible_subset[0]}"
    elif suggestion.infeasible_subset:
        lines = [f"  - {words}" for words in suggestion.infeasible_subset]
        text = "\n".join(
            ["no order meets all of this, though it would without any one of it:", *lines]
        )
    elif not suggestion.proven:
        text = "no order was found in time; allow more with --time-limit"
    elif cut_off := _cut_off(problem):
        text = f"no way leads to {cut_off}, or none on from there: look at the site's map there"
    else:
        text = (
            "no order meets all that is asked for, and what of it clashes was not found: look at "
            "the time limits first, then at what has to come before what, and leave some of it out"
        )
    limit, written = problem.max_duration, found.written.duration
    if limit is not None and written > limit and not problem.selective:
        text += f"\nAs it is written, the mission takes {clock(found.seconds(written))}"
        if found.written.waiting:
            text += f", {clock(found.seconds(found.written.waiting))} of it spent waiting"
        text += "; "
        text += "with --budget, what does not fit is left out."
    return text


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


def _why_empty(found: Suggested) -> str:
    """All may be left out, and is."""
    problem = found.planned.problem
    limit = problem.words.get("max_duration", "what is asked for")
    group = {visit: one for one in problem.rounds for visit in one.members}
    alone = [
        Tour(group[visit].members if visit in group else (visit,)) for visit in range(problem.size)
    ]
    free = replace(problem, max_duration=None)
    worth = [(evaluate(free, route), route.order[0]) for route in alone]
    takes = [(one.duration, visit) for one, visit in worth if one.feasible]
    if not takes:
        return f"nothing fits within the {limit}"
    least, visit = min(takes)
    which = group[visit].name if visit in group else problem.visits[visit].name
    nearest = f"the nearest, {which}, takes {clock(found.seconds(least))}"
    if problem.max_duration is not None and least > problem.max_duration:
        return f"nothing fits within the {limit}: {nearest}; allow more"
    return (
        f"nothing was found that is sure to fit within the {limit}, though {nearest}: allow more, "
        "or more time to search with --time-limit"
    )
