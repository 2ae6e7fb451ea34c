"""The command `argo`: import a script, compile a mission, run it and report."""

import sys
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from argo_compiler.check import check
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.errors import ArgoError
from argo_compiler.files import read_mission, write_mission
from argo_compiler.hfsm import lower, to_mermaid
from argo_compiler.il import Mission, Task
from argo_compiler.script import Resolved, import_script, read_script
from argo_env.catalog import make_catalog
from argo_env.navigation import Navigator
from argo_env.pictures import check_film, write_film, write_overview
from argo_env.report import write_report
from argo_env.robot.spec import load_robot
from argo_env.session import simulate
from argo_env.site import load_site
from argo_planner.summary import show_record

app = typer.Typer(
    name="argo",
    help="Turns a written inspection mission into a checked plan and drives it through a site.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

Source = Annotated[
    Path, typer.Argument(metavar="SCRIPT|MISSION", help="a mission script, or a mission's .json")
]
SiteOption = Annotated[str, typer.Option("--site", help="a site's name, or a path to its .yaml")]
StartArea = Annotated[
    int | None, typer.Option("--start-area", help="the starting area, where the script leaves it")
]
EndArea = Annotated[
    int | None, typer.Option("--end-area", help="the area to end in, where the script leaves it")
]


@app.command("import")
def import_command(
    script: Annotated[Path, typer.Argument(metavar="SCRIPT", help="a mission sheet or protocol")],
    output: Annotated[Path, typer.Option("-o", "--output", help="the mission's .json to write")],
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Read a mission script and write the mission as JSON."""
    if script.suffix.lower() == ".json":
        raise ArgoError(f"{script} is no script: `argo run` and `argo compile` take missions")
    _keep_input(script, output)
    resolved = _import(script, _navigator(site), start_area, end_area)
    write_mission(resolved.mission, output)
    names = ", ".join(task.name for task in resolved.mission.tasks)
    _console().print(f"{escape(str(output))}: {escape(names)}", soft_wrap=True)


@app.command("compile")
def compile_command(
    source: Source,
    output: Annotated[Path, typer.Option("-o", "--output", help="the machine's .json to write")],
    mermaid: Annotated[
        Path | None, typer.Option("--mermaid", help="a Mermaid diagram to write as well")
    ] = None,
    site: SiteOption = "umad",
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Lower a mission to its state machine and write it as JSON."""
    _keep_input(source, output)
    mission = _mission(source, site, start_area, end_area)
    machine = lower(mission, str(source))
    _write(output, machine.model_dump_json(indent=2) + "\n")
    if mermaid:
        _write(mermaid, to_mermaid(machine))
    groups = len(machine.composites) - 1
    _console().print(
        f"{escape(str(output))}: {len(machine.leaves)} tasks, {groups} groups", soft_wrap=True
    )


@app.command()
def run(
    source: Source,
    site: SiteOption = "umad",
    seed: Annotated[int, typer.Option(help="draws what the checkpoints show", min=0)] = 0,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="DIR", help="folder for the report")
    ] = None,
    start_area: StartArea = None,
    end_area: EndArea = None,
    value: Annotated[
        list[str] | None,
        typer.Option("--value", metavar="ID=VALUE", help="what a checkpoint shows, such as 8=4.2"),
    ] = None,
    gui: Annotated[bool, typer.Option("--gui", help="open PyBullet's window")] = False,
    pace: Annotated[
        float, typer.Option(help="with --gui: simulated seconds a second, at most", min=0.1)
    ] = 5.0,
    render: Annotated[
        Path | None, typer.Option("--render", metavar="FILE.mp4|FILE.gif", help="film the run")
    ] = None,
) -> None:
    """Run a mission on a site, show what was measured, and write a report."""
    if render:
        check_film(render)
    if report:
        _make_folder(report)
    values = _values(value or [])
    started = time.monotonic()
    navigator = _navigator(site)
    mission, diagnostics = _load(source, navigator, start_area, end_area)
    lower(mission, str(source))
    navigator.lattice  # noqa: B018 - built here, so that the time of loading is not the run's
    loaded = time.monotonic()
    with _progress() as progress:
        bar = progress.add_task("setting off", total=mission.max_duration)

        def observe(now: float, task: Task | None) -> None:
            progress.update(bar, completed=now, description=task.name if task else "ended")

        record = simulate(
            mission,
            navigator,
            seed=seed,
            values=values,
            diagnostics=diagnostics,
            observe=observe,
            gui=gui,
            pace=pace if gui else None,
        )
    ended = time.monotonic()
    console = Console()
    show_record(record, console)
    console.print(
        f"Loading took {loaded - started:.1f} s, the run {ended - loaded:.1f} s: "
        f"{record.result.duration / max(1e-9, ended - loaded):.0f} times real time."
    )
    if report:
        page = write_report(record, navigator.site, report)
        write_overview(record, navigator.site, navigator.robot, report / "site.png")
        console.print(f"Report: {escape(str(page))}", soft_wrap=True)
    if render:
        with _progress() as progress:
            bar = progress.add_task("filming", total=1.0)
            write_film(
                record,
                navigator.site,
                navigator.robot,
                render,
                progress=lambda share: progress.update(bar, completed=share),
            )
        console.print(f"Film: {escape(str(render))}", soft_wrap=True)
    if not record.result.success:
        raise typer.Exit(1)


