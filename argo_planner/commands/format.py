"""`argo format`: a mission is written as a script."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from argo_env.planning.opening import open_site
from argo_planner.terminal.files import keep_apart, read_upload, write_text
from argo_planner.terminal.importing import import_shown
from argo_planner.terminal.options import EndArea, SiteOption, Source, StartArea
from argo_planner.use_cases.exporting import as_script


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
    keep_apart([source, site], [output])
    opened = open_site(site)
    script = as_script(import_shown(read_upload(source), opened, start_area, end_area), opened)
    if output:
        write_text(output, script)
    else:
        sys.stdout.write(script)
