"""Tests of the pages and pictures of evaluations, with rows made by hand."""

import html
import re
import shlex
from xml.etree import ElementTree

import pytest
from matplotlib.figure import Figure

import argo_compiler
from argo_env.evaluation import plots
from argo_env.evaluation.comparison import compare_plans
from argo_env.evaluation.detection import FaultDetection
from argo_env.evaluation.folder import replace_failing_specs
from argo_env.evaluation.plan import Stopping
from argo_env.evaluation.report.page import (
    comparison_page,
    evaluation_page,
    write_comparison_report,
    write_evaluation_report,
)
from argo_env.evaluation.report.picture import PALETTE
from argo_env.evaluation.report.sections import reasons_by_plan_with_faults
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.row import RunOutcome
from argo_env.files.checked_files import checked_page
from tests.argo_env.evaluation.conftest import plan_of
from tests.argo_env.evaluation.test_store import row

HOSTILE = "<script>alert('$x$')</script>"


def results_of(mission, name="mission", faults=("none", "brick"), fail=(3, 7), died=(), **plan):
    """Return results in twenty worlds with some failures, all at one location."""
    rows = []
    for seed in range(20):
        for number, faults_name in enumerate(faults):
            outcome = RunOutcome.FAILURE if seed in fail and number else RunOutcome.SUCCESS
            if seed in died:
                outcome = RunOutcome.DIED
            rows.append(
                row(
                    seed, key=f"{seed:012x}{number:012x}", mission=name, faults=faults_name,
                    outcome=outcome, reason=f"because of {name}", limit=400.0,
                    duration=None if outcome is RunOutcome.DIED else 300.0 + 2.0 * seed,
                    detections=(
                        FaultDetection(fault="brick", began=3.0, delay=None if seed == 5 else 7.5),
                    ) if number else (),
                    place=(3.0, 2.0, 0.0) if outcome is RunOutcome.FAILURE else None,
                    floor=1 if outcome is RunOutcome.FAILURE else None,
                )
            )  # fmt: skip
    return EvaluationResults(plan_of(mission, range(20), faults, name=name, **plan), tuple(rows))


def joined(first, second):
    """Return the results of both as one evaluation."""
    cases = (*first.plan.cases, *second.plan.cases)
    plan = first.plan.model_copy(update={"cases": cases})
    return EvaluationResults(plan, (*first.rows, *second.rows))


def svgs(page):
    return re.findall(r"<svg.*?</svg>", page, flags=re.S)


@pytest.fixture
def results(mission) -> EvaluationResults:
    return results_of(mission)


def test_the_page_has_the_numbers(results, tmp_path):
    replace_failing_specs(tmp_path, results)
    page = evaluation_page(results, tmp_path)
    assert "2 of 40 runs without success" in page
    assert "95.0 %" in page  # over both cases; 90 % with a brick
    assert "90.0 %" in page
    assert f"argo run {tmp_path}/failing/{results.unsuccessful_rows[0].key}.json" in page
    assert re.search(r"<td>brick</td><td class=\"n\">20</td><td class=\"n\">19</td>", page)
    assert "floor 1: 2 runs" in page


def test_only_runs_with_a_spec_file_have_a_command(mission, tmp_path):
    results = results_of(mission, fail=(3, 7, 9))
    first, *others = (row.key for row in results.unsuccessful_rows)
    page = evaluation_page(results, tmp_path)
    assert "There are no files from which they could be repeated." in page
    assert "argo run" not in section_failing(page)
    replace_failing_specs(tmp_path, results)
    assert section_failing(evaluation_page(results, tmp_path)).count("argo run") == 3
    for key in others:
        (tmp_path / "failing" / f"{key}.json").unlink()
    page = evaluation_page(results, tmp_path)
    assert "Those with a command can be repeated by it" in page
    assert re.findall(r"argo run \S*?(\w+).json", section_failing(page)) == [first]


def section_failing(page):
    return re.search(r'<section id="failing">.*?</section>', page, re.DOTALL)[0]


def test_equal_rows_give_an_equal_page(mission, tmp_path):
    pages = {evaluation_page(results_of(mission), tmp_path) for _ in range(2)}
    assert len(pages) == 1
    written = write_evaluation_report(tmp_path, results_of(mission))
    assert written.read_text(encoding="utf-8") in set(map(checked_page, pages))


