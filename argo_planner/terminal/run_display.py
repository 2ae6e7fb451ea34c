"""What a person sees of a run: its progress and readings while it goes on, then its results."""

from pathlib import Path
from typing import Self

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from argo_env.closing import Closing
from argo_env.faults.kinds import changed_site
from argo_env.report.files import PAGE
from argo_env.robot.spec import RobotSpec
from argo_env.run.action import ActionUnderWay
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import Anomaly, Reading, RunRecord
from argo_env.run.rig import Rig
from argo_env.run.spec import RunSpec
from argo_env.site import Site
from argo_planner.terminal.files import write_content
from argo_planner.terminal.record_tables import show_record
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.use_cases.reporting import report_files


class RunDisplay(Observer, Closing):
    """The progress on standard error. Holds the bar; use it as a context."""

    def __init__(self, total: float | None) -> None:
        """`total`: the mission's longest duration (s), if it has one."""
        self._progress = _progress()
        self._bar = self._progress.add_task("setting off", total=total)
        self._site: Site | None = None

    def on_begin(self, rig: Rig, spec: RunSpec) -> None:  # noqa: ARG002
        """The run is about to begin on this site."""
        self._site = rig.navigator.site

    def on_step(self, now: float, action: ActionUnderWay | None) -> None:
        """Shows the time (s) and the task under way."""
        task = action.task.name if action else "waits"
        self._progress.update(self._bar, completed=now, description=task)

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """Shows what was told and sensed."""
        told = entry.told(self._site) if self._site else ()
        for news in (*told, *entry.news):
            self.announce(news)

    def announce(self, news: Reading | Anomaly) -> None:
        """Shows a reading or a finding in a line of its own, which stays."""
        if isinstance(news, Reading):
            text = (
                f"{news.t!r} s: {news.task}: {news.name} (#{news.checkpoint}) shows "
                f"{news.value!r} {news.unit}"
            )
        else:
            how = "told" if news.is_told else "found"
            said = filter(None, (how, news.kind.replace("_", " "), news.detail))
            text = f"{news.t!r} s: {': '.join(said)}"
            if place := news.whereabouts:
                text += f", {place}"
        if not is_quiet():
            self._progress.console.print(escape(text), soft_wrap=True, highlight=False)

    def warn(self, text: str) -> None:
        """Shows what the run goes on without, in lines of their own, which stay."""
        self._progress.console.print(
            f"[bold yellow]Warning[/]: {escape(text)}", soft_wrap=True, highlight=False
        )

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def close(self) -> None:
        """Ends the display; what it has shown stays."""
        self._progress.stop()


def conclude(
    record: RunRecord,
    site: Site,
    robot: RobotSpec,
    took: str,
    report: Path | None,
    render: Path | None = None,
) -> None:
    """Shows the results and writes what was asked for; exits with status 1 if it is no success."""
    console = Console()
    show_record(record, console)
    if not is_quiet():
        console.print(took, soft_wrap=True)
    if report:
        write_content(report, report_files(record, site, robot))
        console.print(f"Report: {escape(str(report / PAGE))}", soft_wrap=True)
    if render:
        _film(record, site, robot, render)
        console.print(f"Film: {escape(str(render))}", soft_wrap=True)
    if not record.result.success:
        raise typer.Exit(1)


def _film(record: RunRecord, site: Site, robot: RobotSpec, file: Path) -> None:
    from argo_env.pictures import write_film

    with _progress() as progress:
        bar = progress.add_task("filming", total=1.0)
        write_film(
            record,
            changed_site(site, record.faults),
            robot,
            file,
            progress=lambda share: progress.update(bar, completed=share),
        )


def _progress() -> Progress:
    return Progress(
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} s"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        disable=is_quiet(),
    )
