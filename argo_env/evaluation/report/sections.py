"""Sections of a report: plans, unsuccessful runs, and how the evaluation was made.

They have no time of day, so that equal rows give an equal report.
"""

import re
import shlex
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

from markupsafe import Markup

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.version import __version__
from argo_env.evaluation.case import PlanName
from argo_env.evaluation.folder import FAILING, spec_file_names
from argo_env.evaluation.plots import failure_places
from argo_env.evaluation.quantities import QUANTITIES
from argo_env.evaluation.rates import PlanRate, shares_of_complete_worlds, success
from argo_env.evaluation.report.picture import render_plot
from argo_env.evaluation.report.texts import (
    explain_success_rate,
    number_ranges_text,
    number_with_noun,
)
from argo_env.evaluation.results import (
    EvaluationResults,
    FailureCluster,
    GroupRate,
    cluster_failures_by_location,
)
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot
from argo_env.site import Site


@dataclass(frozen=True)
class PlanSection:
    """Section of a report on one evaluated plan."""

    name: str
    rate: PlanRate
    worlds: int
    """number of worlds that count"""
    meaning: str
    """sentences on what the rate means"""
    faults: tuple[GroupRate, ...]
    outcomes: Counter[RunOutcome]


def plan_sections(results: EvaluationResults) -> list[PlanSection]:
    """Return a report's section for each evaluated plan, in the order of the plans."""
    plans = results.plan.plans
    return [
        PlanSection(
            plan.label(plans),
            results.rate(plan),
            _count_worlds(results, plan),
            explain_success_rate(results, plan),
            results.by_faults(plan),
            Counter(row.outcome for row in results.rows_for(plan)),
        )
        for plan in plans
    ]


def other_rates_by_quantity_and_plan(results: EvaluationResults) -> list[tuple[str, str, PlanRate]]:
    """Return the rates of all quantities but success, as description, name of the plan, and rate.

    Quantities that make no sense are left out: detections without faults, and late ends without a
    limit.
    """
    plans = results.plan.plans
    ran = [row for row in results.rows if row.is_completed]
    left_out = {"success"}
    if not results.delays:
        left_out.add("detected")
    if all(row.limit is None for row in ran):
        left_out.add("late")
    if not ran:
        return []
    return [
        (_DESCRIPTIONS.get(name, name), plan.label(plans), results.rate(plan, name))
        for name in QUANTITIES
        if name not in left_out
        for plan in plans
        if results.rate(plan, name).runs
    ]


_DESCRIPTIONS = {
    "contact": "the robot touched something",
    "mishap": "the robot slipped, fell or stalled",
    "late": "the mission exceeded its limit of time",
    "detected": "all faults were found, if there were any",
    "false alarm": "the robot reported something that was not true",
}


def _count_worlds(results: EvaluationResults, plan: PlanName) -> int:
    """Return the number of worlds that count for the plan's success rate."""
    ran = [row for row in results.rows_for(plan) if row.is_completed]
    weights = {case.faults: case.weight for case in results.plan.cases if case.plan == plan}
    if results.plan.strata or len(weights) == 1:
        return len({row.seed for row in ran})
    return len(shares_of_complete_worlds(ran, weights, success))


_SECONDS = re.compile(r"\b\d+(?:\.\d+)?(?= s\b)")


@dataclass(frozen=True)
class FloorFailures:
    """Floor of a site on which runs failed."""

    site: str
    floor: int
    clusters: tuple[FailureCluster, ...]
    picture: Markup | None
    """drawing of the floor; None if the site can't be opened any more, or has no such floor"""
    why: str = ""
    """reason why the site can't be opened"""

    @property
    def runs(self) -> int:
        """Number of runs that failed on the floor."""
        return sum(cluster.runs for cluster in self.clusters)


def unsuccessful_rows_plans_specs(
    results: EvaluationResults, folder: Path
) -> list[tuple[RunRow, str, str]]:
    """Return each unsuccessful run: its row, the label of its plan, and the path of its spec file.

    The run can be repeated from that file, which lies in the folder. The path is quoted for a
    shell. It is empty if there is no such file.
    """
    plans = results.plan.plans
    names = spec_file_names(folder)
    runs = []
    for row in results.unsuccessful_rows:
        name = f"{row.key}.json"
        path = shlex.quote(str(folder / FAILING / name)) if name in names else ""
        runs.append((row, row.plan.label(plans), path))
    return runs


