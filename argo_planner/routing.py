"""A mission's best order: asked for, applied and shown."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.errors import ArgoError
from argo_compiler.il import Mission, Order
from argo_compiler.route.evaluation import Evaluation, evaluate
from argo_compiler.route.mission import MissionRoute
from argo_compiler.route.problem import Route
from argo_compiler.route.requirements import Requirements
from argo_compiler.route.rewriting import apply_route
from argo_compiler.route.robust import suggest_robust_route
from argo_compiler.route.robust_sampling import Draws, completion
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.suggest import suggest_route
from argo_compiler.route.suggestion import RouteSuggestion
from argo_env.navigation import Navigator
from argo_env.record import Reordering
from argo_env.route_matrix import plan_mission
from argo_env.seeding import generator
from argo_env.travel import SiteTravel
from argo_env.words import clock
from argo_env.yaml_file import read_yaml

TIME_LIMIT = 5.0
"""s that a search takes at most, if nothing else is said"""
_SAMPLES = 10_000  # of a mission, to tell how probable it is that it is in time
_BROKEN = 3  # requirements that the written order does not keep to, as far as they are shown
_SHOWN = 12  # orders to keep that are shown


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
    def route(self) -> Route:
        """Raises ArgoError, in the mission's words, where there is no order."""
        if self.suggestion.route is None:
            raise ArgoError(why_none(self))
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
        planned = plan_mission(mission, navigator, requirements, travel)
    except DiagnosticError as error:
        raise DiagnosticError(str(source), error.diagnostics) from None
    except ArgoError as error:
        raise ArgoError(f"{source}: {error}") from None
    return Suggested(planned, suggest_route(planned.problem, time_limit, seed), travel)


def suggest_robust(
    found: Suggested, spread: TravelSpread, time_limit: float, seed: int
) -> Suggested:
    """The order that is most probably kept to within all limits of time, instead.

    Raises ArgoError if nothing limits the mission's time, or there is no order.
    """
    problem = found.planned.problem
    if problem.max_duration is None and all(visit.latest is None for visit in problem.visits):
        raise ArgoError(
            "nothing limits this mission's time, so every order is completed in time: give "
            "--budget, or the mission a maximum duration"
        )
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


def show_risk(found: Suggested, spread: TravelSpread, seed: int, console: Console) -> None:
    """Prints how probable it is that both orders keep to all limits."""
    problem = found.planned.problem
    for name, route in (("As written", found.planned.written), ("Suggested", found.route)):
        done = completion(problem, route, Draws(spread, _SAMPLES, generator(seed, "route risk")))
        text = f"{name}: within all limits with {done.probability:.1%}"
        if done.duration < float("inf"):
            mean, most = (clock(x * problem.unit) for x in (done.duration, done.duration_95))
            text += f" ({done.low:.1%} to {done.high:.1%}); {mean} on average, {most} in 95 %"
        console.print(escape(text), soft_wrap=True)
    console.print(escape(f"Spread: {spread.source}"), soft_wrap=True)


def optimised(source: Path, mission: Mission, navigator: Navigator) -> tuple[Mission, Reordering]:
    """The mission in its best order, and what is said of it. Prints how much time that saves.

    Raises ArgoError if its order can't be changed, or there is none that meets all that it asks
    for.
    """
    found = suggest(source, mission, navigator, Requirements(), TIME_LIMIT, 0)
    if found.suggestion.route is None:
        raise ArgoError(f"{source}: {why_none(found)}")
    done = found.reordering
    order = ", ".join(done.order)
    text = (
        f"Order: {order}\nPredicted: {clock(done.duration)}, as written "
        f"{clock(done.written_duration)}{'; no order is better' if done.proven else ''}"
    )
    Console(highlight=False).print(escape(text), soft_wrap=True)
    return found.mission, done


def why_none(found: Suggested) -> str:
    """Why there is no order."""
    suggestion, written = found.suggestion, found.seconds(found.written.duration)
    if suggestion.clash:
        lines = [f"  - {escape(words)}" for words in suggestion.clash]
        text = "\n".join(
            ["no order meets all of this, though it would without any one of it:", *lines]
        )
    elif suggestion.proven:
        text = "no order meets all that is asked for"
    else:
        text = "no order was found in time; allow more with --time-limit"
    if found.planned.problem.max_duration is not None and found.written.duration > (
        found.planned.problem.max_duration
    ):
        text += f"\nAs it is written, the mission takes {clock(written)}; "
        text += "with --budget, what does not fit is left out."
    return text


