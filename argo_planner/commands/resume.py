"""`argo resume`: continue a run from its journal."""

import os
import sys
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import Invalid, Unavailable
from argo_env.files.folders import make_folder
from argo_env.planning.opening import open_site
from argo_env.recording.files import check_recording_path
from argo_env.run.journal import open_journal
from argo_env.run.session import resume_unchecked
from argo_env.run.spec import logged_events
from argo_planner.terminal.conclusion import Conclusion
from argo_planner.terminal.events import KINDS, READING_FORM, parse_events
from argo_planner.terminal.files import check_outputs
from argo_planner.terminal.options import Force, Report
from argo_planner.terminal.run_display import run_and_describe_recording
from argo_planner.terminal.run_storage import (
    JOURNAL,
    RunStorage,
    find_own_report,
    is_report_of,
    require_no_unfinished_run,
)
from argo_planner.terminal.signals import defer_first_signal
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.use_cases.reporting import REPORT_FILES


def resume_command(
    journal: Annotated[
        Path,
        typer.Argument(
            metavar="JOURNAL", help="journal that `argo run` has written, such as DIR/run.journal"
        ),
    ],
    report: Report = None,
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="TIME=KIND",
            help="event at a time in s of the run; at once if that time is over; KIND: "
            f"{KINDS}, or {READING_FORM}",
        ),
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option(
            "--record", metavar="FILE.mcap", help="record the rest of the run into this file"
        ),
    ] = None,
    render: Annotated[
        Path | None,
        typer.Option("--render", metavar="FILE.mp4|FILE.gif", help="write a film of the whole run"),
    ] = None,
    force: Force = False,
) -> None:
    """Continue an interrupted run from its journal."""
    if os.path.isfile(journal / JOURNAL):
        raise Invalid(f"{journal} is a folder; name the journal in it: {journal / JOURNAL}")
    check_outputs([journal], [recording, render], (), force)
    if recording:
        check_recording_path(recording)
    if render:
        from argo_env.pictures import check_film

        check_film(render)
    events = logged_events(*parse_events(event or []))
    console = Console(stderr=True, highlight=False, quiet=is_quiet())
    with open_journal(journal) as book:
        if book.loss:
            print(f"argo: {book.loss}", file=sys.stderr)
        if report is None:
            try:
                report = find_own_report(book, journal)
            except Unavailable as error:
                print(f"argo: no report is written: {error}", file=sys.stderr)
        if report and not force:
            if os.path.realpath(report / JOURNAL) != os.path.realpath(journal):
                require_no_unfinished_run(report)
            if not is_report_of(book, report):
                check_outputs([journal], (), [(report, REPORT_FILES)])
        if events:
            book.require_not_ended()
        site = open_site(book.header.spec.site)
        book.require_inputs_unchanged(site)
        if report:
            make_folder(report)  # only now, so that a refused command leaves no folder
        at = book.entries[-1].t if book.entries else 0.0
        if book.had_ended_when_opened:
            console.print(f"The run had ended already, at {at:g} s; these are its results.")
        else:
            site.prepare()
            console.print(f"The run continues at {at:g} s.")
        with defer_first_signal() as interruption:
            conclusion = Conclusion(report, render, RunStorage(journal, force=force), interruption)
            begun = time.monotonic()
            with conclusion.exit_with_hint_on_interruption():
                record, recorded = run_and_describe_recording(
                    book.header.spec.mission.max_duration,
                    recording,
                    Path(book.header.spec.source) if book.header.spec.source else None,
                    lambda observers: resume_unchecked(
                        book, site, observers=observers, events=events, interrupted=interruption
                    ),
                )
            seconds = time.monotonic() - begun
            speed = (record.result.duration - at) / max(1e-9, seconds)
            took = f"The rest took {seconds:.1f} s: {speed:.0f} times real time."
            if book.had_ended_when_opened:
                took = f"Reading the journal took {seconds:.1f} s."
            if recorded:
                took += f"\n{escape(recorded)}"
            conclusion.write_report_and_show_results(record, site.site, site.robot, took)
