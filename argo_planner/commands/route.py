"""`argo route`: suggest the best order of a mission's tasks, with its proof."""

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError
from rich.console import Console

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.extensions import installed_names
from argo_compiler.base.stages import stage
from argo_compiler.files.loading import read_bytes
from argo_compiler.files.mission_file import write_mission
from argo_compiler.reorder.requirements import MissionPart, Requirements
from argo_compiler.route.robust_spread import CAUTIOUS, SIMULATED
from argo_env.files.folders import make_folder
from argo_env.files.yaml_messages import error_message
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.terminal.certificate_lines import show_certificate
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.files import check_outputs, read_upload, require_mission_output
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import (
    EndArea,
    Force,
    SiteOption,
    Source,
    StartArea,
    read_duration,
)
from argo_planner.terminal.order_tables import reordered_mission_lines, show_order, show_risk
from argo_planner.terminal.words import error_text, insert_keep_order_option
from argo_planner.use_cases.importing import SourceKind, guess_source_kind, require_no_areas
from argo_planner.use_cases.no_order import require_order
from argo_planner.use_cases.routing import (
    MAX_BYTES,
    TIME_LIMIT,
    SuggestedOrder,
    certify_order,
    parse_requirements,
    require_any_time_limit,
    suggest_order,
    suggest_robust_order,
)


class Spread(StrEnum):
    """Distribution of the travel times."""

    SIMULATED = "simulated"
    """as measured in simulation"""
    CAUTIOUS = "cautious"
    """as assumed for a real site with people"""


SPREADS = {Spread.SIMULATED: SIMULATED, Spread.CAUTIOUS: CAUTIOUS}


def route_command(
    source: Source,
    site: SiteOption = "umad",
    budget: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="longest duration, such as 20min; tasks that do not fit are left out",
        ),
    ] = None,
    keep_order: Annotated[
        bool, typer.Option("--keep-order", help="leave tasks out if needed, but keep their order")
    ] = False,
    before: Annotated[
        list[str] | None,
        typer.Option(metavar="A,B", help='required order, such as "8, 4": 8 before 4'),
    ] = None,
    requirements: Annotated[
        Path | None,
        typer.Option(metavar="FILE.yaml", help="file with requirements; see `argo docs routes`"),
    ] = None,
    time_limit: Annotated[
        float,
        typer.Option(
            parser=read_duration(least=0.01),
            metavar="TIME",
            help="longest time of the search, such as 10s or 2min; a number is in s",
        ),
    ] = TIME_LIMIT,
    seed: Annotated[int, typer.Option(help="seed of the search", min=0)] = 0,
    solver: Annotated[
        list[str] | None,
        typer.Option(
            help="solver of an installed package, which takes part besides Argo's own; "
            "can be given several times; `argo doctor` lists them",
            autocompletion=offer_names(partial(installed_names, "argo.solvers")),
        ),
    ] = None,
    risk: Annotated[
        Spread | None,
        typer.Option(
            help="show the probability of being in time if times vary as simulated, or more"
        ),
    ] = None,
    robust: Annotated[
        bool, typer.Option("--robust", help="suggest the order that is most probably in time")
    ] = False,
    verify: Annotated[
        bool, typer.Option("--verify", help="check the result with code independent of the search")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="file for the mission in the new order (.json)"),
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for a picture of each floor")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Suggest the best order of a mission's tasks; exits with status 2 if there is none."""
    check_outputs([source, site, requirements], [output], [(pictures, ())], force)
    if output:
        require_mission_output(output)
    wanted = add_options(_read(requirements), budget, keep_order, before or [])
    upload = read_upload(source)
    if guess_source_kind(upload) is not SourceKind.SCRIPT:
        require_no_areas(upload.name, start_area, end_area)
    opened = open_site(site)
    if pictures:
        _check_pictures(pictures, opened, force)
    imported = import_and_warn(upload, opened, start_area, end_area)
    if robust:
        require_any_time_limit(imported.mission, wanted)
    found = suggest_order(
        imported, opened, wanted, time_limit=time_limit, seed=seed, solvers=solver or ()
    )
    console = Console(highlight=False)
    spread = SPREADS[risk or Spread.CAUTIOUS]
    _require_order(source, found, console, verify)
    if robust:
        found = suggest_robust_order(found, spread, time_limit, seed)
        _require_order(source, found, console, verify)
    # Before any output, since not every order can be written.
    reordered = found.mission if output else None
    show_order(found, console)
    if verify:
        _verify(found, console)
    if robust or risk:
        show_risk(found, spread, seed, console)
    if output and reordered:
        write_mission(reordered, output)
        for line in reordered_mission_lines(found, reordered, opened, output):
            console.print(line, soft_wrap=True, markup=False)
    if pictures:
        _draw(found, opened, pictures, console)


def _read(requirements: Path | None) -> Requirements:
    if requirements is None:
        return Requirements()
    content = read_bytes(requirements, "file of requirements", MAX_BYTES)
    return parse_requirements(content, str(requirements))


def _check_pictures(folder: Path, site: OpenedSite, force: bool) -> None:
    """Raise ArgoError if pictures of floors can't be written or, without `force`, replace files."""
    from argo_env.pictures.route import possible_picture_names

    check_outputs([], folders=[(folder, possible_picture_names(site.site))], force=force)


def _draw(found: SuggestedOrder, site: OpenedSite, folder: Path, console: Console) -> None:
    from argo_env.pictures.route import write_route

    make_folder(folder)
    with stage("drawing the order"):
        paths = write_route(found.planned, found.route, site.navigator, found.travel, folder)
    for path in paths:
        console.print(f"Picture: {path}", soft_wrap=True, markup=False)


def _verify(found: SuggestedOrder, console: Console) -> None:
    certificate = certify_order(found)
    show_certificate(found, certificate, console)
    if certificate.refuted:
        raise typer.Exit(1)


def _require_order(source: Path, found: SuggestedOrder, console: Console, verify: bool) -> None:
    try:
        require_order(found, str(source))
    except Conflict as error:
        console.print(insert_keep_order_option(error_text(error)), soft_wrap=True, markup=False)
        if verify:
            _verify(found, console)
        raise typer.Exit(2) from None


def add_options(
    requirements: Requirements, budget: str | None, keep_order: bool, before: list[str]
) -> Requirements:
    """Return a copy of the requirements with those of the command line's options added.

    Args:
        requirements: requirements of the file
        budget: value of `--budget`, which replaces the file's; None: not given
        keep_order: whether `--keep-order` is given
        before: values of `--before`, such as `8, 4`

    Raises:
        Invalid: An option has a wrong value.
    """
    found: dict[str, object] = {"keep_order": keep_order or requirements.keep_order}
    if budget is not None:
        found["budget"] = _validate_option("budget", budget, budget).budget
    added = [_validate_option("before", one, (_sequence(one),)).before for one in before]
    found["before"] = sum(added, requirements.before)
    return requirements.model_copy(update=found)


def _validate_option(name: str, option: str, value: object) -> Requirements:
    """Return requirements with `value` in the field `name`; raise Invalid if it is wrong.

    `option` is the text that was given for the option, for the message.
    """
    try:
        return Requirements.model_validate({name: value})
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        raise Invalid(f"--{name} {option}: {error_message(fault, ())}") from None


def _sequence(option: str) -> tuple[MissionPart, ...]:
    parts = [part.strip().removeprefix("#") for part in option.split(",")]
    if len(parts) < 2 or not all(parts):
        raise Invalid(f'--before {option}: name at least two, such as --before "8, 4"')
    return tuple(int(part) if part.isdecimal() else part for part in parts)
