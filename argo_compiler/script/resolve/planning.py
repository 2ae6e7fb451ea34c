"""Carries out the steps of a script, and those within them: each order adds to the program, or
changes it."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from argo_compiler.il import OnFailure, Order
from argo_compiler.script.documents.source import MOST_KEPT, RefusedError
from argo_compiler.script.resolve.accepting import require_used, said
from argo_compiler.script.resolve.cases import Cases
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.edits import Edits
from argo_compiler.script.resolve.manners import Manners, make_round
from argo_compiler.script.resolve.ordering import Ordering
from argo_compiler.script.resolve.program import (
    Ahead,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    all_nodes,
    in_branch,
)
from argo_compiler.script.resolve.repeating import Repeating
from argo_compiler.script.resolve.starting import Starting
from argo_compiler.script.resolve.tasks import TaskMaker
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.manner import NOTHING_SAID, Manner
from argo_compiler.script.sentences.tree.node import Node
from argo_compiler.script.sentences.tree.nouns import Nouns, Pronoun
from argo_compiler.script.sentences.tree.orders import Fact, PlainWord, ScriptOrder, Sentence
from argo_compiler.script.sentences.tree.places import (
    AreaLocation,
    DockLocation,
    FloorName,
    Location,
    Steps,
)
from argo_compiler.script.sentences.tree.script import ScriptHeader, ScriptStep, Unread

_WHOLE_PLAN = (
    *(orders.Repeat, orders.Add, orders.Delete, orders.Move, orders.Replace, orders.Start),
)
_PLANNED = (orders.Measure, orders.Go, orders.Home, orders.Start)
"""most orders: they only plan tasks"""


class Planner:
    """Plans steps and their sentences, into the program or into a block of it."""

    def __init__(self, context: Context, starting: Starting, header: ScriptHeader) -> None:
        self.context = context
        self.header = header
        self.diagnostics = context.diagnostics
        self.starting = starting
        self.manners = Manners(context)
        self.repeating = Repeating(context)
        self.ordering = Ordering(context, header)
        self.edits = Edits(context, self.manners)
        self.making = TaskMaker(context, starting, self.manners)
        self.cases = Cases(context, self.manners, self.carry_out)
        self.done = False

    def steps(self, steps: Sequence[ScriptStep]) -> None:
        """Plans all steps of a script."""
        self._check_numbers(steps)
        numbered = any(step.number is not None for step in steps)
        for i, step in enumerate(steps, start=1):
            if self.diagnostics.errors > MOST_KEPT:
                return  # further errors would not be kept
            number = step.number if numbered else i
            self.context.begin_step(number)
            self._step(step, self.context.program, number)

    def _check_numbers(self, steps: Sequence[ScriptStep]) -> None:
        """Warns where the steps' numbers are not one after the other: a line may have been lost.

        Steps with the numbers 1 to n in another order are asked about.
        """
        numbers = [step.number for step in steps if step.number is not None]
        in_order = list(range(1, len(numbers) + 1))
        if numbers != in_order and sorted(numbers) == in_order:
            message = "the steps can be meant in the order of their numbers, or as they are written"
            hint = "number them in the order in which they are done"
            self.diagnostics.error("ambiguous-step", message, steps[0].span, hint)
            return
        expected = 1
        for step in steps:
            if step.number is None:
                continue
            if step.number != expected:
                message = f"step {step.number} is in the position of step {expected}"
                hint = "check whether a line is missing or misplaced"
                self.diagnostics.warning("step-number", message, step.span, hint)
            expected = step.number + 1

    def _step(self, step: ScriptStep, block: ProgramBlock, number: int | None = None) -> None:
        sentences = list(step.sentences)
        following = self._taken(sentences) if step.steps else None
        for i, sentence in enumerate(sentences, start=1):
            ends = i == len(sentences) and not step.steps
            self.context.number = number if ends else None
            errors = self.diagnostics.errors
            if isinstance(sentence, Sentence):
                self._sentence(self._without_limit(sentence), block)
                for fact in sentence.facts:
                    self._fact(fact)
            elif not isinstance(sentence, Unread):
                self._fact(sentence)
            if isinstance(sentence, Unread) or self.diagnostics.errors > errors:
                self.context.fail()
        if following is None or not following.manner:
            for one in step.steps:
                self._step(one, block)
            return
        with suppress(RefusedError):
            self._follow(following, step.steps, block)

    def _follow(self, order: ScriptOrder, steps: Sequence[ScriptStep], block: ProgramBlock) -> None:
        """Plans the steps within one that says how they are done."""
        manner = order.manner
        require_used(order, self.diagnostics)
        known: set[int] = set()
        if said(manner) <= {"order", "by_importance"}:
            known = {id(node) for node in all_nodes(block)}
        else:
            round_ = make_round(order, "Repeat", self.context, order.name)
            self.context.put([round_], block, block.last)
            self.context.step.append(round_)
            block = round_.body
        for one in steps:
            self._step(one, block)
        tasks = [n for n in all_nodes(block) if isinstance(n, Do) and id(n) not in known]
        if manner.order is not None:
            self.ordering.say(manner.order, tasks, order.span)
        if manner.by_importance:
            of_each = Manner(by_importance=True)
            self.manners.furnish_each(of_each, order.span, tasks)

    def _without_limit(self, sentence: Sentence) -> Sentence:
        """The sentence without the duration of the mission: `at most 25 minutes in total`."""
        if not any(order.manner for order in sentence.orders):
            return sentence
        left: list[ScriptOrder] = []
        for order in sentence.orders:
            manner = order.manner
            limit = manner.mission_time or self._limit(order)
            if limit is None:
                left.append(order)
                continue
            self._max_duration(limit, order)
            own = None if manner.mission_time is None else manner.time_limit
            rest = replace(manner, mission_time=None, time_limit=own)
            if rest or not isinstance(order, orders.Amend):
                left.append(replace(order, manner=rest))
        return replace(sentence, orders=tuple(left))

    def _limit(self, order: ScriptOrder) -> float | None:
        """A limit of time that can only be the mission's: of its start, or before all else."""
        first = isinstance(order, orders.Amend) and self.context.program.first is None
        alone = first and said(order.manner) == {"time_limit"}
        return order.manner.time_limit if alone or isinstance(order, orders.Start) else None

    def _taken(self, sentences: list[Sentence | Fact | Unread]) -> ScriptOrder | None:
        """`Do the following twice:`, taken out of the sentences over inner steps."""
        last = sentences[-1] if sentences else None
        if not isinstance(last, Sentence) or last.cases or not last.orders:
            return None
        *before, order = last.orders
        if isinstance(order, orders.Amend) and not before:
            order = orders.Follow(span=order.span, name=order.name, manner=order.manner)
        if not isinstance(order, orders.Follow):
            return None
        found: ScriptOrder = order
        while before and isinstance(before[-1], orders.Amend):
            found = self.manners.with_prefix(found, before.pop())
        sentences[-1:] = [replace(last, orders=tuple(before))] if before else []
        return found

    def _fact(self, fact: Fact) -> None:
        match fact:
            case orders.MaxDuration():
                self._max_duration(fact.seconds, fact)
                if fact.where is not None:
                    self._back(fact, fact.where)
            case orders.RoundsDriven():
                manner = Manner(times=fact.count)
                order = orders.Repeat(span=fact.span, steps=fact.steps, manner=manner)
                self.order(order, self.context.program)
            case orders.DoneBefore():
                with suppress(RefusedError):
                    self.ordering.precede(fact)
            case orders.LeaveOut():
                self.ordering.left_out.append(fact.span)
            case orders.OrderFree():
                self.ordering.say(Order.ANY, (), fact.span)

    def _back(self, fact: Fact, dock: Location) -> None:
        if isinstance(dock, AreaLocation):
            dock = DockLocation(span=fact.span, area=dock)
        if not isinstance(dock, DockLocation):
            message = "a mission can have a latest end in a docking station only, not at a place"
            hint = "name the starting area: `it has to be back in starting area 1`"
            self.diagnostics.error("fact", message, fact.span, hint)
            return
        self.order(orders.Home(span=fact.span, dock=dock), self.context.program)

    def _max_duration(self, seconds: float, fact: Node) -> None:
        said = self.header.max_duration
        if said is not None and said[0] != seconds:
            message = f"line {said[1].span.line} has another maximum duration"
            self.diagnostics.error("repeated-field", message, fact.span, "remove one of the two")
        self.header.max_duration = (seconds, fact)

    # ---- sentences and orders

    def _sentence(self, sentence: Sentence, block: ProgramBlock) -> None:
        """Carries a sentence out."""
        self.carry_out(sentence.orders, block)
        for case in sentence.cases:
            self.cases.add(case, block)

    def carry_out(self, orders_: Sequence[ScriptOrder], block: ProgramBlock) -> None:
        """Carries orders out, one after the other, at the end of a block."""
        prefix: ScriptOrder | None = None
        floors = NOTHING_SAID
        for i, order in enumerate(orders_):
            if isinstance(order, orders.Amend) and i + 1 < len(orders_):
                # `three times: check checkpoint 17`
                prefix = order if prefix is None else self.manners.with_prefix(order, prefix)
                continue
            if i and isinstance(orders_[i - 1], orders.Retry) and self._given_up(order):
                continue
            if prefix is not None:
                floors = Manner(floors=prefix.manner.floors)
                order = self.manners.with_prefix(order, prefix)
                prefix = None
            elif floors and isinstance(order, orders.Measure):
                # `on the second floor, check the valve, then read the gauge`
                order = self.manners.with_prefix(order, replace(order, name=None, manner=floors))
            before = orders_[max(i - 2, 0) : i]
            several = len(before) == 2 and all(isinstance(one, orders.Measure) for one in before)
            if isinstance(order, orders.Retry) and several:
                message = "this can apply to the last of these only, or to each of them"
                hint = "write `check checkpoints 1 and 4, retry twice` for each, or two sentences"
                self.diagnostics.error("ambiguous-manner", message, order.span, hint)
                continue
            self.order(order, block)

    def _given_up(self, order: ScriptOrder) -> bool:
        """`retry twice, then abort`: what is done if it fails all the same."""
        match order:
            case orders.Plain(word=PlainWord.ABORT) if not order.manner:
                self.manners.on_failure(OnFailure.ABORT)
            case orders.Plain(word=PlainWord.END) | orders.Home():
                message = "this can apply only if it still fails, or in any case"
                hint = "write `if it still fails, ...` for the first, and a separate sentence "
                hint += "for the second"
                self.diagnostics.error("ambiguous-case", message, order.span, hint)
            case _:
                return False
        return True

    def order(self, order: ScriptOrder, block: ProgramBlock) -> None:
        """Carries one order out; one that can't be is given up."""
        try:
            self._order(order, block)
        except RefusedError:
            self.context.fail()

    def _order(self, order: ScriptOrder, block: ProgramBlock) -> None:
        context = self.context
        order = _as_wait_for_battery(self._staying(context.counted(order), block))
        if self.done:
            hint = "move `Done!` to the end"
            self.diagnostics.refuse("after-done", "this comes after `Done!`", order.span, hint)
        if isinstance(order, orders.Amend) and self.repeating.limited(order, block):
            return
        require_used(order, self.diagnostics)
        changes = isinstance(order, _WHOLE_PLAN) or order.manner.task_pair is not None
        if changes and in_branch(block):
            message = "this changes the mission, so it can't depend on a condition"
            self.diagnostics.refuse("route", message, order.span, "write it as a separate step")
        if not isinstance(order, orders.Measure):
            self.making.leave_unvisited()
        if type(order) in _PLANNED:
            self._planned(order, block)
            return
        match order:
            case orders.Spare():
                for checkpoint in context.nouns.all(order.what):
                    context.spared[str(checkpoint.id)] = order.span
            case orders.VisitOrder():
                self.making.visit(order)
            case orders.Beside():
                for measure in self.making.measured_beside(order):
                    self.order(measure, block)
            case orders.WaitOrder() if order.manner.task_pair is not None:
                self._wait_between(order, order.manner.task_pair)
            case orders.WaitOrder(where=where) if where is not None:
                self._wait_at(order, where, block)
            case orders.Amend() | orders.Retry():
                self._amend(order)
            case orders.Repeat():
                self.repeating.repeat(order, block)
                self._say_order(order, [block.last] if block.last is not None else [])
            case orders.Jump():
                self._leave(Leave(order.step, order.span), block)
            case orders.Add() | orders.Delete() | orders.Move() | orders.Replace():
                self.repeating.fill_known()
                self.edits.carry_out(order)
            case orders.Patrol():
                self._is_back(order, block)
                context.require_reached(order.span, block)
                rounds, stops = self.making.patrol_rounds(order)
                self._put(order, self.manners.around(order, rounds), stops, block)
            case orders.Plain(word=word) if word is not PlainWord.MEET:
                self._plain(order, block)
            case _:
                self._planned(order, block)

    def _staying(self, order: ScriptOrder, block: ProgramBlock) -> ScriptOrder:
        """Take `stay there` for the end of the mission, unless another order comes behind it; then
        it has to say how long."""
        context = self.context
        if context.stays is not None and not isinstance(order, orders.Plain):
            hint = "write `stay there for 90 s`, or move it to the end if the mission ends there"
            context.diagnostics.error("wait", "this does not say how long", context.stays, hint)
            context.stays = None
            context.fail()
        if not isinstance(order, orders.WaitOrder) or not order.stays or in_branch(block):
            return order
        if order.manner or order.where is not None:
            return order
        context.stays = order.span
        return orders.Plain(span=order.span, word=PlainWord.END)

    def _is_back(self, order: ScriptOrder, block: ProgramBlock) -> bool:
        """Whether the robot is in its docking station, and is only told to go there again. Raises
        RefusedError if it is told anything else."""
        context = self.context
        docked = context.docked
        if docked is None or not docked.is_listed or block is not context.program:
            return False
        if docked.ways or isinstance(order, orders.Plain):
            return False
        if isinstance(order, orders.Home):
            if order.dock.area is None:
                return True
            context.program.remove(docked)  # `go home and dock in area 2`
            return False
        lasting = order.manner.duration or order.manner.until
        if isinstance(order, orders.WaitOrder) and (order.recharges or lasting):
            context.docked = None  # `stay there for 5 minutes`: it goes on behind that
            return False
        line = docked.source.line if docked.source else 0
        message = f"line {line} has already returned the robot to its docking station"
        hint = "move the return to the end, or write how to go on: `then go to step 3`"
        context.diagnostics.refuse("after-docking", message, order.span, hint)

    def _wait_at(
        self, order: orders.WaitOrder, where: Location | FloorName, block: ProgramBlock
    ) -> None:
        """`The robot waits at the front of the site`: it starts there, if nothing is said of how
        long; else it goes there and waits."""
        begins = not order.manner and self.context.program.first is None
        if begins and self.starting.start_at is None and not isinstance(where, FloorName):
            self.order(orders.Start(span=order.span, where=where), block)
            return
        self.order(orders.Go(span=order.span, where=where), block)
        self.order(replace(order, where=None), block)

    def _wait_between(self, order: orders.WaitOrder, between: Nouns | Steps) -> None:
        """Put a wait between two neighbouring tasks that are planned already."""
        if order.where is not None:
            message = "a wait between two tasks is where the robot is then, not at another place"
            hint = "remove the place, or write the drive and the wait between the two lines"
            self.diagnostics.refuse("stray-clause", message, order.span, hint)
        if order.manner.condition is not None or order.manner.until is not None:
            # `it` would be what was measured last in the script, and not before the wait.
            message = "a wait between two tasks has a duration, and no condition"
            hint = "write the wait and its condition in a line between the lines of the two"
            self.diagnostics.refuse("stray-clause", message, order.span, hint)
        tasks = self.making.tasks(order)
        self.manners.name(order, tasks)
        self.repeating.fill_known()
        nodes = self.manners.apply(order, tasks)
        first, second = self.edits.put_between(between, nodes)
        self.ordering.between.append((order.span, first, nodes[0], second))

    def _amend(self, order: ScriptOrder) -> None:
        recent = self.context.recent
        self._say_order(order, recent)
        if recent or said(order.manner) != {"order"}:
            self.manners.amend(order)  # else said of all tasks

    def _planned(self, order: ScriptOrder, block: ProgramBlock) -> None:
        """Puts the tasks of an order into a block, with what is said of them."""
        if isinstance(order, orders.Measure) and (demanded := self.making.demanded_of(order)):
            self.manners.furnish(order, demanded)
            return
        tasks = self.making.tasks(order)
        if isinstance(order, orders.Measure) and self._is_same_reading(order, tasks, block):
            message = "this can be the reading that was asked for just before, or one more"
            hint = "write `check it again` for one more, or remove this"
            self.diagnostics.refuse("ambiguous-measure", message, order.span, hint)
        if isinstance(order, orders.Start) and not order.here:
            self.manners.name(order, tasks)
            self.manners.furnish(order, tasks)
        elif not self._is_back(order, block):
            self.context.require_reached(order.span, block)
            self.manners.name(order, tasks)
            self._put(order, self.manners.apply(order, tasks), tasks, block)
            if tasks[-1].docks and block is self.context.program:
                self.context.docked = tasks[-1]

    def _is_same_reading(
        self, order: orders.Measure, tasks: Sequence[Do], block: ProgramBlock
    ) -> bool:
        """Return True if `read it` directly follows the order to measure what it means."""
        before = self.context.recent
        pronouns = all(isinstance(noun, Pronoun) for noun in order.what.nouns)
        follows = bool(before) and block.last is before[-1] and not before[-1].ways
        same = [do.object_id for do in tasks] == [do.object_id for do in before]
        return pronouns and follows and same and not order.manner

    def _put(
        self,
        order: ScriptOrder,
        nodes: Sequence[ProgramNode],
        tasks: list[Do],
        block: ProgramBlock,
    ) -> None:
        context = self.context
        self._say_order(order, tasks)
        context.put(nodes, block, block.last)
        context.step += nodes
        context.recent = tasks
        context.choice = None

    def _say_order(self, order: ScriptOrder, nodes: Sequence[ProgramNode]) -> None:
        if order.manner.order is not None:
            self.ordering.say(order.manner.order, nodes, order.span)

    # ---- orders of one word

    def _plain(self, order: orders.Plain, block: ProgramBlock) -> None:
        match order.word:
            case PlainWord.DONE:
                self.done = True
            case PlainWord.END:
                self._leave(Leave(Ahead.END, order.span), block)
            case PlainWord.GO_ON | PlainWord.REPORT:
                done = "reported" if order.word is PlainWord.REPORT else "done next"
                what = "every reading" if order.word is PlainWord.REPORT else "the next task"
                message = f"this has no effect, because {what} is {done} anyway"
                self.diagnostics.warning("no-effect", message, order.span)
            case _:
                message = f"this does not say when to {order.word}"
                hint = "write `if a gas leak is detected, pause`, or `wait 5 minutes`"
                self.diagnostics.refuse("stray-clause", message, order.span, hint)

    def _leave(self, leave: Leave, block: ProgramBlock) -> None:
        self.context.require_reached(leave.span, block)
        self.context.put([leave], block, block.last)
        self.context.step.append(leave)
        self.context.choice = None

    def finish(self) -> None:
        """Looks whether all that was begun has been said to its end."""
        self.making.leave_unvisited()
        self._require_once()
        self._check_spared()

    def _require_once(self) -> None:
        """Asks about what is measured beside another one, and elsewhere as well."""
        context = self.context
        for key, span in context.once.items():
            if len(context.measured.get(key, {})) > 1:
                message = f"checkpoint #{key} is measured elsewhere as well: it can be meant "
                message += "to be measured here as well, or only there"
                hint = "name it in only one of the two places, or write `check it again`"
                context.diagnostics.error("ambiguous-edit", message, span, hint)

    def _check_spared(self) -> None:
        """Looks whether it is in the plan; what is not, is said."""
        context = self.context
        for key, span in context.spared.items():
            tasks = context.measured.get(key)
            if tasks:
                lines = sorted({s.line for do in tasks.values() if (s := do.source)})
                asks = f"line {lines[0]} asks for checkpoint #{key}" if lines else "it is asked for"
                hint = "remove one of the two, or write `except` in the line that asks for it"
                context.diagnostics.error("spared", asks, span, hint)
            else:
                message = f"checkpoint #{key} is not in the mission anyway, so this has no effect"
                context.diagnostics.warning("no-effect", message, span)


def _as_wait_for_battery(order: ScriptOrder) -> ScriptOrder:
    """Return `recharge` as the wait that it is; another order is returned as it is."""
    match order:
        case orders.Plain(word=PlainWord.RECHARGE):
            return orders.WaitOrder(
                span=order.span, manner=order.manner, name=order.name, recharges=True
            )
    return order
