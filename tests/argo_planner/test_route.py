"""`argo route`, and the option `--optimise` of other commands."""

import json
import re
from dataclasses import replace

import pytest
from PIL import Image

from argo_compiler.base.model import Pose
from argo_compiler.files.mission_file import read_mission, write_mission
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, EventKind, Group, Order, Task, TimeWindow, WaitRule
from argo_compiler.route import RouteSuggestion, Tour, evaluate
from argo_env.run.record import RunRecord
from argo_planner.use_cases import routing
from tests.argo_planner.conftest import argo as run_argo
from tests.yard import measure, mission, waypoint

DOCK = Pose(x=1.05, y=1.05, z=0.02)


@pytest.fixture
def argo(yard_site, monkeypatch):
    """Return a function that runs `argo` on the yard in this process, and returns its output."""
    for command in ("route", "compile", "run", "check", "format", "import_script"):
        monkeypatch.setattr(f"argo_planner.commands.{command}.open_site", lambda _: yard_site)
    monkeypatch.setenv("COLUMNS", "120")

    def call(*arguments, status=0):
        result = run_argo(*arguments, status=status)
        return result.output if result.exception is None else f"{result.output}{result.exception}"

    return call


@pytest.fixture
def source(tmp_path):
    """Return the path of a mission whose order makes detours."""
    far, near = waypoint("far", 5.5, 2.5), waypoint("near", 2.2, 1.05)
    written = mission(
        measure(2), near, measure(3), measure(1), far,
        waypoint("DOCK", 1.05, 1.05), order=Order.ANY, dock=DOCK, designation="to and fro",
    )  # fmt: skip
    path = tmp_path / "mission.json"
    write_mission(written, path)
    return path


def order_in(path):
    return [task.name for task in read_mission(path).tasks]


def test_the_suggestion_is_shown_drawn_and_written(argo, source, tmp_path):
    written, pictures = tmp_path / "new.json", tmp_path / "pictures"
    said = argo("route", source, "-o", written, "--pictures", pictures, "--before", "3, 1")
    assert "Proven: no order is better" in said
    assert "Kept: checkpoint 3 before checkpoint 1" in said
    order = order_in(written)
    assert sorted(order) == sorted(order_in(source))
    assert (order[0], order[-1]) == ("START", "DOCK")
    assert order.index("MEASURE 3") < order.index("MEASURE 1")
    assert order != order_in(source)
    with Image.open(pictures / "floor-1.png") as picture:
        assert picture.size == (1280, 720)


def test_what_does_not_fit_into_a_budget_is_left_out(argo, source, tmp_path):
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("mandatory: [2]\noptional:\n- {what: far, priority: 3}\n")
    said = argo(
        "route", source, "--budget", "1 min", "--requirements", wanted,
        "-o", tmp_path / "new.json", "--risk", "simulated",
    )  # fmt: skip
    assert "within the budget 1 min; left out:" in said
    assert "Suggested: in time with a probability of" in said
    assert "MEASURE 2" in order_in(tmp_path / "new.json")
    assert len(order_in(tmp_path / "new.json")) < len(order_in(source))


@pytest.mark.usefixtures("quick_picture")
def test_a_routed_mission_keeps_its_limit_and_names_what_was_left_out(argo, source, tmp_path):
    """Follow the limit from the written file through a check and a script to a report."""
    new, wanted, script = tmp_path / "new.json", tmp_path / "wanted.yaml", tmp_path / "new.txt"
    wanted.write_text("mandatory: [2]\n")
    said = argo(
        "route", source, "--budget", "65 s", "--requirements", wanted, "--before", "3, 1",
        "-o", new,
    )  # fmt: skip
    assert "Its maximum duration is now the budget: 1 min 5 s" in said
    assert "exact travel times" not in said
    before, after = read_mission(source), read_mission(new)
    assert after.before == (("MEASURE 3", "MEASURE 1"),)
    assert after.left_out
    assert {t.name for t in after.tasks} | set(after.left_out) == {t.name for t in before.tasks}
    assert after.max_duration == 65.0
    named = f"left out when the order was chosen: {', '.join(after.left_out)}"
    assert named in argo("check", new)
    argo("format", new, "-o", script)
    again = tmp_path / "again.json"
    argo("import", script, "-o", again)
    assert read_mission(again).left_out == after.left_out
    assert named in argo("run", new, "--drive", "route", "--report", tmp_path / "report")
    page = (tmp_path / "report" / "report.html").read_text()
    assert f"<dt>Left out when the order was chosen</dt><dd>{', '.join(after.left_out)}" in page


