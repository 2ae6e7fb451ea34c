"""`argo route`: the best order of a mission's tasks, with its proof."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError
from rich.console import Console

from argo_compiler.errors import ArgoError
from argo_compiler.files.mission_file import write_mission
from argo_compiler.reorder.requirements import Requirements, What
from argo_compiler.route.robust_spread import CAUTIOUS, SIMULATED
from argo_env.files.folders import make_folder
from argo_env.files.yaml_messages import message_of
from argo_env.pictures.route import write_route
from argo_planner.loading import (
    is_mission_file,
    load_mission,
    load_navigator,
    refuse_areas,
    require_mission_output,
)
from argo_planner.options import EndArea, SiteOption, Source, StartArea
from argo_planner.route_shown import show, show_risk
from argo_planner.routing import (
    TIME_LIMIT,
    Suggested,
    read_requirements,
    require_limit,
    suggest,
    suggest_robust,
    why_none,
)


class Spread(StrEnum):
    """How much travel times spread."""

    SIMULATED = "simulated"
    """as the simulator's do"""
    CAUTIOUS = "cautious"
    """as they might on a real site; an assumption"""


SPREADS = {Spread.SIMULATED: SIMULATED, Spread.CAUTIOUS: CAUTIOUS}


def suggest_order(
    source: Source,
    site: SiteOption = "umad",
    budget: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="such as 20min: what does not fit into this time is left out",
        ),
    ] = None,
    keep_order: Annotated[
        bool, typer.Option("--keep-order", help="leave out what does not fit, but move nothing")
    ] = False,
    before: Annotated[
        list[str] | None,
        typer.Option(metavar="A,B", help='what comes before what, such as "8, 4"'),
    ] = None,
    requirements: Annotated[
        Path | None,
        typer.Option(metavar="FILE.yaml", help="what else is asked for; see docs/routes.md"),
    ] = None,
    time_limit: Annotated[
        float, typer.Option(help="s that the search may take", min=0.01)
    ] = TIME_LIMIT,
    seed: Annotated[int, typer.Option(help="of the search", min=0)] = 0,
    risk: Annotated[
        Spread | None,
        typer.Option(help="say how probable it is to be in time, with times that spread so"),
    ] = None,
    robust: Annotated[
        bool, typer.Option("--robust", help="take the order that is most probably in time instead")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="the mission's .json to write")
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for a picture of each floor")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Suggest the best order of a mission's tasks; exits with status 2 if there is none."""
    if output:
        require_mission_output(source, output)
    wanted = read_requirements(requirements) if requirements else Requirements()
    wanted = with_options(wanted, budget, keep_order, before or [])
    if is_mission_file(source):
        refuse_areas(source, start_area, end_area)
    if pictures:
        make_folder(pictures)
    navigator = load_navigator(site)
    mission, _ = load_mission(source, navigator, start_area, end_area)
    if robust:
        require_limit(mission, wanted)
    found = suggest(source, mission, navigator, wanted, time_limit, seed)
    console = Console(highlight=False)
    spread = SPREADS[risk or Spread.CAUTIOUS]
    _require_order(source, found, console)
    if robust:
        found = suggest_robust(found, spread, time_limit, seed)
        _require_order(source, found, console)
    reordered = found.mission if output else None  # now: not every order can be written
    show(found, console)
    if robust or risk:
        show_risk(found, spread, seed, console)
    if output and reordered:
        write_mission(reordered, output)
        console.print(f"Mission: {output}", soft_wrap=True, markup=False)
    if pictures:
        for path in write_route(found.planned, found.route, navigator, found.travel, pictures):
            console.print(f"Picture: {path}", soft_wrap=True, markup=False)


def _require_order(source: Path, found: Suggested, console: Console) -> None:
    if why := why_none(found):
        console.print(f"{source}: {why}", soft_wrap=True, markup=False)
        raise typer.Exit(2)


def with_options(
    requirements: Requirements, budget: str | None, keep_order: bool, before: list[str]
) -> Requirements:
    """The requirements with those that options ask for; ArgoError where they make no sense."""
    found: dict[str, object] = {"keep_order": keep_order or requirements.keep_order}
    if budget is not None:
        found["budget"] = _checked("budget", budget, budget).budget
    asked = [_checked("before", one, (_sequence(one),)).before for one in before]
    found["before"] = sum(asked, requirements.before)
    return requirements.model_copy(update=found)


def _checked(name: str, option: str, value: object) -> Requirements:
    """What one option asks for alone."""
    try:
        return Requirements.model_validate({name: value})
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        raise ArgoError(f"--{name} {option}: {message_of(fault, ())}") from None


def _sequence(option: str) -> tuple[What, ...]:
    parts = [part.strip().removeprefix("#") for part in option.split(",")]
    if len(parts) < 2 or not all(parts):
        raise ArgoError(f'--before {option}: name at least two, such as --before "8, 4"')
    return tuple(int(part) if part.isdecimal() else part for part in parts)
