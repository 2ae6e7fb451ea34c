"""`argo export`: a mission in the format of another tool."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.errors import NotFound
from argo_env.planning.opening import open_site
from argo_planner.terminal.completion import among
from argo_planner.terminal.files import keep_apart, read_upload, write_content
from argo_planner.terminal.importing import import_shown
from argo_planner.terminal.options import EndArea, SiteOption, Source, StartArea
from argo_planner.use_cases.exporting import FORMATS, require_format
from argo_planner.use_cases.exporting import export_mission as export_imported


def export_mission(
    source: Source,
    to: Annotated[
        str,
        typer.Option(
            "--to", metavar="FORMAT", help=", ".join(FORMATS), autocompletion=among(FORMATS)
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="the file to write, or the folder of files")
    ],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Write a mission in the format of another tool."""
    keep_apart([source, site], [output])
    try:
        require_format(to)
    except NotFound as error:
        raise NotFound(f"--to {error}") from None
    opened = open_site(site)
    imported = import_shown(read_upload(source), opened, start_area, end_area)
    exported = export_imported(imported, opened, to)
    write_content(output, exported.content)
    Console(highlight=False).print(f"{escape(str(output))}: {exported.description}", soft_wrap=True)
