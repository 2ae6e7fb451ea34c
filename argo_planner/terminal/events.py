"""Parsing of the options `--event` and `--value`."""

import math

from argo_compiler.base.errors import ArgoError, Conflict, Invalid
from argo_compiler.hfsm import Event
from argo_planner.use_cases.running import EVENTS, READING, parse_event

KINDS = ", ".join(EVENTS)
"""kinds of events in `--event TIME=KIND`, apart from `READING_FORM`"""
READING_FORM = f"{READING}:ID=VALUE"
"""kind of event for a value that a person reports"""


def parse_events(options: list[str]) -> list[tuple[float, Event]]:
    """Parse options `TIME=KIND`; return times (simulated s since the start) and events, sorted.

    Raises:
        ArgoError: An option has another form, or there is no such kind.
    """
    events = []
    for option in options:
        at, equals, name = option.partition("=")
        try:
            time_s = float(at)
        except ValueError:
            time_s = math.nan
        if not (equals and 0.0 <= time_s < math.inf):
            raise Invalid(f"--event {option}: write TIME=KIND in s, such as 60=gas_leak")
        try:
            events.append((time_s, parse_event(name.strip())))
        except ArgoError as error:
            raise Invalid(f"--event {option}: {error}") from None
    return sorted(events, key=lambda event: event[0])


def parse_checkpoint_values(options: list[str]) -> dict[int, float]:
    """Return the values of options `ID=VALUE`, by checkpoint.

    Raises:
        Invalid: An option has another form.
        Conflict: A checkpoint has two values.
    """
    values: dict[int, float] = {}
    for option in options:
        id, _, value = option.partition("=")
        try:
            number, shown = int(id), float(value)
            if not math.isfinite(shown):
                raise ValueError(value)
        except ValueError:
            raise Invalid(f"--value {option}: write ID=VALUE, such as 8=4.2") from None
        if number in values:
            raise Conflict(f"--value {option}: checkpoint {number} has been given a value already")
        values[number] = shown
    return values
