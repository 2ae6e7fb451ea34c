"""The end of a run: results are written, then shown; missing ones are reported."""

from pathlib import Path

import pytest
import typer

from argo_compiler.base.stages import listen_to_stages
from argo_env.pictures import write_film
from argo_planner.terminal.conclusion import Conclusion
from argo_planner.terminal.run_storage import RunStorage
from argo_planner.terminal.signals import Interrupted, SignalWatch
from argo_planner.use_cases.reporting import REPORT_FILES
from tests.yard import fast_setup, measure, mission, run_with


@pytest.fixture(scope="module")
def record(yard_site):
    return run_with(mission(measure(1)), fast_setup(yard_site.navigator))


@pytest.fixture
def conclude(record, yard_site, tmp_path, monkeypatch, capsys):
    """Return a function that ends a stored run, and returns the exit status and the output."""
    monkeypatch.chdir(tmp_path)
    Path("run.journal").write_text("the run")
    files = dict.fromkeys(REPORT_FILES, b"in short")
    monkeypatch.setattr("argo_planner.terminal.conclusion.report_files", lambda *_: files)

    def end(report=None, render=None, kept=RunStorage(Path("run.journal")), came=None):  # noqa: B008
        interruption = SignalWatch()
        interruption.received = came
        status = 0
        try:
            Conclusion(
                report and Path(report), render and Path(render), kept, interruption
            ).write_report_and_show_results(
                record, yard_site.site, yard_site.robot, "It took no time."
            )
        except typer.Exit as end:
            status = end.exit_code
        return status, *capsys.readouterr()

    return end


def test_the_results_are_written_before_they_are_shown(conclude, monkeypatch):
    def full(*_, **__):
        raise Interrupted(2)

    monkeypatch.setattr("argo_planner.terminal.conclusion.show_record", full)
    with pytest.raises(Interrupted):
        conclude(report="report")
    assert {path.name for path in Path("report").iterdir()} == set(REPORT_FILES)


def test_a_report_that_cannot_be_written(conclude):
    Path("report/report.html").mkdir(parents=True)
    status, shown, said = conclude(report="report")
    assert status == 2
    assert "MEASURE 1" in shown
    assert "Is a directory" in said
    assert said.endswith(
        "argo: not written: report; to try again: argo resume run.journal --report report\n"
    )


def test_an_unwritable_report_of_a_run_that_is_not_stored(conclude):
    Path("report/report.html").mkdir(parents=True)
    status, _, said = conclude(report="report", kept=RunStorage())
    assert (status, said.splitlines()[-1]) == (
        2, "argo: not written: report; the run was not stored for another try",
    )  # fmt: skip


def test_the_report_is_still_written_when_the_process_is_interrupted_and_the_film_is_not(conclude):
    status, shown, said = conclude("report", "run.gif", came=Interrupted(15))
    assert status == 143
    assert "Report: report/report.html" in shown
    assert not Path("run.gif").exists()
    assert said.endswith(
        "argo: not written: run.gif; to try again: argo resume run.journal --render run.gif\n"
    )


def test_an_interruption_when_all_is_written_changes_nothing(conclude):
    status, shown, said = conclude("report", came=Interrupted(2))
    assert status == 0
    assert "Report: report/report.html" in shown
    assert "not written" not in said


def test_a_second_signal_ends_the_report(conclude, monkeypatch):
    def interrupted(*_):
        raise Interrupted(2)

    monkeypatch.setattr("argo_planner.terminal.conclusion.report_files", interrupted)
    status, shown, said = conclude("report", came=Interrupted(2))
    assert status == 130
    assert "MEASURE 1" in shown
    assert said.endswith("to try again: argo resume run.journal --report report\n")


@pytest.mark.physics
@pytest.mark.parametrize("stage_name", ["placing the film's camera", "drawing the film"])
def test_a_film_is_interrupted_between_two_pictures(conclude, monkeypatch, stage_name):
    def filming(*arguments, **options):
        def interrupt(name, share, _):
            if name == stage_name and share is not None and share > 0.1:
                options["raise_if_interrupted"].__self__.received = Interrupted(2)

        with listen_to_stages(interrupt):
            write_film(*arguments, **options)

    monkeypatch.setattr("argo_env.pictures.write_film", filming)
    status, shown, said = conclude(render="run.gif", kept=RunStorage(recording=Path("run.journal")))
    assert status == 130
    assert "MEASURE 1" in shown
    assert said.endswith("to try again: argo replay run.journal --render run.gif\n")
    assert [path.name for path in Path().iterdir()] == ["run.journal"]


def test_the_retry_command_replaces_files_if_the_run_did(conclude):
    Path("run.gif").write_bytes(b"an older film")
    status, _, said = conclude(
        render="run.gif", kept=RunStorage(Path("run.journal"), force=True), came=Interrupted(15)
    )
    assert status == 143
    assert Path("run.gif").read_bytes() == b"an older film"
    assert said.endswith("to try again: argo resume run.journal --render run.gif --force\n")


def test_a_run_without_its_journal_can_be_replayed_but_not_continued(tmp_path):
    recording = tmp_path / "run.mcap"
    recording.touch()
    storage = RunStorage(journal=tmp_path / "run.journal", recording=recording)
    hint = storage.continuation_or_loss_text(None, None)
    assert hint.startswith("the run can't be continued")
    assert hint.endswith(f"to see the results so far: argo replay {recording}")
