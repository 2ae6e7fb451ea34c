"""Carries out the orders of a script: each adds to the program, or changes it."""

from collections.abc import Sequence
from dataclasses import replace

from argo_compiler.il import OnFailure
from argo_compiler.script.resolve.accepting import require_used, said
from argo_compiler.script.resolve.beside import measured_beside, require_once
from argo_compiler.script.resolve.cases import Cases
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.counting import counted
from argo_compiler.script.resolve.demanding import demanded_of
from argo_compiler.script.resolve.edits import Edits
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.ordering import Ordering
from argo_compiler.script.resolve.patrolling import patrol_rounds
from argo_compiler.script.resolve.program import (
    Ahead,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    in_branch,
)
from argo_compiler.script.resolve.reaching import is_back, require_reached
from argo_compiler.script.resolve.repeating import Repeating
from argo_compiler.script.resolve.sparing import check_spared
from argo_compiler.script.resolve.starting import Starting
from argo_compiler.script.resolve.tasks import TaskMaker
from argo_compiler.script.resolve.waiting import staying
from argo_compiler.script.syntax.text.source import RefusedError
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import PlainWord, ScriptOrder, Sentence
from argo_compiler.script.syntax.tree.places import FloorName, Location

_WHOLE_PLAN = (
    *(orders.Repeat, orders.Add, orders.Delete, orders.Move, orders.Replace, orders.Start),
)
_PLANNED = (orders.Measure, orders.Go, orders.Home, orders.Start)
"""most orders: they only plan tasks"""


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
        self.making = TaskMaker(context, starting, self.manners)
        self.cases = Cases(context, self)
        self.done = False

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
            self.order(order, block)

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
        """Carries one order out; one that can't be is given up."""
        try:
            self._order(order, block)
        except RefusedError:
            self.context.fail()

    def _order(self, order: ScriptOrder, block: ProgramBlock) -> None:
        context = self.context
        order = staying(counted(order, context), block, context)
        if self.done:
            hint = "move `Done!` to the end"
            self.diagnostics.refuse("after-done", "this comes after `Done!`", order.span, hint)
        if isinstance(order, orders.Amend) and self.repeating.limited(order, block):
            return
        require_used(order, self.diagnostics)
        if isinstance(order, _WHOLE_PLAN) and in_branch(block):
            message = "this changes the plan, so it can't be done in one case only"
            self.diagnostics.refuse("route", message, order.span, "write it as a step of its own")
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
                for measure in measured_beside(order, context):
                    self.order(measure, block)
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
                is_back(order, block, self.context)
                require_reached(order.span, block, context)
                rounds, stops = patrol_rounds(order, context, self.manners)
                self._put(order, self.manners.around(order, rounds), stops, block)
            case orders.Plain(word=word) if word is not PlainWord.MEET:
                self._plain(order, block)
            case _:
                self._planned(order, block)

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

    def _amend(self, order: ScriptOrder) -> None:
        recent = self.context.recent
        self._say_order(order, recent)
        if order.manner is None or recent or said(order.manner) != {"order"}:
            self.manners.amend(order)  # else said of all tasks

    def _planned(self, order: ScriptOrder, block: ProgramBlock) -> None:
        """Puts the tasks of an order into a block, with what is said of them."""
        if isinstance(order, orders.Measure) and (demanded := demanded_of(order, self.context)):
            self.manners.furnish(order, demanded)
            return
        tasks = self.making.tasks(order)
        if isinstance(order, orders.Start) and not order.here:
            self.manners.name(order, tasks)
            self.manners.furnish(order, tasks)
        elif not is_back(order, block, self.context):
            require_reached(order.span, block, self.context)
            self.manners.name(order, tasks)
            self._put(order, self.manners.apply(order, tasks), tasks, block)
            if tasks[-1].docks and block is self.context.program:
                self.context.docked = tasks[-1]

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
        if order.manner is not None and order.manner.order is not None:
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
                what = "every reading" if order.word is PlainWord.REPORT else "what comes behind"
                message = f"{what} is {done} anyway, so that this has no effect"
                self.diagnostics.note("no-effect", message, order.span)
            case _:
                message = f"when is the robot to {order.word}?"
                hint = "write `if a gas leak is detected, pause`, or `wait 5 minutes`"
                self.diagnostics.refuse("stray-clause", message, order.span, hint)

    def _leave(self, leave: Leave, block: ProgramBlock) -> None:
        require_reached(leave.span, block, self.context)
        self.context.put([leave], block, block.last)
        self.context.step.append(leave)
        self.context.choice = None

    def finish(self) -> None:
        """Looks whether all that was begun has been said to its end."""
        self.making.leave_unvisited()
        require_once(self.context)
        check_spared(self.context)


def _several(orders_: Sequence[ScriptOrder]) -> bool:
    """Whether the last two orders both measure: what is said next may be said of both."""
    return len(orders_) > 1 and all(isinstance(order, orders.Measure) for order in orders_[-2:])
