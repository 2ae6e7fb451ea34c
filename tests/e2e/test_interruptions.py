"""Ctrl-C, SIGTERM, SIGHUP and closed output: at any moment, without lost data or a traceback."""

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
from tests.e2e.conftest import read_run_record, start_argo
from tests.e2e.test_journal import (
    ANNOUNCED,
    LONGEST,
    PLAN,
    parse_announced,
    read_announced,
    require_complete,
    run_arguments,
    settings,
)
from tests.processes import run_python
from tests.yard import measure, mission, simulated, write_yard

INTERRUPTIONS = examples(50)
FULL = Path("/dev/full")
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


LISTING_IMPORTS = {**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}
"""environment in which Python prints the name of each imported module to standard error"""


def signal_on_import(process: subprocess.Popen[str], module: str, number: int) -> list[str]:
    """Send a process a signal once it has imported a module; return its standard error as lines."""
    lines = []
    for line in process.stderr:
        lines.append(line)
        if line.endswith(f" {module}\n"):
            process.send_signal(number)
    return lines


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
def test_a_signal_while_modules_are_imported(missions: Path, number, module: str) -> None:
    with start_argo("run", missions / "protocol_3.txt", env=LISTING_IMPORTS) as process:
        lines = signal_on_import(process, module, number)
        output = process.stdout.read()
    own = [line for line in lines if not line.startswith("import time:")]
    assert process.returncode == STATUS[number]
    assert own in ([], ["argo: interrupted\n"])
    assert not output


def test_a_signal_at_each_line_that_handles_signals() -> None:
    """Each process is interrupted, or ignores the signal because its work is done."""
    ran = run_python("-m", "tests.e2e.signal_at_each_line", int(signal.SIGTERM))
    ends = [tuple(json.loads(line)) for line in ran.stdout.splitlines()]
    interrupted = (143, "argo: interrupted\n")
    assert ends.count(interrupted) > 50
    assert ends == sorted(ends, key=lambda end: end != interrupted)
    assert set(ends) == {interrupted, (0, "")}


