"""Ctrl-C, SIGTERM and readers that go away: at whatever moment, nothing is lost and no traceback is
shown."""

import json
import os
import random
import re
import shlex
import signal
import subprocess
import time
from itertools import count
from pathlib import Path

import pytest

from argo_env.run.journal import open_journal
from tests.conftest import FIRST_SEED, examples
from tests.e2e.conftest import reported, started
from tests.e2e.test_journal import (
    ANNOUNCED,
    LONGEST,
    PLAN,
    announced,
    announced_in,
    require_complete,
    run_of,
    settings,
)
from tests.processes import run_python
from tests.yard import measure, mission, simulated, write_yard

INTERRUPTIONS = examples(50)
FULL = Path("/dev/full")
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


TELLING = {**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}
"""an environment in which Python says which module it has just imported"""


def signalled_on_import(process: subprocess.Popen[str], module: str, number: int) -> list[str]:
    """Send a process the signal when it has imported the module; return what it says as errors."""
    said = []
    for line in process.stderr:
        said.append(line)
        if line.endswith(f" {module}\n"):
            process.send_signal(number)
    return said


@pytest.mark.parametrize(
    ("number", "module"),
    [
        (signal.SIGINT, "argo_planner.terminal.signals"),
        (signal.SIGTERM, "argo_planner.cli"),
        (signal.SIGHUP, "argo_planner.cli"),
        (signal.SIGINT, "numpy"),
        (signal.SIGTERM, "argo_planner.terminal.run_display"),
    ],
    ids=lambda given: getattr(given, "name", given),
)
def test_while_modules_are_imported(missions: Path, number, module: str) -> None:
    with started("run", missions / "protocol_3.txt", env=TELLING) as process:
        said = signalled_on_import(process, module, number)
        output = process.stdout.read()
    own = [line for line in said if not line.startswith("import time:")]
    assert process.returncode == STATUS[number]
    assert own in ([], ["argo: interrupted\n"])
    assert not output


def test_at_each_line_that_answers_signals() -> None:
    """Once signals are ignored, the command has done what it was to do."""
    ran = run_python("-m", "tests.e2e.signal_at_each_line", int(signal.SIGTERM))
    ends = [tuple(json.loads(line)) for line in ran.stdout.splitlines()]
    interrupted = (143, "argo: interrupted\n")
    assert ends.count(interrupted) > 50
    assert ends == sorted(ends, key=lambda end: end != interrupted)
    assert set(ends) == {interrupted, (0, "")}


