"""Watch for the charge of the battery, estimated from voltage and current."""

from collections.abc import Sequence

from argo_compiler.base.message import Message
from argo_compiler.hfsm.charging import FULL, LOW, AwaitedCharge
from argo_compiler.il import EventKind
from argo_env.drives.battery import ESTIMATE_ERROR, Battery, estimated_charge
from argo_env.robot.pose import BodyPose
from argo_env.sensing.watch import Detection, ReportedDetection

MARGIN = 2 * ESTIMATE_ERROR
"""charge above the alarm level from which on the next alarm is at that level again, and charge
below the end of an earlier charging at which the next alarm is"""


class BatteryWatch:
    """Watch for the charge of the battery, estimated from voltage and current.

    It reports a low battery once, below its level. The next report is possible when the charge has
    been above that level by MARGIN. If charging, the mission's wait for it, or its reaction to the
    report ended before that, the next report is at MARGIN below the charge then. So the robot never
    uses up the energy of a short charging without a report.

    It reports a charged battery when the mission waits for it and its charge is reached, and else
    once after a low battery, at FULL.
    """

    name = "battery"
    period = 1.0

    def __init__(self, battery: Battery, low: float = LOW) -> None:
        """`low`: the charge, 0 to 1, below which the battery is low."""
        self._awaited: tuple[AwaitedCharge, ...] = ()
        self._is_answered = False
        self._was_answered = False  # waited for, or a reaction ended, since the last update
        self._battery = battery
        self._level = low
        self._alarm = low  # charge below which a low battery is reported next; 0: not yet
        self._low = False  # whether the last report was a low battery

    @property
    def awaited(self) -> tuple[AwaitedCharge, ...]:
        """Charges for which the mission waits now; the run sets them."""
        return self._awaited

    @awaited.setter
    def awaited(self, charges: tuple[AwaitedCharge, ...]) -> None:
        self._awaited = charges
        self._was_answered |= bool(charges)

    @property
    def is_answered(self) -> bool:
        """True if the mission reacts to the low battery now; the run sets it."""
        return self._is_answered

    @is_answered.setter
    def is_answered(self, now_answered: bool) -> None:
        self._was_answered |= self._is_answered and not now_answered
        self._is_answered = now_answered

    @property
    def alarm_level(self) -> float | None:
        """Charge, 0 to 1, below which a low battery is reported next, if not at its own level."""
        return None if self._alarm == self._level else self._alarm

    @alarm_level.setter
    def alarm_level(self, charge: float | None) -> None:
        self._alarm = self._level if charge is None else charge

    @property
    def has_awaited_charge(self) -> bool:
        """True if the battery has the charge for which the mission waits, so that its wait ends."""
        return bool(self.awaited) and self._has_charge(self._estimate())

    def restore(self, reported: Sequence[ReportedDetection], now: float) -> None:  # noqa: ARG002
        """Set the state after the reports; a low battery is reported again MARGIN below now."""
        self._low = bool(reported) and reported[-1].kind is EventKind.LOW_BATTERY
        if self._low:
            self._alarm = min(self._level, max(0.0, self._estimate() - MARGIN))

    def can_skip_updates(self, lowest_charge: float, highest_charge: float) -> bool:
        """Return True if no estimate of the charge can reach the level of the next detection."""
        if self._alarm != self._level or lowest_charge - ESTIMATE_ERROR <= self._level:
            return False
        if self.awaited:
            return highest_charge + ESTIMATE_ERROR < max(map(_least_charge, self.awaited))
        return not self._low or highest_charge + ESTIMATE_ERROR < FULL

    def update(self, now: float, pose: BodyPose) -> tuple[Detection, ...]:  # noqa: ARG002
        charge = self._estimate()
        if charge >= self._level + MARGIN:
            self._alarm = self._level
        elif self._was_answered or self._battery.current < 0.0:
            self._alarm = max(self._alarm, charge - MARGIN)
        self._was_answered = bool(self._awaited)
        if charge < self._alarm:
            self._alarm, self._low = 0.0, True
            return (self._detection(EventKind.LOW_BATTERY, charge),)
        if self._is_charged(charge, now):
            self._low = False
            return (self._detection(EventKind.BATTERY_CHARGED, charge),)
        return ()

    def _is_charged(self, charge: float, now: float) -> bool:
        if not self.awaited:
            return self._low and charge >= FULL
        has_passed = now >= max(awaited.not_before for awaited in self.awaited) - 1e-6
        return has_passed and self._has_charge(charge)

    def _has_charge(self, charge: float) -> bool:
        """Return True if the estimated charge is the awaited one, and charges if it has to."""
        is_charging = self._battery.current < 0.0 or charge >= FULL
        return charge >= max(map(_least_charge, self.awaited)) and (
            is_charging or not any(awaited.while_charging for awaited in self.awaited)
        )

    def _estimate(self) -> float:
        return estimated_charge(self._battery.voltage, self._battery.current)

    def _detection(self, kind: EventKind, charge: float) -> Detection:
        return Detection(
            kind,
            Message(
                "{voltage:.1f} V, {charge:.0%} charged",
                voltage=self._battery.voltage,
                charge=charge,
            ),
        )


def _least_charge(awaited: AwaitedCharge) -> float:
    """Return the estimated charge from which on the battery is charged as the mission waits for."""
    return FULL if awaited.level is None else min(awaited.level, FULL)
