"""Display of a run in progress: a bar, readings and findings."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from argo_env.closing import Closing
from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.record import Anomaly, Reading, RunRecord
from argo_env.run.robot import RobotAction
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.site import Site
from argo_planner.terminal.verbosity import is_quiet


class RunDisplay(Observer, Closing):
    """Progress of a run on standard error. Holds the bar; use it as a context."""

    def __init__(self, total: float | None) -> None:
        """Prepare a bar for a mission of at most `total` s; None: it has no limit."""
        self._progress = progress_bar()
        self._bar = self._progress.add_task("starting", total=total)
        self._site: Site | None = None

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:  # noqa: ARG002
        """Store the site of the run, which is about to begin."""
        self._site = setup.navigator.site

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """Show the simulated time in s and the current task in the bar."""
        task = action.task.name if action else "waiting"
        self._progress.update(self._bar, completed=now, description=task)

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """Print anomalies and values that people reported, and those that the robot sensed."""
        reported = entry.anomalies_reported_from_outside(self._site) if self._site else ()
        for value in entry.values_from_people(self._site) if self._site else ():
            self._print(f"{value.t!r} s: {value.in_words}")
        for item in (*reported, *entry.other_anomalies_then_reading):
            self.print_reading_or_anomaly(item)

    def print_reading_or_anomaly(self, item: Reading | Anomaly) -> None:
        """Print a reading or an anomaly as a line above the bar; with `--quiet` print nothing."""
        if isinstance(item, Reading):
            text = (
                f"{item.t!r} s: {item.task}: {item.name} (#{item.checkpoint}) shows "
                f"{item.value!r} {item.unit}"
            )
        else:
            origin = "reported" if item.is_reported_from_outside else "detected"
            parts = filter(None, (origin, item.kind.replace("_", " "), item.detail))
            text = f"{item.t!r} s: {': '.join(parts)}"
            if place := item.whereabouts:
                text += f", {place}"
        self._print(text)

    def _print(self, text: str) -> None:
        if not is_quiet():
            self._progress.console.print(escape(text), soft_wrap=True, highlight=False)

    def warn(self, text: str) -> None:
        """Print a warning as a line above the bar, unlike other warnings even with `--quiet`."""
        self._progress.console.print(
            f"[bold yellow]Warning[/]: {escape(text)}", soft_wrap=True, highlight=False
        )

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def close(self) -> None:
        """End the display; printed lines stay."""
        self._progress.stop()


def run_and_describe_recording(
    total: float | None,
    recording: Path | None,
    source: Path | None,
    carry_out: Callable[[Sequence[Observer]], RunRecord],
) -> tuple[RunRecord, str]:
    """Carry out a run with a display and, if wanted, a recording.

    Args:
        total: longest duration of the mission in s; None: it has no limit
        recording: file to record into; None: the run is not recorded
        source: file that the mission was read from; None: it is not known
        carry_out: function that carries out the run with observers

    Returns:
        The record of the run, and a line about the recording; the line is empty if there is none.
    """
    with ExitStack() as stack:
        display = stack.enter_context(RunDisplay(total))
        if recording is None:
            return carry_out([display]), ""
        # Needs an extra that may not be installed.
        from argo_env.recording.files import recording_to

        recorder = stack.enter_context(recording_to(recording, source, display.warn))
        record = carry_out([display, recorder])
    return record, f"Recording: {recording}" + (f": {recorder.loss}" if recorder.loss else "")


def progress_bar() -> Progress:
    """Return a bar on standard error that vanishes at its end; with `--quiet` it is not shown."""
    return Progress(
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} s"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        disable=is_quiet(),
    )
