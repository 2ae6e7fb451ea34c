"""Carries out the orders of a script: each adds to the program, or changes it."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.diagnostics import Span
from argo_compiler.il import EventKind, OnFailure, WaitRule
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.accepting import accepts, said
from argo_compiler.script.resolve.cases import Cases
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.edits import Edits
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.ordering import Ordering
from argo_compiler.script.resolve.program import (
    Ahead,
    Do,
    HomeAhead,
    Leave,
    ProgramBlock,
    ProgramNode,
    in_branch,
    leads_away,
)
from argo_compiler.script.resolve.repeating import Repeating, timed
from argo_compiler.script.resolve.starting import Starting
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import Occurs
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import PlainWord, ScriptOrder, Sentence
from argo_compiler.script.syntax.tree.places import DockLocation, FloorName, Location, Steps

_WHOLE_PLAN = (
    orders.Repeat | orders.Add | orders.Delete | orders.Move | orders.Replace | orders.Start
)


class Planner:
    """Plans sentences, into the program or into a block of it."""

    def __init__(self, context: Context, starting: Starting, ordering: Ordering) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.starting = starting
        self.manners = Manners(context)
        self.repeating = Repeating(context)
        self.ordering = ordering
        self.edits = Edits(context, self.manners)
        self.cases = Cases(context, self)
        self.done = False
        self.visiting: tuple[orders.VisitOrder, list[CheckpointInfo]] | None = None
        """a drive to a checkpoint, of which it has not been said yet what to do there"""

    def sentence(self, sentence: Sentence, block: ProgramBlock) -> None:
        """Carries a sentence out."""
        self.carry_out(sentence.orders, block)
        for case in sentence.cases:
            self.cases.add(case, block)

    def carry_out(self, orders_: Sequence[ScriptOrder], block: ProgramBlock) -> None:
        """Carries orders out, one after the other, at the end of a block."""
        prefix: ScriptOrder | None = None
        floors: Manner | None = None
        for i, order in enumerate(orders_):
            if isinstance(order, orders.Amend) and i + 1 < len(orders_):
                # `three times: check checkpoint 17`
                prefix = order if prefix is None else self.manners.with_prefix(order, prefix)
                continue
            if i and isinstance(orders_[i - 1], orders.Retry) and self._given_up(order):
                continue
            if prefix is not None:
                floors = prefix.manner and Manner(floors=prefix.manner.floors)
                order = self.manners.with_prefix(order, prefix)
                prefix = None
            elif floors is not None and floors.floors and isinstance(order, orders.Measure):
                # `on the second floor, check the valve, then read the gauge`
                order = self.manners.with_prefix(order, replace(order, name=None, manner=floors))
            if isinstance(order, orders.Retry) and _several(orders_[:i]):
                message = "this can be meant for the last of these only, or for each of them"
                hint = "write `check checkpoints 1 and 4, retry twice` for each, or two sentences"
                self.diagnostics.error("ambiguous-manner", message, order.span, hint)
                continue
            self.order(self._counted(order), block)

    def _counted(self, order: ScriptOrder) -> ScriptOrder:
        """The order with the number of `the next step`."""
        for field in fields(order):
            steps = getattr(order, field.name)
            if isinstance(steps, Steps) and steps.ahead:
                given: dict[str, Any] = {field.name: self.context.counted(steps)}
                return replace(order, **given)
        return order

    def skipping(self, order: ScriptOrder) -> ScriptOrder:
        """`Skip the next step`, in one case only: it goes on behind it."""
        if not isinstance(order, orders.Delete) or not isinstance(order.what, Steps):
            return order
        ahead = order.what.ahead
        steps = self.context.counted(order.what) if ahead else order.what
        following = (self.context.number or 0) + 1
        listed = steps.through or steps.points == (
            *range(following, following + len(steps.points)),
        )
        if not ahead and (steps.points[0] != following or not listed or not self.context.number):
            return order
        return orders.Jump(span=order.span, step=replace(steps, behind=True))

    def _given_up(self, order: ScriptOrder) -> bool:
        """`retry twice, then abort`: what is done if it fails all the same."""
        match order:
            case orders.Plain(word=PlainWord.ABORT, manner=None):
                self.manners.on_failure(OnFailure.ABORT)
            case orders.Plain(word=PlainWord.END) | orders.Home():
                message = "this can be meant for the case that it still fails, or for any case"
                hint = (
                    "write `if it still fails, ...` for the first, and a sentence of its own for "
                )
                hint += "the second"
                self.diagnostics.error("ambiguous-case", message, order.span, hint)
            case _:
                return False
        return True

    def order(self, order: ScriptOrder, block: ProgramBlock) -> None:
        """Carries one order out."""
        if self.done:
            hint = "move `Done!` to the end"
            self.diagnostics.error("after-done", "this comes after `Done!`", order.span, hint)
            return
        if not accepts(order, self.diagnostics):
            self.context.fail()
            return
        if isinstance(order, _WHOLE_PLAN) and in_branch(block):
            message = "this changes the plan, so it can't be done in one case only"
            hint = "write it as a step of its own"
            self.diagnostics.error("route", message, order.span, hint)
            return
        if self.visiting is not None and not isinstance(order, orders.Measure):
            self.leave_unvisited()
        match order:
            case orders.Spare():
                self._spare(order)
            case orders.VisitOrder():
                self._visit(order)
            case orders.WaitOrder(where=where) if where is not None:
                self._wait_at(order, where, block)
            case orders.Amend() | orders.Retry():
                self._amend(order)
            case orders.Plain():
                self._plain(order, block)
            case orders.Start():
                self._planned(order, self.starting.set(order), block)
            case orders.Repeat():
                self.repeating.repeat(order, block)
                self._say_order(order, [block.last] if block.last is not None else [])
            case orders.Jump():
                self._leave(Leave(order.step, order.span), block)
            case orders.Add() | orders.Delete() | orders.Move() | orders.Replace():
                self.edits.carry_out(order)
                if isinstance(order, orders.Add):
                    self.manners.furnish(order, self.context.recent)
            case orders.Patrol():
                self._patrol(order, block)
            case _:
                self._planned(order, self.tasks(order), block)

    def _visit(self, order: orders.VisitOrder) -> None:
        found = self.context.nouns.all(order.what)
        if found is None:
            self.context.fail()
            return
        self.context.remember(found)
        self.visiting = (order, found)

    def leave_unvisited(self) -> None:
        """Says where a drive to a checkpoint is not followed by what is to be done there."""
        if self.visiting is None:
            return
        (order, (checkpoint, *_)), self.visiting = self.visiting, None
        message = f"this does not say what to do at {checkpoint.name} (#{checkpoint.id})"
        hint = f"write `check checkpoint {checkpoint.id}`"
        self.diagnostics.error("visit", message, order.span, hint)

    def _wait_at(
        self, order: orders.WaitOrder, where: Location | FloorName, block: ProgramBlock
    ) -> None:
        """`The robot waits at the front of the site`: it starts there, if nothing is said of how
        long; else it goes there and waits."""
        begins = order.manner is None and self.context.program.first is None
        if begins and self.starting.start_at is None and not isinstance(where, FloorName):
            self.order(orders.Start(span=order.span, where=where), block)
            return
        self.order(orders.Go(span=order.span, where=where), block)
        self.order(replace(order, where=None), block)

    def _spare(self, order: orders.Spare) -> None:
        """Notes what is not to be checked; what is in the plan can't be."""
        for checkpoint in self.context.nouns.all(order.what) or ():
            self.context.spared[str(checkpoint.id)] = order.span

    def finish(self) -> None:
        """Looks whether what is not to be checked is in the plan; what is not, is said."""
        self.leave_unvisited()
        for key, span in self.context.spared.items():
            tasks = list(self.context.measured.get(key, {}).values())
            lines = sorted({s.line for do in tasks if (s := do.source)})
            if tasks:
                message = (
                    f"line {lines[0]} asks for checkpoint #{key}" if lines else "it is asked for"
                )
                hint = "leave one of the two out, or write `except` in the line that asks for it"
                self.diagnostics.error("spared", message, span, hint)
            else:
                message = f"checkpoint #{key} is not in the plan anyway, so that this has no effect"
                self.diagnostics.note("no-effect", message, span)

    def _amend(self, order: ScriptOrder) -> None:
        recent = self.context.recent
        if order.manner is not None and order.manner.order is not None:
            self.ordering.say(order.manner.order, recent, order.span)
            if not recent and said(order.manner) == {"order"}:
                return  # said of all tasks
        self.manners.amend(order)

    # ---- tasks

    def tasks(self, order: ScriptOrder) -> list[Do]:
        """The tasks of an order that plans some."""
        match order:
            case orders.Measure():
                nouns, what = self.context.nouns, order.what
                if order.manner is not None and order.manner.floors:
                    what = nouns.on(order.manner.floors, what)
                found = nouns.all(what)
                if found is None:
                    self.context.fail()
                    return []
                self.context.remember(found)
                tasks = [making.measurement(c.id, order.span) for c in found]
                if self.visiting is not None and self.visiting[1] == found[:1]:
                    self.manners.furnish(self.visiting[0], tasks[:1])
                    self.visiting = None
                self.leave_unvisited()
                return tasks
            case orders.Go():
                return self._go(order.where, order)
            case orders.Home():
                return self._dock(order.dock, order)
            case orders.WaitOrder():
                return self._wait(order)
            case orders.Plain(word=PlainWord.MEET):
                return [making.meeting(order.span)]
        message = "this can't be done here"
        self.diagnostics.error("route", message, order.span, "write it as a step of its own")
        return []

    def _go(self, where: Location | FloorName, order: ScriptOrder) -> list[Do]:
        if isinstance(where, FloorName):
            floor = self.context.lookup.floor(where)
            return [] if floor is None else [making.waypoint(floor.patrol[0], order.span)]
        pose, _ = self.context.locator.locate(where, "end")
        if pose is None:
            self.context.fail()
            return []
        return [making.waypoint(pose, order.span)]

    def _dock(self, dock: DockLocation, order: ScriptOrder) -> list[Do]:
        area = self.starting.docking_area(dock)
        if area is None:
            self.context.fail()
            return []
        return [making.dock(area.dock, order.span)]

    def _wait(self, order: orders.WaitOrder) -> list[Do]:
        manner = order.manner
        until = manner.until if manner is not None else None
        if order.person:
            message = "a mission does not wait for a person"
            hint = "let somebody pause it there, or write how long: `wait 5 minutes`"
            self.diagnostics.error("wait", message, order.span, hint)
            return []
        if manner is None or (manner.duration is None and until is None):
            message = "this does not say how long, or for what"
            hint = "write `wait 90 s`, `wait until #1 is below 3` or `wait for the all-clear`"
            self.diagnostics.error("wait", message, order.span, hint)
            return []
        if until is None and manner.time_limit is not None:
            message = "a wait that lasts for a time has no other limit"
            self.diagnostics.error("wait", message, order.span, "leave one of them out")
        if until is None:
            return [making.wait(WaitRule(duration=manner.duration), order.span)]
        if manner.time_limit is not None and manner.duration is not None:
            message = "how long it waits at most is said twice"
            self.diagnostics.error("repeated-limit", message, order.span, "leave one of them out")
        limit = manner.time_limit if manner.time_limit is not None else manner.duration
        match until.alternatives:
            case ((Occurs(event=EventKind() as event),),):
                rule = WaitRule(event=event, limit=limit)
            case ((Occurs(event=EventKind() as event),), others):
                found = self.context.conditions.alternatives(replace(until, alternatives=(others,)))
                if found is None:
                    return []
                rule = WaitRule(event=event, conditions=found[0], limit=limit)
            case _:
                conditions = self.context.conditions.alternatives(until)
                if conditions is None:
                    return []
                if len(conditions) > 1:
                    message = "a wait ends by conditions that all hold, not by one of several"
                    self.diagnostics.error("wait", message, until.span, "join them by `and`")
                    return []
                rule = WaitRule(conditions=conditions[0], limit=limit)
        return [making.wait(rule, order.span)]

    def _planned(self, order: ScriptOrder, tasks: list[Do], block: ProgramBlock) -> None:
        """Puts the tasks of an order into a block, with what is said of them."""
        if not tasks:
            return
        if isinstance(order, orders.Start) and not order.here:
            self.manners.name(order, tasks)
            self.manners.furnish(order, tasks)
            return
        if not self._may_go_on(order, block) or not self.comes_here(order.span, block):
            return
        context = self.context
        self.manners.name(order, tasks)
        nodes = self.manners.apply(order, tasks)
        self._say_order(order, tasks)
        context.put(nodes, block, block.last)
        context.step += nodes
        context.recent = tasks
        context.choice = None
        for do in tasks:
            context.note(do)
        if tasks[-1].docks and block is context.program:
            context.docked = tasks[-1]

    def _say_order(self, order: ScriptOrder, nodes: Sequence[ProgramNode]) -> None:
        if order.manner is not None and order.manner.order is not None:
            self.ordering.say(order.manner.order, nodes, order.span)

    def _may_go_on(self, order: ScriptOrder, block: ProgramBlock) -> bool:
        docked = self.context.docked
        if docked is None or not docked.listed or block is not self.context.program:
            return True
        if docked.ways or isinstance(order, orders.Plain):
            return True
        if isinstance(order, orders.Home):
            if order.dock.area is not None:  # `go home and dock in area 2`: the same, said better
                self.context.program.remove(docked)
                return True
            return False
        line = docked.source.line if docked.source else 0
        message = f"the robot is back in its docking station since line {line}"
        hint = "move the return to the end, or say how it goes on: `then go to step 3`"
        self.diagnostics.error("after-docking", message, order.span, hint)
        return False

    # ---- patrols

    def _patrol(self, order: orders.Patrol, block: ProgramBlock) -> None:
        tasks: list[Do] = []
        nodes: list[ProgramNode] = []
        limited = timed(self.context, order)
        if limited is None:
            return
        for base, poses in self.repeating.places(order):
            round_ = self.repeating.round(limited, base)
            if round_ is None:
                return
            stops = [making.waypoint(pose, order.span) for pose in poses]
            self.manners.furnish(limited, stops)
            self.context.put(stops, round_.body, None)
            tasks += stops
            nodes.append(round_)
        if nodes and self._may_go_on(order, block):
            self._say_order(order, tasks)
            nodes = self.manners.around(order, nodes)
            self.context.put(nodes, block, block.last)
            self.context.step += nodes
            self.context.recent = tasks
            self.context.choice = None

    # ---- orders of one word

    def _plain(self, order: orders.Plain, block: ProgramBlock) -> None:
        match order.word:
            case PlainWord.DONE:
                self.done = True
            case PlainWord.END:
                self._leave(Leave(Ahead.END, order.span), block)
            case PlainWord.GO_ON | PlainWord.REPORT:
                pass  # every reading is reported, and what comes next is done anyway
            case PlainWord.MEET:
                self._planned(order, self.tasks(order), block)
            case _:
                message = f"when is the robot to {order.word}?"
                hint = "write `if a gas leak is detected, pause`, or `wait 5 minutes`"
                self.diagnostics.error("stray-clause", message, order.span, hint)

    def _leave(self, leave: Leave, block: ProgramBlock) -> None:
        if self.comes_here(leave.span, block):
            self.context.put([leave], block, block.last)
            self.context.step.append(leave)
            self.context.choice = None

    def comes_here(self, span: Span, block: ProgramBlock) -> bool:
        """Whether the mission comes to the end of a block, or a step begins there."""
        last = block.last
        step = self.context.step
        begins = block is self.context.program and (not step or last not in step[-1:])
        if begins or not leads_away(last):
            return True
        message = "the mission never comes here: what stands before this leads elsewhere"
        hint = "write it before the words that lead elsewhere, or as a step of its own"
        self.diagnostics.error("second-route", message, span, hint)
        return False

    def home_ahead(self, order: orders.Home) -> HomeAhead | None:
        """The way home with which the mission ends where a condition leads to it."""
        pose = None
        if order.dock.area is not None:
            area = self.context.lookup.area(order.dock.area.area, order.dock.span)
            if area is None:
                return None
            pose = area.dock
        return HomeAhead(pose, order.dock.span)


def _several(orders_: Sequence[ScriptOrder]) -> bool:
    """Whether the last two orders both measure: what is said next may be said of both."""
    return len(orders_) > 1 and all(isinstance(order, orders.Measure) for order in orders_[-2:])
