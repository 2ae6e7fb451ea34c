"""A mission's best order on the terminal."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from argo_compiler.analysis.quantities import time_words
from argo_compiler.il import Mission, Order
from argo_compiler.reorder.mission_problem import late_visits
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.robust_spread import TravelSpread
from argo_compiler.route.tour_pauses import TourPause, pauses
from argo_env.formatting import clock
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.words import order_said
from argo_planner.use_cases.routing import Suggested, completions, too_long

_BROKEN = 3  # requirements that the written order does not keep to, as far as they are shown
_SHOWN = 12  # orders to keep that are shown


def show_risk(found: Suggested, spread: TravelSpread, seed: int, console: Console) -> None:
    """Prints how probable it is that both orders keep to all limits."""
    problem = found.planned.problem
    both = completions(found, spread, seed)
    for name, done in zip(("As written", "Suggested"), both, strict=True):
        text = f"{name}: within all limits with {done.probability:.1%}"
        if done.duration < float("inf"):
            mean, most = (clock(x * problem.unit) for x in (done.duration, done.duration_95))
            text += f" ({done.low:.1%} to {done.high:.1%}); {mean} on average, {most} in 95 %"
        console.print(escape(text), soft_wrap=True)
    console.print(escape(f"Spread: {spread.source}"), soft_wrap=True)


def show(found: Suggested, console: Console) -> None:
    """Prints the suggested order beside the written one, and what is known of it."""
    console.print(_table(found))
    for line in _lines(found):
        console.print(escape(line), soft_wrap=True)


def written_lines(
    found: Suggested, mission: Mission, site: OpenedSite, output: Path
) -> Iterator[str]:
    """What is said of a mission that was written in its new order."""
    yield f"Mission: {output}"
    limit = mission.max_duration
    if limit is not None and limit != found.planned.mission.max_duration:
        yield f"Its maximum duration is the budget now: {time_words(limit)}"
    if wrong := too_long(mission, site):
        yield f"Note: on its own ways {wrong}: choose the order for less time"


def _table(found: Suggested) -> Table:
    planned, route = found.planned, found.route
    worth = evaluate(planned.problem, route)
    stops = pauses(planned.problem, route)
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
            "not reached" if visit in late else clock(found.seconds(worth.arrivals[k])),
            str(written[visit] + 1),
            clock(found.seconds(before[written[visit]])),
        )
        if along := planned.visits.other_tasks(visit):
            table.add_row("", f"[italic]then {escape(', '.join(along))}[/]", "", "", "")
    for pause in stops.get(len(route.order), ()):
        table.add_row("", f"[italic]{escape(_pause(found, pause))}[/]", "", "", "")
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
    for pause in chain.from_iterable(pauses(problem, found.route).values()):
        unsaid = "" if pause.charger is None else "; no mission says that, so -o can't write it"
        yield f"Pause: {_pause(found, pause)}{unsaid}"
    for words in late_visits(planned, found.route):
        yield f"Note: {words}"
    if planned.mission.order is Order.PRECISE:
        yield "The mission asks for a precise order: nothing may change places."
    for name, late in _unreached(found):
        members = ", ".join(planned.visits.names[visit] for visit in late)
        yield f"Note: the time of {name} is over before {members}: the way there counts"
    kept = list(dict.fromkeys(p.words for p in problem.precedences))
    for words in kept[:_SHOWN]:
        yield f"Kept: {order_said(words)}"
    if len(kept) > _SHOWN:
        yield f"Kept: {len(kept) - _SHOWN} more"
    for reason in planned.reasons:
        yield f"Note: {reason}"
    for reason in suggestion.reasons:
        yield f"Search: {reason}"


def _unreached(found: Suggested) -> Iterator[tuple[str, list[int]]]:
    """Groups that their time ends before all of their tasks have been reached once, and those tasks
    that it ends before, as visits."""
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


def _pause(found: Suggested, pause: TourPause) -> str:
    how_long = clock(found.seconds(pause.duration))
    if pause.charger is not None:
        return f"charge {how_long} at {found.planned.problem.chargers[pause.charger]}"
    assert pause.visit is not None
    return f"wait {how_long} for {found.planned.visits.names[pause.visit]}"


def _broken(found: Suggested) -> str:
    """What the written order does not keep to."""
    limit = found.planned.problem.words.get("max_duration", "")
    broken = [
        # Else in the problem's units.
        limit
        if violation.startswith("it takes ")
        else violation.replace(" begins at ", "'s time window|").partition("|")[0]
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
