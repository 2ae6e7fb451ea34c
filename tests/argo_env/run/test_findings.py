"""Findings of a run, the mission's answers to them, and the headline that counts them."""

import json

import pytest

from argo_compiler.hfsm import Occurred, Pause
from argo_compiler.il import EventKind, Reaction, Response
from argo_env.drives.drive import Trouble
from argo_env.run.record import Anomaly, Contact, Mishap, RunRecord
from argo_env.run.spec import RunSpec, logged_events
from argo_env.run.verdict_line import Tone
from tests.yard import (
    Entries,
    fast_setup,
    measure,
    mission,
    opened,
    run,
    run_with,
    shelter,
    simulation_of,
    waypoint,
)

PLAN = mission(measure(1), waypoint("A", 4.05, 2.05))
LEAK = Occurred(EventKind.GAS_LEAK, "a hiss")
CLEAR = Occurred(EventKind.ALL_CLEAR)
SHELTER = shelter(3.05, 1.55)


@pytest.fixture(scope="module")
def quiet(yard):
    """Return the record of a run without findings."""
    return run(yard, PLAN)


def plan_with_reactions(*reactions):
    return PLAN.model_copy(update={"reactions": reactions})


def with_anomalies(record, *found):
    """Return the record with these anomalies: times (s), kinds and sources."""
    return record.model_copy(
        update={
            "anomalies": tuple(
                Anomaly(t=t, kind=kind, detail="", source=source) for t, kind, source in found
            )
        }
    )


def test_nothing_found_is_a_plain_success(quiet):
    assert quiet.findings == ()
    assert quiet.headline.tone is Tone.GOOD
    assert str(quiet.headline) == "Success: everything was done as planned."


class TestEventsFromOutside:
    def test_without_a_reaction_it_is_a_finding(self, yard):
        record = run(yard, PLAN, (3.0, LEAK))
        (finding,) = record.findings
        assert (finding.t, finding.kind, finding.detail) == (3.0, EventKind.GAS_LEAK, "a hiss")
        assert (finding.is_reported_from_outside, finding.answered, finding.floor) == (
            True,
            False,
            1,
        )
        (sample,) = [s for s in record.path if s.t == 3.0]
        assert finding.noticed_from == (sample.x, sample.y, sample.z)
        assert "reported while the robot was on floor 1 at (" in finding.whereabouts
        assert (record.result.success, record.headline.tone) == (True, Tone.NOTICE)
        said = "Done, 1 finding: gas leak at 00:03 (no reaction answers it)."
        assert str(record.headline) == said

    def test_with_a_reaction_it_says_which_and_that_it_is_over(self, yard):
        record = run(yard, plan_with_reactions(SHELTER), (4.0, LEAK), (60.0, CLEAR))
        (finding,) = record.findings
        assert (finding.answered, finding.over_at) == (True, 60.0)
        assert str(record.headline) == (
            "Done, 1 finding: gas leak at 00:04 (answered by reaction: safe area), over at 01:00."
        )

    @pytest.mark.parametrize("response", [Response.REPORT, Response.ABORT])
    def test_answers_that_do_not_interrupt(self, yard, response):
        reaction = Reaction(event=EventKind.GAS_LEAK, response=response)
        (finding,) = run(yard, plan_with_reactions(reaction), (4.0, LEAK)).findings
        assert finding.answer == f"answered by reaction: {response}"

    def test_a_reaction_that_did_not_begin_answers_nothing(self, yard):
        record = run(yard, plan_with_reactions(SHELTER), (3.0, Pause()), (4.0, LEAK))
        (finding,) = record.findings
        assert (finding.answered, finding.answer) == (False, "the reaction to it did not begin")
        assert record.headline.word == "No success"
        assert "nothing more occurs; 0 of 1 checkpoint read" in record.headline.text
        assert "not done: MEASURE 1, A. 1 finding: gas leak at 00:04" in record.headline.text

    def test_what_was_written_down_gives_the_same(self, yard):
        kept, events = Entries(), logged_events((3.0, LEAK), (5.0, CLEAR))
        plan = plan_with_reactions()
        record = run_with(plan, fast_setup(yard, {1: 9.0}), events=events, observers=[kept])
        spec = RunSpec(mission=plan, site="yard", events=events)
        setup = fast_setup(yard, {1: 9.0})
        with simulation_of(spec, opened(yard), past=kept.all, setup=setup) as again:
            assert again.record() == record
        assert [f.kind for f in record.findings] == ["gas_leak", "abnormal_reading"]


class TestReadings:
    def test_an_abnormal_one_counts_once(self, yard):
        record = run(yard, PLAN, values={1: 9.0})
        assert len(record.findings) == 1
        assert str(record.headline) == "Done, 1 finding: gauge 1 (#1) abnormal: 9 bar."

    def test_one_of_which_no_anomaly_tells_counts_as_well(self, yard):
        record = run(yard, PLAN, values={1: 9.0})
        bare = record.model_copy(update={"anomalies": ()})
        assert bare.headline == record.headline
        assert [f.number for f in bare.findings] == [None]

    def test_the_same_value_again_is_named_once_and_counted(self, yard):
        plan = mission(measure(1), waypoint("A", 2.05, 2.05), measure(1).model_copy(
            update={"name": "again"}
        ))  # fmt: skip
        record = run(yard, plan, values={1: 9.0})
        assert str(record.headline) == "Done, 2 findings: gauge 1 (#1) abnormal: 9 bar, 2 times."


