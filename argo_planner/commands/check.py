"""`argo check`: check a mission without running it."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import INCOMPLETE, ArgoError
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    has_errors,
    severity_counts_text,
)
from argo_compiler.diagnostics.codes.code import Severity
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import STANDARD_OUTPUT, check_outputs, read_upload, write_content
from argo_planner.terminal.language import in_chosen_language
from argo_planner.terminal.options import EndArea, Force, SiteOption, Source, StartArea, Strict
from argo_planner.terminal.output import EXIT_INCOMPLETE
from argo_planner.terminal.words import add_options_to_hints
from argo_planner.use_cases.checking import (
    Format,
    check_source,
    error_diagnostics,
    format_diagnostics,
)


def check_command(
    source: Source,
    site: SiteOption = "umad",
    format: Annotated[
        Format,
        typer.Option("--format", help="text for people, json for programs, sarif for code hosts"),
    ] = Format.TEXT,
    strict: Strict = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="write the result to this file")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Check a mission without running it; exits with status 2 if there are errors."""
    check_outputs([source, site], [output], force=force)
    draft = None
    try:
        found = _diagnostics(source, site, start_area, end_area)
    except DiagnosticError as error:
        if error.code != INCOMPLETE:
            raise
        found, draft = error.diagnostics, error.draft  # type: ignore[attr-defined]
    diagnostics = add_options_to_hints(found, str(source))
    left = None if draft is None else draft.left
    written = format_diagnostics(diagnostics, str(source), format, left, in_chosen_language)
    if draft is not None and format is Format.TEXT:
        from argo_planner.terminal.draft_display import left_text

        written += f"\n{left_text(draft)}"
    if output and output != STANDARD_OUTPUT:
        write_content(output, written + "\n")
        print(f"{source}: {in_chosen_language(severity_counts_text(diagnostics))}")
    else:
        print(written)
    if draft is not None:
        raise typer.Exit(EXIT_INCOMPLETE)
    if has_errors(diagnostics):
        raise typer.Exit(2)
    if strict and any(d.severity is not Severity.NOTE for d in diagnostics):
        raise typer.Exit(1)


def _diagnostics(
    source: Path, site: str, start_area: int | None, end_area: int | None
) -> tuple[Diagnostic, ...]:
    opened = open_site(site)
    try:
        upload = read_upload(source)
    except ArgoError as error:
        return error_diagnostics(error)
    return check_source(upload, opened.catalog, start_area, end_area, opened.travel, opened)
