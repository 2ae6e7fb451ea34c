"""Carries out the commands of a protocol: makes its plan, changes it, and gathers reactions."""

from collections.abc import Sequence

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.diagnostics import Span
from argo_compiler.errors import Remedy
from argo_compiler.il import Action, JointState, Reaction, Task
from argo_compiler.listing import listed
from argo_compiler.model import Pose
from argo_compiler.script.resolve.conditions import resolve_alternatives
from argo_compiler.script.resolve.header import HeaderValues
from argo_compiler.script.resolve.locating import Locator
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.plan import (
    Home,
    Item,
    Plan,
    PlannedGroup,
    ResolvedBranch,
    dock_item,
    measure_item,
    place_item,
    start_item,
    waypoint_item,
)
from argo_compiler.script.syntax.commands import (
    Add,
    Amend,
    Branch,
    Command,
    Comparison,
    Delete,
    Done,
    Go,
    Manner,
    Measure,
    Meet,
    Move,
    Patrol,
    Plain,
    Planned,
    React,
    Repeat,
    Replace,
    SetStart,
    Side,
)
from argo_compiler.script.syntax.nodes import Protocol
from argo_compiler.script.syntax.source import Diagnostics
from argo_compiler.script.syntax.terms import (
    DockLocation,
    FloorName,
    Location,
    PlaceLocation,
    Reference,
    StepRef,
)


