"""What is done if something is so: after a value, after a failure, after an event."""

from dataclasses import replace
from typing import NoReturn

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.resolve.branching import CaseBranches
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.counting import skipping
from argo_compiler.script.resolve.excluding import put_together
from argo_compiler.script.resolve.failing import Failures, OrderPlanner, is_failure
from argo_compiler.script.resolve.program import (
    Ahead,
    Choice,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    Way,
    in_branch,
)
from argo_compiler.script.resolve.reaching import require_reached
from argo_compiler.script.syntax.text.source import RefusedError
from argo_compiler.script.syntax.tree.conditions import SaidCondition, Test, TooLate
from argo_compiler.script.syntax.tree.orders import Case, Rest


class Cases:
    """Plans cases behind what they are looked at after."""

    def __init__(self, context: Context, planner: OrderPlanner) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.branches = CaseBranches(context, planner.carry_out)
        self.failures = Failures(context, planner, self.branches)
        self.asked: tuple[CheckpointInfo, ...] = ()
        """what `it` means in a condition, and where that does not hold"""

    def add(self, case: Case, block: ProgramBlock) -> None:
        """Plans one case; one that can't be is given up. After it, `it` may be what the condition
        asks of, or what is measured in that case only."""
        memory = self.context.memory
        before = memory.last
        if self.context.choice is not None and (case.condition is None or case.chained):
            memory.last = self.asked
        else:
            self.asked = before
        try:
            self._add(case, block)
        except RefusedError:
            self.context.fail()
        memory.last = (*before, *(c for c in memory.last if c not in before))

    def _add(self, case: Case, block: ProgramBlock) -> None:
        condition = case.condition
        case = replace(case, orders=tuple(skipping(o, self.context) for o in case.orders))
        if condition is None:
            chosen = case.rest is Rest.ALL_OTHERS and isinstance(self.context.choice, Choice)
            if case.rest is Rest.OTHERWISE or chosen:
                self._otherwise(case, block)
            else:
                self._rest(case, block)
            return
        condition = self.failures.turned(condition)
        asked = [test for tests in condition.alternatives for test in tests]
        values = any(isinstance(test, Test) for test in asked)
        late = any(isinstance(test, TooLate) for test in asked)
        if values and not late and not case.orders:
            hint = "add, say, `go to step 5` or `return to the docking station`"
            self.diagnostics.refuse("unfinished", "this does not say what to do", case.span, hint)
        if condition.negated and (late or not values):
            message = "`unless` is said of values, not of events or of what comes too late"
            hint = "say what is to be done if it is so"
            self.diagnostics.refuse("condition", message, condition.span, hint)
        if late or not values or is_failure(condition):
            self.context.choice = None
        if late:
            self.failures.too_late(case, condition)
        elif not values:
            self.context.reactions.add(case)
        elif is_failure(condition):
            self.failures.failure(case, block)
            self.context.choice = self.context.recent[-1]
        else:
            self._values(case, condition, self._other_case(case, block) if case.chained else block)

    def _other_case(self, case: Case, block: ProgramBlock) -> ProgramBlock:
        """Where a condition of `otherwise, if ...` stands."""
        before = self.context.choice
        if isinstance(before, Choice) and before.listed and before.otherwise.first is None:
            return before.otherwise
        do = block.last
        if isinstance(before, Way) and isinstance(do, Do) and before in do.ways:
            if before.target is not Ahead.GO_ON:
                return block  # the first way whose condition holds is taken
            return self._to_choice(do, before, case, block).otherwise
        self._otherwise_of_what(case)

    # ---- values

    def _values(self, case: Case, condition: SaidCondition, block: ProgramBlock) -> None:
        alternatives = self.context.conditions.alternatives(condition)
        if condition is not case.condition and sum(map(len, alternatives)) != 1:
            message = "this can be asked of one checkpoint only"
            hint = "turn it round: `if ..., go on; otherwise ...`"
            self.diagnostics.refuse("condition", message, condition.span, hint)
        do = block.last
        if isinstance(do, Leave):
            require_reached(case.span, block, self.context)
        if isinstance(do, Do) and any(way.otherwise for way in do.ways):
            message = "this is never looked at: `otherwise` before it leads elsewhere"
            hint = "write this condition before the `otherwise`"
            self.diagnostics.refuse("second-route", message, case.span, hint)
        target = None if condition.negated else self.branches.target(case.orders)
        plain = isinstance(do, Do) and do.failure is None and do.missed is None
        if target is not None and isinstance(do, Do) and plain:
            way = Way(alternatives, target, case.span)
            do.ways.append(way)
            self.context.choice = way
            return
        choice = Choice(alternatives, case.span, negated=condition.negated, bound=self._bound(do))
        self.context.put([choice], block, do)
        if not in_branch(block):
            self.context.step.append(choice)
        self.branches.plan(case.orders, choice.then)
        self.context.choice = choice

    def _bound(self, node: ProgramNode | None) -> bool:
        """Whether a node stands in the step that is being planned."""
        return node is not None and node in self.context.step[-1:]

    # ---- all others

    def _otherwise(self, case: Case, block: ProgramBlock) -> None:
        before = self.context.choice
        do = block.last
        if isinstance(before, Choice) and before.listed and before.block is not None:
            if before.otherwise.first is not None:
                message = "there are two `otherwise` for one condition"
                self.diagnostics.refuse("second-route", message, case.span, "leave one out")
            # It is what is done if none of several conditions holds, where that is clear.
            if not put_together(before):
                message = "`otherwise` can be meant for the last of these conditions, or for all"
                hint = "write `otherwise, if ...`, or say each condition in a step of its own"
                self.diagnostics.refuse("ambiguous-otherwise", message, case.span, hint)
            self.branches.plan(case.orders, before.otherwise)
        elif isinstance(before, Way) and isinstance(do, Do):
            target = self.branches.target(case.orders)
            if target is not None:
                do.ways.append(Way((), target, case.span, otherwise=True))
                return
            choice = self._to_choice(do, before, case, block)
            self.branches.plan(case.orders, choice.otherwise)
            self.context.choice = choice
        elif not isinstance(before, Do) or not self.failures.otherwise(before, case, block):
            self._otherwise_of_what(case)

    def _otherwise_of_what(self, case: Case) -> NoReturn:
        if not self.context.whole:
            raise RefusedError  # the condition may be what was not understood
        message = "`Otherwise` of what? No condition stands before it"
        hint = "write it behind the condition whose other case it is"
        self.diagnostics.refuse("otherwise", message, case.span, hint)

    def _rest(self, case: Case, block: ProgramBlock) -> None:
        """The way that a task leads on if none of its conditions holds, wherever that is said."""
        do, target = block.last, self.branches.target(case.orders)
        if not isinstance(do, Do) or target is None:
            message = f"`{case.rest}` is said of a task, and leads to another one"
            hint = f"write it behind the task: `{case.rest}, go to step 5`"
            self.diagnostics.refuse("otherwise", message, case.span, hint)
        last_round = case.rest is Rest.LAST_ROUND
        do.ways.append(Way((), target, case.span, last_round=last_round))

    def _to_choice(self, do: Do, way: Way, case: Case, block: ProgramBlock) -> Choice:
        """Puts a choice where a way was: its other case has orders of its own."""
        do.ways.remove(way)
        choice = Choice(way.alternatives, case.span, bound=self._bound(do))
        self.context.put([choice], block, do)
        self.context.step.append(choice)
        self.context.put([Leave(way.target, way.span)], choice.then, None)
        return choice