def test_nothing_is_fetched_and_names_are_text(mission, tmp_path):
    page = evaluation_page(results_of(mission, HOSTILE, faults=("none", HOSTILE)), tmp_path)
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert not re.search(r"(href|src)=\"(?!#)", page)
    assert "default-src &#39;none&#39;" in page or "default-src 'none'" in page


def test_requirements_are_on_the_page(mission, tmp_path):
    stopping = Stopping(require=(parse_requirement("success >= 0.3"),))
    page = evaluation_page(results_of(mission, stopping=stopping), tmp_path)
    assert "all requirements are met" in page
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
        lambda ax: plots.success_share_over_time(results, ax),
        lambda ax: plots.heat_map_of_outcomes_by_faults(results, ax),
        lambda ax: plots.detection_delays(results, ax),
        lambda ax: plots.failure_places(results, open_site("umad").site, 1, ax),
        lambda ax: plots.histogram_of_duration_differences(compared, ax),
        lambda ax: plots.pairs_that_differ(compared, ax),
    ):
        ax = Figure().subplots()
        assert draw(ax) is ax
        assert ax.has_data()
        assert draw(None) is not ax


ODD_NAMES = ("$x^{$", "_hidden", "漢字 ☃", "bell\a", "two\nlines", "\\$", "<&>", "W" * 300)


@pytest.mark.parametrize(
    "name", [*ODD_NAMES[:2], *(pytest.param(n, marks=pytest.mark.long) for n in ODD_NAMES[2:])]
)
def test_any_name_can_be_drawn(mission, tmp_path, name):
    results = joined(results_of(mission, name, ("none", name)), results_of(mission, "other"))
    page = evaluation_page(results, tmp_path)
    assert "\a" not in page
    assert page.count("<svg") == page.count("</svg>")
    for svg in svgs(page):
        ElementTree.fromstring(svg)


def test_pictures_have_descriptions_and_do_not_affect_the_page(mission, tmp_path):
    results = joined(results_of(mission), results_of(mission, "other", fail=range(9)))
    page = evaluation_page(results, tmp_path)
    names = re.findall(r' id="([^"]+)"', page)
    assert len(names) == len(set(names))
    assert len(svgs(page)) >= 6
    for svg in svgs(page):
        assert re.search(r'role="img" aria-label="[^"]{10,}"', svg)
        assert "<style" not in svg
        used = set(re.findall(r"(?:#|\(#)([\w-]+)[\")]", svg))
        assert used <= set(re.findall(r'id="([^"]+)"', svg))
        # All colours are variables of the page, which has other values in dark mode.
        assert not re.search(r"#[0-9a-f]{6}\b", svg)
    style = page[page.index("<style>") : page.index("</style>")]
    assert {f"--{name}" for name in PALETTE} <= set(re.findall(r"--[\w-]+(?=:)", style))


def test_pyplot_does_not_manage_the_pictures(results, tmp_path):
    from matplotlib import pyplot

    numbers = pyplot.get_fignums()
    evaluation_page(results, tmp_path)
    assert pyplot.get_fignums() == numbers


def test_all_plans_are_on_the_page(mission, tmp_path):
    results = joined(
        results_of(mission, "calm", fail=()), results_of(mission, "hasty", fail=range(20))
    )
    page = evaluation_page(results, tmp_path)
    for plan, rate in (("calm", "100.0 %"), ("hasty", "50.0 %")):
        assert re.search(rf"<h3>{plan}</h3>\s*<p><span class=\"rate\">{rate}</span>", page)
        assert re.search(rf"<td[^>]*>{plan}</td>", page)
    assert "40 runs in 20 worlds" in page
    assert "8 more" in page  # unsuccessful runs, in the closed section


def test_times_faults_and_places_have_their_numbers(results, tmp_path):
    page = evaluation_page(results, tmp_path)
    # Each world has two runs and takes 2 s more: the 4th, 20th, 36th and last success of 40 runs.
    times = re.findall(r'<td class="n">(\d\d:\d\d)</td>', page)
    assert times == ["05:02", "05:20", "05:36", "05:38", "06:40"]
    assert ">5.0 %<" in page
    assert re.search(r"<td>brick</td><td class=\"n\">20</td><td class=\"n\">19</td>.*7.5 s", page)
    assert re.search(r"<td>no task</td><td class=\"n\">3.0, 2.0 m</td><td class=\"n\">2</td>", page)
    assert "0 to 19" in page
    assert argo_compiler.__version__ in page


