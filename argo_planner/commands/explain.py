"""`argo explain`: what was understood of a mission, in plain sentences."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.diagnostics.codes.code import Severity
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import STANDARD_OUTPUT, check_outputs, read_upload, write_content
from argo_planner.terminal.options import EndArea, Force, SiteOption, Source, StartArea, Strict
from argo_planner.use_cases.explaining import ReadingFormat, reading_of, write_reading
from argo_planner.use_cases.importing import import_mission


def explain_mission(
    source: Source,
    site: SiteOption = "umad",
    format: Annotated[ReadingFormat, typer.Option("--format", help="for people or programs")] = (
        ReadingFormat.TEXT
    ),
    strict: Strict = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="a file to write it to; else it is shown")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Print in plain sentences how Argo understood a mission, and what it assumed."""
    check_outputs([source, site], [output], force=force)
    opened = open_site(site)
    imported = import_mission(read_upload(source), opened, start_area, end_area)
    reading = reading_of(imported, opened)
    write_content(output or STANDARD_OUTPUT, write_reading(reading, format))
    if strict and any(d.severity is Severity.WARNING for d in imported.warnings):
        raise typer.Exit(1)
