"""Output about the record of a run on the terminal."""

import io

import pytest
from rich.console import Console

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.quantity_text import rounded_down, rounded_up
from argo_compiler.il import Action, Afterwards, EventKind, Mission, Reaction, Response, Task
from argo_env.faults.plant import GasLeakFault
from argo_env.faults.robot import ConnectionLoss
from argo_env.formatting import distinct_time_texts, min_sec_text, rounded_time_text
from argo_env.planning import open_site
from argo_env.run.record import (
    Anomaly,
    Contact,
    Interruption,
    Reading,
    Result,
    RunRecord,
    TaskRun,
    WindowOutcome,
    WindowVisit,
)
from argo_planner.terminal.record_tables import show_record
from tests.yard import record_of


def shown(record: RunRecord, width: int = 140) -> str:
    console = Console(file=io.StringIO(), width=width, color_system=None)
    show_record(record, open_site(record.site).site, console)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


@pytest.fixture
def record() -> RunRecord:
    mission = Mission(tasks=(Task(name="[bold]M[/]", action=Action.MEASURE, object_id="3"),))
    return record_of(
        mission,
        result=Result(
            success=False, verdict="it took 11:40 min of at most 10:00 min", duration=700.0,
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
    )  # fmt: skip


def test_all_problems_are_shown(record: RunRecord) -> None:
    text = shown(record)
    for part in (
        "abnormal", "9.50 bar", "1 to 2.5", "failed", "hidden behind x", "not docked",
        "11:40 of at most 10:00", "1 contact,", "forearm with floor 2 railing 7, 12 mm deep",
        "No success: it took 11:40 min of at most 10:00 min. 1 finding, 1 contact: ",
    ):  # fmt: skip
        assert part in text


def test_each_thing_that_the_headline_counts_has_a_line(record: RunRecord) -> None:
    told = Anomaly(
        t=60.0, kind=EventKind.GAS_LEAK, detail="a hiss", source="told",
        noticed_from=(1.0, 2.0, 0.0), floor=1,
    )  # fmt: skip
    over = told.model_copy(update={"t": 90.0, "kind": EventKind.ALL_CLEAR})
    result = record.result.model_copy(
        update={"success": True, "verdict": "everything was done as planned"}
    )
    text = shown(record.model_copy(update={"anomalies": (told, over), "result": result}))
    lines = text[text.index("11:40 of") :].splitlines()
    assert lines[1:-1] == [
        "  pressure gauge 2 (#3) abnormal: 9.5 bar",
        "  gas leak at 01:00 (no reaction answers it), over at 01:30, reported while the robot was "
        "on floor 1 at (1.00, 2.00, 0.00): a hiss",
        "  contact at 00:12: forearm with floor 2 railing 7, 12 mm deep",
    ]
    assert lines[-1] == (
        "Done, 2 findings, 1 contact: pressure gauge 2 (#3) abnormal: 9.5 bar; gas leak at 01:00 "
        "(no reaction answers it), over at 01:30; forearm touched floor 2 railing 7 at 00:12."
    )


def test_measuring_times_are_shown_on_wide_terminals(record: RunRecord) -> None:
    assert "measuring" not in shown(record)
    first = record.tasks[0].model_copy(update={"measuring": ((10.0, 16.0), (20.0, 30.0))})
    changed = record.model_copy(update={"tasks": (first, *record.tasks[1:])})
    (row,) = [line for line in shown(changed).splitlines() if line.startswith("│ [bold]M")]
    assert [cell.strip() for cell in row.split("│")[4:6]] == ["01:00", "00:16"]
    assert "measuring" not in shown(changed, width=80)


def test_repeated_tasks_are_taken_together(record: RunRecord) -> None:
    (row,) = [line for line in shown(record).splitlines() if line.startswith("│ [bold]M")]
    assert [cell.strip() for cell in row.split("│")[2:7]] == [
        "2",
        "00:00",
        "01:00",
        "12.0 m",
        "2.5 m",
    ]


GAS = Reaction(
    event=EventKind.GAS_LEAK, response=Response.PAUSE, until=EventKind.ALL_CLEAR, priority=1
)
ALARM = Reaction(
    event=EventKind.PLATFORM_ALARM, response=Response.RETURN, afterwards=Afterwards.WAIT
)


def waits(record: RunRecord, *interruptions: tuple[float, float, EventKind | None]) -> list[str]:
    """Return the rows about waits: cause, number, first start, total time, outcome."""
    changed = record.model_copy(
        update={
            "mission": record.mission.model_copy(update={"reactions": (GAS, ALARM)}),
            "interruptions": tuple(
                Interruption(start=start, end=end, event=event)
                for start, end, event in interruptions
            ),
        }
    )
    rows = [[c.strip() for c in row.split("│")[1:-1]] for row in shown(changed).splitlines()]
    return [" | ".join(filter(None, row)) for row in rows if row and row[0].startswith("waits")]


def test_waits_of_reactions_are_shown(record: RunRecord) -> None:
    # The tasks run from 0 to 30 s and from 40 to 70 s.
    assert waits(record, (70.0, 95.0, EventKind.GAS_LEAK), (200.0, 230.0, EventKind.GAS_LEAK)) == [
        "waits for all clear (reaction to gas leak) | 2 | 01:10 | 00:55 | over"
    ]
    # The drive of a reaction does not count as waiting.
    assert waits(record, (35.0, 75.0, EventKind.GAS_LEAK)) == [
        "waits for all clear (reaction to gas leak) | 1 | 01:10 | 00:05 | over"
    ]
    assert waits(record, (39.0, 70.0, EventKind.GAS_LEAK)) == []
    assert waits(record, (100.0, 110.0, None)) == [
        "waits for a person (paused) | 1 | 01:40 | 00:10 | over"
    ]


def test_tasks_and_waits_stand_in_the_order_in_which_they_began(record: RunRecord) -> None:
    dock = record.tasks[0].model_copy(update={"task": "DOCK", "start": 300.0, "end": 330.0})
    pause = Interruption(start=100.0, end=110.0)
    changed = record.model_copy(update={"tasks": (*record.tasks, dock), "interruptions": (pause,)})
    lines = shown(changed).splitlines()
    (waits,), (docks,) = (
        [n for n, line in enumerate(lines) if line.startswith(f"│ {name}")]
        for name in ("waits", "DOCK")
    )
    assert waits == docks - 1


def test_waits_at_the_end_are_shown(record: RunRecord) -> None:
    """A run stops at once if no event can end the wait."""
    alarm = (600.0, 700.0, EventKind.PLATFORM_ALARM), (700.0, 700.0, None)
    assert waits(record, alarm[0]) == [
        "waits for a person (reaction to platform alarm) | 1 | 10:00 | 01:40"
        " | still waiting at the end"
    ]
    drive = TaskRun(
        task="react to platform_alarm", action=Action.WAYPOINT, start=600.0, end=700.0,
        outcome="done", distance=1.0, climbed=0.0,
    )  # fmt: skip
    drove = record.model_copy(update={"tasks": (*record.tasks, drive)})
    assert waits(drove, *alarm) == [
        "waits for a person (reaction to platform alarm) | 1 | 11:40 | 00:00"
        " | still waiting at the end"
    ]


def test_visits_in_which_nothing_ran_as_the_window_was_over_are_counted(record: RunRecord) -> None:
    windows = tuple(
        WindowVisit(
            task=task, earliest=0.0, latest=90.0, hard=True, visited=visited, ended=ended, kept=kept
        )
        for task, visited, ended, kept in (
            ("[bold]M[/]", 0.0, 30.0, WindowOutcome.KEPT),
            ("[bold]M[/]", 120.0, 120.0, WindowOutcome.MISSED),
            ("N", 130.0, 130.0, WindowOutcome.MISSED),
        )
    )
    text = shown(record.model_copy(update={"windows": windows}))
    table = text.split("Tasks")[1].splitlines()
    rows = [[c.strip() for c in row.split("│")[1:-1]] for row in table if row.startswith("│")]
    assert [(row[0], row[1], row[2], row[-1]) for row in rows] == [
        ("[bold]M[/]", "3", "00:00", "done, failed, missed (hidden behind x)"),
        ("N", "1", "02:10", "missed"),
    ]


def test_faults_that_did_not_happen_are_shown(record: RunRecord) -> None:
    faults = (GasLeakFault(at=700.0), ConnectionLoss(at=700.1), GasLeakFault(at=5000.0))
    text = shown(record.model_copy(update={"faults": faults}))
    said = [line.strip() for line in text.splitlines() if "did not happen" in line]
    assert said == [
        "fault connection loss did not happen: begins at 700.1 s, the mission ended at 700 s",
        "fault gas leak did not happen: begins at 5000 s, the mission ended at 700 s",
    ]


def test_names_are_not_taken_for_markup(record: RunRecord) -> None:
    assert "[bold]M[/]" in shown(record)


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "00:00"), (59.6, "01:00"), (299.4, "04:59"), (3600.0, "60:00")]
)
def test_clock(seconds: float, text: str) -> None:
    assert min_sec_text(seconds) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(34.4, "34 s"), (59.6, "1:00 min"), (1200.0, "20:00 min"), (4491.0, "1:14:51 h")],
)
def test_time_text(seconds: float, text: str) -> None:
    assert rounded_time_text(seconds) == text


def test_times_that_are_bounds_are_rounded_to_their_side() -> None:
    assert [min_sec_text(59.6, rounding) for rounding in (round, rounded_down)] == [
        "01:00",
        "00:59",
    ]
    assert min_sec_text(60.2, rounded_up) == "01:01"
    assert rounded_time_text(59.6, rounded_down) == "59 s"


def test_distinct_time_texts() -> None:
    assert distinct_time_texts(4491.0, 1200.0) == ("1:14:51 h", "20:00 min")
    assert distinct_time_texts(1200.25, 1200.0) == ("1200.2 s", "1200.0 s")
    assert distinct_time_texts(5.4, 5.0) == ("5.4 s", "5.0 s")
