"""The record of a run on the terminal."""

import io

import pytest
from rich.console import Console

from argo_compiler.catalog import CheckpointKind, Interval
from argo_compiler.hfsm import lower
from argo_compiler.il import Action, Mission, Task
from argo_env.record import Contact, Reading, Result, RunRecord, TaskRun
from argo_planner.summary import clock, show_record


def shown(record: RunRecord) -> str:
    console = Console(file=io.StringIO(), width=140, color_system=None)
    show_record(record, console)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


@pytest.fixture
def record() -> RunRecord:
    mission = Mission(tasks=(Task(name="[bold]M[/]", action=Action.MEASURE, object_id="3"),))
    return RunRecord(
        mission=mission,
        hfsm=lower(mission),
        site="umad",
        robot="tracker",
        drive="kinematic",
        sensor="ideal",
        seed=0,
        diagnostics=(),
        result=Result(
            success=False, verdict="it took 700 s of at most 600 s", duration=700.0,
            max_duration=600.0, within_max_duration=False, docked=False, distance=12.34,
            climbed=2.5,
        ),
        tasks=tuple(
            TaskRun(
                task="[bold]M[/]", action=Action.MEASURE, object_id="3", start=s, end=s + 30,
                outcome=outcome, reason=reason, distance=6.0, climbed=1.25,
            )
            for s, outcome, reason in ((0.0, "done", None), (40.0, "failed", "hidden behind x"))
        ),
        readings=(
            Reading(
                checkpoint=3, name="pressure gauge 2", kind=CheckpointKind.PRESSURE_GAUGE, floor=1,
                task="[bold]M[/]", t=30.0, value=9.5, unit="bar",
                nominal=Interval(low=1.0, high=2.5), normal=False, distance=1.0,
            ),
        ),
        contacts=(
            Contact(
                start=12.0, end=13.0, link="forearm", element="floor 2 railing 7", x=0.0, y=0.0,
                z=0.0, depth=0.012,
            ),
        ),
        trace=(),
        path=(),
    )  # fmt: skip


def test_everything_that_went_wrong_is_said(record: RunRecord) -> None:
    text = shown(record)
    for part in (
        "abnormal", "9.50 bar", "1 to 2.5", "failed", "hidden behind x", "not docked",
        "11:40 of at most 10:00", "1 contact,", "forearm with floor 2 railing 7, 12 mm deep",
        "No success: it took 700 s of at most 600 s.",
    ):  # fmt: skip
        assert part in text


def test_repeated_tasks_are_taken_together(record: RunRecord) -> None:
    (row,) = [line for line in shown(record).splitlines() if line.startswith("│ [bold]M")]
    assert [cell.strip() for cell in row.split("│")[2:7]] == [
        "2",
        "0:00",
        "1:00",
        "12.0 m",
        "2.5 m",
    ]


def test_names_are_not_taken_for_markup(record: RunRecord) -> None:
    assert "[bold]M[/]" in shown(record)


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0:00"), (59.6, "1:00"), (299.4, "4:59"), (3600.0, "60:00")]
)
def test_clock(seconds: float, text: str) -> None:
    assert clock(seconds) == text
