"""`argo resume`: a run goes on from its journal."""

import time
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from argo_env.files.folders import make_folder
from argo_env.recording.files import check_recording, recording_to
from argo_env.run.journal import open_journal
from argo_env.run.session import resume
from argo_env.run.spec import logged
from argo_planner.commands.run import KINDS, parse_events
from argo_planner.loading import load_navigator
from argo_planner.running import RunDisplay, conclude


def resume_run(
    journal: Annotated[
        Path, typer.Argument(metavar="JOURNAL", help="the file that `argo run --journal` kept")
    ],
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="folder for the report")
    ] = None,
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="TIME=KIND",
            help=f"what occurs at a time (s), at once if that is over; {KINDS}",
        ),
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option("--record", metavar="FILE.mcap", help="record the rest of the run"),
    ] = None,
) -> None:
    """Go on with a run whose process has died, from its journal."""
    if report:
        make_folder(report)
    if recording:
        check_recording(recording)
    events = logged(*parse_events(event or []))
    console = Console(stderr=True, highlight=False)
    with open_journal(journal) as book:
        navigator = load_navigator(book.header.site)
        book.require_unchanged(navigator)
        at = book.entries[-1].t if book.entries else 0.0
        if book.ended:
            console.print(f"The run had ended already, at {at:g} s; these are its results.")
        else:
            navigator.prepare()
            console.print(f"The run goes on at {at:g} s.")
        begun = time.monotonic()
        source = Path(book.header.source) if book.header.source else None
        with ExitStack() as stack:
            display = stack.enter_context(RunDisplay(book.header.mission.max_duration))
            record = resume(
                book,
                navigator,
                observe=display.observe,
                announce=display.announce,
                events=events,
                recorder=stack.enter_context(recording_to(recording, source))
                if recording
                else None,
            )
    seconds = time.monotonic() - begun
    speed = (record.result.duration - at) / max(1e-9, seconds)
    took = f"The rest took {seconds:.1f} s: {speed:.0f} times real time."
    if book.ended:
        took = f"Reading the journal took {seconds:.1f} s."
    conclude(record, navigator, took, report)
