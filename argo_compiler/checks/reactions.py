"""Checks of reactions: whether their fields are complete and have an effect."""

from collections.abc import Iterator

from argo_compiler.base.message import Message, identifier
from argo_compiler.base.quantity_text import duration_text
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response, WaitRule
from argo_compiler.il.subjects import Subjects

_CHARGED = EventKind.BATTERY_CHARGED


def check_reactions(mission: Mission) -> Iterator[Diagnostic]:
    """Yield the diagnostics of a mission's reactions."""
    first: dict[EventKind, Reaction] = {}
    for reaction in mission.reactions:
        first.setdefault(reaction.event, reaction)
    subjects = Subjects(mission)
    ranked: dict[tuple[int, int], Reaction] = {}
    for i, reaction in enumerate(mission.reactions):
        item = CheckedItem(subjects.reaction_subject(i), reaction.source)
        if first[reaction.event] is not reaction:
            yield item.diagnostic(
                "il.duplicate-reaction",
                Message("there is more than one reaction to {event}", event=reaction.event),
                "keep one reaction for each event",
                ".event",
            )
        yield from _check_poses(item, reaction, mission)
        yield from _check_rank(item, reaction, ranked)
        if reaction.response is not Response.REPORT:
            ranked.setdefault(reaction.urgency_score, reaction)
        yield from _check_battery(item, reaction)
        yield from _check_unused(item, reaction)
        if _may_hold(reaction.response) and reaction.until is not None:
            yield from _check_until(item, reaction, first)
        if reaction.until is EventKind.ALL_CLEAR and reaction.hold_limit is None:
            yield from _check_all_clear(item, reaction)
        for field, event in (("event", reaction.event), ("until", reaction.until)):
            if event is EventKind.TIME_UP and mission.max_duration is None:
                yield item.diagnostic(
                    "il.time-up-without-limit",
                    Message(
                        "the reaction to {event} waits for {event_2}, which never occurs: the "
                        "mission has no max_duration",
                        event=reaction.event,
                        event_2=event,
                    ),
                    "give the mission a max_duration, or use another event",
                    f".{field}",
                )


def _check_poses(item: CheckedItem, reaction: Reaction, mission: Mission) -> Iterator[Diagnostic]:
    if reaction.response is Response.SAFE_AREA and reaction.pose is None:
        yield item.diagnostic(
            "il.safe-area-without-pose",
            Message("the reaction to {event} has no pose of the safe area", event=reaction.event),
            "give the reaction a `pose`",
            ".response",
        )
    if reaction.response is Response.RETURN and mission.dock is None and reaction.pose is None:
        yield item.diagnostic(
            "il.no-dock",
            Message(
                "the robot must return to the dock on {event}, but the mission has no dock",
                event=reaction.event,
            ),
            "give the mission the pose of its docking station as `dock`, or the reaction a `pose`",
            ".response",
        )


def _check_rank(
    item: CheckedItem, reaction: Reaction, ranked: dict[tuple[int, int], Reaction]
) -> Iterator[Diagnostic]:
    """Yield a diagnostic if a previous reaction has the same rank: one would wait for the other.

    `ranked` has, by rank, the first of the previous reactions in the mission's list; it is not
    changed.
    """
    other = ranked.get(reaction.urgency_score)
    if (
        other is None
        or reaction.response in (Response.REPORT, Response.ABORT)
        or other.event is reaction.event
        or other.until is reaction.event
        or reaction.until is other.event
    ):
        return
    yield item.diagnostic(
        "il.equal-priority",
        Message(
            "the reactions to {event} and {event_2} have the same priority "
            "{urgency_score}: the one whose event occurs later waits until the other "
            "is over",
            event=other.event,
            event_2=reaction.event,
            urgency_score=reaction.urgency_score[1],
        ),
        "give the more urgent one the higher priority",
        ".priority",
    )


def _check_battery(item: CheckedItem, reaction: Reaction) -> Iterator[Diagnostic]:
    if reaction.battery_below is not None and reaction.event is not EventKind.LOW_BATTERY:
        yield item.diagnostic(
            "il.battery-level",
            Message(
                "the reaction to {event} has `battery_below`, but that event does not "
                "depend on the battery",
                event=reaction.event,
            ),
            Message(
                "remove `battery_below`, or set the event of the reaction to {low_battery}",
                low_battery=EventKind.LOW_BATTERY,
            ),
            ".battery_below",
        )
    yield from check_charging(
        item,
        Message("the reaction to {event}", event=reaction.event),
        reaction,
        reaction.until,
        reaction.hold_limit,
        "until",
        "",
    )
    level, goal = reaction.battery_below, reaction.charge_to
    if level is not None and goal is not None and goal <= level:
        yield item.diagnostic(
            "il.charge-below-level",
            Message(
                "the reaction to {event} charges the battery to {goal:.0%}, and answers a "
                "charge below {level:.0%}: the robot leaves the dock with a battery that "
                "is still low",
                event=reaction.event,
                goal=goal,
                level=level,
            ),
            "charge to a higher level than `battery_below`",
            ".charge_to",
        )