def show(found: Suggested, console: Console) -> None:
    """Prints the suggested order beside the written one, and what is known of it."""
    console.print(_table(found))
    for line in _lines(found):
        console.print(escape(line), soft_wrap=True)


def _table(found: Suggested) -> Table:
    planned, route = found.planned, found.route
    worth = evaluate(planned.problem, route)
    before = found.written.arrivals
    written = {visit: k for k, visit in enumerate(planned.written.order)}
    table = Table(title="Order", title_justify="left")
    for name in ("", "task", "begins", "was", "began"):
        table.add_column(name, justify="left" if name == "task" else "right")
    for k, visit in enumerate(route.order):
        if k in route.charges:
            charger = planned.problem.chargers[route.charges[k]]
            table.add_row("", f"[italic]charge at {escape(charger)}[/]", "", "", "")
        table.add_row(
            str(k + 1),
            escape(planned.visits.names[visit]),
            clock(found.seconds(worth.arrivals[k])),
            str(written[visit] + 1),
            clock(found.seconds(before[written[visit]])),
        )
    for visit in found.suggestion.dropped:
        table.add_row(
            "-",
            escape(planned.visits.names[visit]),
            "left out",
            str(written[visit] + 1),
            clock(found.seconds(before[written[visit]])),
            style="yellow",
        )
    return table


def _lines(found: Suggested) -> Iterator[str]:
    planned, suggestion = found.planned, found.suggestion
    problem, worth = planned.problem, evaluate(planned.problem, found.route)
    new, old = found.seconds(worth.duration), found.seconds(found.written.duration)
    yield f"As written: {clock(old)}" + _broken(found)
    change = f", {clock(abs(old - new))} {'less' if new <= old else 'more'}" if new != old else ""
    share = f" ({(old - new) / old:.0%})" if new < old and old > 0.0 else ""
    yield f"Suggested:  {clock(new)}{change}{share}"
    if suggestion.dropped:
        done, of = len(suggestion.order), problem.size
        names = ", ".join(planned.visits.names[visit] for visit in suggestion.dropped)
        limit = problem.words.get("max_duration", "what is asked for")
        yield f"{done} of {of} tasks within the {limit}; left out: {names}"
    yield _proof(found)
    if planned.mission.order is Order.PRECISE:
        yield "The mission asks for a precise order: nothing may change places."
    kept = list(dict.fromkeys(p.words for p in problem.precedences))
    for words in kept[:_SHOWN]:
        yield f"Kept: {words}"
    if len(kept) > _SHOWN:
        yield f"Kept: {len(kept) - _SHOWN} more"
    for reason in planned.reasons:
        yield f"Note: {reason}"
    for reason in suggestion.reasons:
        yield f"Search: {reason}"


def _broken(found: Suggested) -> str:
    """What the written order does not keep to."""
    limit = found.planned.problem.words.get("max_duration", "")
    broken = [
        # Else in the problem's units.
        limit
        if violation.startswith("it takes ")
        else violation.replace(" is begun at ", "'s time window|").partition("|")[0]
        for violation in dict.fromkeys(found.written.violations)
    ]
    if not broken:
        return ""
    more = f" and {len(broken) - _BROKEN} more" if len(broken) > _BROKEN else ""
    return f", which does not keep to: {'; '.join(broken[:_BROKEN])}{more}"


def _proof(found: Suggested) -> str:
    suggestion = found.suggestion
    method = f" ({suggestion.method})" if suggestion.method else ""
    if suggestion.proven:
        return f"Proven: no order is better{method}"
    if suggestion.prize < suggestion.prize_bound:
        return (
            f"Not proven: worth {suggestion.prize}, and none is worth more than "
            f"{suggestion.prize_bound}{method}"
        )
    bound = clock(found.seconds(suggestion.bound))
    return f"Not proven: no order takes less than {bound}, {suggestion.gap or 0.0:.1%} less{method}"
