"""`argo import`: a mission script becomes a mission."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import Invalid
from argo_compiler.files.mission_file import decode_mission, mission_text
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import (
    STANDARD_OUTPUT,
    check_outputs,
    print_written,
    read_upload,
    require_mission_output,
    write_content,
)
from argo_planner.terminal.importing import import_and_warn, show_explanation
from argo_planner.terminal.options import EndArea, Force, SiteOption, StartArea
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.use_cases.importing import SourceKind, kind_of


def import_script(
    script: Annotated[
        Path, typer.Argument(metavar="SCRIPT", help="a sheet, a protocol, a bag or isar's .json")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="the mission's .json to write")],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Read a script, a ROS bag or an isar mission, and write the mission as JSON."""
    upload = read_upload(script)
    if kind_of(upload) is SourceKind.MISSION and isinstance(upload.content, bytes):
        decode_mission(upload.content, upload.name)  # says what is wrong with a broken one
        raise Invalid(f"{script} is a mission already: `argo run` and `argo compile` take it")
    check_outputs([script, site], [output], force=force)
    if output != STANDARD_OUTPUT:
        require_mission_output(output)
    opened = open_site(site)
    imported = import_and_warn(upload, opened, start_area, end_area)
    write_content(output, mission_text(imported.mission))
    print_written(output, ", ".join(task.name for task in imported.mission.tasks))
    if output != STANDARD_OUTPUT and not is_quiet():
        show_explanation(imported, opened)
