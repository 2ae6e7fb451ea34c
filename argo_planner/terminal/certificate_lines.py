"""What could be verified of a suggested order, on the terminal."""

from collections.abc import Iterator

from rich.console import Console
from rich.markup import escape

from argo_compiler.route.certificate import Certificate, CheckedClaim, Claim, Judgement
from argo_compiler.route.evaluation import evaluate
from argo_env.formatting import clock
from argo_planner.use_cases.routing import Suggested

_BEGINNINGS = {
    Judgement.CONFIRMED: "Verified",
    Judgement.OPEN: "Not verified",
    Judgement.REFUTED: "Wrong",
}


def show_certificate(found: Suggested, certificate: Certificate, console: Console) -> None:
    """Prints a line for each claim that says something of this mission."""
    for line in _lines(found, certificate):
        console.print(escape(line), soft_wrap=True)


def _lines(found: Suggested, certificate: Certificate) -> Iterator[str]:
    for one in certificate.claims:
        if one.judgement is Judgement.REFUTED or not _goes_without_saying(found, one):
            what = _claimed(found, one.claim)
            yield f"{_BEGINNINGS[one.judgement]}: {what} ({_why(found, one)})"
    if certificate.refuted:
        yield "That is a defect of Argo: please report it, with the mission and what you asked for"


def _goes_without_saying(found: Suggested, one: CheckedClaim) -> bool:
    """The best order proves the bounds as well; without one, or anything optional, they say
    nothing."""
    if one.claim is Claim.PRIZE_BOUND and not found.planned.problem.selective:
        return True
    of_bounds = one.claim in (Claim.PRIZE_BOUND, Claim.BOUND)
    return of_bounds and (found.suggestion.proven or found.suggestion.route is None)


def _claimed(found: Suggested, claim: Claim) -> str:
    made = found.suggestion
    match claim:
        case Claim.ROUTE:
            takes = evaluate(found.planned.problem, found.route).duration
            return f"the order keeps to everything and takes {clock(found.seconds(takes))}"
        case Claim.PRIZE_BOUND:
            return f"no order is worth more than {made.prize_bound}"
        case Claim.BOUND:
            worth = f" worth {made.prize_bound}" if found.planned.problem.selective else ""
            return f"no order{worth} takes less than {clock(found.seconds(made.bound))}"
        case Claim.BEST:
            return "no order is better"
        case Claim.NONE:
            return f"no order meets all that is asked for{found.planned.if_assumed}"
        case Claim.SUBSET:
            return "without any one of these there is an order"


def _why(found: Suggested, one: CheckedClaim) -> str:
    if one.counterexample is not None:
        worth = evaluate(found.planned.problem, one.counterexample)
        names = (found.planned.visits.names[visit] for visit in one.counterexample.order)
        takes = clock(found.seconds(worth.duration))
        return f"{', '.join(names)}: worth {worth.prize}, and takes {takes}"
    if one.shown is None:
        return one.why
    most, least = one.shown
    if most > found.suggestion.prize:
        return f"{one.why}: by it, one may be worth {most}"
    return f"{one.why}: by it, one may take {clock(found.seconds(least))}"
