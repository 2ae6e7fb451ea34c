"""The end of a run, as a person sees it: its results are written, then shown."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.markup import escape

from argo_compiler.base.errors import ArgoError
from argo_env.faults.kinds import site_with_faults
from argo_env.report.files import PAGE
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site
from argo_planner.terminal.files import write_content
from argo_planner.terminal.kept import Kept
from argo_planner.terminal.record_tables import show_record
from argo_planner.terminal.run_display import progress_bar
from argo_planner.terminal.signals import Interrupted, SignalWatch
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.terminal.words import said
from argo_planner.use_cases.reporting import report_files


@dataclass(frozen=True)
class Conclusion:
    """What is made of a run when it has ended, or was interrupted."""

    report: Path | None
    render: Path | None
    kept: Kept
    interruption: SignalWatch
    """that of the process, the first of which lets it come to a good end"""

    def conclude(self, record: RunRecord, site: Site, robot: RobotSpec, took: str) -> None:
        """Writes what was asked for, then shows the results, so that whoever stops reading them
        loses nothing. Exits with status 1 if the run is no success, with 2 if something can't be
        written, and as the signal has it if one has kept the run or its results from their end."""
        came = self.interruption.came
        if came and self.report and not is_quiet():
            print("argo: writing the report; Ctrl-C once more ends at once", file=sys.stderr)
        told: list[str] = []
        errors: list[ArgoError] = []
        left: list[Path] = []
        for place, write in ((self.report, self._report), (self.render, self._film)):
            if place is None:
                continue
            try:
                told.append(write(place, record, site, robot))
            except ArgoError as error:
                errors.append(error)
                left.append(place)
            except Interrupted as interrupted:
                came = interrupted
                left.append(place)
        console = Console()
        show_record(record, console)
        if not is_quiet():
            console.print(took, soft_wrap=True)
        for line in told:
            console.print(escape(line), soft_wrap=True)
        for failure in errors:
            print(said(failure, "argo: "), file=sys.stderr)
        came = came or self.interruption.came
        if came and not record.result.ended:
            way_on = self.kept.way_on(self.report, self.render)
            print(f"argo: interrupted at {record.result.duration:.0f} s; {way_on}", file=sys.stderr)
        elif left:
            self._say_what_is_left(left)
        if errors:
            raise typer.Exit(2)
        if came and (left or not record.result.ended):
            raise typer.Exit(came.status)
        if not record.result.success:
            raise typer.Exit(1)

    @contextmanager
    def telling_the_way_on(self) -> Iterator[None]:
        """Says how the run goes on where it is interrupted for good."""
        try:
            yield
        except Interrupted as interrupted:
            way_on = self.kept.way_on(self.report, self.render)
            print(f"argo: interrupted; {way_on}", file=sys.stderr)
            raise typer.Exit(interrupted.status) from None

    def _report(self, folder: Path, record: RunRecord, site: Site, robot: RobotSpec) -> str:
        write_content(folder, report_files(record, site, robot))
        return f"Report: {folder / PAGE}"

    def _film(self, file: Path, record: RunRecord, site: Site, robot: RobotSpec) -> str:
        self.interruption.require_none()
        from argo_env.pictures import write_film

        with progress_bar() as progress:
            bar = progress.add_task("filming", total=1.0)

            def go_on(share: float) -> None:
                self.interruption.require_none()
                progress.update(bar, completed=share)

            try:
                write_film(
                    record, site_with_faults(site, record.faults), robot, file, progress=go_on
                )
            except ArgoError:
                # The encoder gets Ctrl-C as well.
                self.interruption.require_none()
                raise
        return f"Film: {file}"

    def _say_what_is_left(self, left: list[Path]) -> None:
        names = " and ".join(map(str, left))
        command = self.kept.command(
            self.report if self.report in left else None,
            self.render if self.render in left else None,
        )
        way = f"; made by: {command}" if command else ", and the run was not kept"
        print(f"argo: not written: {names}{way}", file=sys.stderr)
