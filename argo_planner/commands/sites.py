"""`argo sites`: which sites there are, and whether one can be driven."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import ArgoError, Invalid, located
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.terminal import completion
from argo_planner.terminal.files import check_outputs, print_written, write_content
from argo_planner.terminal.options import Force
from argo_planner.use_cases.sites import (
    check_site,
    describe_site,
    draw_report,
    list_sites,
    require_free_name,
)


def show_sites(
    site: Annotated[
        str | None,
        typer.Argument(
            metavar="SITE",
            help="a site to check: its name, its .yaml, or generated:…",
            autocompletion=completion.offer_sites,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="a .yaml to write the site's description to"),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="a .png of the floors, with the places of errors"),
    ] = None,
    force: Force = False,
) -> None:
    """List the sites, or check one; exits with status 2 if parts can't be reached."""
    if site is None:
        if output or picture:
            raise Invalid("a description or a picture is of one site: say which")
        for one in list_sites():
            print(f"{one.name}: {one.title}, floors: {one.floors}, checkpoints: {one.checkpoints}")
        return
    if output:
        _check_name(output)
    if picture and picture.suffix.lower() != ".png":
        raise Invalid(f"{picture}: a site is drawn as a .png; name it so")
    check_outputs([site], [output, picture], force=force)
    opened = open_site(site)
    if output:
        _write(opened, output)
    report = check_site(opened)
    if picture:
        write_content(picture, draw_report(opened, report))
        print_written(picture, "written, the site's floors")
    for note in report.notes:
        print(f"{site}: note: {note}")
    for error in report.errors:
        print(f"{site}: error: {error}")
    if report.errors:
        if not picture:
            print(f"to see where: argo sites {shlex.quote(site)} --picture FILE.png")
        raise typer.Exit(2)
    print(f"{site}: every floor and every checkpoint can be reached from every dock, and back")


def _check_name(output: Path) -> None:
    """Raises ArgoError if no site is found in a file of that name, or another one is by the name
    that it gets."""
    if output.suffix not in {".yaml", ".yml"}:
        raise Invalid(f"{output}: a site is found in a file that ends in .yaml or .yml; name it so")
    try:
        require_free_name(str(output))
        require_free_name(output.stem)
    except ArgoError as error:
        raise located(error, str(output)) from None


def _write(opened: OpenedSite, output: Path) -> None:
    write_content(output, describe_site(opened, output.stem))
    use = f"argo check MISSION --site {shlex.quote(str(output))}"
    print(f"{output}: written, site `{output.stem}`; use it with `{use}`")
