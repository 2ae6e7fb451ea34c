"""`argo explain`: print what Argo understood of a mission, in plain sentences."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.diagnostics.codes.code import Severity
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import STANDARD_OUTPUT, check_outputs, read_upload, write_content
from argo_planner.terminal.options import EndArea, Force, SiteOption, Source, StartArea, Strict
from argo_planner.use_cases.explaining import ExplanationFormat, explain_mission, format_explanation
from argo_planner.use_cases.importing import import_mission


def explain_command(
    source: Source,
    site: SiteOption = "umad",
    format: Annotated[
        ExplanationFormat, typer.Option("--format", help="text for people, json for programs")
    ] = ExplanationFormat.TEXT,
    strict: Strict = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="write the result to this file")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Print in plain sentences how Argo understood a mission, and what it assumed."""
    check_outputs([source, site], [output], force=force)
    opened = open_site(site)
    imported = import_mission(read_upload(source), opened, start_area, end_area)
    explanation = explain_mission(imported, opened)
    write_content(output or STANDARD_OUTPUT, format_explanation(explanation, format))
    if strict and any(d.severity is Severity.WARNING for d in imported.warnings):
        raise typer.Exit(1)
