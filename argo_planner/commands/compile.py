"""`argo compile`: convert a mission to its state machine."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.quantity_text import counted_text
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import check_outputs, print_written, read_upload, write_content
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import EndArea, Force, Optimise, SiteOption, Source, StartArea
from argo_planner.use_cases.compiling import compile_mission


def compile_command(
    source: Source,
    output: Annotated[Path, typer.Option("-o", "--output", help="file for the machine (.json)")],
    mermaid: Annotated[
        Path | None, typer.Option("--mermaid", help="write a Mermaid diagram, too")
    ] = None,
    site: SiteOption = "umad",
    optimise: Optimise = False,
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Convert a mission to its state machine, and write that as JSON."""
    check_outputs([source, site], [output, mermaid], force=force)
    opened = open_site(site)
    imported = import_and_warn(read_upload(source), opened, start_area, end_area)
    if optimise:
        from argo_planner.terminal.reordering import optimise_and_show  # imports the solvers

        imported, _ = optimise_and_show(imported, opened)
    compiled = compile_mission(imported)
    write_content(output, compiled.json)
    if mermaid:
        write_content(mermaid, compiled.mermaid)
    machine = compiled.machine
    tasks = counted_text(len(machine.leaves), "task")
    print_written(output, f"{tasks}, {counted_text(len(machine.composites) - 1, 'group')}")