def test_a_signal_that_is_ignored_from_outside_stays_so(missions: Path) -> None:
    """As in a script's background jobs."""
    with started(
        "format", missions / "protocol_3.txt", env=TELLING,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    ) as process:  # fmt: skip
        signalled_on_import(process, "argo_planner.terminal.importing", signal.SIGINT)
        assert process.stdout.read().startswith("Mission Protocol")
    assert process.returncode == 0


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["sites"], ["schema", "mission"]])
def test_a_reader_that_has_gone_is_told_nothing(arguments: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with started(*arguments, stdout=writing) as process:
        os.close(writing)
        assert not process.stderr.read()
    assert process.returncode == 141


def test_nobody_reads_what_is_said_either(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with started("check", tmp_path / "none.json", stdout=writing, stderr=writing) as process:
        os.close(writing)
    assert process.returncode == 2


@pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full, a disk without room")
@pytest.mark.parametrize("arguments", [["--help"], ["sites"]])
def test_output_that_has_no_room_is_told(arguments: list[str]) -> None:
    with FULL.open("w") as full, started(*arguments, stdout=full) as process:
        said = process.stderr.read()
    assert process.returncode == 2
    assert said == "argo: the output can't be written: No space left on device\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory, argo) -> Path:
    folder = tmp_path_factory.mktemp("interrupted")
    write_yard(folder, plan=PLAN, short=mission(measure(1)))
    argo.open(folder / "yard.yaml")
    return folder


def interrupted_when_it_reads(number: int, *arguments: object) -> tuple[int, str, str]:
    """What comes of a run that gets the signal when it has told its first reading: the exit status,
    and what it has printed."""
    with started(*arguments) as process:
        said = ""
        while not ANNOUNCED.match(line := process.stderr.readline()):
            assert line, said
            said += line
        process.send_signal(number)
        said += line + process.stderr.read()
        shown = process.stdout.read()
    assert "Traceback" not in said + shown
    return process.returncode, shown, said


@pytest.mark.long
def test_an_interrupted_run_is_reported_and_goes_on(argo, folder, navigator, tmp_path) -> None:
    report = tmp_path / "re port"
    status, shown, said = interrupted_when_it_reads(
        signal.SIGINT, *run_of(folder), "--report", report
    )
    assert status == 130
    assert "MEASURE 1" in shown
    assert "the mission has not ended after" in shown
    so_far = reported(report)
    assert not so_far.result.ended
    assert len(so_far.readings) == len(ANNOUNCED.findall(said)) > 0
    last = said.splitlines()[-1]
    assert re.match(r"argo: interrupted at \d+ s; continue with: argo resume ", last)
    go_on = shlex.split(last.partition("continue with: argo ")[2])
    assert go_on == ["resume", str(report / "run.journal"), "--report", str(report)]

    refused = argo(*run_of(folder), "--report", report, status=2)
    assert f"continue it with: {last.partition('with: ')[2]}" in refused.stderr
    with open_journal(report / "run.journal"):
        refused = argo(*run_of(folder), "--report", report, "--force")
    assert (refused.returncode, refused.stderr.count("in use")) == (2, 1)
    assert reported(report) == so_far

    result = argo(*go_on, status=0)
    record = reported(report)
    told = announced(said + result.stderr)
    require_complete(record, simulated(PLAN, navigator, **settings(3)), told)
    assert record.readings[: len(so_far.readings)] == so_far.readings

    again = argo("resume", report / "run.journal", "--report", report)
    assert (again.returncode, reported(report)) == (0, record)
    late = argo("resume", report / "run.journal", "--event", "5=pause")
    assert (late.returncode, late.stderr.count("the run has ended, at")) == (2, 1)
    # What was finished is not replaced by a run that tells something else.
    (report / "other.journal").write_bytes(
        b"".join((report / "run.journal").read_bytes().splitlines(keepends=True)[:20])
    )
    kept = argo("resume", report / "other.journal", "--report", report)
    assert (kept.returncode, kept.stderr.count("already exists")) == (2, 1)
    assert reported(report) == record


def test_what_goes_on_with_a_run_replaces_what_that_was_to_replace(folder, tmp_path) -> None:
    film = tmp_path / "run.gif"
    film.write_bytes(b"an older film")
    status, _, said = interrupted_when_it_reads(
        signal.SIGTERM,
        *run_of(folder), "--journal", tmp_path / "run.journal", "--render", film, "--force",
    )  # fmt: skip
    assert status == 143
    assert film.read_bytes() == b"an older film"
    assert said.endswith(
        f"continue with: argo resume {tmp_path}/run.journal --render {film} --force\n"
    )


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_an_interrupted_run_that_is_recorded_only(argo, folder, tmp_path, number) -> None:
    recording = tmp_path / "run.mcap"
    status, shown, said = interrupted_when_it_reads(number, *run_of(folder), "--record", recording)
    assert status == STATUS[number]
    assert "the run can't be continued, as no journal (--report or --journal) stores it" in said
    assert f"; to see the results so far: argo replay {recording}\n" in said
    again = argo("replay", recording, "--report", tmp_path / "again", status=1)
    verdict = next(line for line in shown.splitlines() if "has not ended" in line)
    assert verdict in again.stdout
    assert not reported(tmp_path / "again").result.ended


@pytest.mark.long
def test_interrupted_before_the_first_step(argo, folder, navigator, tmp_path) -> None:
    report = tmp_path / "report"
    with started(*run_of(folder), "--report", report) as process:
        while not (report / "run.journal").exists():
            assert process.poll() is None
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        shown, said = process.communicate()
    assert (process.returncode, "Traceback" in said) == (130, False)
    assert "has not ended" in shown
    assert not reported(report).result.ended
    argo("resume", report / "run.journal", "--report", report, status=0)
    require_complete(reported(report), simulated(PLAN, navigator, **settings(3)), ())


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda n: n.name)
def test_a_search_for_the_best_order_is_interrupted(missions: Path, number) -> None:
    sheet = missions / "any_order.txt"
    with started("route", sheet, "--time-limit", 100, env=TELLING) as process:
        said = signalled_on_import(process, "ortools.sat.python.cp_model", number)
    assert "Traceback" not in "".join(said)
    assert process.returncode == STATUS[number]


@pytest.mark.long
@pytest.mark.parametrize("closed", [True, False], ids=["closed", "full"])
def test_a_run_whose_output_goes_nowhere_is_reported(folder, tmp_path, closed: bool) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    if not closed:
        os.close(writing)
        writing = os.open(FULL, os.O_WRONLY)
    short = ("run", folder / "short.json", "--site", folder / "yard.yaml")
    with started(*short, "--report", tmp_path / "report", stdout=writing) as process:
        os.close(writing)
        said = process.stderr.read()
    assert process.returncode == (141 if closed else 2)
    assert "Traceback" not in said
    assert said.count("the output can't be written") == (0 if closed else 1)
    assert reported(tmp_path / "report").result.success


@pytest.mark.long
def test_runs_that_are_interrupted_lose_nothing(argo, folder, navigator) -> None:
    """At random moments, from the first one on."""
    rng = random.Random(16 + FIRST_SEED)
    sent, statuses, seeds = 0, [], count()
    while sent < INTERRUPTIONS:
        seed = next(seeds)
        report = folder / f"report {seed}"
        told, status = [], None
        for process in count():
            output = folder / f"{seed}-{process}.txt"
            journal = report / "run.journal"
            begin = ("resume", journal) if journal.exists() else run_of(folder, seed)
            number = rng.choice(list(STATUS))
            after = rng.uniform(0.0, LONGEST) if sent < INTERRUPTIONS else None
            status = argo.kill(
                *begin, "--report", report, output=output, after=after, number=number
            )
            said = output.read_text(encoding="utf-8") if output.exists() else ""
            assert "Traceback" not in said
            assert "ignored" not in said
            told += announced_in(output)
            statuses.append(status)
            if status == 0:
                break
            assert status == STATUS[number], said
            sent += 1
            if journal.exists() and "continue with" in said:
                assert {(r.t, r.task) for r in reported(report).readings} >= {
                    (t, task) for t, task, *_ in told
                }
        require_complete(reported(report), simulated(PLAN, navigator, **settings(seed)), told)
    print(f"{sent} interruptions, {statuses.count(0)} runs to their end")
