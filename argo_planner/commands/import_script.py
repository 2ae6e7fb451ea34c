"""`argo import`: convert a script, bag or isar mission to a mission."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import Invalid
from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.files.mission_file import decode_mission, mission_text
from argo_env.planning.opening import open_site
from argo_planner.terminal.draft_decisions import ActOptions, Deciding
from argo_planner.terminal.files import (
    STANDARD_OUTPUT,
    check_outputs,
    print_written,
    read_upload,
    require_mission_output,
    write_content,
)
from argo_planner.terminal.importing import import_and_warn, show_explanation
from argo_planner.terminal.options import (
    EndArea,
    Force,
    SiteOption,
    StartArea,
    Strict,
    read_duration,
)
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.use_cases.assisting import Assistant
from argo_planner.use_cases.importing import SourceKind, guess_source_kind

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


Interactive = Annotated[
    bool,
    typer.Option("--interactive", help="ask about each line that is left, one key a line"),
]

AssistantAddress = Annotated[
    str | None,
    typer.Option(
        "--assistant",
        metavar="COMMAND|URL",
        help="let it suggest sentences for open lines; the script is sent to it",
    ),
]
AssistantModel = Annotated[
    str | None, typer.Option("--assistant-model", metavar="NAME", help="model of an endpoint")
]
AssistantTimeout = Annotated[
    float | None,
    typer.Option(
        "--assistant-timeout",
        metavar="DURATION",
        parser=read_duration(least=0.1),
        help="how long it may take; 2 min if not given",
    ),
]
KEY_VARIABLE = "ARGO_ASSISTANT_KEY"
"""environment variable of an endpoint's key"""


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
    interactive: Interactive = False,
    assistant: AssistantAddress = None,
    assistant_model: AssistantModel = None,
    assistant_timeout: AssistantTimeout = None,
    strict: Strict = False,
    force: Force = False,
) -> None:
    """Read a script, a ROS bag or an isar mission, and write the mission as JSON."""
    helper = _assistant(assistant, assistant_model, assistant_timeout)
    if interactive:
        from argo_planner.terminal.draft_dialogue import ask_about_lines, require_terminal

        require_terminal(output)
    upload = read_upload(script)
    kind = guess_source_kind(upload)
    if kind is SourceKind.MISSION and isinstance(upload.content, bytes):
        decode_mission(upload.content, upload.name)  # raises the errors of a broken mission
        raise Invalid(
            f"{script} is a mission already: use it with `argo run` or `argo compile` as it is"
        )
    options = ActOptions(confirm or [], set_aside or [], say or [], choose or [], undo or [])
    if kind is not SourceKind.SCRIPT and (options.given or interactive or helper):
        raise Invalid(f"{script} is no script, so it has no lines to decide on")
    check_outputs([script, site], [output], force=force)
    if output != STANDARD_OUTPUT:
        require_mission_output(output)
    opened = open_site(site)
    if kind is SourceKind.SCRIPT:
        deciding = Deciding(script, upload, opened, (start_area, end_area))
        if options.given:
            deciding.act(options)
        if helper is not None:
            deciding.ask(helper)
            deciding.keep()
        if interactive:
            ask_about_lines(deciding)
        deciding.keep()
        upload = replace(upload, draft=deciding.draft)
    imported = import_and_warn(upload, opened, start_area, end_area)
    if strict and any(d.severity is Severity.WARNING for d in imported.warnings):
        raise typer.Exit(1)
    write_content(output, mission_text(imported.mission))
    print_written(output, ", ".join(task.name for task in imported.mission.tasks))
    if output != STANDARD_OUTPUT and not is_quiet():
        show_explanation(imported, opened)


def _assistant(address: str | None, model: str | None, timeout_s: float | None) -> Assistant | None:
    """Return the assistant that options ask for; None: none.

    Raises:
        Invalid: There are options of one that is not given, or its URL is none.
    """
    if address is None:
        if model is not None or timeout_s is not None:
            raise Invalid("--assistant-model and --assistant-timeout need --assistant")
        return None
    found = Assistant(address, model, os.environ.get(KEY_VARIABLE))
    if model is not None and not found.is_endpoint:
        raise Invalid(f"--assistant-model is for endpoints, and `{address}` is a command")
    if not found.place.strip():
        raise Invalid("--assistant: name a command or the URL of an endpoint")
    return found if timeout_s is None else replace(found, timeout_s=timeout_s)
