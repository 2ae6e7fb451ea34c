"""Progress of long computations, printed in lines: training, and policies on many instances."""

import time
from collections.abc import Callable

LINE_INTERVAL = 10.0
"""least time in s between two lines"""


class StageLines:
    """Listener to stages, which writes the present stage, its progress and its remaining time.

    It holds the present stage, and the times of its beginning and of the last line.
    """

    def __init__(
        self, write: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Take a function that writes a line, and a clock in s."""
        self._write = write
        self._clock = clock
        self._begun = self._written = clock()
        self._stage: str | None = None

    def __call__(self, stage: str | None, share: float | None, detail: str) -> None:
        """Write a line about the current stage unless the last line is less than 10 s old.

        See StageListener for the arguments.
        """
        now = self._clock()
        if stage != self._stage:
            self._stage, self._begun = stage, now
        if stage is None or now - self._written < LINE_INTERVAL:
            return
        self._written = now
        parts = [] if share is None else [f"{share:.0%}"]
        parts += [detail] if detail else []
        if share:
            left = (now - self._begun) * (1.0 - share) / share
            parts.append(f"about {left:.0f} s left")
        self._write(f"{stage}: {', '.join(parts)}" if parts else f"{stage} …")
