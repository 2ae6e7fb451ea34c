"""Display of a running evaluation: a progress bar, the outcomes and the success rate."""

import sys
import time
from collections.abc import Callable
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from argo_compiler.base.quantity_text import rounded_up
from argo_env.closing import Closing
from argo_env.evaluation.rates import approximate_success_rate
from argo_env.evaluation.row import RunOutcome
from argo_env.evaluation.runner import EvaluationProgress
from argo_env.formatting import min_sec_text
from argo_planner.terminal.verbosity import is_quiet

EVERY = 10.0
"""s between two lines if standard error is no terminal"""
_REDRAW_INTERVAL = 0.2  # s


class EvaluationDisplay(Closing):
    """Progress on standard error: a bar on a terminal, otherwise a line every 10 s."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._console = Console(stderr=True, highlight=False)
        self._progress = Progress(
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[status]}"),
            console=self._console,
            transient=True,
            disable=is_quiet() or not sys.stderr.isatty(),
        )
        self._bar = self._progress.add_task("", total=None, status="")
        self._shown = -EVERY

    def show(self, progress: EvaluationProgress) -> None:
        """Show the progress, unless it was shown less than 0.2 s (10 s without a terminal) ago."""
        terminal = sys.stderr.isatty()
        now = self._clock()
        if is_quiet() or now - self._shown < (_REDRAW_INTERVAL if terminal else EVERY):
            return
        first, self._shown = self._shown < 0, now
        text = progress_text(progress)
        if terminal:
            self._progress.update(
                self._bar, total=progress.max_runs, completed=progress.completed_runs, status=text
            )
        elif not first:
            self._console.print(f"{progress.completed_runs} of {progress.max_runs} runs, {text}")

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def close(self) -> None:
        """End the display."""
        self._progress.stop()


def progress_text(progress: EvaluationProgress) -> str:
    """Return the success rate, the counts of other outcomes, and the time left, in words."""
    outcomes = progress.all_outcomes
    rate = approximate_success_rate(outcomes)
    parts = []
    if rate.runs:
        parts.append(f"success {rate.value:.1%} ({rate.low:.1%} to {rate.high:.1%})")
    for outcome, name in (
        (RunOutcome.FAILURE, "failed"),
        (RunOutcome.ERROR, "errors"),
        (RunOutcome.DIED, "died"),
    ):
        if outcomes[outcome]:
            parts.append(f"{outcomes[outcome]} {name}")
    if progress.longest_remaining_seconds is not None:
        parts.append(f"at most {min_sec_text(progress.longest_remaining_seconds, rounded_up)} left")
    return ", ".join(parts)
