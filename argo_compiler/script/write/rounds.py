"""How the canonical script says what is repeated: patrols of floors, and rounds of steps."""

from collections import Counter
from dataclasses import dataclass

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Group, Mission, Stop, Task, Transition
from argo_compiler.il.grouping import GroupNesting
from argo_compiler.script.write.conditions import conditions
from argo_compiler.script.write.text import duration, times


@dataclass(frozen=True, slots=True)
class FloorPatrol:
    """A group that is the patrol of a floor."""

    index: int
    """of the group in the mission"""
    last: int
    """the position of its last task"""
    floor: int


def limits(group: Group) -> str:
    """How often and how long: `for 10 minutes or 3 times,\nfinishing the round`."""
    said = []
    if group.max_repeat_duration:
        said.append(f"for {duration(group.max_repeat_duration)}")
    if group.max_repeat_count:
        once = group.max_repeat_count == 1  # `repeat once` would be once more
        said.append("once in total" if once else times(group.max_repeat_count))
    if group.until:
        said.append(f"until {conditions(group.until)}")
    text = " or\n".join(said) or "endlessly"
    if group.every:
        text = f"every {duration(group.every)}, {text}"
    if group.stop is Stop.SOFT:
        text += ",\nfinishing the round"
    if group.count_interruptions:
        text += ",\ninterruptions included"
    return text


class RoundNames:
    """Which groups are called as a script calls them that gives them no name. Mutable: groups are
    asked for in the mission's order."""

    def __init__(self, layout: GroupNesting) -> None:
        self.layout = layout
        self.places = {r.index: place for place, r in enumerate(layout.ranges)}
        self.used: Counter[str] = Counter()
        self.twice = {
            (r.first, r.last)
            for r, parent in zip(layout.ranges, layout.parent, strict=True)
            if parent is not None
            and (r.first, r.last) == (layout.ranges[parent].first, layout.ranges[parent].last)
        }
        """ranges of groups of which one lies in the other: their names tell which"""

    def own(self, index: int, base: str) -> str | None:
        """The name that the group must be given; None if it is called so without."""
        place = self.places[index]
        r, parent = self.layout.ranges[place], self.layout.parent[place]
        default = f"{base} ({self.used[base] + 1})" if self.used[base] else base
        if parent is not None:
            default = f"{self.layout.ranges[parent].group.name}/{default}"
        if r.group.name != default or (r.first, r.last) in self.twice:
            return r.group.name
        self.used[base] += 1
        return None


def patrols(
    mission: Mission, catalog: Catalog, layout: GroupNesting, usual: list[bool]
) -> dict[int, FloorPatrol]:
    """The groups that can be written as the patrol of a floor, by their first task. `usual` tells
    which tasks are called as a script calls them.

    A patrol stands where its tasks do, so that the groups before it must end before it.
    """
    floors: dict[tuple[Pose | None, ...], int] = {}
    for floor in catalog.floors:
        floors.setdefault(floor.patrol, floor.number)
    longest = max((len(poses) for poses in floors), default=0)
    places = {r.index: place for place, r in enumerate(layout.ranges)}
    targets = _targets(mission)
    found: dict[int, FloorPatrol] = {}
    furthest = -1
    for index, group in enumerate(mission.groups):
        place = places[index]
        r = layout.ranges[place]
        before, furthest = furthest, max(furthest, r.last)
        limited = group.max_repeat_count or group.max_repeat_duration or group.until
        if before >= r.first or r.last - r.first >= longest or not limited:
            continue
        tasks = mission.tasks[r.first : r.last + 1]
        number = floors.get(tuple(task.pose for task in tasks))
        if number is None or any(task.name in targets for task in tasks[1:]):
            continue
        whole = range(r.first, r.last + 1)
        if all(usual[i] and layout.innermost[i] == place for i in whole) and all(
            _is_stop(mission.tasks, i, group.name) for i in whole
        ):
            found[r.first] = FloorPatrol(index, r.last, number)
    return found


def _targets(mission: Mission) -> set[str]:
    """The tasks that are led to from elsewhere than the task before them, or named."""
    found = {mission.tasks[0].name} if mission.tasks else set()
    found |= {name for pair in mission.before for name in pair}
    for i, task in enumerate(mission.tasks):
        following = mission.tasks[i + 1].name if i + 1 < len(mission.tasks) else None
        ways = {t.target for t in task.transitions if t.conditions or t.target != following}
        found |= ways | {task.failure_target or ""}
        found.add((task.window.missed_target if task.window is not None else None) or "")
    return found


def _is_stop(tasks: tuple[Task, ...], i: int, group: str) -> bool:
    """Whether a task has nothing that those of a patrol don't have."""
    task = tasks[i]
    following = next((t.name for t in tasks[i + 1 :] if t.action is not Action.START), None)
    return task == Task(
        name=task.name,
        action=Action.WAYPOINT,
        group=group,
        pose=task.pose,
        transitions=() if following is None else (Transition(target=following),),
        source=task.source,
    )
