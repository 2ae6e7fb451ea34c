"""The command `argo`: its name, its version, and the commands that it has."""

import errno
import gc
import sys
from typing import Annotated

import typer

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.garbage_collector import collect_again
from argo_compiler.base.version import __version__
from argo_planner.lazy_group import LazyCommand, LazyGroup
from argo_planner.terminal.output import guard_output
from argo_planner.terminal.signals import SignalWatch, ignore_signals, raise_interrupted
from argo_planner.terminal.verbosity import set_verbosity

_COMMANDS = {
    "import": (
        "import_script.import_script",
        "Read a mission script, a bag or an isar mission, and write the mission as JSON.",
    ),
    "check": (
        "check.check_mission",
        "Say all that is wrong or odd about a mission; exits with status 2 if there are errors.",
    ),
    "explain": (
        "explain.explain_mission",
        "Say back in plain sentences what was understood of a mission, and what was assumed.",
    ),
    "compile": (
        "compile.compile_mission",
        "Lower a mission to its state machine and write it as JSON.",
    ),
    "format": (
        "format.format_mission",
        "Write a mission as a script, in one canonical form; importing that gives the same "
        "mission.",
    ),
    "export": (
        "export.export_mission",
        "Write a mission in the format of another tool.",
    ),
    "route": (
        "route.suggest_order",
        "Suggest the best order of a mission's tasks; exits with status 2 if there is none.",
    ),
    "run": (
        "run.run",
        "Run a mission, or the spec of a run, show what was measured, and write a report.",
    ),
    "resume": (
        "resume.resume_run",
        "Go on with a run whose process has died, from its journal.",
    ),
    "replay": (
        "replay.replay",
        "Show what was recorded of a run, and make its report and its film again.",
    ),
    "evaluate": (
        "evaluate.evaluate",
        "Run missions many times: how sure they work, what breaks them, which is better.",
    ),
    "sites": (
        "sites.show_sites",
        "List the sites, or check one; exits with status 2 if it can't be driven.",
    ),
    "plan": (
        "plan.plan_mission",
        "Plan a mission in the browser, on a 3D model of the site, and watch it run.",
    ),
    "serve": (
        "serve.serve_plans",
        "Serve the missions of a folder to many people at once.",
    ),
    "schema": (
        "schema.show_schema",
        "Print the JSON Schema of a mission, a machine, its progress, faults or a reading.",
    ),
    "doctor": (
        "doctor.show_health",
        "Show the version, the cache on disk, and which optional parts are installed.",
    ),
}
"""by their names: the module and the function of each, and the line that lists it"""
_SHORT = {"import", "check", "explain", "compile", "format", "export"}
"""commands that read a mission, and end"""


class ArgoCommands(LazyGroup):
    """The commands in the order in which `argo --help` lists them."""

    lazy_commands = tuple(
        LazyCommand(name, f"argo_planner.commands.{module}", function, help)
        for name, (place, help) in _COMMANDS.items()
        for module, function in [place.split(".")]
    )


app = typer.Typer(
    name="argo",
    cls=ArgoCommands,
    help="Turns a written inspection mission into a checked plan and drives it through a site.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"argo {__version__}")
        raise typer.Exit


@app.callback()
def argo(
    context: typer.Context,
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="show Argo's version"
        ),
    ] = False,
    verbose: Annotated[
        int,
        typer.Option(
            "-v",
            "--verbose",
            count=True,
            show_default=False,
            help="say what is done; -vv: in detail",
        ),
    ] = 0,
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="show results and errors only")
    ] = False,
) -> None:
    """Turns a written inspection mission into a checked plan and drives it through a site."""
    from argo_planner.terminal.stage_display import stages_shown  # `argo --help` has no stages

    collect_again(seldom=context.invoked_subcommand in _SHORT)
    set_verbosity(verbose, quiet)
    context.with_resource(stages_shown())


def main() -> None:
    """The entry point: what goes wrong is said in one message, with exit status 2."""
    output = guard_output()
    try:
        status = _carry_out()
        if output.failure is not None and status in {0, 1, 2}:
            status = _without_output(output.failure, status)
        raise SystemExit(status)
    finally:
        gc.freeze()  # the process ends: all goes, and needs no search for what can go


def _carry_out() -> int:
    """Carry out what the command line asks for. Return the exit status."""
    raised = SignalWatch()
    try:
        try:
            raise_interrupted(raised)
            app(prog_name="argo")
        finally:
            ignore_signals()
            sys.stdout.flush()
    except BaseException as error:
        ignore_signals()  # the first one may have come before they were ignored
        told = isinstance(error, SystemExit) and error.code not in {None, 0}
        if raised.came is not None and not told:  # whatever has been made of it
            print("argo: interrupted", file=sys.stderr)
            return raised.came.status
        return _status(error)
    return 0


def _status(error: BaseException) -> int:
    """What went wrong is said; raised again if it is a defect of Argo."""
    if isinstance(error, SystemExit) and isinstance(error.code, int):
        return error.code
    if isinstance(error, ArgoError):
        from argo_planner.terminal.words import said

        print(said(error, "argo: "), file=sys.stderr)
        return 2
    raise error


def _without_output(failure: OSError, status: int) -> int:
    """The exit status of a command whose output nobody has got; else it would be that `status`."""
    if failure.errno == errno.EPIPE:  # its reader has gone, and knows
        return 2 if status == 2 else 141
    print(f"argo: the output can't be written: {failure.strerror}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    main()
