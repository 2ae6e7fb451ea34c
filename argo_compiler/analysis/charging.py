"""Diagnostics on the charging of a low battery: too long for the mission, or cut short."""

from collections.abc import Iterator

from argo_compiler.analysis.study import Study
from argo_compiler.analysis.travel import Travel
from argo_compiler.base.quantity_text import duration_text, rounded_down, rounded_up
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Afterwards, EventKind, Reaction, Response

LOW_SHARE, CHARGED_SHARE = 0.2, 0.99
"""shares of the battery's charge at which the robot calls it low and charged by itself"""
_ESTIMATE_ERRORS = 0.01
"""share of the battery by which the estimates of the charge at both ends may be wrong together"""


def diagnose_charging(study: Study, travel: Travel) -> Iterator[Diagnostic]:
    """Yield diagnostics on reactions to a low battery that charge it.

    The charge is at most the level of the reaction when charging begins, so that all times are
    lower bounds.
    """
    battery, power = travel.battery, travel.charging_power
    if battery is None or power is None:
        return
    share_per_second = power / 3600.0 / battery
    for reaction in study.mission.reactions:
        if not _charges(reaction):
            continue
        level = LOW_SHARE if reaction.battery_below is None else reaction.battery_below
        goal = _goal(reaction, level)
        to_level = max((goal - level - _ESTIMATE_ERRORS) / share_per_second, 0.0)
        needed = max(to_level, reaction.charge_for or 0.0)
        limit = reaction.hold_limit
        subject = subject_of("reactions", reaction.event)
        if limit is not None and limit < needed:
            if reaction.on_limit is not Afterwards.RESUME:
                continue
            reached = min(goal, level + limit * share_per_second)
            yield study.diagnostic(
                "charge-cut-short",
                f"the reaction to {reaction.event} charges for {duration_text(limit)} at most, and "
                "then continues the mission with a charge of at most "
                f"{rounded_up(100 * reached)}%, not {goal:.0%}: it takes at least "
                f"{duration_text(needed, rounded_down)} to charge from {level:.0%}",
                "allow more time, or charge to a level that is reached in this time",
                subject=f"{subject}.hold_limit",
            )
        elif study.mission.max_duration is not None and needed > study.mission.max_duration:
            least = duration_text(needed, rounded_down)
            if to_level < needed:
                charging = f"for at least {least}"
                less = "recharge for a shorter time"
            else:
                charging = f"from {level:.0%} to {goal:.0%}, which takes at least {least}"
                less = "recharge to a lower level, such as `recharge to 60 %`"
            yield study.diagnostic(
                "charging-too-long",
                f"the reaction to {reaction.event} charges the battery {charging}, longer than the "
                f"mission's maximum duration of {duration_text(study.mission.max_duration)}",
                f"{less}, or allow more time",
                subject=subject,
            )


def _charges(reaction: Reaction) -> bool:
    """Return True if a reaction drives to the dock when the battery is low, and charges it."""
    return (
        reaction.event is EventKind.LOW_BATTERY
        and reaction.response is Response.RETURN
        and reaction.until is EventKind.BATTERY_CHARGED
    )


def _goal(reaction: Reaction, level: float) -> float:
    """Return the charge, 0 to 1, to which a reaction charges the battery from `level`."""
    if reaction.charge_to is not None:
        return min(reaction.charge_to, CHARGED_SHARE)
    return level if reaction.charge_for is not None else CHARGED_SHARE