def main() -> None:
    """The entry point: what goes wrong is said in one message, with exit status 2."""
    try:
        app()
    except ArgoError as error:
        print(f"argo: {error}", file=sys.stderr)
        raise SystemExit(2) from None


def _navigator(site: str) -> Navigator:
    return Navigator(load_site(site), load_robot())


def _import(
    script: Path, navigator: Navigator, start_area: int | None, end_area: int | None
) -> Resolved:
    """The script's mission; its warnings are shown."""
    text = read_script(script)
    resolved = import_script(
        text,
        make_catalog(navigator),
        source_name=str(script),
        start_area=start_area,
        end_area=end_area,
    )
    _show_warnings(str(script), resolved.diagnostics)
    return resolved


def _load(
    source: Path, navigator: Navigator, start_area: int | None, end_area: int | None
) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """The mission in a script or in a .json, and what the import had to say."""
    if source.suffix.lower() != ".json":
        resolved = _import(source, navigator, start_area, end_area)
        return resolved.mission, resolved.diagnostics
    if start_area is not None or end_area is not None:
        raise ArgoError(
            f"{source}: --start-area and --end-area belong to the import of a script; "
            "a mission has its areas already"
        )
    mission = read_mission(source)
    _require_site(mission, navigator)
    findings = check(mission, make_catalog(navigator))
    if any(f.severity is Severity.ERROR for f in findings):
        raise DiagnosticError(str(source), findings)
    _show_warnings(str(source), findings)
    return mission, ()


def _mission(source: Path, site: str, start_area: int | None, end_area: int | None) -> Mission:
    return _load(source, _navigator(site), start_area, end_area)[0]


def _require_site(mission: Mission, navigator: Navigator) -> None:
    if mission.site and mission.site != navigator.site.name:
        raise ArgoError(
            f"the mission was planned for site `{mission.site}`, not for `{navigator.site.name}`; "
            f"choose it with --site {mission.site}"
        )


def _values(options: list[str]) -> dict[int, float]:
    """What `--value ID=VALUE` says."""
    values = {}
    for option in options:
        id, _, value = option.partition("=")
        try:
            values[int(id)] = float(value)
        except ValueError:
            raise ArgoError(f"--value {option}: write ID=VALUE, such as 8=4.2") from None
    return values


def _show_warnings(source_name: str, diagnostics: tuple[Diagnostic, ...]) -> None:
    for diagnostic in diagnostics:
        print(diagnostic.render(source_name), file=sys.stderr)


def _keep_input(source: Path, output: Path) -> None:
    """Refuses to write over what is read."""
    if source.resolve() == output.resolve():
        raise ArgoError(f"{output} is the input as well; choose another place to write to")


def _make_folder(path: Path) -> None:
    """Makes the folder now, so that no run is lost for want of a place for its report."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ArgoError(f"{path}: can't be made a folder: {error.strerror}") from error


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise ArgoError(f"{path}: can't be written: {error.strerror}") from error


def _console() -> Console:
    return Console(highlight=False)


def _progress() -> Progress:
    return Progress(
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} s"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
    )


if __name__ == "__main__":
    main()
