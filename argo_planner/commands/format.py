"""`argo format`: a mission is written as a script."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import format_script
from argo_env.planning.catalog import make_catalog
from argo_planner.loading import keep_input, load_mission, load_navigator, write_text
from argo_planner.options import EndArea, SiteOption, Source, StartArea


def format_mission(
    source: Source,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="the script to write; else it is shown")
    ] = None,
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Write a mission as a script, in one canonical form; importing that gives the same mission."""
    if output:
        keep_input(source, output)
    navigator = load_navigator(site)
    mission, _ = load_mission(source, navigator, start_area, end_area)
    try:
        script = format_script(mission, make_catalog(navigator))
    except DiagnosticError as error:
        raise DiagnosticError(str(source), error.diagnostics) from None
    if output:
        write_text(output, script)
    else:
        sys.stdout.write(script)
