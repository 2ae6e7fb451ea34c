"""What a report says of runs that are no success: why, where, and how each is made again."""

import re
import shlex
from dataclasses import dataclass, replace
from pathlib import Path

from markupsafe import Markup

from argo_compiler.base.errors import ArgoError
from argo_env.evaluation.folder import FAILING
from argo_env.evaluation.places import FailurePlace, failure_places_of
from argo_env.evaluation.plots import failure_places
from argo_env.evaluation.report.picture import picture
from argo_env.evaluation.report.words import counted
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunRow
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.site import Site

_SECONDS = re.compile(r"\b\d+(?:\.\d+)?(?= s\b)")


@dataclass(frozen=True)
class FloorFailures:
    """A floor of a site on which runs failed."""

    site: str
    floor: int
    spots: tuple[FailurePlace, ...]
    picture: Markup | None
    """of the floor; None: the site can't be opened any more"""
    why: str = ""
    """it can't"""

    @property
    def runs(self) -> int:
        """How many failed there."""
        return sum(spot.runs for spot in self.spots)


def failing_runs(results: EvaluationResults, folder: Path) -> list[tuple[RunRow, str, str]]:
    """Each run that is no success, of which plan it is, and the file in the folder from which it is
    made again, quoted as shells want it."""
    plans = results.plan.plans
    return [
        (row, row.plan.beside(plans), shlex.quote(str(folder / FAILING / f"{row.key}.json")))
        for row in results.failing
    ]


def reasons(results: EvaluationResults) -> list[tuple[tuple[str, str], int, list[str]]]:
    """Plan and reason of failures, how many have it, and with which faults; the most frequent ones
    first. Reasons that differ in how long something took only are one."""
    plans = results.plan.plans
    found: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for row in results.failing:
        said = row.reason if row.carried_out else f"{row.outcome.value}: {row.reason}"
        key = row.plan.beside(plans), _SECONDS.sub("", said)
        found.setdefault(key, []).append((said, results.faults_of(row)))
    ordered = sorted(found.items(), key=lambda one: -len(one[1]))
    return [
        (
            (plan, _put_together([said for said, _ in own])),
            len(own),
            list(dict.fromkeys(faults for _, faults in own)),
        )
        for (plan, _), own in ordered
    ]


def _put_together(alike: list[str]) -> str:
    """Sentences that differ in seconds only as one, in which these are `349 to 353 s`."""
    times = zip(*(_SECONDS.findall(said) for said in alike), strict=True)
    spans = iter([(min(each, key=float), max(each, key=float)) for each in times])

    def span(_: re.Match[str]) -> str:
        low, high = next(spans)
        return low if low == high else f"{low} to {high}"

    return _SECONDS.sub(span, alike[0])


def floors_with_failures(results: EvaluationResults) -> list[FloorFailures]:
    """The floors on which runs failed, with their pictures, site by site."""
    found = []
    failing = [row for row in results.failing if row.place and row.floor is not None]
    for reference, robot in dict.fromkeys((row.site, row.robot) for row in failing):
        own = replace(
            results,
            rows=tuple(row for row in failing if (row.site, row.robot) == (reference, robot)),
        )
        site, why = _site(reference, robot)
        name = reference if site is None else site.spec.title
        spots = failure_places_of(own.rows)
        for floor in sorted({spot.floor for spot in spots}):
            here = tuple(spot for spot in spots if spot.floor == floor)
            drawn = None if site is None else _drawn(own, site, floor)
            found.append(FloorFailures(name, floor, here, drawn, why))
    return found


def _site(reference: str, robot: str) -> tuple[Site | None, str]:
    """The site, or why it can't be opened: its file may have gone since."""
    try:
        return open_site(reference, load_robot(robot)).site, ""
    except ArgoError as error:
        return None, str(error)


def _drawn(own: EvaluationResults, site: Site, floor: int) -> Markup | None:
    if floor not in {one.number for one in site.spec.floors}:
        return None
    failed = sum(row.floor == floor for row in own.rows)
    alt = f"Plan of floor {floor} of {site.name}: {counted(failed, 'run')} failed there"
    return picture(alt, lambda: failure_places(own, site, floor))
