"""`argo sites`: list the sites, or check one of them."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import ArgoError, Invalid, with_message_prefix
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.terminal import completion
from argo_planner.terminal.files import check_outputs, print_written, write_content
from argo_planner.terminal.options import Force
from argo_planner.use_cases.sites import (
    draw_site_report_png,
    list_shipped_sites,
    make_site_report,
    require_free_name,
    site_yaml_with_name,
)


def sites_command(
    site: Annotated[
        str | None,
        typer.Argument(
            metavar="SITE",
            help="site to check: its name, the path of its .yaml, or generated:…",
            autocompletion=completion.offer_sites,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="file for the site's description (.yaml)"),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", help="file for a picture of the floors with the errors (.png)"),
    ] = None,
    force: Force = False,
) -> None:
    """List the sites, or check one; exits with status 2 if parts can't be reached."""
    if site is None:
        if output or picture:
            raise Invalid("-o and --picture need a site: name one")
        for one in list_shipped_sites():
            print(f"{one.name}: {one.title}, floors: {one.floors}, checkpoints: {one.checkpoints}")
        return
    if output:
        _check_name(output)
    if picture and picture.suffix.lower() != ".png":
        raise Invalid(f"{picture}: the picture is a PNG: choose a name that ends in .png")
    check_outputs([site], [output, picture], force=force)
    opened = open_site(site)
    if output:
        _write_description(opened, output)
    report = make_site_report(opened)
    if picture:
        write_content(picture, draw_site_report_png(opened, report))
        print_written(picture, "picture of the site's floors")
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
    """Raise ArgoError if the file could not be used as a site.

    That is the case if its name has another suffix or stands for another site.
    """
    if output.suffix not in {".yaml", ".yml"}:
        raise Invalid(
            f"{output}: a site needs a file that ends in .yaml or .yml: choose such a name"
        )
    try:
        require_free_name(str(output))
        require_free_name(output.stem)
    except ArgoError as error:
        raise with_message_prefix(error, str(output)) from None


def _write_description(opened: OpenedSite, output: Path) -> None:
    write_content(output, site_yaml_with_name(opened, output.stem))
    use = f"argo check MISSION --site {shlex.quote(str(output))}"
    print(f"{output}: written, site `{output.stem}`; use it with `{use}`")
