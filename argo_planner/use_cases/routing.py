"""A mission's best order: asked for, and applied."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from argo_compiler.analysis import analyse
from argo_compiler.base.errors import ArgoError, Conflict, Invalid, Remedy, located
from argo_compiler.base.stages import stage
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.loading import decode_text, require_size
from argo_compiler.il import Mission
from argo_compiler.reorder.mission_problem import MissionProblem, require_known
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route.certificate import Certificate, certify
from argo_compiler.route.evaluation import RouteEvaluation, evaluate
from argo_compiler.route.problem import Tour
from argo_compiler.route.robust import suggest_robust_route
from argo_compiler.route.robust_sampling import Completion, Draws, completion
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.stop import SearchProgress
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route
from argo_env.files.yaml_file import parse_yaml
from argo_env.formatting import clock
from argo_env.planning.opening import OpenedSite
from argo_env.planning.route_matrix import plan_mission
from argo_env.planning.travel import SiteTravel
from argo_env.run.record import Reordering
from argo_env.seeding import generator
from argo_planner.use_cases.importing import ImportedMission

TIME_LIMIT = 5.0
"""s that a search takes at most, if nothing else is said"""

MAX_BYTES = 10_000_000
"""of a file of requirements"""

_VERIFIED = 10.0  # s that it may take to verify an order
_SAMPLES = 10_000  # of a mission, to tell how probable it is that it is in time


@dataclass(frozen=True, eq=False)
class Suggested:
    """What was found for a mission on a site."""

    planned: MissionProblem
    suggestion: RouteSuggestion
    travel: SiteTravel

    @property
    def written(self) -> RouteEvaluation:
        """What the order is worth in which the mission is written."""
        return evaluate(self.planned.problem, self.planned.written)

    @property
    def route(self) -> Tour:
        """Raises Conflict where there is no order; `why_none` tells more."""
        if self.suggestion.route is None:
            raise Conflict("there is no order that meets all that is asked for")
        return self.suggestion.route

    @property
    def mission(self) -> Mission:
        """The mission in its new order. Raises ArgoError if there is none."""
        return apply_route(self.planned, self.route)

    @property
    def reordering(self) -> Reordering:
        """For the record of a run. Raises ArgoError if there is no order."""
        visits, route, problem = self.planned.visits, self.route, self.planned.problem
        tasks = [visits.chain.name(stop.entry) for stop in visits.task_units]
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


def parse_requirements(content: bytes, source_name: str) -> Requirements:
    """The requirements in YAML, which messages call `source_name`.

    Raises ArgoError if it is no text, and DiagnosticError if it holds something else.
    """
    require_size(content, source_name, "file of requirements", MAX_BYTES)
    return parse_yaml(
        decode_text(content, source_name, "file of requirements"),
        source_name,
        Requirements,
        "requirements",
        not_yaml="route.not-yaml",
        duplicate_key="route.duplicate-key",
        wrong_field="route.wrong-field",
    )


def suggest_order(
    imported: ImportedMission,
    site: OpenedSite,
    requirements: Requirements | None = None,
    *,
    time_limit: float = TIME_LIMIT,
    seed: int = 0,
    heard: Callable[[SearchProgress, float], None] | None = None,
) -> Suggested:
    """The best order of the mission that is found within the time limit (s); `why_none` tells why
    there is none, where there is none. What is `heard` meanwhile is how far the search is, and how
    long (s) its unit of time is.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: its order can't be changed, or a requirement does not fit it.
    """
    name, mission = imported.source_name, imported.mission
    requirements = requirements or Requirements()
    try:
        require_known(mission, requirements)  # before all ways are planned, which takes long
        planned = plan_mission(mission, site.navigator, requirements, site.travel)
    except DiagnosticError as error:
        raise DiagnosticError(name, error.diagnostics) from None
    except ArgoError as error:
        raise located(error, name) from None
    with stage("searching for the best order") as tell:

        def found(progress: SearchProgress, *_: object) -> None:
            tell(None, _known(progress, planned.problem.unit))
            if heard is not None:
                heard(progress, planned.problem.unit)

        suggestion = suggest_route(planned.problem, time_limit, seed, on_best=found, on_bound=found)
    return Suggested(planned, suggestion, site.travel)


def _known(progress: SearchProgress, unit: float) -> str:
    """How far a search is, in words."""
    if progress.cost is None:
        return "none found so far"
    best, bound = (clock(units * unit) for units in (progress.cost, progress.bound))
    return f"{best} so far, none takes less than {bound}"


def require_limit(mission: Mission, requirements: Requirements) -> None:
    """Raises Invalid if nothing limits the mission's time."""
    limits = [mission.max_duration, requirements.budget, *(w.latest for w in requirements.windows)]
    limits += [t.window.latest for t in mission.tasks if t.window and t.window.hard]
    if all(limit is None for limit in limits):
        raise Invalid(
            "nothing limits this mission's time, so every order is completed in time: give it a "
            "budget, or the mission a maximum duration",
            remedies=(Remedy.GIVE_BUDGET,),
        )


@stage("trying orders with times that spread")
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


def too_long(mission: Mission, site: OpenedSite) -> str | None:
    """What is wrong if a mission in its new order takes longer than it may, reckoned on its own
    ways: the order was chosen with one place for each checkpoint, wherever the robot comes from."""
    if mission.max_duration is None:
        return None
    found = analyse(mission, site.catalog, site.travel).diagnostics
    return next((d.message for d in found if d.code == "analysis.too-long"), None)


@stage("verifying the order")
def verify(found: Suggested) -> Certificate:
    """What is sure of all that is said of the order, checked apart from the search."""
    return certify(found.planned.problem, found.suggestion, _VERIFIED)


@stage("drawing how long the orders take")
def completions(found: Suggested, spread: TravelSpread, seed: int) -> tuple[Completion, Completion]:
    """How probable it is that the written order and the suggested one keep to all limits, if times
    spread so. Raises Conflict if there is no order."""
    problem = found.planned.problem
    written, suggested = (
        completion(problem, tour, Draws(spread, _SAMPLES, generator(seed, "route risk")))
        for tour in (found.planned.written, found.route)
    )
    return written, suggested