def test_without_limits_and_faults_there_is_less(mission, tmp_path):
    full = results_of(mission, faults=("none",), fail=())
    rows = tuple(row.model_copy(update={"limit": None}) for row in full.rows)
    page = evaluation_page(EvaluationResults(full.plan, rows), tmp_path)
    assert "the mission exceeded its limit of time" not in page
    assert "all faults were found" not in page
    for section in ("delays", "outcomes", "failures", "failing", "requirements"):
        assert f'<section id="{section}"' not in page
    assert ">none</td>" in page
    empty = evaluation_page(EvaluationResults(full.plan, ()), tmp_path)
    assert "no run could be carried out" in empty


def test_reasons_that_differ_in_time_only_are_one(mission):
    results = results_of(mission, fail=(3, 7, 9))
    texts = iter(("it took 349.5 s of 300 s", "it took 1001 s of 300 s", "failed: MEASURE 4"))
    rows = tuple(
        row if row.success else row.model_copy(update={"reason": next(texts)})
        for row in results.rows
    )
    assert reasons_by_plan_with_faults(EvaluationResults(results.plan, rows)) == [
        (("mission", "it took 349.5 to 1001 s of 300 s"), 2, ["brick"]),
        (("mission", "failed: MEASURE 4"), 1, ["brick"]),
    ]


def test_a_site_that_was_removed_only_loses_its_pictures(mission, tmp_path):
    results = results_of(mission)
    rows = tuple(row.model_copy(update={"site": "/gone/site.yaml"}) for row in results.rows)
    spec = results.plan.cases[0].spec.model_copy(update={"site": "/gone/site.yaml"})
    cases = tuple(case.model_copy(update={"spec": spec}) for case in results.plan.cases)
    plan = results.plan.model_copy(update={"cases": cases})
    page = evaluation_page(EvaluationResults(plan, rows), tmp_path)
    assert "There is no drawing of this floor" in page
    assert "3.0, 2.0 m" in page


def test_a_folder_with_a_space_has_commands_that_work(results, tmp_path):
    replace_failing_specs(tmp_path / "two words", results)
    page = html.unescape(evaluation_page(results, tmp_path / "two words"))
    command = re.search(r"<code>(argo run .*?)</code>", page)[1]
    key = results.unsuccessful_rows[0].key
    assert shlex.split(command)[2] == str(tmp_path / "two words" / "failing" / f"{key}.json")


def test_the_page_of_a_comparison_has_the_tests_and_intervals(mission, tmp_path):
    compared = compare_plans(
        results_of(mission, "calm", fail=()), results_of(mission, "hasty", fail=range(8))
    )
    page = write_comparison_report(tmp_path, tmp_path, tmp_path / "b", compared).read_text(
        encoding="utf-8"
    )
    assert "A succeeds more often." in page
    assert "+20.0 %" in page
    assert "none: the same in all worlds" in page  # of times
    assert "succeeds in 40 of 40 runs" in page
    assert "A test over worlds" in page
    assert f"{100 * compared.power(0.05):.0f} %" in page
    assert page == checked_page(comparison_page(compared, tmp_path, tmp_path / "b"))


def test_few_worlds_show_no_difference_of_the_times(mission):
    calm, hasty = (results_of(mission, name, fail=()) for name in ("calm", "hasty"))

    def compared_in(worlds):
        rows = [row for row in hasty.rows if row.seed < worlds]
        slower = (row.model_copy(update={"duration": row.duration + 100.0}) for row in rows)
        return compare_plans(calm, EvaluationResults(hasty.plan, tuple(slower)))

    few, many = compared_in(5), compared_in(6)
    assert "A is faster where both succeed, but 5 worlds can't exclude chance" in few.conclusion
    assert "evaluate at least 6" in few.conclusion
    assert many.conclusion.endswith("A is faster where both succeed.")
    for compared in (few, many):
        assert "none: the same in all worlds" in comparison_page(compared)


def test_a_comparison_of_failures_has_a_page(mission):
    failures = results_of(mission, HOSTILE, ("none", HOSTILE), fail=range(20))
    page = comparison_page(compare_plans(failures, results_of(mission, "b", ("none", HOSTILE))))
    assert "<script>" not in page
    lost = results_of(mission, died=range(20))
    page = comparison_page(compare_plans(lost, lost))
    assert "0 pairs" in page
    assert "nan" not in re.sub(r"<svg.*?</svg>", "", page, flags=re.S)
    assert 'id="times"' not in page