def test_a_written_mission_that_takes_too_long_is_noted(argo, source, tmp_path):
    new = tmp_path / "new.json"
    shown = argo("route", source, "--budget", "70 s", "-o", new)
    said = "the mission takes at least 1 min 11 s if nothing fails, longer than its maximum "
    said += "duration of 1 min 10 s"
    assert f"Note: with its exact travel times, {said}" in shown
    assert said in argo("check", new, status=2)


@pytest.mark.physics
def test_a_run_without_possible_order_names_the_route_command(argo, source, tmp_path):
    late = read_mission(source).model_copy(update={"max_duration": 3.0})
    write_mission(late, tmp_path / "late.json")
    said = argo("run", tmp_path / "late.json", "--optimise", status=1)
    assert f"(argo route {tmp_path / 'late.json'} --budget)" in said
    assert "left out (--budget)" in argo("route", tmp_path / "late.json", status=2)


def test_lower_bound_of_an_order_is_rounded_down(argo, source, monkeypatch):
    search = routing.suggest_route

    def unproven(problem, *arguments, **options):
        bound = int(59.6 / problem.unit)
        return replace(search(problem, *arguments, **options), proven=False, bound=bound)

    monkeypatch.setattr(routing, "suggest_route", unproven)
    assert "no order takes less than 00:59" in argo("route", source)
    assert "no order takes less than 00:59" in argo("route", source, "--verify")


def test_claims_about_an_order_can_be_verified(argo, source):
    said = argo("route", source, "--verify")
    assert "Verified: the order meets all requirements and takes" in said
    assert "Verified: no order is better (all routes enumerated" in said
    assert "Wrong" not in said
    argo("route", source, "--verify", "--budget", "1s", status=2)
    said = argo("route", source, "--verify", "--keep-order", "--before", "1, 2", status=2)
    assert "Verified: no order meets all requirements" in said


def test_a_wrong_claim_is_reported_as_a_defect(argo, source, monkeypatch):
    def turned(problem, *_, **__):
        route = Tour(tuple(range(problem.size))[::-1])
        cost = evaluate(problem, route).cost(problem.objective)
        return RouteSuggestion(route, 0, 0, cost, cost, proven=True)

    monkeypatch.setattr("argo_planner.use_cases.routing.suggest_route", turned)
    said = argo("route", source, "--verify", status=1)
    assert "Wrong: no order is better (" in said
    assert "please report it" in said


def test_a_robust_order_is_in_time_more_often(argo, source):
    said = argo("route", source, "--budget", "70 s", "--robust", "--time-limit", 4)
    assert "robust: the best of" in said
    assert "nothing limits this mission's time" in argo("route", source, "--robust", status=1)


def test_requirements_that_can_not_all_be_met_are_an_error(argo, source):
    said = argo("route", source, "--before", "3, 1", "--before", "1,3", status=2)
    assert "no order meets all" in said
    kept = argo("route", source, "--keep-order", "--before", "1, 2", status=2)
    assert "the order as written (--keep-order)" in kept


def test_one_requirement_that_can_not_be_met_is_named_alone(argo, source, tmp_path):
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("windows:\n- {what: 1, latest: 1 s}\n")
    said = argo("route", source, "--requirements", wanted, status=2)
    assert "this requirement can't be met: checkpoint 1 done by 1 s" in said


def test_a_refusal_states_the_assumed_duration_of_waits(argo, tmp_path):
    rule = WaitRule(event=EventKind.ALL_CLEAR, limit=90)
    waiting = mission(
        Task(name="W", action=Action.WAIT, wait=rule),
        measure(1, window=TimeWindow(latest=80)),
        waypoint("DOCK", 1.05, 1.05), dock=DOCK, version=4,
    )  # fmt: skip
    write_mission(waiting, tmp_path / "waiting.json")
    said = argo("route", tmp_path / "waiting.json", "--verify", status=2)
    assert "no order meets all of these if each WAIT takes its whole limit, but" in said
    assert "Note: 'W' is assumed to take its whole limit" in said
    verified = "Verified: no order meets all requirements if each WAIT takes its whole limit ("
    assert verified in said


def test_a_limit_of_a_task_refuses_no_order(argo, tmp_path):
    limited = mission(measure(1, time_limit=1, retries=1), waypoint("DOCK", 1.05, 1.05), dock=DOCK)
    write_mission(limited, tmp_path / "limited.json")
    said = argo("route", tmp_path / "limited.json", "--verify")
    assert "Note: 'MEASURE 1' may take longer than its time limit, 1 s" in said


