"""When the next time step of a simulation is due, on a person's clock."""

LAG = 0.5
"""s by which a slow machine may be late before it does not make up for it"""


class Pace:
    """How fast simulated time goes. Holds where both clocks stood when that changed last."""

    def __init__(self, speed: float | None, simulated: float, now: float) -> None:
        """`speed`: simulated seconds a second; None: as fast as possible. Both times in s."""
        self.speed = speed
        self._waits = False
        self._simulated, self._now = simulated, now

    def change(self, speed: float | None, simulated: float, now: float) -> None:
        """From now on time goes at that speed."""
        self.speed = speed
        self._simulated, self._now = simulated, now

    def left(self, simulated: float, now: float, waits: bool) -> float:
        """How long (s) until the next step is due; 0 or less: now. While the run `waits` for a
        person, time goes no faster than theirs."""
        if waits is not self._waits:
            self._waits = waits
            self._simulated, self._now = simulated, now
        speed = self.speed
        if waits:
            speed = 1.0 if speed is None else min(1.0, speed)
        if speed is None:
            return 0.0
        due = self._now + (simulated - self._simulated) / speed
        if now - due > LAG:
            self._simulated, self._now = simulated, now
            return 0.0
        return due - now
