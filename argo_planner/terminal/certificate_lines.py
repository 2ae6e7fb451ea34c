"""Lines on the terminal that say which claims about a suggested order are verified."""

from collections.abc import Iterator

from rich.console import Console
from rich.markup import escape

from argo_compiler.base.quantity_text import rounded_down
from argo_compiler.route.certificate import Certificate, CheckedClaim, Claim, Judgement
from argo_compiler.route.evaluation import evaluate
from argo_env.formatting import min_sec_text
from argo_planner.use_cases.routing import SuggestedOrder

_BEGINNINGS = {
    Judgement.CONFIRMED: "Verified",
    Judgement.OPEN: "Not verified",
    Judgement.REFUTED: "Wrong",
}


def show_certificate(found: SuggestedOrder, certificate: Certificate, console: Console) -> None:
    """Print for each claim about the order whether it is verified; skip bounds that say nothing."""
    for line in _lines(found, certificate):
        console.print(escape(line), soft_wrap=True)


def _lines(found: SuggestedOrder, certificate: Certificate) -> Iterator[str]:
    for one in certificate.claims:
        if one.judgement is Judgement.REFUTED or not _adds_nothing(found, one):
            claim = _claim_text(found, one.claim)
            yield f"{_BEGINNINGS[one.judgement]}: {claim} ({_reason_text(found, one)})"
    if certificate.refuted:
        yield "This is a defect of Argo: please report it with the mission and the command line"


def _adds_nothing(found: SuggestedOrder, one: CheckedClaim) -> bool:
    """Return True if a claim is about a bound that tells nothing about this mission.

    The bounds on the cost and on the prize tell nothing if the order is proven to be the best, or
    if no order was found. The bound on the prize tells nothing either if no task is optional.
    """
    if one.claim is Claim.PRIZE_BOUND and not found.planned.problem.selective:
        return True
    of_bounds = one.claim in (Claim.PRIZE_BOUND, Claim.BOUND)
    return of_bounds and (found.suggestion.proven or found.suggestion.route is None)


def _claim_text(found: SuggestedOrder, claim: Claim) -> str:
    made = found.suggestion
    match claim:
        case Claim.ROUTE:
            takes = evaluate(found.planned.problem, found.route).duration
            time = min_sec_text(found.to_seconds(takes))
            return f"the order meets all requirements and takes {time}"
        case Claim.PRIZE_BOUND:
            return f"no order is worth more than {made.prize_bound}"
        case Claim.BOUND:
            worth = f" worth {made.prize_bound}" if found.planned.problem.selective else ""
            bound = min_sec_text(found.to_seconds(made.bound), rounded_down)
            return f"no order{worth} takes less than {bound}"
        case Claim.BEST:
            return "no order is better"
        case Claim.NONE:
            return f"no order meets all requirements{found.planned.assumptions_clause}"
        case Claim.SUBSET:
            return "there is an order if any one of these is left out"


def _reason_text(found: SuggestedOrder, one: CheckedClaim) -> str:
    if one.counterexample is not None:
        worth = evaluate(found.planned.problem, one.counterexample)
        names = (found.planned.visits.names[visit] for visit in one.counterexample.order)
        takes = min_sec_text(found.to_seconds(worth.duration))
        return f"counterexample: {', '.join(names)}; it is worth {worth.prize} and takes {takes}"
    if one.shown is None:
        return one.why
    most, least = one.shown
    if most > (found.suggestion.prize or 0):
        return f"{one.why}: it only shows that none is worth more than {most}"
    time = min_sec_text(found.to_seconds(least), rounded_down)
    return f"{one.why}: it only shows that none takes less than {time}"
