"""Verdicts of missions that end before their end: what was done, what was not, and what counts."""

import json
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ByHand, Cancel, GiveBack, Occurred, Outcome, Pause, TakeOver
from argo_compiler.il import (
    Action,
    Afterwards,
    EventKind,
    Group,
    OnFailure,
    Response,
    Task,
    TimeWindow,
    WaitRule,
)
from argo_env.evaluation.case import EvaluationCase
from argo_env.evaluation.row import make_row
from argo_env.evaluation.score import read_scoring, score_run
from argo_env.planning.opening import open_site
from argo_env.run.log import Entry
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec, logged_events
from argo_env.run.verdict import VerdictCode, VerdictPart
from argo_env.run.verdict_line import Ending
from tests.conftest import examples
from tests.mission_writing import reaction as react
from tests.whole_scripts import import_whole
from tests.yard import measure, mission, run, waypoint

DOCK = Pose(x=1.05, y=1.05, z=0.02)
SHELTER = Pose(x=3.05, y=1.55, z=0.02)
LOW = EventKind.LOW_BATTERY
HOME = waypoint("HOME", DOCK.x, DOCK.y)
AWAY = waypoint("AWAY", 5.05, 2.55)
RETURN = react(LOW, Response.RETURN, afterwards=Afterwards.END)
SCORING = read_scoring()
EXAMPLES = Path(__file__).parents[3] / "argo_planner/page/test/texts/verdict-examples.json"


def plan_of(*tasks, **fields):
    usual = {"dock": DOCK, "end_area": 1, "reactions": (RETURN,)}
    return mission(*tasks, **(usual | fields))


def parts_of(record):
    return {part.code: part for part in record.result.parts}


def row_of(record, yard):
    spec = RunSpec(mission=record.mission, site="yard", drive="route")
    case = EvaluationCase(mission="m", faults="none", spec=spec)
    return make_row("", case, spec, record, yard.site)


def end_of(record, task):
    return next(run.end for run in record.tasks if run.task == task)


@pytest.fixture(scope="module")
def way_home(yard):
    """Return a time in s at which the robot drives home, with all else done."""
    undisturbed = run(yard, plan_of(measure(1), HOME))
    return (end_of(undisturbed, "MEASURE 1") + undisturbed.result.duration) / 2


@pytest.mark.parametrize(
    ("reaction", "outcome"),
    [
        (RETURN, Outcome.RETURNED),
        (react(LOW, Response.SAFE_AREA, pose=DOCK, afterwards=Afterwards.END), Outcome.SHELTERED),
    ],
)
def test_a_reaction_that_asks_for_what_was_under_way_gives_nothing_up(
    yard, way_home, reaction, outcome
):
    record = run(yard, plan_of(measure(1), HOME, reactions=(reaction,)), (way_home, Occurred(LOW)))
    assert record.result.outcome is outcome
    assert record.result.success
    assert record.result.reached_all_the_same == ("HOME",)
    assert record.headline.ending is Ending.DONE  # the low battery is a finding
    assert VerdictCode.NOTHING_GIVEN_UP in parts_of(record)
    row = row_of(record, yard)
    assert (row.success, row.done, row.tasks) == (True, 2, 2)
    assert score_run(row, SCORING).total == SCORING.max_score


def test_the_same_by_a_script_on_a_site(fault_inputs):
    site = open_site("umad")
    script = (fault_inputs / "low_home.txt").read_text("utf-8")
    plan = import_whole(script, site.catalog).mission
    low = logged_events((60.0, Occurred(LOW)))
    spec = RunSpec(mission=plan, site=site.reference, drive="route", events=low)
    record = simulate(spec, site)
    assert record.result.outcome is Outcome.RETURNED
    assert record.result.success
    assert record.result.docked
    assert "given up" not in str(record.headline)