class Planner:
    """The plan while a protocol's commands are carried out."""

    def __init__(self, lookup: Lookup, diagnostics: Diagnostics, header: HeaderValues) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics
        self.header = header
        self.locator = Locator(lookup, diagnostics, header.start.area, header.end.area)
        self.plan = Plan()
        self.steps: dict[int, list[Item] | None] = {}
        self.reactions: list[Reaction] = []
        self.start_area: int | None = None
        self.end_area: int | None = None
        self.dock: Pose | None = None
        self.measurements: dict[str, dict[int, Item]] = {}
        self.named: dict[str, Item] = {}
        self.step: list[Item] = []
        """what the step planned so far"""
        self.recent: list[Item] = []
        """what the last command planned"""
        self.last_measured: CheckpointInfo | None = None
        self.start: Item | None = None
        self.start_at: Span | None = None
        self.docked: Item | None = None
        self.homes: list[ResolvedBranch] = []
        self.failure_docks: list[DockLocation] = []
        self.ended: PlannedGroup | None = None
        """the round that the last command asked for"""
        self.events: dict[str, Span] = {}
        self.done = False
        self.done_is_news = True
        """what comes after `Done!` has not been complained about yet"""
        self.whole = not diagnostics.errors
        """all that was asked for so far is planned: what a change does not find is not there"""

    def begin_step(self, number: int | None) -> None:
        self.step = []
        if number is not None:
            self.steps[number] = None if number in self.steps else self.step

    def carry_out(self, command: Command) -> None:
        if self.done:
            if self.done_is_news:
                hint = "move `Done!` to the end"
                self.diagnostics.error("after-done", "this comes after `Done!`", command.span, hint)
            self.done_is_news = False
            return
        if not isinstance(command, Amend):
            self.ended = None
        match command:
            case Measure():
                self._planned(command, self._measure(command))
            case Meet():
                self._meet(command)
            case Go():
                self._go(command)
            case SetStart():
                self._set_start(command)
            case Patrol():
                self._patrol(command)
            case Add():
                self._planned(command, self._add(command))
            case Amend():
                self._amend(command)
            case Delete():
                self._delete(command)
            case Move():
                self._move(command)
            case Replace():
                self._replace(command)
            case Repeat():
                self._repeat(command)
            case React():
                self._react(command)
            case Done():
                self.done = True

    def finish(self) -> None:
        """Adds the start and the way into the dock, and looks up where home is."""
        if self.plan.first is None and self.whole:
            hint = "give it steps such as `Check the checkpoint #14`"
            self.diagnostics.error("nothing-to-do", "the protocol has nothing to do", None, hint)
            return
        if self.start_at is None:
            self._start_unsaid()
        if self.start is not None and not self.start.listed:
            self.plan.insert_after(None, self.start)
        if self.header.start.as_planned:
            self.start_area = self.header.start.area
        end = self.header.end
        if end.as_planned:
            self.end_area = end.area
        elif self.docked is None and end.area is not None:
            area = self.lookup.area(end.area, end.span)
            if area:
                self.end_area = area.number
                self.docked = dock_item(area.dock, None)
                self.plan.append(self.docked)
        self._find_dock()
        for leg in self.homes:
            self._lead_home(leg)
        for dock in self.failure_docks:
            self._check_failure_dock(dock)

    def current_name(self, protocol: Protocol, tasks: Sequence[Task]) -> str | None:
        """The name of the task that the header gives as the current one."""
        if protocol.current is None:
            return None
        point = protocol.current.task.first
        if isinstance(point, str):
            return point
        for item, task in zip(self.plan, tasks, strict=True):
            if any(item is other for other in self.steps.get(point) or ()):
                return task.name
        message = f"there is no step {point} with a task"
        self.diagnostics.error("unknown-step", message, protocol.current.span, "name the task")
        return None

    # ---- where it starts and ends

    def _set_start(self, command: SetStart) -> None:
        if self.start_at is not None:
            message = f"the starting point is already set in line {self.start_at.line}"
            hint = "leave one of the two out"
            self.diagnostics.error("second-start", message, command.span, hint)
            return
        self.start_at = command.span
        pose, area = None, None
        if command.location is not None:
            pose, area = self.locator.locate(command.location, "start")
            if pose is None:
                return
        wanted = self.header.start
        if (
            wanted.area is not None
            and not wanted.as_planned
            and (area is None or area.number != wanted.area)
        ):
            message = f"the starting area {wanted.area} contradicts the script's starting point"
            hint = "choose none, or take the starting point out of the script"
            remedies: tuple[Remedy, ...] = (Remedy.CHOOSE_START,)
            if wanted.span is not None:
                remedies = ()
                message = f"line {wanted.span.line} says that it starts in area {wanted.area}"
                hint = "leave one of the two out, or add `as planned` to the header line"
            self.diagnostics.error("area-conflict", message, command.span, hint, remedies)
            return
        self.start_area = area.number if area else None
        self.start = start_item(pose, command.span)
        if command.here:
            self.plan.append(self.start)
        self._planned(command, [self.start])

    def _start_unsaid(self) -> None:
        wanted = self.header.start
        if wanted.area is not None and not wanted.as_planned:
            area = self.lookup.area(wanted.area, wanted.span)
            if area:
                self.start_area = area.number
                self.start = start_item(area.dock, wanted.span)
        elif self.whole and not wanted.said:
            known = listed((a.number for a in self.lookup.catalog.areas), "or")
            hint = f"write `Set a starting point in starting area 1`, or choose area {known}"
            message = "the protocol sets no starting point"
            self.diagnostics.error("no-start", message, None, hint, (Remedy.CHOOSE_START,))

    def _find_dock(self) -> None:
        if self.header.dock_said:
            point = self.header.dock
            self.dock = self.locator.point(point) if point else None
            return
        for number in (self.end_area, self.start_area):
            area = self.lookup.catalog.area(number) if number is not None else None
            if area is not None:
                self.dock = area.dock
                return

    def _lead_home(self, leg: ResolvedBranch) -> None:
        """Leads a route to the last drive into the docking station, which is added if need be."""
        home = leg.target
        assert isinstance(home, Home)
        pose = self.dock
        if home.area is not None:
            area = self.lookup.area(home.area, home.span)
            pose = area.dock if area else None
        if pose is None:
            if home.area is None:
                message = "this does not say which docking station"
                hint = "add `in starting area 1`, or a line such as `End area: 1`"
                self.diagnostics.error("area-choice", message, home.span, hint)
            return
        last = self.plan.last
        if last is None or not last.docks or last.routes or last.pose != pose:
            last = dock_item(pose, home.span)
            last.apart = True
            self.plan.append(last)
        leg.target = last

    def _check_failure_dock(self, dock: DockLocation) -> None:
        """That a return after a failure is to the dock that the mission has."""
        area = self.lookup.area(dock.area.value, dock.span) if dock.area else None
        if area is None or area.dock == self.dock:
            return
        message = (
            f"after a failure the robot returns to the mission's dock, which is not that of "
            f"starting area {area.number}"
        )
        hint = f"leave the area out, or let the mission end there: `End area: {area.number}`"
        self.diagnostics.error("failure", message, dock.span, hint)

    # ---- what it does

    def _may_go_on(self, span: Span) -> bool:
        docked = self.docked
        if docked is None or not docked.listed:
            return True
        if any(not leg.alternatives for leg in docked.routes or ()):
            return True
        line = docked.source.line if docked.source else 0
        message = f"the robot is back in its docking station since line {line}"
        hint = "move the return to the end, or say how it goes on: `then go to step 3`"
        self.diagnostics.error("after-docking", message, span, hint)
        return False

    def _append(self, item: Item) -> None:
        self._insert(self.plan.last, item)

    def _insert(self, anchor: Item | None, *items: Item) -> None:
        self.plan.put(items, anchor)
        for item in items:
            if item.action is Action.MEASURE and item.object_id is not None:
                self.measurements.setdefault(item.object_id, {})[id(item)] = item

    def _checkpoints(self, references: Sequence[Reference]) -> list[CheckpointInfo]:
        found: list[CheckpointInfo] = []
        for reference in references:
            numbers: Sequence[int | None] = [reference.number]
            if reference.last is not None and reference.number is not None:
                numbers = range(reference.number, reference.last + 1)
                if not numbers:
                    message = "this range of checkpoints is empty"
                    hint = "write the lower number first"
                    self.diagnostics.error("empty-range", message, reference.span, hint)
                    self.whole = False
            for number in numbers:
                one = Reference(
                    span=reference.span,
                    number=number,
                    name=reference.name,
                    quantity=reference.quantity,
                )
                checkpoint = self.lookup.checkpoint(one if reference.last else reference)
                if checkpoint is None:
                    self.whole = False
                    break
                found.append(checkpoint)
        return found

    def _measure(self, command: Measure, after: Item | None = None) -> list[Item]:
        """Plans the measurements, behind the item or at the end."""
        checkpoints = self._checkpoints(command.checkpoints)
        if after is None and not self._may_go_on(command.span):
            return []
        items = [measure_item(checkpoint.id, command.span) for checkpoint in checkpoints]
        for item in items:
            self._insert(after if after is not None else self.plan.last, item)
            after = item if after is not None else None
        if checkpoints:
            self.last_measured = checkpoints[-1]
        return items

    def _meet(self, command: Meet) -> None:
        if self._may_go_on(command.span):
            item = place_item(str(Action.WAIT), command.span)
            self._append(item)
            self._planned(command, [item])

    def _go(self, command: Go) -> None:
        if not self._may_go_on(command.span):
            return
        item = self._destination(command)
        if item is None:
            self.whole = False
            return
        self._append(item)
        if item.docks:
            self.docked = item
        self._planned(command, [item])

    def _destination(self, command: Go) -> Item | None:
        pose, area = self.locator.locate(command.location, "end")
        if pose is None:
            return None
        if isinstance(command.location, DockLocation):
            self.end_area = area.number if area else None
            return dock_item(pose, command.span)
        return waypoint_item(pose, command.span)

    def _patrol(self, command: Patrol) -> None:
        if not self._may_go_on(command.span):
            return
        for items in self._rounds(command, None):
            self.step += items
            self.recent = items
            self._furnish(command, items)
            self.ended = self.plan.rounds[-1]
        if self.ended is not None:
            self._follow(self.ended, command.routes)

    def _rounds(self, command: Patrol, after: Item | None) -> list[list[Item]]:
        """Plans the rounds of a patrol: one for each floor, or one through the places."""
        limits = command.limits
        if not (limits.count or limits.duration or limits.endless):
            hint = "say how long or how often: `for 10 minutes`, `three times`"
            message = "this patrol would never end"
            self.diagnostics.error("endless-patrol", message, command.span, hint)
            self.whole = False
            return []
        if limits.duration and sum(isinstance(p, FloorName) for p in command.places) > 1:
            message = "this duration can be read as that of each floor or of all together"
            hint = "write one patrol for each floor, each with its own duration"
            self.diagnostics.error("ambiguous-duration", message, command.span, hint)
            self.whole = False
            return []
        rounds: list[tuple[str, list[Pose]]] = []
        through: list[Pose] = []
        label = ""
        for place in command.places:
            if isinstance(place, FloorName):
                floor = self.lookup.floor(place)
                if floor is None:
                    self.whole = False
                else:
                    rounds.append((f"Patrol floor {floor.number}", list(floor.patrol)))
                continue
            pose, area = self.locator.locate(place, "end")
            if pose is None:
                self.whole = False
                continue
            if not through:
                label = f"area {area.number}" if area else "place"
                if isinstance(place, PlaceLocation):
                    label = place.name.removeprefix("the ")
            through.append(pose)
        if through:
            rounds.append((f"Patrol {label}".replace("/", "-"), through))
        if command.name is not None and len(rounds) > 1:
            self._one_name(command.span)
        planned: list[list[Item]] = []
        for base, poses in rounds:
            items = [waypoint_item(pose, command.span) for pose in poses]
            for item in items:
                self._insert(after if after is not None else self.plan.last, item)
                after = item if after is not None else None
            self.plan.rounds.append(
                PlannedGroup(
                    base,
                    limits,
                    command.span,
                    name=command.name,
                    first=items[0],
                    last=items[-1],
                )
            )
            planned.append(items)
        return planned

    def _one_name(self, span: Span) -> None:
        message = "this name stands before a command with several tasks"
        hint = "give each of them a line and a name"
        self.diagnostics.error("one-name", message, span, hint)

    def _planned(self, command: Planned, items: list[Item]) -> None:
        """Takes note of the items that a command planned, and of how they are carried out."""
        if not items:
            return
        self.step += items
        self.recent = items
        self._furnish(command, items)
        self._add_routes(items[-1], command.routes)

    def _furnish(self, command: Planned, items: list[Item]) -> None:
        if command.name is not None and not isinstance(command, Patrol):
            if len(items) > 1:
                self._one_name(command.span)
            items[0].name = command.name
            self.named[command.name] = items[0]
        if command.manner is not None:
            self._apply(command.manner, items, command.span)

    def _apply(self, manner: Manner, items: list[Item], span: Span) -> None:
        pose = self.locator.point(manner.pose) if manner.pose is not None else None
        joints = manner.joints
        for item in items:
            if manner.speed is not None:
                item.arriving = manner.speed
            if manner.retries is not None:
                item.retries = manner.retries
            if manner.on_failure is not None:
                item.on_failure = manner.on_failure
                if manner.failure_dock is not None:
                    self.failure_docks.append(manner.failure_dock)
            if joints is not None:
                item.joints = JointState(names=joints.names, positions=joints.positions)
            if manner.shown_in is not None:
                item.shown_in = manner.shown_in
            if manner.object_id is not None:
                if item.action is Action.MEASURE:
                    message = "a measurement is about its checkpoint"
                    hint = "leave `about object` out"
                    self.diagnostics.error("stray-clause", message, span, hint)
                item.object_id = manner.object_id
            if pose is not None:
                item.pose = pose
        if manner.leaving is not None:
            items[-1].leaving = manner.leaving

    def _amend(self, command: Amend) -> None:
        if self.ended is not None and command.routes:
            if command.manner is not None and self.recent:
                self._apply(command.manner, self.recent, command.span)
            self._follow(self.ended, command.routes)
            return
        if not self.recent or (not self.recent[-1].listed and self.recent[-1] is not self.start):
            if self.whole:
                message = "there is no task before this that it could belong to"
                hint = "write it behind the task after which it is looked at"
                self.diagnostics.error("no-task", message, command.span, hint)
            return
        if command.manner is not None:
            self._apply(command.manner, self.recent, command.span)
        self._add_routes(self.recent[-1], command.routes)

    # ---- what follows a round

    def _follow(self, round_: PlannedGroup, routes: Sequence[Branch]) -> None:
        """Adds routes behind the last round: at a place of its own, which the mission comes to when
        the time is up as well. What is done in any case leads on from the last task."""
        if not routes:
            return
        decides = any(route.alternatives or isinstance(route.target, tuple) for route in routes)
        if round_.last is not None and round_.after is None and not decides:
            self._add_routes(round_.last, routes)
            return
        if round_.after is None:
            last = self._last_of(round_)
            if last is None:
                return
            while last.detour is not None:
                last = last.detour
            round_.after = place_item(f"after '{round_.title}'", round_.span)
            self._insert(last, round_.after)
            self.step.append(round_.after)
        self._add_routes(round_.after, routes)

    def _last_of(self, round_: PlannedGroup) -> Item | None:
        """The last task of a round, which has to be planned before what follows it."""
        if round_.last is not None:
            return round_.last
        found: Item | None = None
        if round_.steps is None:
            first, found = self.plan.first, self.plan.last
            while found is not None and (found.docks or found.action is Action.START):
                found = found.before
            while first is not None and first.action is Action.START:
                first = first.after
            if found is not None:
                round_.first, round_.last = first, found
        else:
            point = round_.steps.first if round_.steps.last is None else round_.steps.last
            items = [named] if (named := self.named.get(str(point))) else []
            if isinstance(point, int):
                items = self.steps.get(point) or []
            found = next((item for item in reversed(items) if item.listed), None)
        if found is None and self.whole:
            message = "not all steps of this repetition are in the plan at this point"
            hint = "write it behind them, with what follows it"
            self.diagnostics.error("not-planned", message, round_.span, hint)
        return found

    # ---- routes

    def _add_routes(self, item: Item, routes: Sequence[Branch]) -> None:
        for route in routes:
            found = resolve_alternatives(route.alternatives, self._compared, self.diagnostics)
            if route.alternatives and not found:
                continue
            leg = ResolvedBranch(found, Plain.GO_ON, route.span, route.otherwise)
            if item.routes is None:
                item.routes = []
            item.routes.append(leg)
            target = route.target
            if isinstance(target, tuple):
                leg.target = self._detour(item, target)
            elif isinstance(target, DockLocation):
                leg.target = Home(target.area.value if target.area else None, target.span)
                self.homes.append(leg)
            elif target is Plain.END and found:
                message = "a condition can't end the mission on the spot; it returns to the dock"
                hint = "write `return to the docking station`"
                self.diagnostics.warning("end-at-dock", message, route.span, hint)
                leg.target = Home(None, route.span)
                self.homes.append(leg)
            else:
                leg.target = target

    def _compared(self, test: Comparison) -> CheckpointInfo | None:
        if test.subject is not None:
            if test.subject.last is not None:
                message = "a condition compares one checkpoint"
                self.diagnostics.error("condition", message, test.span, "join two by `and` or `or`")
                return None
            return self.lookup.checkpoint(test.subject)
        if self.last_measured is None:
            message = "nothing has been measured before this, so it does not say which value"
            hint = "name the checkpoint: `if the value of checkpoint #1 is greater than 5`"
            self.diagnostics.error("which-checkpoint", message, test.span, hint)
        return self.last_measured

    def _detour(self, owner: Item, commands: Sequence[Command]) -> Item | Plain:
        """Plans what is carried out in one case only, behind the owner; the first task of it."""
        first: Item | None = None
        tail = owner.detour or owner
        measured = self.last_measured
        for command in commands:
            groups: list[list[Item]] = []
            if isinstance(command, Measure):
                groups = [self._measure(command, tail)]
            elif isinstance(command, Patrol):
                groups = self._rounds(command, tail)
            elif isinstance(command, Go):
                item = self._destination(command)
                if item is None:
                    self.whole = False
                    continue
                self._insert(tail, item)
                groups = [[item]]
            else:
                message = "this can't be done in one case only"
                hint = "after a condition the mission can go to a step, drive or measure"
                self.diagnostics.error("route", message, command.span, hint)
            for items in groups:
                if not items:
                    continue
                first = first or items[0]
                tail = items[-1]
                self.step += items
                assert isinstance(command, Planned)
                self._furnish(command, items)
                self._add_routes(tail, command.routes)
                if tail.docks and not tail.routes:
                    tail.routes = [ResolvedBranch((), Plain.END, command.span)]
        self.last_measured = measured
        if first is None:
            return Plain.GO_ON
        owner.detour = tail
        tail.returns = owner
        return first

    def _repeat(self, command: Repeat) -> None:
        limits = command.limits
        if not (limits.count or limits.duration or limits.endless):
            hint = "say how long or how often: `for 10 minutes`, `three times`, `endlessly`"
            message = "this repetition would never end"
            self.diagnostics.error("endless-repeat", message, command.span, hint)
            return
        steps = command.steps
        base = "Repeat"
        if steps is not None:
            points = [str(p) for p in (steps.first, steps.last) if p is not None]
            base = f"Repeat {' to '.join(points)}".replace("/", "-")
        self.ended = PlannedGroup(
            base, limits, command.span, name=command.name, steps=steps, whole=steps is None
        )
        self.plan.rounds.append(self.ended)
        self._follow(self.ended, command.routes)

    def _react(self, command: React) -> None:
        pose, area = self._refuge(command.location)
        for event in command.events:
            before = self.events.get(event)
            if before is not None:
                message = f"line {before.line} already says what to do in this event"
                hint = "leave one of the two out"
                self.diagnostics.error("second-reaction", message, command.span, hint)
                continue
            self.events[event] = command.span
            self.reactions.append(
                Reaction(
                    event=event,
                    response=command.response,
                    pose=pose,
                    area=area,
                    until=command.until,
                    afterwards=command.afterwards,
                    priority=command.priority,
                    source=command.span,
                )
            )

    def _refuge(self, location: Location | None) -> tuple[Pose | None, int | None]:
        """Where a reaction drives to, and the starting area if it is the dock of one that is named;
        this need not be the one in which the mission ends."""
        if location is None:
            return None, None
        if isinstance(location, DockLocation):
            if location.area is None:
                return None, None
            area = self.lookup.area(location.area.value, location.span)
            return (area.dock, area.number) if area else (None, None)
        return self.locator.locate(location, "end")[0], None

    # ---- changes of the plan

    def _add(self, command: Add) -> list[Item]:
        checkpoints = self._checkpoints(command.checkpoints)
        anchors = self._found(command.anchor)
        if not checkpoints or anchors is None:
            self.whole = False
            return []
        items = [measure_item(checkpoint.id, command.span) for checkpoint in checkpoints]
        self._put(items, anchors, command.side)
        self.last_measured = checkpoints[-1]
        return items

    def _put(self, items: list[Item], anchors: list[Item], side: Side) -> None:
        before = anchors[0].before
        if side is Side.AFTER:
            before = anchors[-1].detour or anchors[-1]
        self._insert(before, *items)

    def _delete(self, command: Delete) -> None:
        for thing in command.things:
            for item in self._found(thing) or ():
                self._take_out(item, command.span)

    def _take_out(self, item: Item, span: Span) -> bool:
        if item.detour is not None or item.returns is not None:
            message = "this task belongs to a condition, so it can't be moved or taken out"
            self.diagnostics.error("bound-task", message, span, "change the line that asks for it")
            return False
        self.plan.remove(item)
        if item.action is Action.MEASURE and item.object_id is not None:
            self.measurements[item.object_id].pop(id(item), None)
        return True

    def _move(self, command: Move) -> None:
        items: list[Item] = []
        for thing in command.things:
            items += self._found(thing) or ()
        anchors = self._found(command.anchor)
        if not items or anchors is None:
            return
        if any(item is anchor for item in items for anchor in anchors):
            message = "this is to stand before or after itself"
            self.diagnostics.error("self-move", message, command.span, "name another place")
            return
        if all(self._take_out(item, command.span) for item in items):
            self._put(items, anchors, command.side)

    def _replace(self, command: Replace) -> None:
        checkpoints = self._checkpoints([command.by])
        items = self._found(command.thing)
        if not checkpoints or items is None:
            self.whole = False
            return
        if len(items) > 1 or items[0].action is not Action.MEASURE or items[0].detour:
            message = "only a single measurement can be replaced"
            hint = "delete what is there, and add the other behind it"
            self.diagnostics.error("bound-task", message, command.span, hint)
            return
        (item,), checkpoint = items, checkpoints[0]
        assert item.object_id is not None
        self.measurements[item.object_id].pop(id(item), None)
        new = measure_item(checkpoint.id, command.span)
        item.base, item.object_id, item.source = new.base, new.object_id, new.source
        self.measurements.setdefault(str(checkpoint.id), {})[id(item)] = item
        self.step.append(item)
        self.recent = [item]
        self.last_measured = checkpoint

    def _found(self, thing: Reference | StepRef) -> list[Item] | None:
        """The planned items that are meant; None if it is not clear which."""
        if isinstance(thing, StepRef):
            return self._of_steps(thing)
        checkpoint = self.lookup.checkpoint(thing)
        if checkpoint is None:
            self.whole = False
            return None
        items = list(self.measurements.get(str(checkpoint.id), {}).values())
        if len(items) == 1:
            return items
        name = f"checkpoint #{checkpoint.id}"
        if items:
            lines = sorted({s.line for item in items[:20] if (s := item.source)})
            where = listed(lines)
            message = f"{name} is measured more than once at this point: lines {where}"
            hint = "say which of them is meant by its step: `step 3`"
            self.diagnostics.error("ambiguous-edit", message, thing.span, hint)
        elif self.whole:
            hint = f"ask for it before this line: `Check the {name}`"
            message = f"{name} is not in the plan at this point"
            self.diagnostics.error("not-planned", message, thing.span, hint)
        return None

    def _of_steps(self, ref: StepRef) -> list[Item] | None:
        if isinstance(ref.first, str):
            item = self.named.get(ref.first)
            if item is not None and item.listed and ref.last is None:
                return [item]
        elif isinstance(ref.last, int | None):
            last = ref.first if ref.last is None else ref.last
            found: list[Item] = []
            for number in range(ref.first, min(last, ref.first + len(self.steps)) + 1):
                found += [item for item in self.steps.get(number) or () if item.listed]
            if found:
                return found
        if self.whole:
            message = "no task of this step is in the plan at this point"
            hint = "name a step above this line that measures or drives"
            self.diagnostics.error("not-planned", message, ref.span, hint)
        return None
