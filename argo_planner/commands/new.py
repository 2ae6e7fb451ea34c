"""`argo new`: write a commented skeleton of a file."""

import os
from pathlib import Path
from typing import Annotated

import typer

from argo_planner.terminal.completion import offer_sites
from argo_planner.terminal.files import check_outputs, print_written, write_content
from argo_planner.terminal.options import Force
from argo_planner.use_cases.skeletons import (
    SkeletonKind,
    fill_skeleton,
    site_values,
    skeleton_file_name,
)

_NEXT = {
    SkeletonKind.MISSION: "argo check {file} --site {site}; argo run {file} --site {site}",
    SkeletonKind.SITE: "argo sites {file}; argo new mission NAME --site {file}",
    SkeletonKind.EVALUATION: "argo evaluate {file}",
    SkeletonKind.FAULTS: "argo run MISSION --faults {file} --site {site}",
}
"""commands for the written file, by its kind"""


def new_command(
    kind: Annotated[SkeletonKind, typer.Argument(help="kind of the file")],
    name: Annotated[str, typer.Argument(help="name of the file, without its ending")],
    site: Annotated[
        str,
        typer.Option(
            help="site of a mission, evaluation or faults: its name, or the path of its .yaml",
            autocompletion=offer_sites,
        ),
    ] = "umad",
    mission: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="mission of an evaluation, relative to it; default: NAME.txt"
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Write a commented skeleton of a mission, a site, an evaluation or a file of faults."""
    file = Path(skeleton_file_name(kind, name))
    check_outputs([site], [file], force=force)
    if kind is SkeletonKind.SITE:
        from argo_planner.use_cases.sites import require_free_name

        require_free_name(name)
        values = {}
    else:
        from argo_env.planning.opening import open_site

        values = site_values(site, open_site(site).catalog)
    values["mission"] = mission or f"{name}.txt"
    write_content(file, fill_skeleton(kind, name, values))
    print_written(file, f"skeleton; next: {_NEXT[kind].format(file=file, site=site)}")
    if kind is SkeletonKind.EVALUATION and not os.path.exists(values["mission"]):
        print(f"{values['mission']} does not exist yet: argo new mission {name} --site {site}")
