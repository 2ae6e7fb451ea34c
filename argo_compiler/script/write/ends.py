"""The tasks that end a mission in some cases only: a script says that in words, without a step."""

import re
from collections.abc import Iterator

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Action, Mission, Task, Transition, WaitRule

_DOCK = re.compile(r"DOCK(?: \(\d+\))?")


def unlisted_ends(mission: Mission, catalog: Catalog) -> dict[str, str]:
    """The last tasks to which only conditions lead, and the words for going there: all those that
    a script which says so gets at its end, with these names and in this order; else none."""
    led, named = _led_to(mission), _named(mission)
    found: dict[str, str] = {}
    kept = list(mission.tasks)
    while kept and kept[-1].name in led and kept[-1].name not in named:
        words = _words(kept[-1], catalog, last=not found)
        if words is None:
            break
        found[kept.pop().name] = words
    homes = [task for task in mission.tasks[len(kept) :] if task.action is Action.WAYPOINT]
    others = [task for task in kept if _DOCK.fullmatch(task.name)]
    if not kept or others not in ([], kept[-1:]) or len({*found.values()}) < len(found):
        return {}
    if any(task.pose in [other.pose for other in others] for task in homes):
        return {}
    first = len(others) + 1
    numbered = ["DOCK" if n == 1 else f"DOCK ({n})" for n in range(first, first + len(homes))]
    names = [name for name in led if name in {task.name for task in homes}]
    return found if [task.name for task in homes] == names == numbered else {}


def _words(task: Task, catalog: Catalog, last: bool) -> str | None:
    """The words for going to a task; None if it is no end that conditions make."""
    end = Task(name="END", action=Action.WAIT, wait=WaitRule(duration=0), source=task.source)
    if last and task == end:
        return "end the mission"
    area = next((area for area in catalog.areas if area.dock == task.pose), None)
    home = Task(name=task.name, action=Action.WAYPOINT, pose=task.pose, source=task.source)
    if area is None or task != home or not _DOCK.fullmatch(task.name):
        return None
    return f"return to the docking station in starting area {area.number}"


def _led_to(mission: Mission) -> dict[str, None]:
    """The tasks to which conditions lead, in the order in which they do first."""
    ways = [t for task in mission.tasks for t in task.transitions if _is_said(t, task)]
    return dict.fromkeys(t.target for t in ways)


def _is_said(transition: Transition, task: Task) -> bool:
    """Whether a way is one of those that are said in a sentence with a condition."""
    if transition.conditions:
        return True
    otherwise = transition is task.transitions[-1] and transition.target != "END"
    return otherwise and len(task.transitions) > 1


def _named(mission: Mission) -> set[str]:
    """The tasks that are led to or named in other ways."""

    def names() -> Iterator[str | None]:
        ends = {group.end for group in mission.groups}
        yield from ends
        yield from (group.start for group in mission.groups)
        yield from (name for pair in mission.before for name in pair)
        yield from (mission.current, *mission.left_out)
        for task in mission.tasks:
            yield task.failure_target
            yield task.window.missed_target if task.window is not None else None
            for transition in task.transitions:
                plain = not transition.conditions and task.name in ends
                if plain or not _is_said(transition, task):
                    yield transition.target

    return {name for name in names() if name is not None}