def check_charging(
    item: CheckedItem,
    what: str,
    rule: Reaction | WaitRule,
    awaited: EventKind | None,
    limit: float | None,
    field_of_event: str,
    path: str,
) -> Iterator[Diagnostic]:
    """Yield the diagnostics of the charge for which a hold or a wait waits.

    Args:
        item: the reaction or task.
        what: its name for messages.
        rule: the reaction or the wait rule.
        awaited: the event for which it waits.
        limit: s for which it waits at most; None: no limit.
        field_of_event: name of the field with `awaited`.
        path: path from the item to the rule, such as `.wait`.
    """
    for field in ("charge_to", "charge_for"):
        if getattr(rule, field) is not None and awaited is not _CHARGED:
            yield item.diagnostic(
                "il.charge-without-wait",
                Message(
                    "{what} has `{field}`, but does not wait for {charged}",
                    what=what,
                    field=identifier(field),
                    charged=_CHARGED,
                ),
                Message(
                    "set `{field_of_event}` to {charged}, or remove `{field}`",
                    field_of_event=identifier(field_of_event),
                    charged=_CHARGED,
                    field=identifier(field),
                ),
                f"{path}.{field}",
            )
    if rule.charge_for is not None and limit is not None and limit <= rule.charge_for:
        yield item.diagnostic(
            "il.charge-after-limit",
            Message(
                "{what} charges the battery for {duration} at least, but waits for "
                "{duration_2} at most: that limit always ends the wait",
                what=what,
                duration=duration_text(rule.charge_for),
                duration_2=duration_text(limit),
            ),
            "allow more time, or charge for a shorter time",
            f"{path}.charge_for",
        )


def _check_unused(item: CheckedItem, reaction: Reaction) -> Iterator[Diagnostic]:
    response = reaction.response
    may_hold = _may_hold(response)
    unused = {
        "pose": reaction.pose is not None and not response.drives,
        "area": reaction.area is not None
        and (response is not Response.RETURN or reaction.pose is None),
        "hold_limit": reaction.hold_limit is not None and not (may_hold and reaction.holds),
        "on_limit": reaction.on_limit is not Afterwards.WAIT and reaction.hold_limit is None,
        "until": reaction.until is not None and not may_hold,
        "afterwards": reaction.afterwards is not Afterwards.END
        and not response.drives
        # After a pause the mission resumes in any case.
        and not (response is Response.PAUSE and reaction.afterwards is Afterwards.RESUME),
    }
    for field in (field for field, is_unused in unused.items() if is_unused):
        yield item.diagnostic(
            "il.unused-field",
            Message(
                "the reaction to {event} has `{field}`, which has no effect on the "
                "response {response}",
                event=reaction.event,
                field=identifier(field),
                response=response,
            ),
            Message("remove `{field}` or choose another response", field=identifier(field)),
            f".{field}",
        )


def _check_until(
    item: CheckedItem, reaction: Reaction, first: dict[EventKind, Reaction]
) -> Iterator[Diagnostic]:
    if reaction.until is reaction.event:
        yield item.diagnostic(
            "il.until-itself",
            Message(
                "the reaction to {event} waits for {event} itself, which changes nothing "
                "while it is active",
                event=reaction.event,
            ),
            "wait for an event that reports its end, such as all_clear",
            ".until",
        )
        return
    restored = reaction.until is EventKind.CONNECTION_RESTORED
    if restored and reaction.event is not EventKind.CONNECTION_LOST and not reaction.hold_limit:
        yield item.diagnostic(
            "il.not-lost-before",
            Message(
                "the reaction to {event} waits for connection_restored without a limit, "
                "which the robot reports only after the connection was lost",
                event=reaction.event,
            ),
            "wait for another event, or limit the wait (`hold_limit`)",
            ".until",
        )
    other = first.get(reaction.until) if reaction.until else None
    if (
        other
        and other.response is not Response.REPORT
        and other.urgency_score > reaction.urgency_score
    ):
        yield item.diagnostic(
            "il.until-answered",
            Message(
                "the reaction to {event} waits for {until}, which has a reaction of higher "
                "priority that is executed instead",
                event=reaction.event,
                until=reaction.until,
            ),
            "wait for another event, or give this reaction the higher priority",
            ".until",
        )


def _check_all_clear(item: CheckedItem, reaction: Reaction) -> Iterator[Diagnostic]:
    """Yield a diagnostic if the robot's own measurements may never end a wait for the all-clear."""
    event, response = reaction.event, reaction.response
    limit = Message(
        "limit the wait, such as `until all clear for at most 10 minutes` (`hold_limit`)"
    )
    if not _may_hold(response) or event in (EventKind.PLATFORM_ALARM, EventKind.ALL_CLEAR):
        return
    if event is not EventKind.GAS_LEAK:
        yield item.diagnostic(
            "il.all-clear-not-sensed",
            Message(
                "the reaction to {event} waits for all_clear without a limit, but the "
                "robot gives an all-clear only after a gas leak or the platform alarm: "
                "otherwise the wait lasts until somebody reports all_clear",
                event=event,
            ),
            limit,
            ".until",
        )
    elif response.drives:
        yield item.diagnostic(
            "il.all-clear-elsewhere",
            "the reaction to gas_leak drives away and waits for all_clear without a limit, but the "
            "robot gives the all-clear only where it has stood in the gas or has heard its hiss: "
            "if neither reaches the place of the wait, it lasts until somebody reports all_clear",
            Message(
                "{limit}, or wait where the leak is noticed, as by `pause until all clear`",
                limit=limit,
            ),
            ".until",
        )


def _may_hold(response: Response) -> bool:
    return response.drives or response is Response.PAUSE
