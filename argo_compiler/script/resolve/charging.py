"""Levels of the battery that a script names, as shares of its charge."""

from typing import NamedTuple

from argo_compiler.diagnostics import Span
from argo_compiler.il import EventKind
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.sentences.tree.conditions import Amount, Asked, BatteryLevel, Occurs

FULL = 1.0
_LOW_HINT = "write, for example, `if the battery drops below 30 %`"
_CHARGED_HINT = "write, for example, `until the battery is charged to 80 %`"


class AwaitedEvent(NamedTuple):
    """Event that ends a wait."""

    event: EventKind
    charge: float | None = None
    """0 to 1, for BATTERY_CHARGED: the charge that is named"""


def awaited_event(asked: Asked, diagnostics: Diagnostics) -> AwaitedEvent | None:
    """Return the event that ends a wait `until` this is so; None if this is no event.

    Raises RefusedError for a level of the battery that ends no wait.
    """
    match asked:
        case Occurs(event=EventKind() as event):
            return AwaitedEvent(event)
        case BatteryLevel(level=level):
            if level.low is None:
                message = "a wait needs a battery that is charged, not one that becomes low"
                diagnostics.refuse("battery", message, asked.span, _CHARGED_HINT)
            share = charge_share(level.low, asked.span, diagnostics)
            return AwaitedEvent(EventKind.BATTERY_CHARGED, share)
    return None


def low_level(battery: BatteryLevel, diagnostics: Diagnostics) -> float:
    """Return the charge, 0 to 1, below which the battery is called low. Raises RefusedError."""
    if battery.level.high is None:
        message = "a reaction needs a battery that becomes low, not one that is charged"
        hint = f"{_LOW_HINT}, or `wait until the battery is charged`"
        diagnostics.refuse("battery", message, battery.span, hint)
    return _share(battery.level.high, battery.span, _LOW_HINT, diagnostics)


def charge_share(amount: Amount, span: Span, diagnostics: Diagnostics) -> float:
    """Return the charge, 0 to 1, to which a battery is charged. Raises RefusedError."""
    if amount.unit == "%" and not 0.0 < amount.value <= 100.0:
        message = "this must be more than 0 % and at most 100 %"
        diagnostics.refuse("battery", message, span, _CHARGED_HINT)
    if amount.value == 100.0:
        return FULL
    return _share(amount, span, _CHARGED_HINT, diagnostics)


def _share(amount: Amount, span: Span, hint: str, diagnostics: Diagnostics) -> float:
    if amount.unit != "%":
        unit = f"in {amount.unit}" if amount.unit else "without a unit"
        message = f"the battery's charge is given in %, not as a number {unit}"
        diagnostics.refuse("battery", message, span, hint)
    if not 0.0 < amount.value < 100.0:
        diagnostics.refuse("battery", "this must be more than 0 % and less than 100 %", span, hint)
    return amount.value / 100.0
