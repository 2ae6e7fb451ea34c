"""Goes through the steps of a script, with those that lie within others."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from argo_compiler.il import Order
from argo_compiler.script.resolve.accepting import require_used, said
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import make_round
from argo_compiler.script.resolve.planning import Planner
from argo_compiler.script.resolve.program import Do, ProgramBlock, all_nodes
from argo_compiler.script.syntax.text.source import MOST_KEPT, RefusedError
from argo_compiler.script.syntax.tree import facts, orders
from argo_compiler.script.syntax.tree.facts import Fact
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.node import Node
from argo_compiler.script.syntax.tree.orders import ScriptOrder, Sentence
from argo_compiler.script.syntax.tree.places import AreaLocation, DockLocation
from argo_compiler.script.syntax.tree.script import ScriptHeader, ScriptStep, Unread


class Stepping:
    """Plans steps."""

    def __init__(self, context: Context, planner: Planner, header: ScriptHeader) -> None:
        self.context = context
        self.planner = planner
        self.header = header

    def all(self, steps: Sequence[ScriptStep]) -> None:
        """Plans all steps of a script."""
        self._check_numbers(steps)
        numbered = any(step.number is not None for step in steps)
        for i, step in enumerate(steps, start=1):
            if self.context.diagnostics.errors > MOST_KEPT:
                return  # further errors would not be kept
            number = step.number if numbered else i
            self.context.begin_step(number)
            self._step(step, self.context.program, number)

    def _check_numbers(self, steps: Sequence[ScriptStep]) -> None:
        """Warns where the steps' numbers are not one after the other: a line may have been lost."""
        expected = 1
        for step in steps:
            if step.number is None:
                continue
            if step.number != expected:
                message = f"step {step.number} stands where step {expected} would be"
                hint = "is a line missing, or in the wrong place?"
                self.context.diagnostics.warning("step-number", message, step.span, hint)
            expected = step.number + 1

    def _step(self, step: ScriptStep, block: ProgramBlock, number: int | None = None) -> None:
        sentences = list(step.sentences)
        following = self._taken(sentences) if step.steps else None
        for i, sentence in enumerate(sentences, start=1):
            ends = i == len(sentences) and not step.steps
            self.context.number = number if ends else None
            errors = self.context.diagnostics.errors
            if isinstance(sentence, Sentence):
                self.planner.sentence(self._without_limit(sentence), block)
                for fact in sentence.facts:
                    self._fact(fact)
            elif not isinstance(sentence, Unread):
                self._fact(sentence)
            if isinstance(sentence, Unread) or self.context.diagnostics.errors > errors:
                self.context.fail()
        if following is None or following.manner is None:
            for one in step.steps:
                self._step(one, block)
            return
        with suppress(RefusedError):
            self._follow(following, following.manner, step.steps, block)

    def _follow(
        self,
        order: ScriptOrder,
        manner: Manner,
        steps: Sequence[ScriptStep],
        block: ProgramBlock,
    ) -> None:
        """Plans the steps within one that says how they are done."""
        require_used(order, self.context.diagnostics)
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
            self.planner.ordering.say(manner.order, tasks, order.span)
        if manner.by_importance:
            of_each = Manner(by_importance=True)
            self.planner.manners.furnish_each(of_each, order.span, tasks)

    def _without_limit(self, sentence: Sentence) -> Sentence:
        """The sentence without how long the mission may take: `at most 25 minutes in total`."""
        if all(order.manner is None for order in sentence.orders):
            return sentence
        kept: list[ScriptOrder] = []
        for order in sentence.orders:
            manner = order.manner
            limit = None if manner is None else manner.mission_time or self._limit(order, manner)
            if manner is None or limit is None:
                kept.append(order)
                continue
            self._max_duration(limit, order)
            own = None if manner.mission_time is None else manner.time_limit
            rest = replace(manner, mission_time=None, time_limit=own)
            if said(rest):
                kept.append(replace(order, manner=rest))
            elif not isinstance(order, orders.Amend):
                kept.append(replace(order, manner=None))
        return replace(sentence, orders=tuple(kept))

    def _limit(self, order: ScriptOrder, manner: Manner) -> float | None:
        """A limit of time that can only be the mission's: of its start, or before all else."""
        first = isinstance(order, orders.Amend) and self.context.program.first is None
        alone = first and said(manner) == {"time_limit"}
        return manner.time_limit if alone or isinstance(order, orders.Start) else None

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
            found = self.planner.manners.with_prefix(found, before.pop())
        sentences[-1:] = [replace(last, orders=tuple(before))] if before else []
        return found

    def _fact(self, fact: Fact) -> None:
        match fact:
            case facts.MaxDuration():
                self._max_duration(fact.seconds, fact)
            case facts.BackWithin():
                self._max_duration(fact.seconds, fact)
                self._back(fact)
            case facts.RoundsDriven():
                manner = Manner(times=fact.count)
                order = orders.Repeat(span=fact.span, steps=fact.steps, manner=manner)
                self.planner.order(order, self.context.program)
            case facts.ReadBefore():
                with suppress(RefusedError):
                    self.planner.ordering.precedence(fact)
            case facts.StepsOrdered():
                self.planner.ordering.steps.append(fact)
            case facts.LeaveOut():
                self.planner.ordering.leave_out(fact.span)
            case facts.OrderFree():
                self.planner.ordering.say(Order.ANY, (), fact.span)

    def _back(self, fact: facts.BackWithin) -> None:
        dock = fact.where
        if isinstance(dock, AreaLocation):
            dock = DockLocation(span=fact.span, area=dock)
        if not isinstance(dock, DockLocation):
            message = "a mission ends in a docking station by a certain time, not at a place"
            hint = "name the starting area: `it has to be back in starting area 1`"
            self.context.diagnostics.error("fact", message, fact.span, hint)
            return
        self.planner.order(orders.Home(span=fact.span, dock=dock), self.context.program)

    def _max_duration(self, seconds: float, fact: Node) -> None:
        said = self.header.max_duration
        if said is not None and said[0] != seconds:
            message = f"line {said[1].span.line} says another maximum duration"
            hint = "leave one of the two out"
            self.context.diagnostics.error("repeated-field", message, fact.span, hint)
        self.header.max_duration = (seconds, fact)
