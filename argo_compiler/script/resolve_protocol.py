"""From a protocol to its mission: its commands are carried out one after the other."""

from argo_compiler.catalog import Area
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Mission
from argo_compiler.model import Pose
from argo_compiler.script.lookup import Lookup
from argo_compiler.script.nodes import (
    Add,
    AreaLocation,
    Command,
    Delete,
    DockLocation,
    Done,
    Go,
    Location,
    Measure,
    Patrol,
    PlaceLocation,
    Protocol,
    Reference,
    SetStart,
    Side,
)
from argo_compiler.script.plan import (
    Item,
    Repeat,
    assemble,
    dock_item,
    measure_item,
    start_item,
)
from argo_compiler.script.source import Findings
from argo_compiler.script.spelling import alternatives


def protocol_mission(
    protocol: Protocol,
    lookup: Lookup,
    findings: Findings,
    start_area: int | None,
    end_area: int | None,
) -> Mission | None:
    """The mission of the protocol; None if `findings` has an error.

    `start_area` is for a protocol that sets no starting point of its own, or must agree with it;
    `end_area` adds the way into that area's docking station, or must agree with it.
    """
    planner = _Planner(lookup, findings, start_area, end_area)
    for step in protocol.steps:
        for command in step.commands:
            planner.carry_out(command)
    items = planner.finish()
    if findings.errors:
        return None
    tasks, groups = assemble(items)
    return Mission(
        designation=protocol.title.text if protocol.title else "",
        site=lookup.catalog.site,
        start_area=planner.start_area,
        end_area=planner.end_area,
        tasks=tasks,
        groups=groups,
    )