def test_a_signal_that_the_parent_ignores_stays_ignored(missions: Path) -> None:
    """Shells ignore SIGINT in background jobs of scripts."""
    with start_argo(
        "format", missions / "protocol_3.txt", env=LISTING_IMPORTS,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    ) as process:  # fmt: skip
        signal_on_import(process, "argo_planner.terminal.importing", signal.SIGINT)
        assert process.stdout.read().startswith("Mission Protocol")
    assert process.returncode == 0


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["sites"], ["schema", "mission"]])
def test_a_closed_output_ends_the_command_without_a_message(arguments: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with start_argo(*arguments, stdout=writing) as process:
        os.close(writing)
        assert not process.stderr.read()
    assert process.returncode == 141


def test_closed_output_and_errors_keep_the_exit_status(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with start_argo("check", tmp_path / "none.json", stdout=writing, stderr=writing) as process:
        os.close(writing)
    assert process.returncode == 2


@pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full, a disk without room")
@pytest.mark.parametrize("arguments", [["--help"], ["sites"]])
def test_output_to_a_full_disk_is_an_error(arguments: list[str]) -> None:
    with FULL.open("w") as full, start_argo(*arguments, stdout=full) as process:
        errors = process.stderr.read()
    assert process.returncode == 2
    assert errors == "argo: the output can't be written: No space left on device\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory, argo) -> Path:
    folder = tmp_path_factory.mktemp("interrupted")
    write_yard(folder, plan=PLAN, short=mission(measure(1)))
    argo.open(folder / "yard.yaml")
    return folder


def interrupt_at_first_reading(number: int, *arguments: object) -> tuple[int, str, str]:
    """Send a run a signal once it has printed its first reading.

    Returns:
        The exit status, the output and the standard error.
    """
    with start_argo(*arguments) as process:
        errors = ""
        while not ANNOUNCED.match(line := process.stderr.readline()):
            assert line, errors
            errors += line
        process.send_signal(number)
        errors += line + process.stderr.read()
        shown = process.stdout.read()
    assert "Traceback" not in errors + shown
    return process.returncode, shown, errors


@pytest.mark.long
def test_an_interrupted_run_has_a_report_and_can_be_resumed(
    argo, folder, navigator, tmp_path
) -> None:
    report = tmp_path / "re port"
    status, shown, errors = interrupt_at_first_reading(
        signal.SIGINT, *run_arguments(folder), "--report", report
    )
    assert status == 130
    assert "MEASURE 1" in shown
    assert "the mission has not ended after" in shown
    so_far = read_run_record(report)
    assert not so_far.result.ended
    assert len(so_far.readings) == len(ANNOUNCED.findall(errors)) > 0
    last = errors.splitlines()[-1]
    assert re.match(r"argo: interrupted at \d+ s; continue with: argo resume ", last)
    go_on = shlex.split(last.partition("continue with: argo ")[2])
    assert go_on == ["resume", str(report / "run.journal"), "--report", str(report)]

    refused = argo(*run_arguments(folder), "--report", report, status=2)
    assert f"continue it with: {last.partition('with: ')[2]}" in refused.stderr
    with open_journal(report / "run.journal"):
        refused = argo(*run_arguments(folder), "--report", report, "--force")
    assert (refused.returncode, refused.stderr.count("in use")) == (2, 1)
    assert read_run_record(report) == so_far

    result = argo(*go_on, status=0)
    record = read_run_record(report)
    printed = parse_announced(errors + result.stderr)
    require_complete(record, simulated(PLAN, navigator, **settings(3)), printed)
    assert record.readings[: len(so_far.readings)] == so_far.readings

    again = argo("resume", report / "run.journal", "--report", report)
    assert (again.returncode, read_run_record(report)) == (0, record)
    late = argo("resume", report / "run.journal", "--event", "5=pause")
    assert (late.returncode, late.stderr.count("the run has ended, at")) == (2, 1)
    # The report of a finished run is not replaced by that of another run.
    (report / "other.journal").write_bytes(
        b"".join((report / "run.journal").read_bytes().splitlines(keepends=True)[:20])
    )
    refused = argo("resume", report / "other.journal", "--report", report)
    assert (refused.returncode, refused.stderr.count("already exists")) == (2, 1)
    assert read_run_record(report) == record


@pytest.mark.physics
def test_the_printed_command_to_resume_keeps_the_option_force(folder, tmp_path) -> None:
    film = tmp_path / "run.gif"
    film.write_bytes(b"an older film")
    status, _, errors = interrupt_at_first_reading(
        signal.SIGTERM,
        *run_arguments(folder), "--journal", tmp_path / "run.journal", "--render", film, "--force",
    )  # fmt: skip
    assert status == 143
    assert film.read_bytes() == b"an older film"
    assert errors.endswith(
        f"continue with: argo resume {tmp_path}/run.journal --render {film} --force\n"
    )


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_an_interrupted_run_without_a_journal_has_its_recording(
    argo, folder, tmp_path, number
) -> None:
    recording = tmp_path / "run.mcap"
    status, shown, errors = interrupt_at_first_reading(
        number, *run_arguments(folder), "--record", recording
    )
    assert status == STATUS[number]
    assert "the run can't be continued, as no journal (--report or --journal) stores it" in errors
    assert f"; to see the results so far: argo replay {recording}\n" in errors
    again = argo("replay", recording, "--report", tmp_path / "again", status=1)
    verdict = next(line for line in shown.splitlines() if "has not ended" in line)
    assert verdict in again.stdout
    assert not read_run_record(tmp_path / "again").result.ended


@pytest.mark.long
def test_a_run_interrupted_before_its_first_step_can_be_resumed(
    argo, folder, navigator, tmp_path
) -> None:
    report = tmp_path / "report"
    with start_argo(*run_arguments(folder), "--report", report) as process:
        while not (report / "run.journal").exists():
            assert process.poll() is None
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        shown, errors = process.communicate()
    assert (process.returncode, "Traceback" in errors) == (130, False)
    assert "has not ended" in shown
    assert not read_run_record(report).result.ended
    result = argo("resume", report / "run.journal", status=0)  # its own report needs no option
    assert f"Report: {report}" in result.stdout
    require_complete(read_run_record(report), simulated(PLAN, navigator, **settings(3)), ())


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda n: n.name)
def test_a_search_for_the_best_order_is_interrupted(missions: Path, number) -> None:
    sheet = missions / "any_order.txt"
    with start_argo("route", sheet, "--time-limit", 100, env=LISTING_IMPORTS) as process:
        lines = signal_on_import(process, "ortools.sat.python.cp_model", number)
    assert "Traceback" not in "".join(lines)
    assert process.returncode == STATUS[number]


@pytest.mark.long
@pytest.mark.parametrize("closed", [True, False], ids=["closed", "full"])
def test_a_run_whose_output_can_not_be_written_has_a_report(folder, tmp_path, closed: bool) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    if not closed:
        os.close(writing)
        writing = os.open(FULL, os.O_WRONLY)
    short = ("run", folder / "short.json", "--site", folder / "yard.yaml")
    with start_argo(*short, "--report", tmp_path / "report", stdout=writing) as process:
        os.close(writing)
        errors = process.stderr.read()
    assert process.returncode == (141 if closed else 2)
    assert "Traceback" not in errors
    assert errors.count("the output can't be written") == (0 if closed else 1)
    assert read_run_record(tmp_path / "report").result.success


@pytest.mark.long
def test_interrupted_runs_lose_nothing(argo, folder, navigator) -> None:
    """Runs get signals at random moments, the earliest right at the start."""
    rng = random.Random(16 + FIRST_SEED)
    sent, statuses, seeds = 0, [], count()
    while sent < INTERRUPTIONS:
        seed = next(seeds)
        report = folder / f"report {seed}"
        printed, status = [], None
        for process in count():
            output = folder / f"{seed}-{process}.txt"
            journal = report / "run.journal"
            begin = ("resume", journal) if journal.exists() else run_arguments(folder, seed)
            number = rng.choice(list(STATUS))
            after = rng.uniform(0.0, LONGEST) if sent < INTERRUPTIONS else None
            status = argo.kill(
                *begin, "--report", report, output=output, after=after, number=number
            )
            output_text = output.read_text(encoding="utf-8") if output.exists() else ""
            assert "Traceback" not in output_text
            assert "ignored" not in output_text
            printed += read_announced(output)
            statuses.append(status)
            if status == 0:
                break
            assert status == STATUS[number], output_text
            sent += 1
            if journal.exists() and "continue with" in output_text:
                assert {(r.t, r.task) for r in read_run_record(report).readings} >= {
                    (t, task) for t, task, *_ in printed
                }
        require_complete(
            read_run_record(report), simulated(PLAN, navigator, **settings(seed)), printed
        )
    print(f"{sent} interruptions, {statuses.count(0)} runs to their end")