class TestOver:
    def end_times(self, record):
        return [finding.over_at for finding in record.findings]

    def test_a_watch_tells_the_end_of_what_it_found_itself(self, quiet):
        record = with_anomalies(
            quiet,
            (1.0, EventKind.GAS_LEAK, "gas"),
            (2.0, EventKind.PLATFORM_ALARM, "alarm"),
            (3.0, EventKind.LOW_BATTERY, "battery"),
            (4.0, EventKind.ALL_CLEAR, "gas"),
            (5.0, EventKind.BATTERY_CHARGED, "battery"),
            (6.0, EventKind.GAS_LEAK, "gas"),
        )
        assert self.end_times(record) == [4.0, None, 5.0, None]
        assert record.headline.word == "Done, 4 findings"
        assert record.headline.text.endswith("; and 1 more")

    def test_a_person_tells_the_end_of_dangers_whoever_found_them(self, quiet):
        record = with_anomalies(
            quiet,
            (1.0, EventKind.GAS_LEAK, "gas"),
            (2.0, EventKind.NEGATIVE_OBSTACLE, "terrain"),
            (3.0, EventKind.ALL_CLEAR, "told"),
        )
        assert self.end_times(record) == [3.0, None]

    def test_an_end_alone_is_no_finding(self, quiet):
        record = with_anomalies(quiet, (1.0, EventKind.ALL_CLEAR, "told"))
        assert (record.findings, record.headline.tone) == ((), Tone.GOOD)


class TestHeadline:
    CONTACT = Contact(
        start=12.0, end=13.0, link="forearm", element="railing 7", x=0.0, y=0.0, z=0.0, depth=0.012
    )
    MISHAP = Mishap(t=70.0, trouble=Trouble.STUCK, detail="", place=(0.0, 0.0, 0.0), floor=1)

    def test_contacts_and_mishaps_are_to_be_looked_at(self, quiet):
        touched = quiet.model_copy(update={"contacts": (self.CONTACT,)})
        assert touched.headline.tone is Tone.NOTICE
        assert str(touched.headline) == "Done, 1 contact: forearm touched railing 7 at 00:12."
        both = touched.model_copy(update={"mishaps": (self.MISHAP, self.MISHAP)})
        assert both.headline.word == "Done, 1 contact, 2 mishaps"
        assert both.headline.text.endswith("; stuck at 01:10, 2 times")

    def test_what_else_the_verdict_says_stays(self, quiet):
        result = quiet.result.model_copy(
            update={"verdict": "the mission was completed; passed over: A"}
        )
        record = quiet.model_copy(update={"result": result})
        assert str(record.headline) == "Success: the mission was completed; passed over: A."
        touched = record.model_copy(update={"contacts": (self.CONTACT,)})
        assert touched.headline.text.endswith("00:12. The mission was completed; passed over: A")

    def test_a_run_that_was_interrupted_is_not_called_a_failure(self, quiet):
        result = quiet.result.model_copy(
            update={"success": False, "ended": False, "outcome": None, "verdict": "not at its end"}
        )
        headline = quiet.model_copy(update={"result": result}).headline
        assert (str(headline), headline.tone) == ("Interrupted: not at its end.", Tone.NOTICE)


class TestAsData:
    def test_other_programs_get_findings_and_headline(self, yard):
        record = run(yard, PLAN, (3.0, LEAK))
        data = record.model_dump(mode="json")
        assert data["headline"]["word"] == "Done, 1 finding"
        assert data["findings"][0]["answered"] is False
        assert RunRecord.model_validate_json(json.dumps(data)) == record

    def test_records_of_before_are_read(self, yard):
        record = run(yard, PLAN, values={1: 9.0})
        data = record.model_dump(mode="json", exclude={"findings", "headline"})
        for task in data["tasks"]:
            del task["measuring"]
        old = RunRecord.model_validate(data)
        assert old.headline == record.headline
        assert {task.measuring for task in old.tasks} == {None}
        assert [task.measuring_duration for task in old.tasks] == [0.0] * len(old.tasks)


class TestMeasuring:
    def test_it_is_told_apart_from_the_drive_there(self, yard, quiet):
        measured, drive = quiet.tasks[-2:]
        takes = yard.robot.sensor.measuring_time
        (span,) = measured.measuring
        assert span == (pytest.approx(measured.end - takes), measured.end)
        assert measured.measuring_duration == pytest.approx(takes)
        assert drive.measuring == ()

    def test_one_that_is_broken_off_ends_with_its_task(self, yard, quiet):
        begun = quiet.tasks[-2].measuring[0][0]
        record = run(yard, PLAN, (begun + 1.0, Pause()))
        (task,) = [t for t in record.tasks if t.task == "MEASURE 1"]
        assert task.outcome == "interrupted"
        assert task.measuring == ((begun, task.end),)
