"""What is done if something is so: after a value, after a failure, after an event."""

from dataclasses import replace
from typing import TYPE_CHECKING

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.script.resolve.accepting import accepts
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.excluding import put_together
from argo_compiler.script.resolve.failing import POLICIES, Failures, is_failure
from argo_compiler.script.resolve.program import (
    Ahead,
    Alternatives,
    Choice,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    Target,
    Way,
    in_branch,
    leads_away,
)
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import SaidCondition, Test, TooLate
from argo_compiler.script.syntax.tree.orders import Case, PlainWord, Rest

if TYPE_CHECKING:  # a case's orders are planned as any others are
    from argo_compiler.script.resolve.planning import Planner


class Cases:
    """Plans cases behind what they are looked at after."""

    def __init__(self, context: Context, planner: "Planner") -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.planner = planner
        self.failures = Failures(context, planner, self._branch)
        self.asked: tuple[CheckpointInfo, ...] = ()
        """what `it` means in a condition, and where that does not hold"""

    def add(self, case: Case, block: ProgramBlock) -> None:
        """Plans one case. After it, `it` may be what the condition asks of, or what is measured in
        that case only."""
        memory = self.context.memory
        before = memory.last
        if case.condition is None or case.chained:
            memory.last = self.asked
        else:
            self.asked = before
        self._add(case, block)
        memory.last = (*before, *(c for c in memory.last if c not in before))

    def _add(self, case: Case, block: ProgramBlock) -> None:
        condition = case.condition
        case = replace(case, orders=tuple(map(self.planner.skipping, case.orders)))
        if condition is None:
            self._otherwise(case, block)
        elif any(isinstance(t, TooLate) for tests in condition.alternatives for t in tests):
            self.context.choice = None
            self.failures.too_late(case, condition)
        elif not any(isinstance(t, Test) for tests in condition.alternatives for t in tests):
            self.context.choice = None
            self.context.reactions.add(case)
        elif not case.orders:
            message = "this does not say what to do"
            hint = "add, say, `go to step 5` or `return to the docking station`"
            self.diagnostics.error("unfinished", message, case.span, hint)
        elif is_failure(condition):
            self.context.choice = None
            self.failures.failure(case, block)
        elif case.chained and (inner := self._other_case(case, block)) is not block:
            if inner is not None:
                self._values(case, condition, inner)
        else:
            self._values(case, condition, block)

    def _other_case(self, case: Case, block: ProgramBlock) -> ProgramBlock | None:
        """Where a condition of `otherwise, if ...` stands; None if there is no other one before."""
        before = self.context.choice
        if isinstance(before, Choice) and before.listed and before.otherwise.first is None:
            return before.otherwise
        do = block.last
        if isinstance(before, Way) and isinstance(do, Do) and before in do.ways:
            if before.target is not Ahead.GO_ON:
                return block  # the first way whose condition holds is taken
            choice = Choice(self._taken(do, before), case.span)
            self._to_choice(do, before, choice, block)
            return choice.otherwise
        self._otherwise_of_what(case)
        return None

    # ---- values

    def _values(self, case: Case, condition: SaidCondition, block: ProgramBlock) -> None:
        alternatives = self.context.conditions.alternatives(condition)
        do = block.last
        if isinstance(do, Leave) and not self.planner.comes_here(case.span, block):
            return
        if isinstance(do, Do) and any(way.otherwise for way in do.ways):
            message = "this is never looked at: `otherwise` before it leads elsewhere"
            hint = "write this condition before the `otherwise`"
            self.diagnostics.error("second-route", message, case.span, hint)
            return
        if alternatives is None:
            return
        target = self._target(case)
        simple = target is not None and target is not Ahead.END and not condition.negated
        if simple and isinstance(do, Do) and do.failure is None and do.missed is None:
            assert target is not None
            way = Way(alternatives, target, case.span)
            do.ways.append(way)
            self.context.choice = way
            return
        choice = Choice(alternatives, case.span, negated=condition.negated, bound=self._bound(do))
        self.context.put([choice], block, do)
        if not in_branch(block):
            self.context.step.append(choice)
        self._branch(case, choice.then)
        self.context.choice = choice

    def _bound(self, node: ProgramNode | None) -> bool:
        """Whether a node stands in the step that is being planned."""
        return node is not None and node in self.context.step[-1:]

    def _branch(self, case: Case, branch: ProgramBlock) -> None:
        """Plans what is done in one case only; after the way home the mission is over."""
        context = self.context
        memory = context.memory.last
        docked, context.docked = context.docked, None
        recent, step = context.recent, context.step
        context.step = []
        orders_ = list(case.orders)
        ending: Leave | None = None
        if orders_ and isinstance(orders_[-1], orders.Plain) and orders_[-1].word in POLICIES:
            last = orders_[-1]
            assert isinstance(last, orders.Plain)
            if not accepts(last, self.diagnostics):
                return
            orders_.pop()
            ahead = Ahead.GO_ON if last.word is PlainWord.GO_ON else Ahead.END
            ending = Leave(ahead, last.span)
        home = orders_[-1] if orders_ and isinstance(orders_[-1], orders.Home) else None
        if home is not None and (ending is None or ending.target is Ahead.END):
            if home.manner is None and home.name is None:
                orders_.pop()
                way = self.planner.home_ahead(home)
                ending = None if way is None else Leave(way, home.span)
            else:
                ending = Leave(Ahead.END, home.span)
        self.planner.carry_out(orders_, branch)
        if ending is not None:
            context.put([ending], branch, branch.last)
        if leads_away(branch.last):
            context.memory.last = memory
        context.docked, context.recent, context.step = docked, recent, step

    def _otherwise(self, case: Case, block: ProgramBlock) -> None:
        if case.rest is not Rest.OTHERWISE:
            self._rest(case, block)
            return
        before = self.context.choice
        if isinstance(before, Choice) and before.listed and before.block is not None:
            if before.otherwise.first is not None:
                message = "there are two `otherwise` for one condition"
                self.diagnostics.error("second-route", message, case.span, "leave one out")
            elif self._is_of_all(before, case):
                self._branch(case, before.otherwise)
            return
        do = block.last
        target = self._target(case)
        if isinstance(before, Way) and isinstance(do, Do):
            if target is not None:
                do.ways.append(Way((), target, case.span, otherwise=True))
                return
            choice = Choice(self._taken(do, before), case.span)
            self._to_choice(do, before, choice, block)
            self._branch(case, choice.otherwise)
            self.context.choice = choice
            return
        self._otherwise_of_what(case)

    def _otherwise_of_what(self, case: Case) -> None:
        if not self.context.whole:
            return  # the condition may be what was not understood
        message = "`Otherwise` of what? No condition stands before it"
        hint = "write it behind the condition whose other case it is"
        self.diagnostics.error("otherwise", message, case.span, hint)

    def _is_of_all(self, last: Choice, case: Case) -> bool:
        """Whether `otherwise` behind several conditions is clear: it is what is done if none of
        them holds, which is put so that it is."""
        if put_together(last):
            return True
        message = "`otherwise` can be meant for the last of these conditions, or for all"
        hint = "write `otherwise, if ...`, or say each condition in a step of its own"
        self.diagnostics.error("ambiguous-otherwise", message, case.span, hint)
        return False

    def _rest(self, case: Case, block: ProgramBlock) -> None:
        """The way that a task leads on if none of its conditions holds, wherever that is said."""
        do, target = block.last, self._target(case)
        if isinstance(do, Do) and target is not None:
            last_round = case.rest is Rest.LAST_ROUND
            do.ways.append(Way((), target, case.span, last_round=last_round))
            return
        message = f"`{case.rest}` is said of a task, and leads to another one"
        hint = f"write it behind the task: `{case.rest}, go to step 5`"
        self.diagnostics.error("otherwise", message, case.span, hint)

    def _taken(self, do: Do, way: Way) -> Alternatives:
        do.ways.remove(way)
        return way.alternatives

    def _to_choice(self, do: Do, way: Way, choice: Choice, block: ProgramBlock) -> None:
        """Puts a choice where a way was: its other case has orders of its own."""
        choice.bound = self._bound(do)
        self.context.put([choice], block, do)
        self.context.step.append(choice)
        self.context.put([Leave(way.target, way.span)], choice.then, None)

    def _target(self, case: Case) -> Target | None:
        """Where a case leads whose only order is to go elsewhere."""
        if len(case.orders) != 1:
            return None
        (order,) = case.orders
        if order.manner is not None or order.name is not None:
            return None
        match order:
            case orders.Jump():
                return order.step
            case orders.Home():
                return self.planner.home_ahead(order)
            case orders.Plain(word=PlainWord.GO_ON):
                return Ahead.GO_ON
            case orders.Plain(word=PlainWord.END) | orders.Plain(word=PlainWord.ABORT):
                return Ahead.END
        return None
