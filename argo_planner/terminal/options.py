"""Arguments and options that several commands have."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import ArgoError
from argo_planner.terminal import completion

Source = Annotated[
    Path,
    typer.Argument(
        metavar="SCRIPT|MISSION",
        help="script, mission (.json) or ROS bag",
    ),
]
SiteOption = Annotated[
    str,
    typer.Option(
        "--site",
        help="site: its name, the path of its .yaml, or generated:floors=3,seed=7",
        autocompletion=completion.offer_sites,
    ),
]
Optimise = Annotated[
    bool,
    typer.Option("--optimise", help="put the tasks in the best order first, as `argo route` does"),
]
StartArea = Annotated[
    int | None,
    typer.Option("--start-area", help="number of the starting area, if the script names none"),
]
EndArea = Annotated[
    int | None,
    typer.Option("--end-area", help="number of the area to end in, if the script names none"),
]
Strict = Annotated[bool, typer.Option("--strict", help="exit with status 1 if there are warnings")]
Report = Annotated[
    Path | None, typer.Option("--report", metavar="DIR", help="write a report into this folder")
]
Render = Annotated[
    Path | None,
    typer.Option("--render", metavar="FILE.mp4|FILE.gif", help="write a film of the run"),
]
Force = Annotated[bool, typer.Option("--force", help="replace existing files")]

_LONGEST = 1e7  # s


def read_duration(least: float) -> Callable[[str | float], float]:
    """Return a parser of durations such as `10s` and `2 min`, in s, of at least `least` s."""

    def read(option: str | float) -> float:
        from argo_compiler.reorder.requirements import parse_seconds  # most commands need none

        try:
            seconds = parse_seconds(str(option))
        except ArgoError as error:
            raise typer.BadParameter(str(error)) from None
        if not least <= seconds <= _LONGEST:
            raise typer.BadParameter(f"`{option}` is not between {least:g} s and 115 days")
        return seconds

    return read


def given_options(context: typer.Context) -> list[str]:
    """Return the parameter names of the options that the command line contains."""
    arguments = {p.name for p in context.command.params if p.param_type_name == "argument"}
    sources = ((name, context.get_parameter_source(name)) for name in context.params)
    return [
        name
        for name, source in sources
        if source is not None and source.name == "COMMANDLINE" and name not in arguments
    ]


def option_name(name: str) -> str:
    """Return the option of a parameter, such as `--start-area` of `start_area`."""
    return "--" + name.replace("_", "-")
