"""`argo export`: write a mission in the format of another tool."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import ArgoError, Invalid, with_message_prefix
from argo_compiler.export import EXPORTERS
from argo_env.planning.opening import open_site
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.files import (
    STANDARD_OUTPUT,
    check_outputs,
    print_written,
    read_upload,
    write_content,
)
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import EndArea, Force, SiteOption, Source, StartArea
from argo_planner.use_cases.exporting import export_mission


def export_command(
    source: Source,
    to: Annotated[
        str,
        typer.Option(
            "--to",
            metavar="FORMAT",
            help=f"format: {', '.join(EXPORTERS)}",
            autocompletion=offer_names(EXPORTERS.names),
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="file to write; a folder for formats of several files"),
    ],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Write a mission in the format of another tool."""
    try:
        exporter = EXPORTERS[to]
    except ArgoError as error:
        raise with_message_prefix(error, f"--to {to}") from None
    if not exporter.suffixes:
        if output == STANDARD_OUTPUT:
            raise Invalid(f"--to {to} writes a folder, not standard output: name a folder with -o")
        check_outputs([source, site], folders=[(output, ())])
    else:
        check_outputs([source, site], [output], force=force)
    opened = open_site(site)
    imported = import_and_warn(read_upload(source), opened, start_area, end_area)
    exported = export_mission(imported, opened, to)
    if isinstance(exported.content, Mapping):
        check_outputs([], folders=[(output, exported.content)], force=force)
    write_content(output, exported.content)
    print_written(output, exported.description)
