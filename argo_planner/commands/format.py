"""`argo format`: write a mission as a script."""

from pathlib import Path
from typing import Annotated

import typer

from argo_env.planning.opening import open_site
from argo_planner.terminal.files import STANDARD_OUTPUT, check_outputs, read_upload, write_content
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import EndArea, Force, SiteOption, Source, StartArea
from argo_planner.use_cases.exporting import to_script


def format_command(
    source: Source,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="write the script to this file")
    ] = None,
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Write a mission as a script in a standard form; importing it gives the same mission."""
    check_outputs([source, site], [output], force=force)
    opened = open_site(site)
    script = to_script(import_and_warn(read_upload(source), opened, start_area, end_area), opened)
    write_content(output or STANDARD_OUTPUT, script)
