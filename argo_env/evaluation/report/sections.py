"""Sections of a report: plans, runs that are no success, and how the evaluation was made, without
the time of day, so that equal rows have an equal report."""

import re
import shlex
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

from markupsafe import Markup

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.version import __version__
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.folder import FAILING
from argo_env.evaluation.plots import failure_places
from argo_env.evaluation.rates import PlanRate, means_of, success
from argo_env.evaluation.report.picture import picture
from argo_env.evaluation.report.words import counted, meaning, ranges
from argo_env.evaluation.results import (
    EvaluationResults,
    FailureCluster,
    GroupRate,
    cluster_failures,
)
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.statistics import QUANTITIES
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.site import Site


@dataclass(frozen=True)
class PlanSection:
    """A plan as a report shows it."""

    name: str
    rate: PlanRate
    worlds: int
    """that count"""
    meaning: str
    faults: tuple[GroupRate, ...]
    outcomes: Counter[RunOutcome]


def plan_sections(results: EvaluationResults) -> list[PlanSection]:
    """One of each plan, in their order."""
    plans = results.plan.plans
    return [
        PlanSection(
            plan.beside(plans),
            results.rate(plan),
            _worlds(results, plan),
            meaning(results, plan),
            results.by_faults(plan),
            Counter(row.outcome for row in results.of(plan)),
        )
        for plan in plans
    ]


def other_rates(results: EvaluationResults) -> list[tuple[str, str, PlanRate]]:
    """What else can be so in a run, of which plan, and how often it was. Without what can't be:
    nothing is found where nothing is wrong, or late where there is no limit."""
    plans = results.plan.plans
    ran = [row for row in results.rows if row.carried_out]
    left_out = {"success"}
    if not results.delays:
        left_out.add("detected")
    if all(row.limit is None for row in ran):
        left_out.add("late")
    if not ran:
        return []
    return [
        (_WORDS.get(name, name), plan.beside(plans), results.rate(plan, name))
        for name in QUANTITIES
        if name not in left_out
        for plan in plans
        if results.rate(plan, name).runs
    ]


_WORDS = {
    "contact": "the robot touched something",
    "mishap": "there was trouble on the way",
    "late": "it took longer than it may",
    "detected": "all that was wrong was found, where anything was",
    "false alarm": "something was found that was not so",
}


def _worlds(results: EvaluationResults, plan: PlanName) -> int:
    """In how many worlds the plan's runs were that count."""
    ran = [row for row in results.of(plan) if row.carried_out]
    weights = {case.faults: case.weight for case in results.plan.cases if case.plan == plan}
    if results.plan.strata or len(weights) == 1:
        return len({row.seed for row in ran})
    return len(means_of(ran, weights, success))


_SECONDS = re.compile(r"\b\d+(?:\.\d+)?(?= s\b)")


@dataclass(frozen=True)
class FloorFailures:
    """A floor of a site on which runs failed."""

    site: str
    floor: int
    spots: tuple[FailureCluster, ...]
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
        spots = cluster_failures(own.rows)
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


def how_it_was_made(results: EvaluationResults) -> list[tuple[str, list[str]]]:
    """What was run, by name."""
    plan = results.plan
    cases = plan.cases
    names = {
        "Missions": [case.mission for case in cases],
        "Order of tasks": [case.policy for case in cases],
        "Sites": [case.spec.site for case in cases],
        "Robots": [case.spec.robot for case in cases],
        "Drives": [case.spec.drive for case in cases],
        "Sensors": [case.spec.sensor for case in cases],
        "Faults": [_weighted(case.faults, case.weight) for case in cases],
    }
    made = [(what, list(dict.fromkeys(said))) for what, said in names.items()]
    if plan.added:
        made.append(("On the site", [plan.added]))
    asked = len(cases) * len(plan.seeds)
    made.append(("Seeds", [ranges(plan.seeds)]))
    made.append(("Runs", [f"{len(results.rows)} of {asked} that there may be"]))
    if results.cut_short:
        made.append(("Ended", ["before its time; told are the worlds of which no run is missing"]))
    stopping = []
    if plan.stopping.require:
        stopping.append("when all that was required is decided")
    if plan.stopping.width is not None:
        stopping.append(f"when all intervals are no wider than {100 * plan.stopping.width:g} %")
    if stopping:
        looked = f"one looks after {counted(plan.stopping.every, 'seed')}"
        made.append(("Stops", [*stopping, looked]))
    made.append(("Argo", [__version__]))
    return made


def _weighted(name: str, weight: float) -> str:
    return name if weight == 1.0 else f"{name} (weight {weight:g})"
