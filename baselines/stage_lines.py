"""What takes long, in lines: training, and policies on many instances."""

import time
from collections.abc import Callable

EVERY = 10.0
"""s between lines"""


class StageLines:
    """Hears of stages. Says now and then what goes on, how far it is, and how long it takes yet."""

    def __init__(
        self, write: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        """The clock gives s."""
        self._write = write
        self._clock = clock
        self._begun = self._written = clock()
        self._stage: str | None = None

    def __call__(self, stage: str | None, share: float | None, detail: str) -> None:
        """Hears of a stage, or of the end of all."""
        now = self._clock()
        if stage != self._stage:
            self._stage, self._begun = stage, now
        if stage is None or now - self._written < EVERY:
            return
        self._written = now
        parts = [] if share is None else [f"{share:.0%}"]
        parts += [detail] if detail else []
        if share:
            left = (now - self._begun) * (1.0 - share) / share
            parts.append(f"about {left:.0f} s left")
        self._write(f"{stage}: {', '.join(parts)}" if parts else f"{stage} …")
