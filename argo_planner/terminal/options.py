"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

from argo_planner.terminal import completion

Source = Annotated[
    Path,
    typer.Argument(
        metavar="SCRIPT|MISSION",
        help="a mission script, a mission's .json, or a bag",
    ),
]
SiteOption = Annotated[
    str,
    typer.Option(
        "--site",
        help="a site's name, a path to its .yaml, or generated:floors=3,seed=7",
        autocompletion=completion.sites,
    ),
]
Optimise = Annotated[
    bool,
    typer.Option("--optimise", help="put the tasks in the best order first; see `argo route`"),
]
StartArea = Annotated[
    int | None, typer.Option("--start-area", help="the starting area, where the script leaves it")
]
EndArea = Annotated[
    int | None, typer.Option("--end-area", help="the area to end in, where the script leaves it")
]
Strict = Annotated[bool, typer.Option("--strict", help="exit with status 1 if there are warnings")]
Report = Annotated[
    Path | None, typer.Option("--report", metavar="DIR", help="folder for the report")
]
Render = Annotated[
    Path | None, typer.Option("--render", metavar="FILE.mp4|FILE.gif", help="film the run")
]
Force = Annotated[bool, typer.Option("--force", help="replace files that are there already")]


def given_options(context: typer.Context) -> list[str]:
    """The names of the parameters of a command that its command line has, but for arguments."""
    arguments = {p.name for p in context.command.params if p.param_type_name == "argument"}
    sources = ((name, context.get_parameter_source(name)) for name in context.params)
    return [
        name
        for name, source in sources
        if source is not None and source.name == "COMMANDLINE" and name not in arguments
    ]


def dashed(name: str) -> str:
    """A parameter's name as that of an option."""
    return "--" + name.replace("_", "-")
