"""The command `argo`: its name, its version, and the commands that it has."""

import sys
from typing import Annotated

import typer

from argo_compiler import __version__
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.errors import ArgoError
from argo_planner.commands.check import check_mission
from argo_planner.commands.compile import compile_mission
from argo_planner.commands.export import export_mission
from argo_planner.commands.format import format_mission
from argo_planner.commands.import_script import import_script
from argo_planner.commands.replay import replay
from argo_planner.commands.resume import resume_run
from argo_planner.commands.route import suggest_order
from argo_planner.commands.run import run
from argo_planner.commands.schema import show_schema
from argo_planner.commands.sites import show_sites

app = typer.Typer(
    name="argo",
    help="Turns a written inspection mission into a checked plan and drives it through a site.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

# In the order in which `argo --help` lists them.
app.command("import")(import_script)
app.command("check")(check_mission)
app.command("compile")(compile_mission)
app.command("format")(format_mission)
app.command("export")(export_mission)
app.command("route")(suggest_order)
app.command("run")(run)
app.command("resume")(resume_run)
app.command("replay")(replay)
app.command("sites")(show_sites)
app.command("schema")(show_schema)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"argo {__version__}")
        raise typer.Exit


@app.callback()
def argo(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="show Argo's version"
        ),
    ] = False,
) -> None:
    """Turns a written inspection mission into a checked plan and drives it through a site."""


def main() -> None:
    """The entry point: what goes wrong is said in one message, with exit status 2."""
    try:
        app()
    except DiagnosticError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None
    except ArgoError as error:
        print(f"argo: {error}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
