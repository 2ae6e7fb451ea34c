"""The canonical script's steps in order: tasks, patrols, and the steps that are repeated."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import field

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Diagnostic, Severity, Span
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Action, Group, Mission, Stop, Task, Transition, WaitRule
from argo_compiler.il.grouping import GroupNesting
from argo_compiler.script.write.conditions import conditions
from argo_compiler.script.write.tasks import Around, command, manners, step_of, ways
from argo_compiler.script.write.text import (
    Places,
    UnwritableError,
    capital,
    duration,
    quote,
    times,
)

_DOCK = re.compile(r"DOCK(?: \(\d+\))?")


@dataclass(frozen=True, slots=True)
class Said:
    """What is said of a part of a mission."""

    subject: str
    """the part, as diagnostics name it"""
    sentences: tuple[str, ...]
    """with line breaks where a line may be broken"""
    number: int | None = None
    """of the step"""
    source: Span | None = None
    about: tuple[Task | Group, ...] = ()


@dataclass
class StepsSaid:
    """The steps of a mission, and what they say of its header."""

    said: list[Said] = field(default_factory=list)
    orders: list[Said] = field(default_factory=list)
    """what has to come before what"""
    start_area: int | None = None
    end_area: int | None = None
    starts: bool = False
    """whether there is a START"""
    diagnostics: list[Diagnostic] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class _FloorPatrol:
    """A group that is the patrol of a floor."""

    index: int
    """of the group in the mission"""
    last: int
    """the position of its last task"""
    floor: int


def unwritable(what: str, subject: str, span: Span | None, error: UnwritableError) -> Diagnostic:
    """What is said of a part of a mission that a script can't say."""
    return Diagnostic(
        code="script.unwritable",
        severity=Severity.ERROR,
        message=f"{what} can't be written as a script: {error}",
        span=span,
        hint="store the mission as JSON, or change what is named here",
        subject=subject,
    )


def write_steps(mission: Mission, catalog: Catalog, places: Places) -> StepsSaid:
    """The steps of the mission's tasks and groups."""
    return _Writer(mission, catalog, places).write()


class _Writer:
    """Goes through the tasks, and writes a group as soon as its last task is written and the groups
    before it in the mission are."""

    def __init__(self, mission: Mission, catalog: Catalog, places: Places) -> None:
        self.ends = _unlisted_ends(mission, catalog)
        listed = tuple(task for task in mission.tasks if task.name not in self.ends)
        mission = mission.model_copy(update={"tasks": listed})
        self.mission = mission
        self.tasks = listed
        self.catalog = catalog
        self.places = places
        self.layout = GroupNesting.from_mission(mission)
        self.result = StepsSaid()
        self.usual = _usual_names(mission, self._docks())
        self.patrols = _patrols(mission, catalog, self.layout, self.usual)
        self.order = list(self._order())
        first_of = {id(patrol): first for first, patrol in self.patrols.items()}
        self.steps = {
            self.tasks[one if isinstance(one, int) else first_of[id(one)]].name: number
            for number, one in enumerate(self.order, start=1)
            if isinstance(one, int | _FloorPatrol)
        }
        self.following = _following(mission.tasks)
        self.names = _RoundNames(self.layout)

    def _order(self) -> Iterator[int | _FloorPatrol | Group]:
        """What the steps are of: tasks by their position, patrols and groups."""
        last = {r.index: r.last for r in self.layout.ranges}
        written = i = 0
        while i < len(self.tasks):
            patrol = self.patrols.get(i)
            if patrol is not None:
                written = patrol.index + 1
                yield patrol
                i = patrol.last
            else:
                yield i
            i += 1
            while written < len(self.mission.groups) and last[written] < i:
                yield self.mission.groups[written]
                written += 1

    def write(self) -> StepsSaid:
        groups = {id(group): k for k, group in enumerate(self.mission.groups)}
        for number, one in enumerate(self.order, start=1):
            part: Task | Group
            if isinstance(one, int):
                part, kind, of = self.tasks[one], "tasks", "task"
            else:
                index = one.index if isinstance(one, _FloorPatrol) else groups[id(one)]
                part, kind, of = self.mission.groups[index], "groups", "group"
            subject = subject_of(kind, part.name)
            try:
                if isinstance(one, int):
                    sentences = tuple(self._task(one))
                elif isinstance(one, _FloorPatrol):
                    sentences = (self._patrol(one),)
                else:
                    sentences = (self._repeat(groups[id(one)], one),)
            except UnwritableError as error:
                found = unwritable(f"{of} '{part.name}'", subject, part.source, error)
                self.result.diagnostics.append(found)
                continue
            said = tuple(map(capital, sentences))
            self.result.said.append(Said(subject, said, number, part.source, (part,)))
        for first, second in dict.fromkeys(self.mission.before):
            before, after = (step_of(name, self.steps) for name in (first, second))
            sentence = f"Always do {before} before {after}"
            self.result.orders.append(Said("before", (sentence,)))
        return self.result

    # ---- tasks

    def _task(self, i: int) -> Iterator[str]:
        task = self.tasks[i]
        said = self._command(i, task)
        if not self.usual[i]:
            said = f"{quote(task.name)}:\n{said}"
        inner = self.layout.innermost[i]
        group = "" if inner is None else self.layout.ranges[inner].group.name
        yield ",\n".join([said, *manners(task, group)])
        ends_round = bool(self.layout.ending[i])
        yield from ways(task, Around(self.following[i], ends_round, self.steps, self.ends))

    def _command(self, i: int, task: Task) -> str:
        if task.action is Action.START:
            self.result.starts = True
            return self._start(i, task)
        if i in self._docks():
            self.result.end_area = self.mission.end_area
            return f"return to the docking station in starting area {self.mission.end_area}"
        return command(task, self.places)

    def _start(self, i: int, task: Task) -> str:
        """Where the mission starts; `here` keeps it where it stands, and what is said of it."""
        number = self.mission.start_area
        area = None if number is None else self.catalog.area(number)
        plain = _is_plain(task, Action.START, task.pose, self.following[i])
        if i == 0 < len(self.tasks) - 1 and plain and self.following[i] is not None:
            if area is not None and task.pose == area.dock:
                self.result.start_area = number
                return f"set the starting point in starting area {number}"
            name = None if task.pose is None else self.places.name(task.pose)
            if name is not None:
                return f"set the starting point at {name}"
        return command(task, self.places)

    def _docks(self) -> tuple[int, ...]:
        """The last task, if the mission ends with it in the docking station of its end area."""
        number = self.mission.end_area
        area = None if number is None else self.catalog.area(number)
        if area is None or not self.tasks:
            return ()
        task = self.tasks[-1].model_copy(update={"velocity": None})
        plain = task.name == "DOCK" and _is_plain(task, Action.WAYPOINT, area.dock)
        return (len(self.tasks) - 1,) if plain and not self.layout.ending[-1] else ()

    # ---- groups

    def _patrol(self, patrol: _FloorPatrol) -> str:
        group = self.mission.groups[patrol.index]
        base = f"Patrol floor {patrol.floor}"
        name = self.names.own(patrol.index, base)
        said = f"patrol floor {patrol.floor}\n{_limits(group)}"
        return said if name is None else f"{quote(name)}:\n{said}"

    def _repeat(self, index: int, group: Group) -> str:
        points = dict.fromkeys((group.start, group.end))
        said = [step_of(name, self.steps).removeprefix("step ") for name in points]
        base = f"Repeat {' to '.join(str(self.steps.get(p, p)) for p in points)}".replace("/", "-")
        name = self.names.own(index, base)
        steps = "step" if len(said) == 1 else "steps"
        opening = "repeat" if name is None else f"{quote(name)}:\nrepeat"
        return f"{opening} {steps} {' to '.join(said)} {_limits(group)}"