@pytest.mark.parametrize("extra", [[], ["--robust", "--time-limit", "1"]])
def test_a_budget_for_nothing_is_an_error(argo, source, tmp_path, extra):
    written = tmp_path / "new.json"
    said = argo("route", source, "--budget", "3 s", "-o", written, *extra, status=2)
    assert "nothing fits within the budget 3 s: the nearest, " in said
    assert "Suggested" not in said
    assert not written.exists()


def test_pauses_are_shown_and_written(argo, source, tmp_path):
    wanted, new = tmp_path / "wanted.yaml", tmp_path / "new.json"
    wanted.write_text("windows:\n- {what: 1, earliest: 30 min}\n")
    shown = argo("route", source, "--requirements", wanted, "-o", new)
    waits = re.search(r"Pause: wait (\d\d:\d\d) for checkpoint 1\n", shown)
    assert f"wait {waits[1]} for checkpoint 1 " in shown.partition("As written")[0]
    assert read_mission(new).task("MEASURE 1").window == TimeWindow(earliest=1800)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--before", "3"], "name at least two"),
        (["--before", "3, 17"], "no checkpoint 17"),
        (["--budget", "soon"], "is not a duration"),
        (["--budget", "0 s"], "more than 0"),
        (["--budget", "-5min"], "must be above 0"),
        (["--budget", "9" * 400], "has to be"),
        (["--before", "0, 3"], "at least 1"),
        (["--before", "3, 3"], "nothing comes before itself"),
        (["--before", "3, MEASURE 3"], "have a task in common"),
        (["--start-area", "1"], "has its areas already"),
        (["--requirements", "missing.yaml"], "can't be read"),
    ],
)
def test_options_that_make_no_sense_are_refused(argo, source, options, said):
    assert said in argo("route", source, *options, status=1)


def test_a_budget_with_two_meanings_is_refused_with_both(argo, source, tmp_path):
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("budget: 12:30\n")
    text = argo("route", source, "--requirements", wanted, status=1)
    assert "wanted.yaml:1:9: error: budget: `12:30` can be read as 12 min 30 s or as 12 h" in text


def test_the_time_limit_is_a_duration_as_the_budget_is(argo, source):
    for text in ("2s", "00:00:02", "2"):
        assert "Proven: " in argo("route", source, "--time-limit", text)
    for text, why in (("12:30", "12 h 30 min"), ("0", "is not between"), ("soon", "20 min")):
        said = re.sub(r"[\s│]+", " ", argo("route", source, "--time-limit", text, status=2))
        assert why in said


def test_errors_in_requirements_name_the_line(argo, source, tmp_path):
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("mandatory: [2]\nbudgets: 5 min\n")
    text = argo("route", source, "--requirements", wanted, status=1)
    assert "wanted.yaml:2:1" in text
    assert "[route.wrong-field]" in text


def test_a_mission_is_never_written_over(argo, source):
    assert "is the input as well" in argo("route", source, "-o", source, status=1)


def test_a_mission_is_compiled_in_its_best_order(argo, source, tmp_path):
    said = argo("compile", source, "-o", tmp_path / "machine.json", "--optimise")
    machine = Hfsm.model_validate_json((tmp_path / "machine.json").read_text())
    order = [leaf.task.name for leaf in machine.leaves]
    assert f"Order: {', '.join(order[:-1])}\n" in said


@pytest.mark.usefixtures("quick_picture")
def test_the_report_of_a_reordered_run_shows_its_order(argo, source, tmp_path):
    report = tmp_path / "report"
    said = argo("run", source, "--optimise", "--drive", "route", "--report", report)
    assert "Predicted:" in said
    record = RunRecord.model_validate(json.loads((report / "report.json").read_text()))
    assert record.reordering.proven
    assert record.reordering.order == tuple(run.task for run in record.tasks[:-1])
    assert record.result.duration == pytest.approx(record.reordering.duration, rel=0.1)
    assert "As suggested" in (report / "report.html").read_text()


def test_a_mission_is_only_written_where_it_can_be_read_again(argo, source, tmp_path):
    said = argo("route", source, "-o", tmp_path / "new.txt", status=1)
    assert "ends in .json" in said
    assert not (tmp_path / "new.txt").exists()


def test_a_group_whose_time_is_over_before_it_is_reached_is_noted(argo, tmp_path):
    patrol = Group(name="PATROL", start="near", end="far", max_repeat_duration=1.0)
    far, near = waypoint("far", 5.5, 2.5), waypoint("near", 2.2, 1.05)
    written = mission(
        measure(2), near, far, waypoint("DOCK", 1.05, 1.05),
        groups=(patrol,), order=Order.ANY, dock=DOCK,
    )  # fmt: skip
    write_mission(written, tmp_path / "mission.json")
    shown = argo("route", tmp_path / "mission.json")
    assert "the time of group 'PATROL' is over before" in shown
