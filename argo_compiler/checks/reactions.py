"""Whether a mission's reactions say what to do, and whether all that they say has an effect."""

from collections.abc import Iterator

from argo_compiler.checks.about import About
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response
from argo_compiler.il.subjects import Subjects


def check_reactions(mission: Mission) -> Iterator[Diagnostic]:
    """All that is wrong or odd about a mission's reactions."""
    first: dict[EventKind, Reaction] = {}
    for reaction in mission.reactions:
        first.setdefault(reaction.event, reaction)
    subjects = Subjects(mission)
    ranked: dict[tuple[int, int], Reaction] = {}
    for i, reaction in enumerate(mission.reactions):
        about = About(subjects.reaction(i), reaction.source)
        if first[reaction.event] is not reaction:
            yield about.diagnostic(
                "il.duplicate-reaction",
                f"there is more than one reaction to {reaction.event}",
                "keep one reaction for each event",
                ".event",
            )
        yield from _check_places(about, reaction, mission)
        yield from _check_rank(about, reaction, ranked)
        if reaction.response is not Response.REPORT:
            ranked.setdefault(reaction.rank, reaction)
        yield from _check_battery(about, reaction)
        yield from _check_unused(about, reaction)
        if _may_hold(reaction.response) and reaction.until is not None:
            yield from _check_until(about, reaction, first)
        for field, event in (("event", reaction.event), ("until", reaction.until)):
            if event is EventKind.TIME_UP and mission.max_duration is None:
                yield about.diagnostic(
                    "il.time-up-without-limit",
                    f"the reaction to {reaction.event} waits for {event}, which never occurs: the "
                    "mission has no max_duration",
                    "give the mission a max_duration, or use another event",
                    f".{field}",
                )


def _check_places(about: About, reaction: Reaction, mission: Mission) -> Iterator[Diagnostic]:
    if reaction.response is Response.SAFE_AREA and reaction.pose is None:
        yield about.diagnostic(
            "il.safe-area-without-pose",
            f"the reaction to {reaction.event} does not say where the safe area is",
            "give the reaction a `pose`",
            ".response",
        )
    if reaction.response is Response.RETURN and mission.dock is None and reaction.pose is None:
        yield about.diagnostic(
            "il.no-dock",
            f"the robot is to return to the dock on {reaction.event}, but the mission has no dock",
            "give the mission the pose of its docking station as `dock`, or the reaction a `pose`",
            ".response",
        )


def _check_rank(
    about: About, reaction: Reaction, ranked: dict[tuple[int, int], Reaction]
) -> Iterator[Diagnostic]:
    """Of two reactions of one rank the later one waits; `ranked` are those that stand before."""
    other = ranked.get(reaction.rank)
    if (
        other is None
        or reaction.response in (Response.REPORT, Response.ABORT)
        or other.event is reaction.event
        or other.until is reaction.event
        or reaction.until is other.event
    ):
        return
    yield about.diagnostic(
        "il.equal-priority",
        f"the reactions to {other.event} and {reaction.event} have the same priority "
        f"{reaction.rank[1]}: the one whose event occurs later waits until the other is over",
        "give the more urgent one the higher priority",
        ".priority",
    )


def _check_battery(about: About, reaction: Reaction) -> Iterator[Diagnostic]:
    if reaction.battery_below is not None and reaction.event is not EventKind.LOW_BATTERY:
        yield about.diagnostic(
            "il.battery-level",
            f"the reaction to {reaction.event} has `battery_below`, and the battery has nothing to "
            "do with that event",
            f"remove it, or let the reaction answer {EventKind.LOW_BATTERY}",
            ".battery_below",
        )


def _check_unused(about: About, reaction: Reaction) -> Iterator[Diagnostic]:
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
        # That is what happens after a pause anyway.
        and not (response is Response.PAUSE and reaction.afterwards is Afterwards.RESUME),
    }
    for field in (field for field, given in unused.items() if given):
        yield about.diagnostic(
            "il.unused-field",
            f"the reaction to {reaction.event} has `{field}`, which has no effect on the response "
            f"{response}",
            "remove it or choose another response",
            f".{field}",
        )


def _check_until(
    about: About, reaction: Reaction, first: dict[EventKind, Reaction]
) -> Iterator[Diagnostic]:
    if reaction.until is reaction.event:
        yield about.diagnostic(
            "il.until-itself",
            f"the reaction to {reaction.event} waits for {reaction.event} itself, which changes "
            "nothing while it is active",
            "wait for an event that tells that it is over, such as all_clear",
            ".until",
        )
        return
    other = first.get(reaction.until) if reaction.until else None
    if other and other.response is not Response.REPORT and other.rank > reaction.rank:
        yield about.diagnostic(
            "il.until-answered",
            f"the reaction to {reaction.event} waits for {reaction.until}, which has a reaction of "
            "higher priority that is carried out instead",
            "wait for another event, or give this reaction the higher priority",
            ".until",
        )


def _may_hold(response: Response) -> bool:
    return response.drives or response is Response.PAUSE
