"""The pages and pictures of evaluations, from rows that were made by hand."""

import re

import pytest
from matplotlib.figure import Figure

from argo_env.evaluation import plots
from argo_env.evaluation.comparison import compare_plans
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.plan import EvaluationCase, EvaluationPlan, Stopping
from argo_env.evaluation.report.page import (
    comparison_page,
    evaluation_page,
    write_evaluation_report,
)
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.run.spec import RunSpec

HOSTILE = "<script>alert('$x$')</script>"


def results_of(mission, name="mission", faults=("none", "brick"), fail=(3, 7), died=(), **plan):
    """Twenty worlds with some failures in them, at one place."""
    spec = RunSpec(mission=mission, drive="route")
    cases = tuple(EvaluationCase(mission=name, faults=one, spec=spec) for one in faults)
    rows = []
    for seed in range(20):
        for number, one in enumerate(faults):
            outcome = RunOutcome.FAILURE if seed in fail and number else RunOutcome.SUCCESS
            if seed in died:
                outcome = RunOutcome.DIED
            rows.append(
                RunRow(
                    key=f"{seed:012x}{number:012x}", mission=name, policy="as written", site="umad",
                    robot="tracker", drive="route", sensor="ideal", faults=one, seed=seed,
                    outcome=outcome, reason=f"because of {name}", limit=400.0,
                    duration=None if outcome is RunOutcome.DIED else 300.0 + 2.0 * seed,
                    detections=(
                        FaultDetection(fault="brick", began=3.0, delay=None if seed == 5 else 7.5),
                    ) if number else (),
                    place=(3.0, 2.0, 0.0) if outcome is RunOutcome.FAILURE else None,
                    floor=1 if outcome is RunOutcome.FAILURE else None,
                )
            )  # fmt: skip
    return EvaluationResults(
        EvaluationPlan(cases=cases, seeds=tuple(range(20)), **plan), tuple(rows)
    )


@pytest.fixture
def results(mission) -> EvaluationResults:
    return results_of(mission)


def test_the_page_has_the_numbers(results, tmp_path):
    page = evaluation_page(results, tmp_path)
    assert "2 of 40 runs are no success" in page
    assert "95.0 %" in page  # of both, and 90 of those with a brick
    assert "90.0 %" in page
    assert f"argo run {tmp_path}/failing/{results.failing[0].key}.json" in page
    assert re.search(r"<td>brick</td><td class=\"n\">20</td><td class=\"n\">19</td>", page)
    assert "floor 1: 2 runs" in page


def test_equal_rows_give_an_equal_page(mission, tmp_path):
    pages = {evaluation_page(results_of(mission), tmp_path) for _ in range(2)}
    assert len(pages) == 1
    written = write_evaluation_report(tmp_path, results_of(mission))
    assert written.read_text(encoding="utf-8") in pages


def test_nothing_is_fetched_and_names_are_text(mission, tmp_path):
    page = evaluation_page(results_of(mission, HOSTILE, faults=("none", HOSTILE)), tmp_path)
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert not re.search(r"(href|src)=\"(?!#)", page)
    assert "default-src &#39;none&#39;" in page or "default-src 'none'" in page


def test_requirements_are_on_the_page(mission, tmp_path):
    stopping = Stopping(require=(parse_requirement("success >= 0.3"),))
    page = evaluation_page(results_of(mission, stopping=stopping), tmp_path)
    assert "all that was required is met" in page
    stopping = Stopping(require=(parse_requirement("detected >= 0.999"),))
    assert "not decided" in evaluation_page(results_of(mission, stopping=stopping), tmp_path)


@pytest.mark.parametrize(
    "odd",
    [
        {"fail": ()},
        {"faults": ("none",)},
        {"died": range(20)},
        {"died": (1,)},
        {"fail": range(20), "faults": ("none", "brick", "other")},
    ],
)
def test_odd_results_have_a_page_too(mission, tmp_path, odd):
    page = evaluation_page(results_of(mission, **odd), tmp_path)
    assert page.endswith("</html>") or page.rstrip().endswith("</html>")
    assert "nan" not in re.sub(r"<svg.*?</svg>", "", page, flags=re.S).lower().replace("nant", "")


def test_a_comparison_has_its_page(mission):
    compared = compare_plans(results_of(mission), results_of(mission, fail=()))
    page = comparison_page(compared)
    assert "No difference is shown." in page
    assert compared.successes.second_only == 2
    assert '<td class="n">2</td>' in page


def test_pictures_are_drawn_on_the_axes_that_are_given(results, mission):
    from argo_env.planning.opening import open_site

    compared = compare_plans(results, results_of(mission, fail=()))
    for draw in (
        lambda ax: plots.forest_of_rates(results, ax),
        lambda ax: plots.durations(results, ax),
        lambda ax: plots.outcomes_by_faults(results, ax),
        lambda ax: plots.detection_delays(results, ax),
        lambda ax: plots.failure_places(results, open_site("umad").site, 1, ax),
        lambda ax: plots.paired_differences(compared, ax),
    ):
        ax = Figure().subplots()
        assert draw(ax) is ax
        assert ax.has_data()
        assert draw(None) is not ax
