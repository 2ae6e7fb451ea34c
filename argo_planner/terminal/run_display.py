"""What a person sees of a run while it goes on: its progress and readings."""

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
    """The progress on standard error. Holds the bar; use it as a context."""

    def __init__(self, total: float | None) -> None:
        """`total`: the mission's longest duration (s), if it has one."""
        self._progress = progress_bar()
        self._bar = self._progress.add_task("setting off", total=total)
        self._site: Site | None = None

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:  # noqa: ARG002
        """The run is about to begin on this site."""
        self._site = setup.navigator.site

    def on_step(self, now: float, action: RobotAction | None) -> None:
        """Shows the time (s) and the task under way."""
        task = action.task.name if action else "waits"
        self._progress.update(self._bar, completed=now, description=task)

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """Shows what was told and sensed."""
        told = entry.reported_anomalies(self._site) if self._site else ()
        for value in entry.given_values(self._site) if self._site else ():
            self._say(f"{value.t!r} s: {value.in_words}")
        for news in (*told, *entry.sensed):
            self.announce(news)

    def announce(self, news: Reading | Anomaly) -> None:
        """Shows a reading or a finding in a line of its own, which stays."""
        if isinstance(news, Reading):
            text = (
                f"{news.t!r} s: {news.task}: {news.name} (#{news.checkpoint}) shows "
                f"{news.value!r} {news.unit}"
            )
        else:
            how = "told" if news.is_reported else "found"
            said = filter(None, (how, news.kind.replace("_", " "), news.detail))
            text = f"{news.t!r} s: {': '.join(said)}"
            if place := news.whereabouts:
                text += f", {place}"
        self._say(text)

    def _say(self, text: str) -> None:
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


def carry_out_shown(
    total: float | None,
    recording: Path | None,
    source: Path | None,
    carry_out: Callable[[Sequence[Observer]], RunRecord],
) -> tuple[RunRecord, str]:
    """A run that is carried out with the observers which show its progress and record it, and a
    line about the recording, empty without one.

    `total`: as of RunDisplay; `source`: the file that the mission was read from.
    """
    with ExitStack() as stack:
        display = stack.enter_context(RunDisplay(total))
        if recording is None:
            return carry_out([display]), ""
        # What this needs is not there without the extra.
        from argo_env.recording.files import recording_to

        recorder = stack.enter_context(recording_to(recording, source, display.warn))
        record = carry_out([display, recorder])
    return record, f"Recording: {recording}" + (f": {recorder.loss}" if recorder.loss else "")


def progress_bar() -> Progress:
    """A bar on standard error, gone when it ends; nothing where only results are to be shown."""
    return Progress(
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} s"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        disable=is_quiet(),
    )
