"""`argo import`: convert a script, bag or isar mission to a mission."""

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
from argo_planner.use_cases.importing import SourceKind, guess_source_kind


def import_command(
    script: Annotated[
        Path, typer.Argument(metavar="SCRIPT", help="script, ROS bag or isar mission (.json)")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="file for the mission (.json)")],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
    force: Force = False,
) -> None:
    """Read a script, a ROS bag or an isar mission, and write the mission as JSON."""
    upload = read_upload(script)
    if guess_source_kind(upload) is SourceKind.MISSION and isinstance(upload.content, bytes):
        decode_mission(upload.content, upload.name)  # raises the errors of a broken mission
        raise Invalid(
            f"{script} is a mission already: use it with `argo run` or `argo compile` as it is"
        )
    check_outputs([script, site], [output], force=force)
    if output != STANDARD_OUTPUT:
        require_mission_output(output)
    opened = open_site(site)
    imported = import_and_warn(upload, opened, start_area, end_area)
    write_content(output, mission_text(imported.mission))
    print_written(output, ", ".join(task.name for task in imported.mission.tasks))
    if output != STANDARD_OUTPUT and not is_quiet():
        show_explanation(imported, opened)
