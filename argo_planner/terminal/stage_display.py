"""Display of work that takes more than two seconds, on standard error, with its progress."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, RLock, Thread
from typing import TYPE_CHECKING

from argo_compiler.base.stages import listen_to_stages
from argo_planner.terminal.verbosity import is_quiet

# Slow to import, and most commands end before anything is shown.
if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

AFTER = 2.0
"""s after which a stage is shown"""
EVERY = 10.0
"""s between two lines if standard error is no terminal"""
_GAP = 1.0  # s between two stages after which the wait for the first line begins anew
_TICK = 0.25  # s


@contextmanager
def show_stages() -> Iterator[None]:
    """Show stages that take long within this context."""
    display = StageDisplay()
    try:
        with listen_to_stages(display):
            yield
    finally:
        display.close()


class StageDisplay:
    """Display of stages: a bar on a terminal, which vanishes at their end, otherwise lines.

    A separate thread refreshes it, since the work itself may report nothing for a long time.
    """

    def __init__(
        self,
        console: "Console | None" = None,
        clock: Callable[[], float] = time.monotonic,
        watched: bool = True,
    ) -> None:
        """Prepare the display; nothing is shown yet.

        Args:
            console: where to show the stages; None: on standard error
            clock: function that returns the time in s
            watched: whether the display starts a thread that calls `refresh`; otherwise the caller
                has to call it
        """
        self._console = console
        self._clock = clock
        self._watched = watched
        self._lock = RLock()
        self._closed = Event()
        self._thread: Thread | None = None
        self._stage: str | None = None
        self._share: float | None = None
        self._detail = ""
        self._begun = 0.0
        self._ended = -_GAP
        self._written = -EVERY
        self._bar: Progress | None = None

    def __call__(self, stage: str | None, share: float | None, detail: str) -> None:
        """Receive the current stage and its progress.

        Args:
            stage: name of the stage; None: all have ended
            share: completed part of it, from 0 to 1; None: unknown
            detail: text about its progress; empty: none
        """
        with self._lock:
            now = self._clock()
            if stage is None:
                self._hide()
                self._ended = now
            elif self._stage is None and now - self._ended >= _GAP:
                self._begun, self._written = now, now - EVERY
            self._stage, self._share, self._detail = stage, share, detail
        if self._watched and self._thread is None:
            self._thread = Thread(target=self._watch, daemon=True)
            self._thread.start()
        self.refresh()

    def refresh(self) -> None:
        """Show the current stage, if it began AFTER s ago or earlier.

        Standard error that is no terminal gets a line every EVERY s.
        """
        with self._lock:
            now = self._clock()
            if self._stage is None or now - self._begun < AFTER or is_quiet():
                return
            if self._console is None:
                from rich.console import Console

                self._console = Console(stderr=True)
            if self._console.is_terminal:
                self._show(self._console)
            elif now - self._written >= EVERY:
                self._written = now
                done = [] if self._share is None else [f"{self._share:.0%}"]
                text = ", ".join([*self._texts(), *done])
                self._console.print(f"{text} …", soft_wrap=True, highlight=False, markup=False)

    def close(self) -> None:
        """End the display."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join()
        with self._lock:
            self._hide()

    def _watch(self) -> None:
        while not self._closed.wait(_TICK):
            self.refresh()

    def _show(self, console: "Console") -> None:
        if self._bar is None:
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

            self._bar = Progress(
                TextColumn("{task.description}", markup=False),
                BarColumn(bar_width=20),
                TimeElapsedColumn(),
                console=console,
                transient=True,
                redirect_stdout=False,  # results never go to standard error
            )
            self._bar.add_task(", ".join(self._texts()), total=None)
            self._bar.start()
        self._bar.update(
            self._bar.task_ids[0],
            description=", ".join(self._texts()),
            total=None if self._share is None else 1.0,
            completed=self._share or 0.0,
        )

    def _texts(self) -> list[str]:
        return [text for text in (self._stage, self._detail) if text]

    def _hide(self) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
