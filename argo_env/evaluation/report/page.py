"""Writes the pages. Equal results give equal bytes."""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

from jinja2 import Environment, StrictUndefined, Template

import argo_compiler
from argo_compiler.errors import Unavailable
from argo_compiler.files.writing import write_whole
from argo_env.evaluation.comparison import PlanComparison
from argo_env.evaluation.folder import FAILING, REPORT
from argo_env.evaluation.plots import (
    detection_delays,
    durations,
    failure_places,
    forest_of_rates,
    outcomes_by_faults,
    paired_differences,
)
from argo_env.evaluation.plots.canvas import as_svg
from argo_env.evaluation.rates import IntervalMethod
from argo_env.evaluation.report.words import headline, in_percent, meaning
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome
from argo_env.formatting import clock
from argo_env.planning.opening import open_site
from argo_env.robot.spec import load_robot

COMPARISON = "comparison.html"
_SHOWN = 100
"""failing runs that are listed; all are among the rows"""


def write_evaluation_report(folder: Path, results: EvaluationResults) -> Path:
    """Writes `report.html` into the folder of an evaluation and returns its path. Raises
    Unavailable where it can't be written."""
    return _write(folder / REPORT, evaluation_page(results, folder))


def write_comparison_report(folder: Path, compared: PlanComparison) -> Path:
    """Writes `comparison.html` into the folder of the first of two evaluations. Raises as
    `write_evaluation_report`."""
    return _write(folder / COMPARISON, comparison_page(compared))


def evaluation_page(results: EvaluationResults, folder: Path) -> str:
    """The report of an evaluation, whose files lie in the folder."""
    plans = results.plan.plans
    ran = any(row.carried_out for row in results.rows)
    return _template("evaluation.html.j2").render(
        name=results.plan.name,
        headline=headline(results),
        plans=[
            (plan.beside(plans), results.of(plan), results.rate(plan), meaning(results, plan))
            for plan in plans
        ],
        verdicts=[(v, v.plan.beside(plans) if len(plans) > 1 else "") for v in results.verdicts],
        groups=[
            (plan.beside(plans), results.by_faults(plan), results.by_seeds(plan)) for plan in plans
        ],
        outcomes=results.outcomes,
        lost=results.missing,
        forest=as_svg(forest_of_rates(results)) if ran else None,
        durations=as_svg(durations(results)) if any(r.success for r in results.rows) else None,
        heat=as_svg(outcomes_by_faults(results)) if results.rows else None,
        delays=as_svg(detection_delays(results)) if results.delays else None,
        found=[(kind, *_found(delays)) for kind, delays in results.delays.items()],
        places=_places(results),
        failing=results.failing[:_SHOWN],
        more=max(0, len(results.failing) - _SHOWN),
        faults_of=results.faults_of,
        folder=folder / FAILING,
        seeds=results.plan.seeds,
        variation=results.plan.variation.model_dump(exclude_none=True, exclude_defaults=True),
        sequence=IntervalMethod.SEQUENCE,
        version=argo_compiler.__version__,
    )


def comparison_page(compared: PlanComparison) -> str:
    """The report of a comparison."""
    both = any(a.success and b.success for a, b in compared.pairs)
    return _template("comparison.html.j2").render(
        compared=compared,
        pairs=compared.successes,
        histogram=as_svg(paired_differences(compared)) if both else None,
        powers=[(gain, compared.power(gain)) for gain in (0.02, 0.05, 0.1)],
        version=argo_compiler.__version__,
    )


def _places(results: EvaluationResults) -> list[tuple[str, int, int, str]]:
    """Of each floor on which runs failed: the site, the floor, how many did, and the picture."""
    found = []
    sites = dict.fromkeys((row.site, row.robot) for row in results.failing if row.place)
    for reference, robot in sites:
        site = open_site(reference, load_robot(robot)).site
        own = EvaluationResults(
            results.plan, tuple(r for r in results.rows if (r.site, r.robot) == (reference, robot))
        )
        for floor in sorted({r.floor for r in own.failing if r.place and r.floor is not None}):
            count = sum(row.floor == floor for row in own.failing)
            picture = as_svg(failure_places(own, site, floor))
            found.append((site.name, floor, count, picture))
    return found


def _found(delays: list[float | None]) -> tuple[int, int, float | None, float | None]:
    """How often a kind of fault happened, how often it was found, and the median and the longest
    time (s) until then."""
    times = sorted(delay for delay in delays if delay is not None)
    if not times:
        return len(delays), 0, None, None
    return len(delays), len(times), times[len(times) // 2], times[-1]


@cache
def _template(name: str) -> Template:
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    filters: dict[str, Callable[[float], str]] = {"clock": clock, "percent": in_percent}
    environment.filters.update(filters)
    environment.globals.update(outcome=RunOutcome, isnan=math.isnan, style=_text("style.css"))
    return environment.from_string(_text(name))


def _text(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _write(path: Path, text: str) -> Path:
    try:
        write_whole(path, text)
    except OSError as error:
        raise Unavailable(f"{path}: can't be written: {error.strerror}") from error
    return path
