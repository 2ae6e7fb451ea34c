"""`argo replay`: show a recorded run, and write its report or film again."""

import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.base.quantity_text import counted_text
from argo_compiler.base.stages import stage
from argo_env.files.folders import make_folder
from argo_env.formatting import min_sec_text
from argo_env.pictures import check_film
from argo_env.recording.reader import Recording, read_recording
from argo_env.robot.spec import load_robot
from argo_planner.terminal.conclusion import Conclusion
from argo_planner.terminal.files import check_outputs
from argo_planner.terminal.options import Force, Render, Report
from argo_planner.terminal.run_storage import RunStorage, require_no_unfinished_run
from argo_planner.terminal.signals import defer_first_signal
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.use_cases.reporting import REPORT_FILES


def replay_command(
    recording: Annotated[
        Path, typer.Argument(metavar="RECORDING", help="file that `argo run --record` has written")
    ],
    report: Report = None,
    render: Render = None,
    force: Force = False,
) -> None:
    """Show the results of a recorded run; its report and film can be made again."""
    if not force:
        require_no_unfinished_run(report)
    check_outputs([recording], [render], [(report, REPORT_FILES)], force)
    if render:
        check_film(render)
    begun = time.monotonic()
    with stage("reading the recording"):
        found = read_recording(recording)
    if found.record is None and not (report or render):
        _show_unfinished(found)
        raise typer.Exit(1)
    record = found.require_record()
    if report:
        make_folder(report)
    console = Console(stderr=True, highlight=False, quiet=is_quiet())
    if found.flaw:
        console.print(
            f"[bold yellow]Warning[/]: {escape(str(recording))} {escape(found.flaw)}; the record "
            "of the run in it is intact",
            soft_wrap=True,
        )
    count = sum(found.messages.values())
    took = f"Reading {counted_text(count, 'message')} took {time.monotonic() - begun:.1f} s."
    with defer_first_signal() as interruption:
        Conclusion(
            report, render, RunStorage(recording=recording, force=force), interruption
        ).write_report_and_show_results(record, found.site, load_robot(record.robot), took)


def _show_unfinished(recording: Recording) -> None:
    """Print readings and last tasks of a recording that has no record of the run."""
    console = Console()
    for reading in recording.readings:
        console.print(
            f"{min_sec_text(reading.t)} {escape(reading.name)} (#{reading.checkpoint}) shows "
            f"{reading.value:.2f} {reading.unit}",
            soft_wrap=True,
        )
    ended = ", ".join(f"{run.task} ({run.outcome})" for run in recording.tasks[-3:]) or "none"
    console.print(
        f"Tasks that have ended: {len(recording.tasks)}; the last: {escape(ended)}.", soft_wrap=True
    )
    loss = escape(recording.reason_if_record_missing)
    console.print(
        f"[bold red]No success[/]: {loss}; there is no record of the run's end.", soft_wrap=True
    )
