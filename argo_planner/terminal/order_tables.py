"""Table and lines on the terminal for the best order of a mission."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_compiler.base.quantity_text import limit_text, rounded_down
from argo_compiler.il import Mission, Order
from argo_compiler.reorder.mission_problem import late_visit_texts
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.tour_pauses import TourPause, pauses_by_position
from argo_env.formatting import min_sec_text
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.words import insert_keep_order_option
from argo_planner.use_cases.routing import SuggestedOrder, duration_problem, estimate_completions

_MAX_VIOLATIONS = 3  # violations of the written order that are listed
_MAX_PRECEDENCES = 12  # precedences that are listed


def show_risk(found: SuggestedOrder, spread: TravelSpread, seed: int, console: Console) -> None:
    """Print how probable it is that the written and the suggested order keep all time limits."""
    problem = found.planned.problem
    both = estimate_completions(found, spread, seed)
    for name, done in zip(("As written", "Suggested"), both, strict=True):
        text = f"{name}: in time with a probability of {done.probability:.1%}"
        if done.duration < float("inf"):
            mean, most = (min_sec_text(x * problem.unit) for x in (done.duration, done.duration_95))
            text += f" ({done.low:.1%} to {done.high:.1%}); {mean} on average, "
            text += f"at most {most} in 95 % of the cases"
        console.print(escape(text), soft_wrap=True)
    console.print(escape(f"Spread of the travel times: {spread.source}"), soft_wrap=True)


def show_order(found: SuggestedOrder, console: Console) -> None:
    """Print the suggested order next to the written one, with its times and proof."""
    console.print(_table(found))
    for line in _lines(found):
        console.print(escape(line), soft_wrap=True)


def reordered_mission_lines(
    found: SuggestedOrder, mission: Mission, site: OpenedSite, output: Path
) -> Iterator[str]:
    """Yield lines that name the file of the reordered mission and notes on its duration."""
    yield f"Mission: {output}"
    limit = mission.max_duration
    if limit is not None and limit != found.planned.mission.max_duration:
        yield f"Its maximum duration is now the budget: {limit_text(limit)}"
    if wrong := duration_problem(mission, site):
        yield f"Note: with its exact travel times, {wrong}: search with a smaller budget"


def _table(found: SuggestedOrder) -> Table:
    planned, route = found.planned, found.route
    worth = evaluate(planned.problem, route)
    stops = pauses_by_position(planned.problem, route)
    before = found.written.arrivals
    written = {visit: k for k, visit in enumerate(planned.written.order)}
    late = {visit for _, visits in _unreached(found) for visit in visits}
    table = Table(title="Order", title_justify="left")
    for name in ("", "task", "begins", "was", "began"):
        table.add_column(name, justify="left" if name == "task" else "right")
    for k, visit in enumerate(route.order):
        for pause in stops.get(k, ()):
            table.add_row("", f"[italic]{escape(_pause(found, pause))}[/]", "", "", "")
        table.add_row(
            str(k + 1),
            escape(planned.visits.names[visit]),
            "not reached" if visit in late else min_sec_text(found.to_seconds(worth.arrivals[k])),
            str(written[visit] + 1),
            min_sec_text(found.to_seconds(before[written[visit]])),
        )
        if along := planned.visits.other_task_display_names(visit):
            table.add_row("", f"[italic]then {escape(', '.join(along))}[/]", "", "", "")
    for pause in stops.get(len(route.order), ()):
        table.add_row("", f"[italic]{escape(_pause(found, pause))}[/]", "", "", "")
    for visit in found.suggestion.dropped or ():
        table.add_row(
            "-",
            escape(planned.visits.names[visit]),
            "left out",
            str(written[visit] + 1),
            min_sec_text(found.to_seconds(before[written[visit]])),
            style="yellow",
        )
    return table


def _lines(found: SuggestedOrder) -> Iterator[str]:
    planned, suggestion = found.planned, found.suggestion
    problem, worth = planned.problem, evaluate(planned.problem, found.route)
    new, old = found.to_seconds(worth.duration), found.to_seconds(found.written.duration)
    yield f"As written: {min_sec_text(old)}" + _violations_text(found)
    change = (
        f", {min_sec_text(abs(old - new))} {'less' if new <= old else 'more'}" if new != old else ""
    )
    share = f" ({(old - new) / old:.0%})" if new < old and old > 0.0 else ""
    yield f"Suggested:  {min_sec_text(new)}{change}{share}"
    if suggestion.dropped:
        done, of = len(found.route.order), problem.size
        names = ", ".join(planned.visits.names[visit] for visit in suggestion.dropped)
        limit = problem.words.get("max_duration", "requirements")
        yield f"{done} of {of} tasks within the {limit}; left out: {names}"
    yield _proof(found)
    for pause in chain.from_iterable(pauses_by_position(problem, found.route).values()):
        refused = "" if pause.charger is None else "; no mission can charge, so -o can't write it"
        yield f"Pause: {_pause(found, pause)}{refused}"
    for words in late_visit_texts(planned, found.route):
        yield f"Note: {words}"
    if planned.mission.order is Order.PRECISE:
        yield "The mission requires its precise order: no task may change its place."
    for name, late in _unreached(found):
        members = ", ".join(planned.visits.names[visit] for visit in late)
        yield f"Note: the time of {name} is over before {members}: it includes the drive there"
    kept = list(dict.fromkeys(p.words for p in problem.precedences))
    for words in kept[:_MAX_PRECEDENCES]:
        yield f"Kept: {insert_keep_order_option(words)}"
    if len(kept) > _MAX_PRECEDENCES:
        yield f"Kept: {len(kept) - _MAX_PRECEDENCES} more"
    for reason in planned.reasons:
        yield f"Note: {reason}"
    for reason in suggestion.reasons:
        yield f"Search: {reason}"


def _unreached(found: SuggestedOrder) -> Iterator[tuple[str, list[int]]]:
    """Yield groups whose time is over before all of their tasks have been reached once.

    Each comes once, with the indices of all its visits that the suggested order reaches too late.
    """
    planned, route = found.planned, found.route
    problem, order = planned.problem, found.route.order
    arrivals = dict(zip(order, evaluate(problem, route).arrivals, strict=True))
    for one in problem.rounds:
        inside = [visit for visit in order if visit in one.members]
        if one.soft or not one.duration or not inside:
            continue
        begin, first = 0, order.index(inside[0])
        if first:
            before = order[first - 1]
            begin = arrivals[before] + problem.visits[before].service
        late = [visit for visit in inside if arrivals[visit] >= begin + one.duration]
        if late and first not in route.charges:
            yield one.name, late


def _pause(found: SuggestedOrder, pause: TourPause) -> str:
    how_long = min_sec_text(found.to_seconds(pause.duration))
    if pause.charger is not None:
        return f"charge {how_long} at {found.planned.problem.chargers[pause.charger]}"
    assert pause.visit is not None
    return f"wait {how_long} for {found.planned.visits.names[pause.visit]}"


def _violations_text(found: SuggestedOrder) -> str:
    """Return a clause on the requirements that the written order violates; empty if none."""
    limit = found.planned.problem.words.get("max_duration", "")
    broken = [
        limit  # in place of the violation's text, which has the problem's units
        if violation.startswith("it takes ")
        else violation.replace(" begins at ", "'s time window|").partition("|")[0]
        for violation in dict.fromkeys(found.written.violations)
    ]
    if not broken:
        return ""
    more = f" and {len(broken) - _MAX_VIOLATIONS} more" if len(broken) > _MAX_VIOLATIONS else ""
    return f", which violates: {'; '.join(broken[:_MAX_VIOLATIONS])}{more}"


def _proof(found: SuggestedOrder) -> str:
    suggestion = found.suggestion
    method = f" ({suggestion.method})" if suggestion.method else ""
    if suggestion.proven:
        return f"Proven: no order is better{method}"
    prize = suggestion.prize or 0
    if prize < suggestion.prize_bound:
        return (
            f"Not proven: worth {prize}, and no order is worth more than "
            f"{suggestion.prize_bound}{method}"
        )
    bound = min_sec_text(found.to_seconds(suggestion.bound), rounded_down)
    gap = f"{suggestion.gap or 0.0:.1%} less than this one"
    return f"Not proven: no order takes less than {bound}, {gap}{method}"
