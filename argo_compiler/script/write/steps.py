"""The canonical script's steps in order: tasks, patrols, and the lines that repeat steps."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from argo_compiler.catalog import Catalog
from argo_compiler.diagnostics import Diagnostic, Severity, Span
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Action, Group, Mission, Stop, Task, Transition
from argo_compiler.il.grouping import GroupNesting
from argo_compiler.model import Pose
from argo_compiler.script.write.sayable import require_sayable
from argo_compiler.script.write.tasks import (
    Places,
    TaskContext,
    clauses,
    command,
)
from argo_compiler.script.write.text import (
    UnwritableError,
    duration,
    point,
    quote,
    statement,
    times,
)

SAID = frozenset(
    [
        "name",
        "start",
        "end",
        "max_repeat_count",
        "max_repeat_duration",
        "count_interruptions",
        "stop",
        "source",
    ]
)
"""the fields of a group that a script can say"""


@dataclass
class Steps:
    """The steps of a mission, and what they say of its header."""

    lines: list[str] = field(default_factory=list)
    rounds: list[str] = field(default_factory=list)
    """the lines that repeat steps and stand behind all of them"""
    start_area: int | None = None
    end_area: int | None = None
    starts: bool = False
    """whether there is a START"""
    diagnostics: list[Diagnostic] = field(default_factory=list)


def unwritable(what: str, subject: str, span: Span | None, error: UnwritableError) -> Diagnostic:
    """What is said of a part of a mission that a script can't say."""
    return Diagnostic(
        code="script.unwritable",
        severity=Severity.ERROR,
        message=f"{what} can't be written as a script: {error}",
        span=span,
        hint="keep the mission as JSON, or change what is named here",
        subject=subject,
    )


@dataclass(frozen=True)
class _Patrol:
    """A group that is the patrol of a floor."""

    index: int
    """of the group in the mission"""
    last: int
    """the position of its last task"""
    floor: int


def write_steps(mission: Mission, catalog: Catalog, places: Places) -> Steps:
    """The steps of the mission's tasks and groups."""
    return _Writer(mission, catalog, places).write()