class _Planner:
    """The plan while a protocol's commands are carried out."""

    def __init__(
        self, lookup: Lookup, findings: Findings, start_area: int | None, end_area: int | None
    ) -> None:
        self.lookup = lookup
        self.findings = findings
        self.start_option = start_area
        self.end_option = end_area
        self.start_area: int | None = None
        self.end_area: int | None = None
        # Items by key, so that a search compares integers: a protocol may have thousands of edits.
        self.items: dict[int, Item] = {}
        self.order: list[int] = []
        self.measurements: dict[str, list[int]] = {}
        self.start: Item | None = None
        self.start_at: Span | None = None
        self.dock_at: Span | None = None
        self.done = False
        self.whole = not findings.errors
        """all that was asked for so far is planned: what an edit does not find is not there"""

    def carry_out(self, command: Command) -> None:
        if self.done:
            hint = "move `Done!` to the end"
            self.findings.error("after-done", "this comes after `Done!`", command.span, hint)
            return
        match command:
            case SetStart():
                self._set_start(command)
            case Patrol():
                self._patrol(command)
            case Measure():
                self._measure(command.checkpoint, command.span)
            case Add(anchor=Reference() as anchor):
                self._add(command, anchor)
            case Add():
                self._measure(command.checkpoint, command.span)
            case Delete():
                self._delete(command)
            case Go():
                self._go(command)
            case Done():
                self.done = True

    def finish(self) -> list[Item]:
        """The items in order, with the start before them and the way into the dock after them."""
        items = [self.items[key] for key in self.order]
        if not items and self.whole:
            hint = "give it steps such as `Check the checkpoint #14`"
            self.findings.error("nothing-to-do", "the protocol has nothing to do", None, hint)
            return []
        if self.start_at is None:
            self._start_by_option()
        if self.dock_at is None and self.end_option is not None:
            dock = self.lookup.area(self.end_option, None)
            if dock:
                self.end_area = dock.number
                items.append(dock_item(dock.dock, None))
        return [self.start, *items] if self.start else items

    # ---- where it starts

    def _set_start(self, command: SetStart) -> None:
        if self.start_at is not None:
            message = f"the starting point is already set in line {self.start_at.line}"
            hint = "leave one of the two out"
            self.findings.error("second-start", message, command.span, hint)
            return
        self.start_at = command.span
        pose, area = self._locate(command.location, "start")
        if pose is None:
            return
        if self.start_option is not None and (area is None or area.number != self.start_option):
            message = f"--start-area {self.start_option} contradicts the script's starting point"
            hint = "leave --start-area out, or take the starting point out of the script"
            self.findings.error("area-conflict", message, command.span, hint)
            return
        self.start_area = area.number if area else None
        self.start = start_item(pose, command.span)

    def _start_by_option(self) -> None:
        if self.start_option is not None:
            area = self.lookup.area(self.start_option, None)
            if area:
                self.start_area = area.number
                self.start = start_item(area.dock, None)
        elif self.whole:
            known = alternatives(f"--start-area {a.number}" for a in self.lookup.catalog.areas)
            hint = f"write `Set a starting point in starting area 1`, or give {known}"
            message = "the protocol sets no starting point"
            self.findings.error("no-start", message, None, hint)

    # ---- what it does

    def _patrol(self, command: Patrol) -> None:
        floor = self.lookup.floor(command.floor)
        if not self._may_go_on(command.span):
            return
        if command.duration is None and command.rounds is None:
            hint = "say how long or how often: `for 10 minutes`, `three times`"
            message = "this patrol would never end"
            self.findings.error("endless-patrol", message, command.span, hint)
        elif floor is None:
            self.whole = False
        else:
            count = command.rounds.value if command.rounds else 0
            duration = command.duration.seconds if command.duration else 0.0
            self._append(
                Item(
                    name=f"Patrol floor {floor.number}",
                    action=Action.WAYPOINT,
                    source=command.span,
                    poses=floor.patrol,
                    repeat=Repeat(count=count, duration=duration),
                )
            )

    def _measure(self, reference: Reference, span: Span) -> None:
        checkpoint = self.lookup.checkpoint(reference)
        if not self._may_go_on(span):
            return
        if checkpoint is None:
            self.whole = False
        else:
            self._append(measure_item(checkpoint.id, span))

    def _go(self, command: Go) -> None:
        if not self._may_go_on(command.span):
            return
        pose, area = self._locate(command.location, "end")
        if pose is None:
            self.whole = False
        elif isinstance(command.location, DockLocation):
            self.dock_at = command.span
            self.end_area = area.number if area else None
            self._append(dock_item(pose, command.span))
        else:
            self._append(Item("WAYPOINT", Action.WAYPOINT, command.span, poses=(pose,)))

    def _locate(self, location: Location, which: str) -> tuple[Pose | None, Area | None]:
        """The pose of the location, and its starting area if it lies in one."""
        match location:
            case PlaceLocation():
                return self.lookup.place(location), None
            case AreaLocation():
                area = self.lookup.area(location.area.value, location.span)
            case DockLocation():
                area = self._docking_area(location, which)
        return (area.dock, area) if area else (None, None)

    def _docking_area(self, dock: DockLocation, which: str) -> Area | None:
        option = self.start_option if which == "start" else self.end_option
        named = dock.area.value if dock.area else option
        flag = f"--{which}-area"
        if named is None:
            known = alternatives(f"{flag} {area.number}" for area in self.lookup.catalog.areas)
            message = "this does not say which docking station"
            hint = f"add `in starting area 1`, or give {known}"
            self.findings.error("area-choice", message, dock.span, hint)
            return None
        if which == "end" and option is not None and option != named:
            message = f"{flag} {option} contradicts the script"
            hint = f"leave {flag} out, or take the area out of the script"
            self.findings.error("area-conflict", message, dock.span, hint)
            return None
        return self.lookup.area(named, dock.span)

    def _may_go_on(self, span: Span) -> bool:
        if self.dock_at is None:
            return True
        message = f"the robot is back in its docking station since line {self.dock_at.line}"
        self.findings.error("after-docking", message, span, "move the return to the end")
        return False

    # ---- edits

    def _append(self, item: Item) -> None:
        self._insert(len(self.order), item)

    def _insert(self, position: int, item: Item) -> None:
        key = len(self.items)
        self.items[key] = item
        self.order.insert(position, key)
        if item.object_id is not None:
            self.measurements.setdefault(item.object_id, []).append(key)

    def _add(self, command: Add, anchor: Reference) -> None:
        checkpoint = self.lookup.checkpoint(command.checkpoint)
        position = self._position(anchor)
        if checkpoint is None or position is None:
            self.whole = False
            return
        item = measure_item(checkpoint.id, command.span)
        self._insert(position + (command.side is Side.AFTER), item)

    def _delete(self, command: Delete) -> None:
        position = self._position(command.checkpoint)
        if position is not None:
            key = self.order.pop(position)
            object_id = self.items[key].object_id
            assert object_id is not None
            self.measurements[object_id].remove(key)

    def _position(self, reference: Reference) -> int | None:
        """Where the checkpoint's one measurement stands in the plan."""
        checkpoint = self.lookup.checkpoint(reference)
        if checkpoint is None:
            self.whole = False
            return None
        keys = self.measurements.get(str(checkpoint.id), [])
        if len(keys) == 1:
            return self.order.index(keys[0])
        name = f"checkpoint #{checkpoint.id}"
        if keys:
            lines = sorted(s.line for key in keys if (s := self.items[key].source))
            where = alternatives((str(line) for line in lines), "and")
            message = f"{name} is measured more than once at this point: lines {where}"
            hint = "the script does not say which of them is meant"
            self.findings.error("ambiguous-edit", message, reference.span, hint)
        elif self.whole:
            hint = f"ask for it before this line: `Check the {name}`"
            message = f"{name} is not in the plan at this point"
            self.findings.error("not-planned", message, reference.span, hint)
        return None
