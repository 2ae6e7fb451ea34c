"""Processes that are killed while they run a mission, and others that resume it.

ARGO_EXAMPLES=200 makes it a campaign.
"""

import random
import re
import signal
import subprocess
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from argo_compiler.hfsm import Occurred, Pause, Resume
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import EventKind, Group, TimeWindow
from argo_env.run.journal import open_journal
from argo_env.run.record import RunRecord
from argo_env.run.session import resume
from argo_env.run.spec import logged_events
from tests.conftest import FIRST_SEED, examples
from tests.e2e.conftest import read_run_record, start_argo
from tests.e2e.test_errors import require_refusal
from tests.mission_writing import above, wait
from tests.yard import measure, mission, opened, shelter, simulated, waypoint, write_yard

KILLS = examples(32)
LONGEST = 1.2  # s after which a process is killed at the latest; a whole run takes longer

PLAN = mission(
    wait("Rest", duration=6.0),
    measure(1),
    waypoint("A", 2.05, 2.05),
    measure(2),
    wait("Join", duration=0.0),
    measure(3, window=TimeWindow(earliest=260.0)),
    waypoint("C", 3.05, 2.05, window=TimeWindow(latest=270.0, missed_target="Told"), optional=True),
    wait("Told", conditions=(above("2", 8.0),), limit=300.0),
    measure(1).model_copy(update={"name": "MEASURE 1 again"}),
    groups=(
        Group(
            name="Round",
            start="A",
            end="Join",
            max_repeat_count=4,
            every=100.0,
            until=(above("3", 8.0),),
        ),
    ),
    reactions=(shelter(2.05, 1.55),),
)
EVENTS = (
    (22.0, Occurred(EventKind.GAS_LEAK)),
    (35.0, Occurred(EventKind.ALL_CLEAR)),
    (50.0, Pause()),
    (55.0, Resume()),
    (145.0, ReadingGiven("3", 9.0)),
    (400.0, ReadingGiven("2", 9.0)),
)
OPTIONS = (
    "--event", "22=gas_leak", "--event", "35=all_clear", "--event", "50=pause",
    "--event", "55=resume", "--event", "145=reading:3=9",
    "--event", "400=reading:2=9", "--value", "2=6.25",
)  # fmt: skip

ANNOUNCED = re.compile(r"^(\S+) s: (.+): gauge \d \(#(\d)\) shows (\S+) bar$", re.MULTILINE)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, argo):
    folder = tmp_path_factory.mktemp("killed")
    write_yard(folder, plan=PLAN)
    argo.open(folder / "yard.yaml")
    return folder


def run_arguments(folder: Path, seed: int = 3) -> tuple[object, ...]:
    """Return the arguments of a run of the mission."""
    return (
        "run", folder / "plan.json", "--site", folder / "yard.yaml", "--seed", seed, *OPTIONS,
    )  # fmt: skip


def parse_announced(text: str) -> list[tuple[float, str, int, float]]:
    """Return the readings that a process printed: time (s), task, checkpoint and value."""
    # A process may be killed in the middle of a line, which is ignored then.
    matches = ANNOUNCED.findall(text[: text.rfind("\n") + 1])
    return [(float(t), task, int(id), float(value)) for t, task, id, value in matches]


def read_announced(output: Path) -> list[tuple[float, str, int, float]]:
    return parse_announced(output.read_text(encoding="utf-8")) if output.exists() else []


def require_complete(record: RunRecord, reference: RunRecord, printed) -> None:
    """Assert that a record has each printed reading once and the results of a reference run."""
    readings = [(r.t, r.task, r.checkpoint, r.value) for r in record.readings]
    assert set(printed) <= set(readings)
    assert len(set(printed)) == len(printed), "a reading was printed twice"
    assert len({r[0] for r in readings}) == len(readings)
    assert [r[1:] for r in readings] == [
        (r.task, r.checkpoint, r.value) for r in reference.readings
    ]
    assert _done_tasks(record) == _done_tasks(reference)
    assert record.result.outcome is reference.result.outcome
    assert record.result.success
    assert [w.task for w in record.waits] == [w.task for w in reference.waits]
    assert [w.kept for w in record.windows] == [w.kept for w in reference.windows]
    assert [(r.group, r.number) for r in record.rounds] == [
        (r.group, r.number) for r in reference.rounds
    ]
    assert record.given_values == reference.given_values
    assert list(record.path) == sorted(record.path, key=lambda sample: sample.t)


def _done_tasks(record: RunRecord) -> list[str]:
    """Return the names of the mission's own tasks that were done, in order.

    Interrupted tasks and those of reactions are left out. Which action an event interrupts, and
    whether a reaction's drive ends before the all-clear, depends on when an action was restarted.
    """
    return [t.task for t in record.tasks if t.outcome == "done" and record.mission.task(t.task)]