@pytest.mark.parametrize(
    ("tasks", "names"),
    [
        ((measure(1), measure(2), HOME), ["MEASURE 2"]),  # one is still to be read
        ((measure(1), HOME, AWAY, HOME.model_copy(update={"name": "END"})), ["AWAY"]),
        ((measure(1), AWAY), ["AWAY"]),  # it was on its way to another place
        (
            (measure(1), HOME, Task(name="W", action=Action.WAIT, wait=WaitRule(duration=60))),
            ["W"],
        ),
        # It has to be home later than it is.
        ((measure(1), HOME.model_copy(update={"window": TimeWindow(earliest=300)})), ["HOME"]),
    ],
)
def test_what_was_given_up_is_named(yard, way_home, tasks, names):
    record = run(yard, plan_of(*tasks), (way_home, Occurred(LOW)))
    assert not record.result.success
    parts = parts_of(record)
    assert list(parts[VerdictCode.NOT_DONE].names) == names
    assert parts[VerdictCode.RETURNED].event is LOW
    missing = tuple(name[-1] for name in names if "MEASURE" in name)
    total = sum(task.action is Action.MEASURE for task in tasks)
    read = parts[VerdictCode.READ]
    assert (read.names, read.numbers) == (missing, (total - len(missing), total))
    assert not row_of(record, yard).success


def test_a_dock_other_than_the_one_under_way_is_another_place(yard, way_home):
    other = react(LOW, Response.RETURN, pose=SHELTER, afterwards=Afterwards.END)
    record = run(yard, plan_of(measure(1), HOME, reactions=(other,)), (way_home, Occurred(LOW)))
    assert not record.result.success
    parts = parts_of(record)
    assert parts[VerdictCode.NOT_DONE].names == ("HOME",)
    assert parts[VerdictCode.READ].numbers == (1, 1)
    assert parts[VerdictCode.NOT_DOCKED].numbers == (1,)
    assert "the checkpoint was read" in record.result.verdict


@pytest.mark.parametrize(
    "reaction",
    [
        RETURN,
        react(LOW, Response.SAFE_AREA, pose=SHELTER, afterwards=Afterwards.END),
        react(LOW, Response.ABORT),
    ],
)
def test_optional_tasks_that_were_left_are_no_loss(yard, reaction):
    tasks = (measure(1), measure(2, optional=True), measure(3, optional=True))
    plan = plan_of(*tasks, end_area=None, reactions=(reaction,))
    after = end_of(run(yard, plan), "MEASURE 1") + 1.0
    record = run(yard, plan, (after, Occurred(LOW)))
    assert record.result.outcome not in (Outcome.COMPLETED, None)
    assert record.result.success
    left = parts_of(record)[VerdictCode.OPTIONAL_NOT_DONE]
    assert left.names == ("MEASURE 2", "MEASURE 3")
    assert score_run(row_of(record, yard), SCORING).total == SCORING.max_score


def test_an_optional_task_may_fail_and_send_the_robot_home(yard):
    lost = waypoint("LOST", 30.0, 30.0, optional=True, on_failure=OnFailure.RETURN)
    record = run(yard, plan_of(measure(1), lost, HOME))
    assert record.result.outcome is Outcome.RETURNED
    assert record.result.success
    assert parts_of(record)[VerdictCode.OPTIONAL_FAILED].names == ("LOST",)
    unfinished = run(yard, plan_of(lost, measure(1), HOME))
    assert unfinished.result.outcome is Outcome.RETURNED
    assert not unfinished.result.success
    assert parts_of(unfinished)[VerdictCode.NOT_DONE].names == ("MEASURE 1",)


def test_the_last_round_is_the_last_one(yard):
    """In its last round of two, the way home is all that remains; in the first one it is not."""
    plan = plan_of(
        measure(1),
        HOME,
        groups=(Group(name="G", start="MEASURE 1", end="HOME", max_repeat_count=2),),
    )
    times = [(t.start + t.end) / 2 for t in run(yard, plan).tasks if t.task == "HOME"]
    first, last = (run(yard, plan, (time, Occurred(LOW))) for time in times)
    assert last.result.success
    assert not first.result.success
    parts = parts_of(first)
    assert parts[VerdictCode.NOT_DONE_AGAIN].names == ("MEASURE 1",)
    assert VerdictCode.NOT_DONE not in parts


