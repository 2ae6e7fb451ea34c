"""Independent check of the rules of docs/language.md that every mission keeps.

It shares no code with the package, so the code that makes an edit does not judge it.
"""

from collections import Counter

from argo_compiler.il import Action, EventKind, Mission, OnFailure, Response


def broken_rules(mission: Mission) -> Counter[str]:
    """Return the rules that a mission breaks, and how often it breaks each."""
    return Counter([*_tasks(mission), *_groups(mission), *_reactions(mission)])


def _tasks(mission):
    names = [t.name for t in mission.tasks]
    starts = {t.name for t in mission.tasks if t.action is Action.START}
    machine = {"return to dock", *(f"react to {event}" for event in EventKind)}
    yield from ["no task"] * (not names)
    yield from ["task named twice"] * (len(names) - len(set(names)))
    yield from ["more than one START"] * (sum(t.action is Action.START for t in mission.tasks) > 1)
    for t in mission.tasks:
        yield from ["task without a name"] * (t.name == "")
        yield from ["name of the machine"] * (t.name in machine)
        yield from ["measures nothing"] * (t.action is Action.MEASURE and t.object_id is None)
        yield from ["leads nowhere"] * (t.action is Action.WAYPOINT and t.pose is None)
        yield from ["two ways without condition"] * (
            sum(not w.conditions for w in t.transitions) > 1
        )
        yield from ["no dock"] * (t.on_failure is OnFailure.RETURN and mission.dock is None)
        branches = t.on_failure is OnFailure.BRANCH
        yield from ["fails to nowhere"] * (branches and t.failure_target is None)
        yield from ["waits for nothing"] * (t.action is Action.WAIT and not _waits(t.wait))
        window = t.window
        late = window is not None and window.latest is not None
        yield from ["no time in its window"] * (late and window.latest <= window.earliest)
        for target in (t.failure_target, window.missed_target if window else None):
            yield from ["to nowhere"] * (target is not None and target not in names)
            yield from ["to START"] * (target in starts)
        for way in t.transitions:
            yield from ["to nowhere"] * (way.target not in names)
            yield from ["to START"] * (way.target in starts)


def _waits(wait):
    if wait is None:
        return False
    return (wait.duration is None) == (wait.event is not None or bool(wait.conditions))


def _groups(mission):
    names = [t.name for t in mission.tasks]
    yield from ["group named twice"] * (len(mission.groups) - len({g.name for g in mission.groups}))
    ranges = []
    for g in mission.groups:
        parts = g.name.split("/")
        yield from ["empty part of a group's name"] * ("" in parts)
        outer = "/".join(parts[:-1])
        yield from ["no group around"] * bool(
            outer and all(o.name != outer for o in mission.groups)
        )
        if g.start not in names or g.end not in names:
            yield "group without its tasks"
            continue
        first, last = names.index(g.start), names.index(g.end)
        yield from ["group in the wrong order"] * (first > last)
        inside = mission.tasks[first : last + 1]
        yield from ["START in a group"] * any(t.action is Action.START for t in inside)
        ranges.append((g.name, first, last))
    for name, first, last in ranges:
        for other, start, end in ranges:
            if other == name:
                continue
            if other.startswith(name + "/"):
                yield from ["outside of its group"] * (not first <= start <= end <= last)
            elif not name.startswith(other + "/"):
                yield from ["groups overlap"] * (start <= last and first <= end)


def _reactions(mission):
    events = [r.event for r in mission.reactions]
    yield from ["two reactions"] * (len(events) - len(set(events)))
    for r in mission.reactions:
        yield from ["no safe area"] * (r.response is Response.SAFE_AREA and r.pose is None)
        yield from ["no dock"] * (r.response is Response.RETURN and mission.dock is r.pose is None)
