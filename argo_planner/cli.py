"""The command `argo`: its subcommands, its own options, and its exit status."""

import errno
import gc
import logging
import sys
from typing import Annotated

import typer

from argo_compiler.base.errors import INCOMPLETE, ArgoError
from argo_compiler.base.garbage_collector import enable_garbage_collector
from argo_compiler.base.version import __version__
from argo_planner.lazy_group import LazyCommand, LazyGroup
from argo_planner.terminal.language import VARIABLE, MessageLanguage, set_language
from argo_planner.terminal.output import EXIT_INCOMPLETE, guard_stdout_and_stderr
from argo_planner.terminal.signals import SignalWatch, ignore_signals, raise_on_signals
from argo_planner.terminal.verbosity import set_verbosity

_log = logging.getLogger(__name__)

_COMMANDS = {
    "import": (
        "import_script.import_command",
        "Read a script, a ROS bag or an isar mission, and write the mission as JSON.",
    ),
    "check": (
        "check.check_command",
        "Check a mission without running it; exits with status 2 if there are errors.",
    ),
    "explain": (
        "explain.explain_command",
        "Print in plain sentences how Argo understood a mission, and what it assumed.",
    ),
    "compile": (
        "compile.compile_command",
        "Convert a mission to its state machine, and write that as JSON.",
    ),
    "format": (
        "format.format_command",
        "Write a mission as a script in a standard form; importing it gives the same mission.",
    ),
    "export": (
        "export.export_command",
        "Write a mission in the format of another tool.",
    ),
    "route": (
        "route.route_command",
        "Suggest the best order of a mission's tasks; exits with status 2 if there is none.",
    ),
    "run": (
        "run.run_command",
        "Run a mission, or the spec of an earlier run, in simulation, and show the results.",
    ),
    "resume": (
        "resume.resume_command",
        "Continue an interrupted run from its journal.",
    ),
    "replay": (
        "replay.replay_command",
        "Show the results of a recorded run; its report and film can be made again.",
    ),
    "evaluate": (
        "evaluate.evaluate_command",
        "Estimate the success rate of missions by many runs, or compare two evaluations.",
    ),
    "sites": (
        "sites.sites_command",
        "List the sites, or check one; exits with status 2 if parts can't be reached.",
    ),
    "examples": (
        "examples.examples_command",
        "List the shipped missions, faults, evaluations and sites, or copy one of them.",
    ),
    "new": (
        "new.new_command",
        "Write a commented skeleton of a mission, a site, an evaluation or a file of faults.",
    ),
    "docs": (
        "docs.docs_command",
        "List the pages of the documentation, or print one as Markdown.",
    ),
    "plan": (
        "plan.plan_command",
        "Plan a mission in the browser, on a 3D model of the site, and watch it run.",
    ),
    "serve": (
        "serve.serve_command",
        "Serve the planner page with a folder of missions to several people at once.",
    ),
    "schema": (
        "schema.schema_command",
        "Print the JSON Schema of one kind of file, such as missions or faults.",
    ),
    "doctor": (
        "doctor.doctor_command",
        "Show Argo's version, its cache on disk, its optional parts, and what extends it.",
    ),
}
"""commands by name: module and function of each, and its line in `argo --help`"""
_SHORT = {"import", "check", "explain", "compile", "format", "export"}
"""commands that end soon: they read a mission and run nothing"""


class ArgoCommands(LazyGroup):
    """The commands of `argo`, in the order in which `argo --help` lists them."""

    lazy_commands = tuple(
        LazyCommand(name, f"argo_planner.commands.{module}", function, help)
        for name, (path, help) in _COMMANDS.items()
        for module, function in [path.split(".")]
    )


app = typer.Typer(
    name="argo",
    cls=ArgoCommands,
    help="Turn a written inspection mission into a checked plan and drive it through a site.",
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
            help="show what is being done; -vv: in detail",
        ),
    ] = 0,
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="show results and errors only")
    ] = False,
    language: Annotated[
        MessageLanguage | None,
        typer.Option(help="language of errors and diagnostics", envvar=VARIABLE, show_envvar=True),
    ] = None,
) -> None:
    """Turn a written inspection mission into a checked plan and drive it through a site."""
    from argo_planner.terminal.stage_display import show_stages  # `argo --help` needs no stages

    enable_garbage_collector(seldom=context.invoked_subcommand in _SHORT)
    set_verbosity(verbose, quiet)
    set_language(language)
    context.with_resource(show_stages())


def main() -> None:
    """Run the command; an ArgoError becomes one message and exit status 2, or 3 for a draft."""
    output = guard_stdout_and_stderr()
    try:
        status = _carry_out()
        if output.failure is not None and status in {0, 1, 2, EXIT_INCOMPLETE}:
            status = _status_without_output(output.failure, status)
        raise SystemExit(status)
    finally:
        gc.freeze()  # the process ends and frees all memory: nothing needs to be collected


def _carry_out() -> int:
    """Run what the command line asks for, and return the exit status."""
    raised = SignalWatch()
    try:
        try:
            raise_on_signals(raised)
            app(prog_name="argo")
        finally:
            ignore_signals()
            sys.stdout.flush()
    except BaseException as error:
        ignore_signals()  # the first one may have come before they were ignored
        reported = isinstance(error, SystemExit) and error.code not in {None, 0}
        if raised.received is not None and not reported:  # a library may have raised another error
            print("argo: interrupted", file=sys.stderr)
            return raised.received.status
        return _report_error(error)
    return 0


def _report_error(error: BaseException) -> int:
    """Print an ArgoError and return the exit status; raise other errors again."""
    if isinstance(error, SystemExit) and isinstance(error.code, int):
        return error.code
    if isinstance(error, ArgoError) and error.code == INCOMPLETE:
        from argo_planner.terminal.draft_display import incomplete_text

        print(incomplete_text(error), file=sys.stderr)  # type: ignore[arg-type]
        return EXIT_INCOMPLETE
    if isinstance(error, ArgoError):
        from argo_planner.terminal.words import error_text

        print(error_text(error, "argo: "), file=sys.stderr)
        return 2
    from argo_compiler.base.extensions import package_failure

    if isinstance(error, Exception) and (failure := package_failure(error)) is not None:
        _log.debug("%s", failure, exc_info=error)
        print(f"argo: {failure}; see more with argo -vv", file=sys.stderr)
        return 2
    raise error


def _status_without_output(failure: OSError, status: int) -> int:
    """Return the exit status of a command whose output could not be written.

    Args:
        failure: why the output could not be written
        status: the exit status that the command has without this failure

    Returns:
        141 if the reader has closed the pipe and `status` is less than 2; 2 or 3 if it is that.
    """
    if failure.errno == errno.EPIPE:  # the reader has closed the pipe, so needs no message
        return status if status >= 2 else 141
    print(f"argo: the output can't be written: {failure.strerror}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    main()
