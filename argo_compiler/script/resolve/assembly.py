"""From a plan to the tasks and groups of a mission: names, transitions, nesting."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Group, Stop, Task, Transition
from argo_compiler.listing import listed
from argo_compiler.script.resolve.plan import (
    MEETING,
    Home,
    Item,
    Plan,
    PlannedGroup,
    ResolvedBranch,
)
from argo_compiler.script.resolve.rounds import PlannedRange, close_rounds
from argo_compiler.script.syntax.commands import Plain
from argo_compiler.script.syntax.source import Diagnostics
from argo_compiler.script.syntax.spelling import nearest
from argo_compiler.script.syntax.terms import StepRef

Steps = Mapping[int, Sequence[Item] | None]
"""the items that each step planned; None for a number that more than one step has"""


def assemble(
    plan: Plan, diagnostics: Diagnostics, steps: Steps | None = None
) -> tuple[tuple[Task, ...], tuple[Group, ...]]:
    """The tasks and groups of a plan whose home drives have been planned.

    Waypoints are numbered through; of other names the second is `MEASURE 4 (2)`. Linear time but
    for the names of groups, which are as long as the groups are deep.
    """
    return _Assembly(plan, diagnostics, steps or {}).result()


_DEEPEST = 500
"""repetitions in one another; the name of each has those of all around it"""


class _Assembly:
    """A plan on its way to tasks and groups."""

    def __init__(self, plan: Plan, diagnostics: Diagnostics, steps: Steps) -> None:
        self.plan = plan
        self.diagnostics = diagnostics
        self.steps = steps
        self._take_stock()

    def _take_stock(self) -> None:
        """The items of the plan as it is now, with their names."""
        self.items = list(self.plan)
        self.at = {id(item): i for i, item in enumerate(self.items)}
        self.names = self._name_tasks()
        self.by_name: dict[str, int] = {}
        for i, name in enumerate(self.names):
            self.by_name.setdefault(name, i)

    def result(self) -> tuple[tuple[Task, ...], tuple[Group, ...]]:
        ranges = [r for i, round_ in enumerate(self.plan.rounds) if (r := self._range(i, round_))]
        before = len(self.items)
        self.following = close_rounds(self.plan, ranges, self.diagnostics)
        if len(self.following) > before:
            self._take_stock()
        shown = self._nest(ranges)
        ways = [self._transitions(item) for item in self.items]
        speeds = self._speeds(ways, ranges)
        tasks = tuple(
            self._task(i, item, shown[i], ways[i], speeds[i]) for i, item in enumerate(self.items)
        )
        groups = tuple(
            Group(
                name=r.name,
                start=self.names[r.first],
                end=self.names[r.last],
                max_repeat_count=r.round.limits.count,
                max_repeat_duration=r.round.limits.duration,
                count_interruptions=r.round.limits.count_interruptions,
                stop=Stop.SOFT if r.round.limits.soft else Stop.HARD,
                source=r.round.span,
            )
            for r in ranges
        )
        return tasks, groups

    # ---- names

    def _name_tasks(self) -> list[str]:
        own: dict[str, Item] = {}
        for item in self.items:
            if item.name is None:
                continue
            if item.name in own:
                message = f"more than one task is named `{item.name}`"
                hint = "give each task a name of its own"
                self.diagnostics.error("repeated-name", message, item.source, hint)
            own[item.name] = item
        used: Counter[str] = Counter()

        def name(base: str) -> str:
            while True:
                used[base] += 1
                if base == Action.WAYPOINT:
                    found = f"{base} {used[base]}"
                else:
                    found = base if used[base] == 1 else f"{base} ({used[base]})"
                if found not in own:
                    return found

        return [name(item.base) if item.name is None else item.name for item in self.items]

    def _range_names(self, ranges: list[PlannedRange]) -> None:
        own = {r.round.name for r in ranges if r.round.name is not None}
        used: Counter[str] = Counter()
        for r in ranges:
            base = r.round.name or r.round.base
            while r.round.name is None:
                used[r.round.base] += 1
                count = used[r.round.base]
                base = r.round.base if count == 1 else f"{r.round.base} ({count})"
                if base not in own:
                    break
            r.base = base

    # ---- what a step or a name stands for

    def _position(self, point: int | str, span: Span, last: bool = False) -> int | None:
        """The place of a step's first task, or its last one, or of the task of this name."""
        if isinstance(point, str):
            found = self.by_name.get(point)
            if found is None:
                close = nearest(point, self.by_name)
                hint = f"the nearest names are {listed((f'`{n}`' for n in close), 'or')}"
                message = f"there is no task `{point}`"
                self.diagnostics.error("unknown-step", message, span, hint if close else None)
            return found
        if point not in self.steps:
            known = sorted(self.steps, key=lambda n: (abs(n - point), n))[:3]
            near = listed(sorted(known))
            hint = f"the nearest steps are {near}"
            message = f"there is no step {point}"
            self.diagnostics.error("unknown-step", message, span, hint if known else None)
            return None
        items = self.steps[point]
        if items is None:
            message = f"more than one step has the number {point}"
            hint = "number the steps anew, or name the task"
            self.diagnostics.error("ambiguous-step", message, span, hint)
            return None
        places = [
            self.at[id(item)]
            for item in items
            if id(item) in self.at and item.action is not Action.START
        ]
        if not places:
            message = f"step {point} leaves nothing to do at which the mission could go on"
            hint = "name a step that measures or drives"
            self.diagnostics.error("empty-step", message, span, hint)
            return None
        return max(places) if last else min(places)

    # ---- groups

    def _nest(self, ranges: list[PlannedRange]) -> list[str]:
        """Names the groups; the innermost one's name for each task."""
        self._range_names(ranges)
        nested = sorted(ranges, key=lambda r: r.key)
        shown = [""] * len(self.items)
        around: list[PlannedRange] = []
        ends = 0
        for i in range(len(self.items)):
            while around and around[-1].last < i:
                around.pop()
            while ends < len(nested) and nested[ends].first == i:
                r = nested[ends]
                ends += 1
                parent = around[-1] if around else None
                if parent is not None and parent.last < r.last:
                    message = "these steps lie partly in those of another repetition"
                    where = f", line {parent.round.span.line}" if parent.round.span else ""
                    hint = f"let one lie in the other as a whole{where}"
                    self.diagnostics.error("overlap", message, r.round.span, hint)
                inside = parent is not None and not r.base.startswith(f"{parent.name}/")
                r.name = f"{parent.name}/{r.base}" if parent is not None and inside else r.base
                around.append(r)
                if len(around) > _DEEPEST:
                    message = f"more than {_DEEPEST} repetitions lie in one another"
                    hint = "repeat the steps more often in one of them"
                    self.diagnostics.error("deep-rounds", message, r.round.span, hint)
                    for other in ranges:
                        other.name = other.name or other.base
                    return shown
            if around:
                shown[i] = around[-1].name
        return shown

    def _range(self, order: int, round_: PlannedGroup) -> PlannedRange | None:
        first: int | None
        last: int | None
        if round_.first is not None and round_.last is not None:
            first, last = self.at.get(id(round_.first)), self.at.get(id(round_.last))
        elif round_.whole:
            places = [
                i for i, t in enumerate(self.items) if t.action is not Action.START and not t.docks
            ]
            first, last = (places[0], places[-1]) if places else (None, None)
        else:
            assert round_.steps is not None
            start, end = round_.steps.first, round_.steps.last
            first = self._position(start, round_.span)
            last = self._position(start if end is None else end, round_.span, last=True)
        if first is None or last is None:
            return None
        if first > last:
            message = "the first of these steps comes after the last one"
            self.diagnostics.error(
                "step-range", message, round_.span, "write the earlier one first"
            )
            return None
        return PlannedRange(round_, first, last, order)

    # ---- speeds

    def _speeds(
        self, ways: Sequence[tuple[Transition, ...]], ranges: Sequence[PlannedRange]
    ) -> list[float | None]:
        """The speed of the way to each task: what is said of it, or of leaving a task before it."""
        speeds = [item.arriving for item in self.items]
        if all(item.leaving is None for item in self.items):
            return speeds
        sources: list[dict[int, None]] = [{} for _ in self.items]
        for i, transitions in enumerate(ways):
            for way in transitions:
                sources[self.by_name[way.target]][i] = None
        for r in ranges:
            if r.round.limits.count != 1:
                sources[r.first][r.last] = None
        left = {j for froms in sources for j in froms}
        for i, item in enumerate(self.items):
            if item.leaving is not None and i not in left:
                message = "no way leads on from here, so there is none that could have this speed"
                hint = "write `at 0.3 m/s` for the way to a task"
                self.diagnostics.warning("speed-unused", message, item.source, hint)
        self._pass_on(sources)
        for i, froms in enumerate(sources):
            self._leave_at(i, speeds, [self.items[j] for j in froms])
        return [
            speeds[i] if item.action is not Action.WAIT else item.arriving
            for i, item in enumerate(self.items)
        ]

    def _pass_on(self, sources: Sequence[Iterable[int]]) -> None:
        """Lets places that take no time be left at the speed of the task before them."""
        targets: list[list[int]] = [[] for _ in self.items]
        for i, froms in enumerate(sources):
            for j in froms:
                targets[j].append(i)
        work = [i for i, item in enumerate(self.items) if item.leaving is not None]
        while work:
            item = self.items[work[-1]]
            for i in targets[work.pop()]:
                place = self.items[i]
                if place.action is Action.WAIT and place.leaving is None:
                    place.leaving = item.leaving
                    work.append(i)

    def _leave_at(self, i: int, speeds: list[float | None], froms: Sequence[Item]) -> None:
        """Gives a task the speed at which those before it are left."""
        others = [item for item in froms if item.leaving is None]
        for item in froms:
            if item.leaving is None:
                continue
            said, speeds[i] = speeds[i], item.leaving
            if said is not None and said != item.leaving:
                message = f"two speeds for one way: {item.leaving:g} and {said:g} m/s"
                self.diagnostics.error("two-speeds", message, item.source, "leave one of them out")
            if others and self.items[i].arriving is None:
                elsewhere = ", ".join(f"'{self.names[self.at[id(o)]]}'" for o in others[:3])
                message = (
                    f"{item.leaving:g} m/s will be the speed of all ways to '{self.names[i]}', "
                    f"also from {elsewhere}"
                )
                hint = f"plan a waypoint before '{self.names[i]}' if these are not to be that fast"
                self.diagnostics.warning("speed-shared", message, item.source, hint)

    # ---- tasks

    def _task(
        self,
        i: int,
        item: Item,
        group: str,
        transitions: tuple[Transition, ...],
        velocity: float | None,
    ) -> Task:
        return Task(
            name=self.names[i],
            action=item.action,
            group=group if item.shown_in is None else item.shown_in,
            object_id=item.object_id,
            pose=item.pose,
            wait=MEETING if item.action is Action.WAIT else None,
            velocity=velocity,
            joint_states=item.joints,
            retries=item.retries,
            on_failure=item.on_failure,
            transitions=transitions,
            source=item.source,
        )

    def _next(self, item: Item) -> str | None:
        """The task that follows the item; None: the mission ends."""
        following = self.following[id(item)]
        return None if following is None else self.names[self.at[id(following)]]

    def _transitions(self, item: Item) -> tuple[Transition, ...]:
        if not item.routes:
            target = self._next(item)
            return () if target is None else (Transition(target=target),)
        transitions: list[Transition] = []
        decided = False
        for leg in item.routes:
            if not leg.alternatives:
                if decided:
                    message = "the mission can go on in one way only where no condition holds"
                    hint = "leave one of the two out, or give it a condition"
                    self.diagnostics.error("second-route", message, leg.span, hint)
                decided = True
            target = self._target(item, leg)
            if target is None:
                continue
            for conditions in leg.alternatives or ((),):
                transitions.append(Transition(target=target, conditions=conditions))
        default = None if decided else self._next(item)
        if default is not None:
            transitions.append(Transition(target=default))
        return tuple(transitions)

    def _target(self, item: Item, leg: ResolvedBranch) -> str | None:
        target = leg.target
        if isinstance(target, StepRef):
            place = self._position(target.first, target.span)
            return None if place is None else self.names[place]
        if isinstance(target, Item):
            if id(target) not in self.at:
                message = "what this leads to has been taken out of the plan"
                self.diagnostics.error(
                    "empty-step", message, leg.span, "take the condition out, too"
                )
                return None
            return self.names[self.at[id(target)]]
        assert not isinstance(target, Home)
        following = self._next(item) if target is Plain.GO_ON else None
        if following is None and leg.alternatives:
            message = "a condition leads to a task, and here the mission ends"
            hint = (
                "write `return to the docking station`, or turn it round: "
                "`if ..., go to step 5; otherwise end the mission`"
            )
            self.diagnostics.error("no-target", message, leg.span, hint)
        return following