def settings(seed: int) -> dict[str, Any]:
    return {"seed": seed, "events": logged_events(*EVENTS), "values": {2: 6.25}}


@pytest.mark.long
def test_killed_runs_lose_nothing(argo, folder, navigator, record_property) -> None:
    rng = random.Random(7 + FIRST_SEED)
    kills, done, silent, seeds = 0, 0, 0, count()
    while kills < KILLS:
        seed = next(seeds)
        reference = simulated(PLAN, navigator, **settings(seed))
        journal = folder / f"{seed}.journal"
        begin = (*run_arguments(folder, seed), "--journal", journal)
        printed, ended = [], False
        for process in count():
            output = folder / f"{seed}-{process}.txt"
            arguments = ("resume", journal) if journal.exists() else begin
            # After the last kill, the last run may end.
            after = rng.uniform(0.0, LONGEST) if kills < KILLS else None
            status = argo.kill(*arguments, output=output, after=after)
            printed += read_announced(output)
            if status == 0:
                ended = True
                break
            assert status == -signal.SIGKILL, output.read_text(encoding="utf-8")
            kills += 1
            silent += not read_announced(output)
        assert ended
        with open_journal(journal) as book:
            assert book.had_ended_when_opened
            record = resume(book, opened(navigator))
        require_complete(record, reference, printed)
        done += 1
    record_property("kills", kills)
    print(f"{kills} kills, {done} runs, {silent} processes that printed no reading")


@pytest.mark.long
def test_the_command_resumes_a_killed_run(
    argo, argo_process, folder: Path, tmp_path: Path, navigator
) -> None:
    journal = tmp_path / "run.journal"
    with start_argo(
        *run_arguments(folder), "--journal", journal, stdout=subprocess.DEVNULL
    ) as process:
        line = process.stderr.readline()
        while not ANNOUNCED.match(line):
            assert line, "the run has ended without a reading"
            line = process.stderr.readline()
        process.send_signal(signal.SIGSTOP)
        refused = argo("resume", journal)
        process.kill()
    assert (refused.returncode, refused.stderr.count("in use")) == (2, 1)
    result = argo_process("resume", journal, "--report", tmp_path / "report", status=0)
    assert "The run continues at" in result.stderr
    record = read_run_record(tmp_path / "report")
    printed = parse_announced(line + result.stderr)
    reference = simulated(PLAN, navigator, **settings(3))
    require_complete(record, reference, printed)
    assert len(record.resumed) == 1
    again = argo("resume", journal, "--report", tmp_path / "again", status=0)
    assert "had ended already" in again.stderr
    one, other = (tmp_path / name / "report.json" for name in ("report", "again"))
    assert other.read_bytes() == one.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "plan.json", "--event", "60=flood"], "no event `flood`; there are: gas_leak"),
        (["run", "plan.json", "--journal", "plan.json"], "is the input"),
        (["resume", "plan.json"], "is not a journal"),
    ],
)
def test_wrong_events_and_journals_are_refused(argo, folder: Path, arguments, message) -> None:
    assert message in require_refusal(argo(*arguments, cwd=folder))


@pytest.mark.physics
def test_what_a_loss_of_power_left_is_told_when_the_run_is_resumed(argo, folder, tmp_path):
    journal = tmp_path / "run.journal"
    argo(*run_arguments(folder), "--journal", journal, status=0)
    lines = journal.read_bytes().splitlines(keepends=True)
    lines = lines[: len(lines) // 2]
    marks = [k for k, line in enumerate(lines) if re.fullmatch(rb'\S+ {"n":\d+}\n', line)]
    synced = b"".join(lines[: marks[-1] + 1])
    journal.write_bytes(synced + bytes(4096) + b"".join(lines[marks[-1] + 4 :]))
    resumed = argo("resume", journal, status=0)
    says = rf"argo: {journal}: damaged from line {marks[-1] + 2} on, as by a loss of power: "
    assert re.search(
        says + r".*All lines before are whole: the run continues at \S+ s", resumed.stderr
    )
    again = argo("resume", journal, status=0)
    assert "damaged" not in again.stderr
    lines[1] = lines[1].replace(b"n", b"m")
    journal.write_bytes(b"".join(lines))
    assert "damaged from line 2 on" in require_refusal(argo("resume", journal))


@pytest.mark.physics
def test_a_damaged_report_next_to_the_journal_is_told_and_stays(argo, folder, tmp_path):
    report = tmp_path / "report"
    argo(*run_arguments(folder), "--report", report, status=0)
    record = report / "report.json"
    damaged = record.read_bytes().replace(b"MEASURE", b"MEASSRE", 1)
    record.write_bytes(damaged)
    resumed = argo("resume", report / "run.journal", status=0)
    assert f"argo: no report is written: {record} is damaged: " in resumed.stderr
    assert record.read_bytes() == damaged
