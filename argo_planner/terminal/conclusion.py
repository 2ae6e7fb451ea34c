"""The end of a run on the terminal: the results are written first, then shown."""

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
from argo_planner.terminal.record_tables import show_record
from argo_planner.terminal.run_storage import RunStorage
from argo_planner.terminal.signals import Interrupted, SignalWatch
from argo_planner.terminal.verbosity import is_quiet
from argo_planner.terminal.words import error_text
from argo_planner.use_cases.reporting import report_files


@dataclass(frozen=True)
class Conclusion:
    """Outputs that a command writes and shows after a run has ended or was interrupted."""

    report: Path | None
    render: Path | None
    stored: RunStorage
    interruption: SignalWatch
    """signals of the process; the first one lets the run stop in good order"""

    def write_report_and_show_results(
        self, record: RunRecord, site: Site, robot: RobotSpec, duration_text: str
    ) -> None:
        """Write report and film, if asked for, then show the results.

        In this order, a reader who closes the output early loses nothing. `duration_text`
        says how long the run took.

        Raises:
            Exit: Status 1: the run was no success. Status 2: a result could not be written. The
                status of the signal: it has interrupted the run or the writing of its results.
        """
        received = self.interruption.received
        if received and self.report and not is_quiet():
            print("argo: writing the report; press Ctrl-C again to stop at once", file=sys.stderr)
        lines: list[str] = []
        errors: list[ArgoError] = []
        unwritten: list[Path] = []
        for path, write in ((self.report, self._write_report), (self.render, self._write_film)):
            if path is None:
                continue
            try:
                lines.append(write(path, record, site, robot))
            except ArgoError as error:
                errors.append(error)
                unwritten.append(path)
            except Interrupted as interrupted:
                received = interrupted
                unwritten.append(path)
        console = Console()
        show_record(record, site, console)
        if not is_quiet():
            console.print(duration_text, soft_wrap=True)
        for line in lines:
            console.print(escape(line), soft_wrap=True)
        for failure in errors:
            print(error_text(failure, "argo: "), file=sys.stderr)
        received = received or self.interruption.received
        if received and not record.result.ended:
            hint = self.stored.continuation_or_loss_text(self.report, self.render)
            print(f"argo: interrupted at {record.result.duration:.0f} s; {hint}", file=sys.stderr)
        elif unwritten:
            self._print_unwritten(unwritten)
        if errors:
            raise typer.Exit(2)
        if received and (unwritten or not record.result.ended):
            raise typer.Exit(received.status)
        if not record.result.success:
            raise typer.Exit(1)

    @contextmanager
    def exit_with_hint_on_interruption(self) -> Iterator[None]:
        """Turn Interrupted in this context into an exit with its status; print how to continue."""
        try:
            yield
        except Interrupted as interrupted:
            hint = self.stored.continuation_or_loss_text(self.report, self.render)
            print(f"argo: interrupted; {hint}", file=sys.stderr)
            raise typer.Exit(interrupted.status) from None

    def _write_report(self, folder: Path, record: RunRecord, site: Site, robot: RobotSpec) -> str:
        write_content(folder, report_files(record, site, robot))
        return f"Report: {folder / PAGE}"

    def _write_film(self, file: Path, record: RunRecord, site: Site, robot: RobotSpec) -> str:
        self.interruption.raise_if_received()
        from argo_env.pictures import write_film

        try:
            write_film(
                record,
                site_with_faults(site, record.faults),
                robot,
                file,
                raise_if_interrupted=self.interruption.raise_if_received,
            )
        except ArgoError:
            # Ctrl-C reaches the encoder too, which then fails.
            self.interruption.raise_if_received()
            raise
        return f"Film: {file}"

    def _print_unwritten(self, unwritten: list[Path]) -> None:
        names = " and ".join(map(str, unwritten))
        command = self.stored.continue_or_replay_command(
            self.report if self.report in unwritten else None,
            self.render if self.render in unwritten else None,
        )
        retry = f"to try again: {command}" if command else "the run was not stored for another try"
        print(f"argo: not written: {names}; {retry}", file=sys.stderr)
