"""`argo compile`: a mission becomes its state machine."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.export import to_mermaid
from argo_compiler.hfsm import lower
from argo_planner.loading import keep_input, load_mission, load_navigator, write_text
from argo_planner.options import EndArea, Optimise, SiteOption, Source, StartArea
from argo_planner.routing import optimised


def compile_mission(
    source: Source,
    output: Annotated[Path, typer.Option("-o", "--output", help="the machine's .json to write")],
    mermaid: Annotated[
        Path | None, typer.Option("--mermaid", help="a Mermaid diagram to write as well")
    ] = None,
    site: SiteOption = "umad",
    optimise: Optimise = False,
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Lower a mission to its state machine and write it as JSON."""
    keep_input(source, output)
    navigator = load_navigator(site)
    mission, _ = load_mission(source, navigator, start_area, end_area)
    if optimise:
        mission, _ = optimised(source, mission, navigator)
    machine = lower(mission, source_name=str(source))
    write_text(output, machine.model_dump_json(indent=2) + "\n")
    if mermaid:
        write_text(mermaid, to_mermaid(machine))
    Console(highlight=False).print(
        f"{escape(str(output))}: {len(machine.leaves)} tasks, {len(machine.composites) - 1} groups",
        soft_wrap=True,
    )