def reasons_by_plan_with_faults(
    results: EvaluationResults,
) -> list[tuple[tuple[str, str], int, list[str]]]:
    """Return the reasons why runs did not succeed, each with its plan, number of runs and faults.

    An item is ((name of the plan, reason), number of runs, names of their faults). The most
    frequent reasons come first. Reasons that differ only in seconds are merged.
    """
    plans = results.plan.plans
    groups: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for row in results.unsuccessful_rows:
        reason = row.reason if row.is_completed else f"{row.outcome.value}: {row.reason}"
        key = row.plan.label(plans), _SECONDS.sub("", reason)
        groups.setdefault(key, []).append((reason, results.faults_for(row)))
    ordered = sorted(groups.items(), key=lambda group: -len(group[1]))
    return [
        (
            (plan, _merge([reason for reason, _ in group])),
            len(group),
            list(dict.fromkeys(faults for _, faults in group)),
        )
        for (plan, _), group in ordered
    ]


def _merge(similar: list[str]) -> str:
    """Merge sentences that differ only in seconds into one with ranges such as `349 to 353 s`."""
    columns = zip(*(_SECONDS.findall(sentence) for sentence in similar), strict=True)
    ends = iter([(min(times, key=float), max(times, key=float)) for times in columns])

    def next_range(_: re.Match[str]) -> str:
        low, high = next(ends)
        return low if low == high else f"{low} to {high}"

    return _SECONDS.sub(next_range, similar[0])


def floors_with_failures(results: EvaluationResults) -> list[FloorFailures]:
    """Return the floors on which runs failed, with a drawing of each, site by site."""
    floors = []
    failing = [row for row in results.unsuccessful_rows if row.place and row.floor is not None]
    for reference, robot in dict.fromkeys((row.site, row.robot) for row in failing):
        site_results = replace(
            results,
            rows=tuple(row for row in failing if (row.site, row.robot) == (reference, robot)),
        )
        site, why = _open(reference, robot)
        name = reference if site is None else site.spec.title
        clusters = cluster_failures_by_location(site_results.rows)
        for floor in sorted({cluster.floor for cluster in clusters}):
            on_floor = tuple(cluster for cluster in clusters if cluster.floor == floor)
            drawing = None if site is None else _draw_floor(site_results, site, floor)
            floors.append(FloorFailures(name, floor, on_floor, drawing, why))
    return floors


def _open(reference: str, robot: str) -> tuple[Site | None, str]:
    """Return the site and an empty text, or None and the reason why it can't be opened.

    Its file may have been removed since the evaluation.
    """
    try:
        return open_site(reference, load_robot(robot)).site, ""
    except ArgoError as error:
        return None, str(error)


def _draw_floor(results: EvaluationResults, site: Site, floor: int) -> Markup | None:
    if floor not in {level.number for level in site.spec.floors}:
        return None
    failed = sum(row.floor == floor for row in results.rows)
    alt = f"Drawing of floor {floor} of {site.name}: {number_with_noun(failed, 'run')} failed there"
    return render_plot(alt, lambda: failure_places(results, site, floor))


def describe_evaluation(results: EvaluationResults) -> list[tuple[str, list[str]]]:
    """Return how an evaluation was made: names of facts, such as `Seeds`, each with its texts."""
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
    made = [(name, list(dict.fromkeys(values))) for name, values in names.items()]
    if plan.added:
        made.append(("On the site", [plan.added]))
    most_runs = len(cases) * len(plan.seeds)
    made.append(("Seeds", [number_ranges_text(plan.seeds)]))
    made.append(("Runs", [f"{len(results.rows)} of at most {most_runs}"]))
    if results.cut_short:
        made.append(("Ended", ["early; only worlds with all of their runs are reported"]))
    stopping = []
    if plan.stopping.require:
        stopping.append("when all requirements are decided")
    if plan.stopping.width is not None:
        stopping.append(f"when all intervals are no wider than {100 * plan.stopping.width:g} %")
    if stopping:
        interval = f"checked after every {number_with_noun(plan.stopping.every, 'seed')}"
        made.append(("Stops", [*stopping, interval]))
    made.append(("Argo", [__version__]))
    return made


def _weighted(name: str, weight: float) -> str:
    return name if weight == 1.0 else f"{name} (weight {weight:g})"
