"""Diagnostics on the charging of the battery: where, how far, how long, or cut short."""

from collections.abc import Iterator

from argo_compiler.analysis.docking import is_docked_after
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.travel import Travel
from argo_compiler.base.message import Message
from argo_compiler.base.model import Pose
from argo_compiler.base.quantity_text import duration_text, rounded_down, rounded_up
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.hfsm.charging import FULL, LOW
from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_compiler.il.docked import is_at_dock

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
        level = LOW if reaction.battery_below is None else reaction.battery_below
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
                Message(
                    "the reaction to {event} charges for {duration} at most, and then "
                    "continues the mission with a charge of at most {value}%, not {goal:.0%}: "
                    "it takes at least {duration_2} to charge from {level:.0%}",
                    event=reaction.event,
                    duration=duration_text(limit),
                    value=rounded_up(100 * reached),
                    goal=goal,
                    duration_2=duration_text(needed, rounded_down),
                    level=level,
                ),
                "allow more time, or charge to a level that is reached in this time",
                subject=f"{subject}.hold_limit",
            )
        elif study.mission.max_duration is not None and needed > study.mission.max_duration:
            least = duration_text(needed, rounded_down)
            if to_level < needed:
                charging = Message("for at least {least}", least=least)
                less = Message("recharge for a shorter time")
            else:
                charging = Message(
                    "from {level:.0%} to {goal:.0%}, which takes at least {least}",
                    level=level,
                    goal=goal,
                    least=least,
                )
                rate = 60.0 * 100.0 * share_per_second
                less = Message(
                    "recharge to a lower level (it charges {rate:.1f} % in a minute)", rate=rate
                )
            yield study.diagnostic(
                "charging-too-long",
                Message(
                    "the reaction to {event} charges the battery {charging}, longer than the "
                    "mission's maximum duration of {duration}",
                    event=reaction.event,
                    charging=charging,
                    duration=duration_text(study.mission.max_duration),
                ),
                Message("{less}, or allow more time", less=less),
                subject=subject,
            )


def diagnose_charge_and_place(study: Study) -> Iterator[Diagnostic]:
    """Yield diagnostics on waits for a charge where nothing charges, and on a battery left low."""
    mission = study.mission
    areas = () if study.catalog is None else study.catalog.areas
    docks = (*((mission.dock,) if mission.dock else ()), *(area.dock for area in areas))
    for reaction in mission.reactions:
        if _waits_for_charge_elsewhere(reaction, docks):
            yield study.diagnostic(
                "charge-elsewhere",
                Message(
                    "the reaction to {event} waits until the battery is charged, but not in a "
                    "docking station: nothing charges it there",
                    event=reaction.event,
                ),
                "return to the docking station, such as by `return, recharge and resume`",
                subject=subject_of("reactions", reaction.event, ".until"),
            )
        if reaction.event is EventKind.LOW_BATTERY:
            yield from _left_low(study, reaction)
    for number, leaf in enumerate(study.flow.leaves):
        waits = leaf.wait is not None and leaf.wait.event is EventKind.BATTERY_CHARGED
        if not waits or not docks or not study.nominal.is_reached(number):
            continue
        if not any(is_docked_after(study, number, dock) for dock in docks):
            yield study.diagnostic(
                "charge-elsewhere",
                Message(
                    "task '{task}' waits until the battery is charged, but the robot may be "
                    "elsewhere than in a docking station, where nothing charges it (path: "
                    "{shortest_path})",
                    task=study.name(number),
                    shortest_path=study.shortest_path_text(number),
                ),
                "let it return to the docking station before",
                number,
            )


def _waits_for_charge_elsewhere(reaction: Reaction, docks: tuple[Pose, ...]) -> bool:
    """Return True if a reaction waits for a charge at a place that is none of the docks."""
    if reaction.until is not EventKind.BATTERY_CHARGED:
        return False
    if reaction.response is Response.PAUSE:
        return True
    pose = reaction.pose
    if not reaction.response.drives or pose is None or not docks:
        return False
    return not any(is_at_dock(pose, dock) for dock in docks)


def _left_low(study: Study, reaction: Reaction) -> Iterator[Diagnostic]:
    """Yield a diagnostic if the mission goes on after a low battery that is not charged enough."""
    subject = subject_of("reactions", reaction.event)
    goes_on = reaction.response.drives and reaction.afterwards is Afterwards.RESUME
    if goes_on and reaction.until is None:
        yield study.diagnostic(
            "not-charged",
            Message(
                "the reaction to {event} resumes the mission without charging the battery: "
                "the robot reports a low battery again when 1 % less is left, and so on",
                event=reaction.event,
            ),
            "wait until the battery is charged, such as by `return, recharge and resume`",
            subject=subject,
        )
    level = reaction.charge_to
    if level is not None and reaction.battery_below is None and level <= LOW:
        yield study.diagnostic(
            "charge-too-low",
            Message(
                "the reaction to {event} charges the battery to {level:.0%}, and the robot "
                "calls a battery low below {low:.0%}: it leaves the dock with a battery "
                "that is still low",
                event=reaction.event,
                level=level,
                low=LOW,
            ),
            "charge to a higher level, or give a lower level for the reaction (`battery_below`)",
            subject=f"{subject}.charge_to",
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
        return min(reaction.charge_to, FULL)
    return level if reaction.charge_for is not None else FULL
