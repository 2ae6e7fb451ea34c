"""How the canonical script says reactions."""

from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_compiler.script.write.conditions import event
from argo_compiler.script.write.places import Places
from argo_compiler.script.write.text import UnwritableError, duration, number, point

_RESPONSES = {
    Response.REPORT: "report it",
    Response.PAUSE: "pause",
    Response.ABORT: "abort the mission",
}
_ON_LIMIT = {
    Afterwards.RESUME: "resume",
    Afterwards.END: "end the mission",
    Afterwards.WAIT: "wait",
}
_AFTERWARDS = {
    Afterwards.RESUME: "and resume",
    Afterwards.WAIT: "and wait for the operator",
}
_DRIVES = (Response.RETURN, Response.SAFE_AREA)


def reaction_said(reaction: Reaction, places: Places) -> str:
    """`if a gas leak is detected, return to the docking station`"""
    _require_used(reaction)
    clauses = [f"if {_occurs(reaction)}", _response(reaction, places)]
    holding = _holding(reaction)
    if holding and reaction.until is not None and reaction.response in _DRIVES:
        clauses.append(f"wait {holding}")
    elif holding:
        clauses[-1] += f" {holding}"
    if reaction.priority is not None:
        clauses.append(f"with priority {reaction.priority}")
    if reaction.afterwards is not Afterwards.END:
        clauses.append(_AFTERWARDS[reaction.afterwards])
    return ",\n".join(clauses)


def _occurs(reaction: Reaction) -> str:
    level = reaction.battery_below
    if level is None:
        return event(reaction.event)
    percent = next((p for p in (level * 100, round(level * 100, 9)) if p / 100 == level), None)
    if percent is None or reaction.event is not EventKind.LOW_BATTERY:
        raise UnwritableError("this level of the battery is no number of percent: `battery_below`")
    return f"the battery drops below {number(percent)} %"


def _holding(reaction: Reaction) -> str:
    """What it waits for, for how long, and what it does then."""
    said = []
    if reaction.until is not None:
        said.append(f"until {event(reaction.until)}")
    if reaction.hold_limit is not None:
        said.append(f"for at most {duration(reaction.hold_limit)}")
    if reaction.hold_limit is not None or reaction.on_limit is not Afterwards.WAIT:
        said.append(f"or else {_ON_LIMIT[reaction.on_limit]}")
    return " ".join(said)


def _response(reaction: Reaction, places: Places) -> str:
    pose, area = reaction.pose, reaction.area
    if reaction.response is Response.SAFE_AREA:
        if pose is None:
            raise UnwritableError("it has no pose")
        return f"go to {places.location(pose)}"
    if reaction.response is not Response.RETURN:
        return _RESPONSES[reaction.response]
    said = "return to the docking station"
    dock = None
    if area is not None:
        dock = places.dock(area)
        if dock is None or pose is None:
            raise UnwritableError(f"there is no docking station that is meant by area {area}")
        said += f" in starting area {area}"
    return said if pose == dock else f"{said}, standing at {point(pose)}" if pose else said


def _require_used(reaction: Reaction) -> None:
    """That nothing is said that has no effect on the response. Raises UnwritableError."""
    unused = {
        "pose": reaction.pose is not None and reaction.response not in _DRIVES,
        "area": reaction.area is not None and reaction.response is not Response.RETURN,
        "hold_limit": reaction.hold_limit is not None
        and reaction.response in _DRIVES
        and reaction.until is None,
    }
    if reaction.response in (Response.REPORT, Response.ABORT):
        unused |= {
            "until": reaction.until is not None,
            "afterwards": reaction.afterwards is not Afterwards.END,
            "hold_limit": reaction.hold_limit is not None,
            "on_limit": reaction.on_limit is not Afterwards.WAIT,
        }
    names = [f"`{name}`" for name, given in unused.items() if given]
    if reaction.response is Response.PAUSE and reaction.afterwards is Afterwards.WAIT:
        names.append("`afterwards`")
    if names:
        raise UnwritableError(f"{', '.join(names)} has no effect on what it does")
