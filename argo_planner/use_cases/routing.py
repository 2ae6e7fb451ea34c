"""Search for the best order of a mission's tasks.

The best order wins the highest prize with its optional tasks, and of such orders it takes the least
time.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from argo_compiler.analysis import analyse
from argo_compiler.base.errors import ArgoError, Conflict, Invalid, Remedy, with_message_prefix
from argo_compiler.base.message import Message
from argo_compiler.base.quantity_text import rounded_down
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
from argo_compiler.route.robust_sampling import Completion, Draws, estimate_completion
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.stop import SearchProgress
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route
from argo_env.files.yaml_file import parse_yaml
from argo_env.formatting import min_sec_text
from argo_env.planning.opening import OpenedSite
from argo_env.planning.route_matrix import make_mission_problem
from argo_env.planning.travel import SiteTravel
from argo_env.run.record import Reordering
from argo_env.seeding import generator
from argo_planner.use_cases.importing import ImportedMission

TIME_LIMIT = 5.0
"""default limit of the wall-clock time of a search, in s"""

MAX_BYTES = 10_000_000
"""largest size of a file of requirements, in bytes"""

_VERIFICATION_TIME = 10.0  # s
_SAMPLES = 10_000  # random durations of an order, for the probability that it is in time


@dataclass(frozen=True, eq=False)
class SuggestedOrder:
    """Result of a search for the best order of a mission on a site."""

    planned: MissionProblem
    suggestion: RouteSuggestion
    travel: SiteTravel

    @property
    def written(self) -> RouteEvaluation:
        """Evaluation of the order in which the mission is written."""
        return evaluate(self.planned.problem, self.planned.written)

    @property
    def route(self) -> Tour:
        """The suggested order; raises Conflict if there is none (see `missing_order_error`)."""
        if self.suggestion.route is None:
            found = self.suggestion.infeasible
            raise Conflict(
                Message("no order meets all requirements")
                if found
                else Message("no order was found")
            )
        return self.suggestion.route

    @property
    def mission(self) -> Mission:
        """The mission in the suggested order.

        Raises ArgoError if there is no order, or no mission can express it, as it charges.
        """
        return apply_route(self.planned, self.route)

    @property
    def reordering(self) -> Reordering:
        """Both orders and their durations, for the record of a run.

        Raises Conflict if there is no suggested order.
        """
        visits, route, problem = self.planned.visits, self.route, self.planned.problem
        tasks = [visits.chain.name(stop.entry) for stop in visits.task_units]
        return Reordering(
            written=tuple(tasks),
            order=tuple(tasks[visit] for visit in route.order),
            written_duration=self.to_seconds(self.written.duration),
            duration=self.to_seconds(evaluate(problem, route).duration),
            bound=self.to_seconds(self.suggestion.bound),
            proven=self.suggestion.proven,
        )

    def to_seconds(self, units: int) -> float:
        """Convert a duration from the time units of the route problem to s."""
        return round(units * self.planned.problem.unit, 6)


def parse_requirements(content: bytes, source_name: str) -> Requirements:
    """Parse requirements in YAML, which messages call `source_name`.

    Raises:
        ArgoError: The content is no text or too large.
        DiagnosticError: It is no YAML, or has other fields.
    """
    require_size(content, source_name, Message("file of requirements"), MAX_BYTES)
    return parse_yaml(
        decode_text(content, source_name, Message("file of requirements")),
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
    solvers: Sequence[str] = (),
    on_progress: Callable[[SearchProgress, float], None] | None = None,
) -> SuggestedOrder:
    """Search for the best order of a mission; the result may be that there is none.

    Args:
        imported: the mission
        site: its site
        requirements: further requirements; None: there are none
        time_limit: longest wall-clock time of the search in s
        seed: seed of the search
        solvers: names of solvers of installed packages that take part besides Argo's own
        on_progress: function that is called with the progress and its unit of time in s

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: The order can't be changed, or a requirement does not fit the mission.
        NotFound: There is no solver of a name.
        Unavailable: The solver of an installed package can't be used.
    """
    name, mission = imported.source_name, imported.mission
    requirements = requirements or Requirements()
    wanted = _solvers_besides(solvers)
    try:
        require_known(mission, requirements)  # before all paths are planned, which takes long
        planned = make_mission_problem(mission, site.navigator, requirements, site.travel)
    except DiagnosticError as error:
        raise DiagnosticError(name, error.diagnostics) from None
    except ArgoError as error:
        raise with_message_prefix(error, name) from None
    with stage("searching for the best order") as report:

        def report_progress(progress: SearchProgress, *_: object) -> None:
            report(None, _progress_text(progress, planned.problem.unit))
            if on_progress is not None:
                on_progress(progress, planned.problem.unit)

        suggestion = suggest_route(
            planned.problem,
            time_limit,
            seed,
            on_best=report_progress,
            on_bound=report_progress,
            solvers=wanted,
        )
    return SuggestedOrder(planned, suggestion, site.travel)


def _solvers_besides(names: Sequence[str]) -> tuple[str, ...] | None:
    """Return the names of Argo's own solvers and of others; None if there are no others.

    Raises NotFound or Unavailable if one of the others can't be used.
    """
    if not names:
        return None
    from argo_compiler.route.solvers import all_solver_names, find_solver  # imports OR-Tools

    for name in names:
        find_solver(name)
    return (*all_solver_names(), *names)


def _progress_text(progress: SearchProgress, unit: float) -> str:
    """Return the shortest duration found so far and its lower bound in words.

    `unit` is the duration in s that one unit of the search stands for.
    """
    if progress.cost is None:
        return Message("none found so far")
    bound = min_sec_text(progress.bound * unit, rounded_down)
    return Message(
        "{min_sec} so far, none takes less than {bound}",
        min_sec=min_sec_text(progress.cost * unit),
        bound=bound,
    )


def require_any_time_limit(mission: Mission, requirements: Requirements) -> None:
    """Raise Invalid without a maximum duration, a budget and the end of any time window."""
    limits = [mission.max_duration, requirements.budget, *(w.latest for w in requirements.windows)]
    limits += [t.window.latest for t in mission.tasks if t.window and t.window.hard]
    if all(limit is None for limit in limits):
        raise Invalid(
            "nothing limits this mission's time, so every order is in time: give it a budget or a "
            "maximum duration",
            remedies=(Remedy.GIVE_BUDGET,),
        )


@stage("comparing orders with random travel times")
def suggest_robust_order(
    found: SuggestedOrder, spread: TravelSpread, time_limit: float, seed: int
) -> SuggestedOrder:
    """Return a copy of `found` with an order that probably keeps all time limits.

    Among the orders that the search tries, it is the one with the highest probability of being in
    time. If tasks may be left out, it is the one with the highest prize among those that are in
    time with a probability of at least 95 %; if there is none, the most probable one.

    Args:
        found: result of the search for the order that is best with nominal travel times.
        spread: distribution of the travel times.
        time_limit: longest wall-clock time of the search in s.
        seed: seed of the search and of the random travel times.

    Raises:
        ArgoError: There is no order.
    """
    problem = found.planned.problem
    robust = suggest_robust_route(problem, spread, time_limit, seed)
    nominal, route = robust.nominal, robust.route
    shortest = nominal.route == route
    text = Message("robust: the best of {tried} orders that were tried", tried=robust.tried)
    if not shortest:
        text += Message("; the shortest one is in time with a probability of ")
        text += f"{robust.nominal_completion.probability:.1%}"
    suggestion = replace(
        nominal,
        route=route,
        prize=robust.prize,
        cost=evaluate(problem, route).cost(problem.objective),
        proven=nominal.proven and shortest,
        dropped=route.left_out(problem.size),
        reasons=(*nominal.reasons, text),
    )
    return replace(found, suggestion=suggestion)


def duration_problem(mission: Mission, site: OpenedSite) -> str | None:
    """Return a message if a reordered mission exceeds its maximum duration, otherwise None.

    The search assumes one pose for each checkpoint; this computes the exact travel times, with
    poses that depend on where the robot comes from.
    """
    if mission.max_duration is None:
        return None
    found = analyse(mission, site.catalog, site.travel).diagnostics
    return next((d.message for d in found if d.code == "analysis.too-long"), None)


@stage("verifying the order")
def certify_order(found: SuggestedOrder) -> Certificate:
    """Return which claims of the search are confirmed by code that is independent of it."""
    return certify(found.planned.problem, found.suggestion, _VERIFICATION_TIME)


@stage("drawing random durations of both orders")
def estimate_completions(
    found: SuggestedOrder, spread: TravelSpread, seed: int
) -> tuple[Completion, Completion]:
    """Estimate how probable it is that the written and the suggested order keep all time limits.

    Returns:
        The estimate for the written order, then the one for the suggested order.

    Raises:
        Conflict: There is no suggested order.
    """
    problem = found.planned.problem
    written, suggested = (
        estimate_completion(problem, tour, Draws(spread, _SAMPLES, generator(seed, "route risk")))
        for tour in (found.planned.written, found.route)
    )
    return written, suggested