def test_a_person_may_cancel_when_everything_is_done(yard):
    """The robot is at the last place, and its reaction holds it there, when a person cancels."""
    hold = react(LOW, Response.RETURN, until=EventKind.BATTERY_CHARGED)
    plan = plan_of(measure(1), HOME, reactions=(hold,))
    undisturbed = run(yard, plan)
    way = (end_of(undisturbed, "MEASURE 1") + undisturbed.result.duration) / 2
    record = run(yard, plan, (way, Occurred(LOW)), (way + 60.0, Cancel()))
    assert record.result.outcome is Outcome.CANCELLED
    assert record.result.success
    earlier = run(yard, plan, (way, Cancel()))
    assert not earlier.result.success
    assert parts_of(earlier)[VerdictCode.NOT_DONE].names == ("HOME",)


def test_a_task_done_in_advance_by_hand_is_not_left_undone(yard):
    plan = plan_of(measure(1), AWAY, HOME)
    by_hand = (ByHand(task="AWAY"),)
    undisturbed = run(yard, plan_of(measure(1), HOME))
    done = end_of(undisturbed, "MEASURE 1")
    record = run(
        yard, plan, (1.0, TakeOver()), (1.0, GiveBack(by_hand)), (2.0, Occurred(LOW))
    )  # fmt: skip
    assert parts_of(record)[VerdictCode.NOT_DONE].names == ("MEASURE 1",)
    late = (done + 3.0, Occurred(LOW))
    record = run(yard, plan, (1.0, TakeOver()), (1.0, GiveBack(by_hand)), late)
    assert record.result.outcome is Outcome.RETURNED
    assert record.result.success


def test_a_run_that_stands_still_says_what_is_left(yard, way_home):
    record = run(yard, plan_of(measure(1), HOME), (way_home, Pause()))
    assert not record.result.success
    parts = parts_of(record)
    assert parts[VerdictCode.NOT_DONE].names == ("HOME",)
    assert parts[VerdictCode.READ].numbers == (1, 1)


RESPONSES = {
    "return": RETURN,
    "shelter": react(LOW, Response.SAFE_AREA, pose=SHELTER, afterwards=Afterwards.END),
    "abort": react(LOW, Response.ABORT),
    "cancel": None,
}


@settings(max_examples=examples(200))
@given(st.sampled_from(sorted(RESPONSES)), st.floats(0.0, 70.0), st.booleans())
@example("return", 60.0, True)
def test_success_is_what_an_observer_calls_it(yard, response, at, optional):
    """A success is a run in which all is read and visited that is needed, and the robot docked."""
    reaction = RESPONSES[response]
    tasks = (measure(1), AWAY, measure(2, optional=optional), HOME)
    plan = plan_of(*tasks, reactions=(reaction,) if reaction else ())
    record = run(yard, plan, (at, Occurred(LOW) if reaction else Cancel()))
    read = {str(reading.checkpoint) for reading in record.readings}
    been_away = any(run.task == "AWAY" and run.outcome == "done" for run in record.tasks)
    docked = record.result.docked
    everything = {"1", *(() if optional else "2")} <= read and been_away and bool(docked)
    assert record.result.success is everything
    assert row_of(record, yard).success is everything
    if record.result.outcome is not Outcome.COMPLETED and not everything:
        left = parts_of(record).get(VerdictCode.NOT_DONE)
        assert docked is False or left is not None
        assert parts_of(record)[VerdictCode.READ].numbers == (len(read), 2)


def test_an_old_journal_has_the_reason_of_a_stop_as_text():
    data = {"t": 1.0, "pose": (0, 0, 0, 0, 0), "distance": 0, "climbed": 0, "ended": True}
    entry = Entry.model_validate(data | {"stopped": "the tide came in"})
    assert str(entry.stopped) == "the tide came in"
    assert Entry.model_validate_json(entry.model_dump_json()) == entry


def test_old_records_have_no_parts(yard):
    record = run(yard, plan_of(measure(1), HOME))
    data = record.model_dump(mode="json")
    del data["result"]["parts"]
    old = RunRecord.model_validate(data)
    assert old.headline.text == record.headline.text
    assert old.headline.verdict == ()


def test_the_examples_of_the_page_have_the_texts_of_the_command():
    """The page's tests compare its English with these texts, and demand German for each."""
    shared = json.loads(EXAMPLES.read_text("utf-8"))
    parts = [VerdictPart.model_validate(example["part"]) for example in shared["parts"]]
    assert [str(part) for part in parts] == [example["text"] for example in shared["parts"]]
    assert {part.code for part in parts} == set(VerdictCode)