class _Writer:
    """Goes through the tasks, and writes a group where its place among the groups comes."""

    def __init__(self, mission: Mission, catalog: Catalog, places: Places) -> None:
        self.mission = mission
        self.tasks = mission.tasks
        self.catalog = catalog
        self.places = places
        self.layout = GroupNesting.of(mission)
        self.result = Steps()
        self.defaults = _default_names(mission.tasks)
        self.number = 0
        self.steps: dict[str, int] = {}
        self.places_of = {r.index: place for place, r in enumerate(self.layout.ranges)}
        self.following = _following(mission.tasks)
        self.used: Counter[str] = Counter()
        self.written = 0
        """groups, in the mission's order"""

    def write(self) -> Steps:
        patrols = self._patrols()
        self._number_steps(patrols)
        i = 0
        while i < len(self.tasks):
            patrol = patrols.get(i)
            try:
                if patrol is not None:
                    self._write_patrol(patrol)
                else:
                    self._write_task(i)
            except UnwritableError as error:
                task = self.tasks[i]
                found = unwritable(
                    f"task '{task.name}'", subject_of("tasks", task.name), task.source, error
                )
                self.result.diagnostics.append(found)
            i = patrol.last + 1 if patrol is not None else i + 1
        self.result.rounds += self._repeats(len(self.mission.groups))
        return self.result

    # ---- tasks

    def _number_steps(self, patrols: dict[int, "_Patrol"]) -> None:
        """The steps of those tasks that are called as a reader expects: others go by name."""
        i = step = 0
        while i < len(self.tasks):
            step += 1
            if self.defaults[i]:
                self.steps[self.tasks[i].name] = step
            i = patrols[i].last + 1 if i in patrols else i + 1

    def _around(self, i: int) -> TaskContext:
        inner = self.layout.innermost[i]
        group = "" if inner is None else self.layout.ranges[inner].group.name
        return TaskContext(self.following[i], group, bool(self.layout.ending[i]), self.steps)

    def _write_task(self, i: int) -> None:
        task = self.tasks[i]
        said, named = self._command(i, task)
        self._step(said, None if named else task.name, clauses(task, self._around(i)))

    def _step(self, said: str, name: str | None, rest: Iterable[str]) -> None:
        said = said[0].upper() + said[1:] if name is None else f"{quote(name)}:\n{said}"
        self.number += 1
        self.result.lines += statement(f"{self.number}. {said}", rest)

    def _command(self, i: int, task: Task) -> tuple[str, bool]:
        """What the task does, and whether that gives it its name."""
        if task.action is Action.START:
            self.result.starts = True
            return self._start(i, task), task.name == "START"
        area = self._dock_area(i, task)
        if area is not None:
            self.result.end_area = area
            return f"return to the docking station in starting area {area}", True
        return command(task, self.places), self.defaults[i]

    def _start(self, i: int, task: Task) -> str:
        number = self.mission.start_area
        area = None if number is None else self.catalog.area(number)
        if i == 0 < len(self.tasks) - 1 and area is not None and task.pose == area.dock:
            self.result.start_area = number
            return f"set the starting point in starting area {number}"
        if task.pose is None:
            return "start here"
        if i > 0 or task.name != "START" or len(self.tasks) == 1:
            return f"start here at {point(task.pose)}"
        # Named by its area, it would set the mission's `start_area`.
        return f"set the starting point at {self.places.name(task.pose) or point(task.pose)}"

    def _dock_area(self, i: int, task: Task) -> int | None:
        """The area in whose docking station the mission ends with this task."""
        number = self.mission.end_area
        area = None if number is None else self.catalog.area(number)
        last = i + 1 == len(self.tasks) and task.action is Action.WAYPOINT
        found = last and task.name == "DOCK" and area is not None and task.pose == area.dock
        return number if found else None

    # ---- groups

    def _patrols(self) -> dict[int, "_Patrol"]:
        """The groups that can be written as the patrol of a floor, by their first task.

        A patrol stands where its tasks do, so that the groups before it must end before it.
        """
        floors: dict[tuple[Pose | None, ...], int] = {}
        for floor in self.catalog.floors:
            floors.setdefault(floor.patrol, floor.number)
        longest = max((len(poses) for poses in floors), default=0)
        found: dict[int, _Patrol] = {}
        furthest = -1
        for index, group in enumerate(self.mission.groups):
            place = self.places_of[index]
            r = self.layout.ranges[place]
            before, furthest = furthest, max(furthest, r.last)
            limited = group.max_repeat_count or group.max_repeat_duration
            limited = limited and not (group.every or group.until)
            if before >= r.first or r.last - r.first >= longest or not limited:
                continue
            number = floors.get(tuple(task.pose for task in self.tasks[r.first : r.last + 1]))
            if number is None or not self._is_round(place):
                continue
            found[r.first] = _Patrol(index, r.last, number)
        return found

    def _group_name(self, index: int, base: str) -> str | None:
        """The name that the group must be given; None if it is called so without."""
        place = self.places_of[index]
        r, parent = self.layout.ranges[place], self.layout.parent[place]
        default = f"{base} ({self.used[base] + 1})" if self.used[base] else base
        if parent is not None:
            around = self.layout.ranges[parent]
            if (around.first, around.last) == (r.first, r.last):
                return r.group.name
            default = f"{around.group.name}/{default}"
        if r.group.name != default:
            return r.group.name
        self.used[base] += 1
        return None

    def _is_round(self, place: int) -> bool:
        """Whether the tasks have nothing that those of a patrol don't have."""
        r = self.layout.ranges[place]
        for i in range(r.first, r.last + 1):
            task, following = self.tasks[i], self.following[i]
            plain = Task(
                name=task.name,
                action=Action.WAYPOINT,
                group=r.group.name,
                pose=task.pose,
                transitions=() if following is None else (Transition(target=following),),
                source=task.source,
            )
            if task != plain or not self.defaults[i] or self.layout.innermost[i] != place:
                return False
        return True

    def _write_patrol(self, patrol: "_Patrol") -> None:
        self.result.lines += self._repeats(patrol.index)
        self.written = patrol.index + 1
        group = self.mission.groups[patrol.index]
        said = f"patrol floor {patrol.floor}\n{_limits(group)}"
        self._step(said, self._group_name(patrol.index, f"Patrol floor {patrol.floor}"), ())

    def _repeats(self, end: int) -> list[str]:
        """The lines for the groups before the one of that index that are not written yet."""
        lines: list[str] = []
        for index in range(self.written, end):
            group = self.mission.groups[index]
            try:
                lines += statement(self._repeat(index, group))
            except UnwritableError as error:
                at = subject_of("groups", group.name)
                found = unwritable(f"group '{group.name}'", at, group.source, error)
                self.result.diagnostics.append(found)
        self.written = end
        return lines

    def _repeat(self, index: int, group: Group) -> str:
        require_sayable(group, SAID)
        points = [self.steps.get(name, name) for name in dict.fromkeys((group.start, group.end))]
        base = f"Repeat {' to '.join(map(str, points))}".replace("/", "-")
        name = self._group_name(index, base)
        steps = "step" if len(points) == 1 else "steps"
        said = "\nto ".join(quote(p) if isinstance(p, str) else str(p) for p in points)
        opening = "Repeat" if name is None else f"{quote(name)}:\nrepeat"
        return f"{opening} {steps} {said}\n{_limits(group)}"


def _limits(group: Group) -> str:
    """How often and how long: `for 10 min or 3 times,\nfinishing the round`."""
    said = []
    if group.max_repeat_duration:
        said.append(f"for {duration(group.max_repeat_duration)}")
    if group.max_repeat_count:
        said.append(times(group.max_repeat_count))
    text = " or ".join(said) or "endlessly"
    if group.stop is Stop.SOFT:
        text += ",\nfinishing the round"
    if group.count_interruptions:
        text += ",\ninterruptions included"
    return text


def _following(tasks: tuple[Task, ...]) -> list[str | None]:
    """For each task, the next one that is not START."""
    following: list[str | None] = []
    name = None
    for task in reversed(tasks):
        following.append(name)
        if task.action is not Action.START:
            name = task.name
    return following[::-1]


def _default_names(tasks: tuple[Task, ...]) -> list[bool]:
    """Whether each task is called as a script calls it that gives it no name."""
    used: Counter[str] = Counter()
    found = []
    for task in tasks:
        if task.action is Action.WAIT:
            found.append(False)  # a person gives it a name of its own
            continue
        if task.action is Action.WAYPOINT:
            base, default = "WAYPOINT", f"WAYPOINT {used['WAYPOINT'] + 1}"
        else:
            base = "START" if task.action is Action.START else f"MEASURE {task.object_id}"
            default = f"{base} ({used[base] + 1})" if used[base] else base
        # A task of another name does not count; see the assembly of a plan.
        found.append(task.name == default)
        used[base] += task.name == default
    return found
