"""`argo import`: convert a script, bag or isar mission to a mission."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import Invalid
from argo_compiler.files.mission_file import decode_mission, mission_text
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.terminal.draft_decisions import DraftActs, decide
from argo_planner.terminal.draft_display import draft_path
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
from argo_planner.use_cases.importing import SourceKind, Upload, guess_source_kind

_LINES = "numbers such as 3,7-9, or `all`"
Confirm = Annotated[
    list[str] | None,
    typer.Option("--confirm", metavar="LINES", help=f"accept what is proposed: {_LINES}"),
]
SetAside = Annotated[
    list[str] | None,
    typer.Option("--set-aside", metavar="LINES", help="let these lines have no effect"),
]
Say = Annotated[
    list[str] | None,
    typer.Option("--say", metavar="LINE TEXT", help="say a line in other words"),
]
Choose = Annotated[
    list[str] | None,
    typer.Option("--choose", metavar="LINE=N", help="take a choice of an open line"),
]
Undo = Annotated[
    list[str] | None,
    typer.Option("--undo", metavar="LINES", help="forget what was decided on lines"),
]


def import_command(
    script: Annotated[
        Path,
        typer.Argument(metavar="SCRIPT", help="script or document, ROS bag, isar mission (.json)"),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="file for the mission (.json)")],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
    confirm: Confirm = None,
    set_aside: SetAside = None,
    say: Say = None,
    choose: Choose = None,
    undo: Undo = None,
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
    if guess_source_kind(upload) is SourceKind.SCRIPT:
        acts = DraftActs(confirm or [], set_aside or [], say or [], choose or [], undo or [])
        upload = _with_decisions(upload, script, output, opened, (start_area, end_area), acts)
    imported = import_and_warn(upload, opened, start_area, end_area)
    write_content(output, mission_text(imported.mission))
    print_written(output, ", ".join(task.name for task in imported.mission.tasks))
    if output != STANDARD_OUTPUT and not is_quiet():
        show_explanation(imported, opened)


def _with_decisions(
    upload: Upload,
    script: Path,
    output: Path,
    site: OpenedSite,
    areas: tuple[int | None, int | None],
    acts: DraftActs,
) -> Upload:
    """Return the upload with what is decided on, and keep that in the script's draft."""
    draft, decisions = decide(upload, site, areas, acts)
    beside = script if script != STANDARD_OUTPUT else output
    if beside != STANDARD_OUTPUT and (draft.left or decisions or upload.decisions):
        from argo_compiler.script import draft_text

        write_content(draft_path(beside), draft_text(draft))
    return replace(upload, decisions=decisions, draft=draft)