def _is_plain(
    task: Task,
    action: Action,
    pose: Pose | None,
    following: str | None = None,
    group: str = "",
    wait: WaitRule | None = None,
) -> bool:
    """Whether nothing else is said of a task than this, and that another one follows."""
    return task == Task(
        name=task.name,
        action=action,
        pose=pose,
        group=group,
        wait=wait,
        transitions=() if following is None else (Transition(target=following),),
        source=task.source,
    )


def _following(tasks: tuple[Task, ...]) -> list[str | None]:
    """For each task, the next one that is not START; a START that leads elsewhere is in the way."""
    following: list[str | None] = []
    name = None
    for task in reversed(tasks):
        following.append(name)
        usual = () if name is None else (Transition(target=name),)
        if task.action is not Action.START or task.transitions != usual:
            name = task.name
    return following[::-1]


def _usual_names(mission: Mission, docks: tuple[int, ...]) -> list[bool]:
    """Whether each task is called as a script calls it that gives it no name."""
    used: Counter[str] = Counter()
    found = []
    for i, task in enumerate(mission.tasks):
        base = "DOCK" if i in docks else _base(task)
        count = used[base] + 1
        usual = f"{base} {count}" if base == Action.WAYPOINT else base
        if base != Action.WAYPOINT and count > 1:
            usual = f"{base} ({count})"
        # A task of another name does not count; see the assembly of a plan.
        found.append(task.name == usual)
        used[base] += task.name == usual
    return found


def _base(task: Task) -> str:
    if task.action is Action.MEASURE:
        return f"MEASURE {task.object_id}"
    if task.action is Action.WAIT and task.wait is not None and task.wait.duration == 0:
        return "MEET"
    return str(task.action)


# ---- what is repeated: patrols of floors, and rounds of steps


def _limits(group: Group) -> str:
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


class _RoundNames:
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


def _patrols(
    mission: Mission, catalog: Catalog, layout: GroupNesting, usual: list[bool]
) -> dict[int, _FloorPatrol]:
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
    found: dict[int, _FloorPatrol] = {}
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
            found[r.first] = _FloorPatrol(index, r.last, number)
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
    following = next((t.name for t in tasks[i + 1 :] if t.action is not Action.START), None)
    return _is_plain(tasks[i], Action.WAYPOINT, tasks[i].pose, following, group)


# ---- the tasks that end a mission in some cases only: a script says that in words, without a step


def _unlisted_ends(mission: Mission, catalog: Catalog) -> dict[str, str]:
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
    ends = _is_plain(task, Action.WAIT, None, wait=WaitRule(duration=0))
    if last and ends and task.name == "END":
        return "end the mission"
    area = next((area for area in catalog.areas if area.dock == task.pose), None)
    plain = _is_plain(task, Action.WAYPOINT, task.pose)
    if area is None or not plain or not _DOCK.fullmatch(task.name):
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
