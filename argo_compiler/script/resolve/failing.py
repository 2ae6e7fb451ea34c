"""What is done if a task fails, or comes too late."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from argo_compiler.base.listing import listed
from argo_compiler.il import Action, OnFailure
from argo_compiler.script.resolve.branching import CaseBranches
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import Do, ProgramBlock, leads_away
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import InState, SaidCondition, TaskState, Test
from argo_compiler.script.syntax.tree.nouns import Pronoun
from argo_compiler.script.syntax.tree.orders import Case, PlainWord, ScriptOrder
from argo_compiler.script.syntax.tree.places import DockLocation

_POLICIES = {
    PlainWord.ABORT: OnFailure.ABORT,
    PlainWord.END: OnFailure.ABORT,
    PlainWord.GO_ON: OnFailure.CONTINUE,
}
_EXCEPTIONS = (TaskState.FAILED, TaskState.UNREADABLE, TaskState.STALE)
"""states that can't be asked for turned round"""


class OrderPlanner(Protocol):
    """Planner of orders, as those that handle a case need it."""

    manners: Manners

    def carry_out(self, orders_: Sequence[ScriptOrder], block: ProgramBlock) -> None:
        """Carry orders out, one after the other, at the end of a block."""

    def order(self, order: ScriptOrder, block: ProgramBlock) -> None:
        """Carry one order out; one that can't be is given up."""


class Failures:
    """Plans what follows failures. Raises RefusedError where that is not clear."""

    def __init__(self, context: Context, planner: OrderPlanner, branches: CaseBranches) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.planner = planner
        self.told: list[Do] = []
        """the tasks of which it is said what is done if they fail"""
        self.branches = branches

    def failure(self, case: Case, block: ProgramBlock) -> None:
        """What is done if the last task fails."""
        recent = self.context.recent
        if not recent:
            message = "there is no task before this that could fail"
            hint = "write it behind the task that it is said of"
            self.diagnostics.refuse("no-task", message, case.span, hint)
        self._require_told(recent, case)
        self._require_each(recent, case)
        for order in case.orders:
            if isinstance(order, orders.Retry):
                self.planner.order(replace(order, again=False), block)
        rest = [order for order in case.orders if not isinstance(order, orders.Retry)]
        if not rest:
            return
        if any(do.failure or any(do is one for one in self.told) for do in recent):
            message = "what is done if it fails is said already"
            self.diagnostics.refuse("second-route", message, case.span, "leave one of the two out")
        self.told += recent
        if (policy := _policy(rest)) is not None:
            self.planner.manners.on_failure(policy)
            return
        if len(recent) > 1:
            message = "several tasks are meant here, and each would need orders of its own"
            hint = "write one sentence for each of them"
            self.diagnostics.refuse("failure", message, case.span, hint)
        do = recent[-1]
        do.failure = ProgramBlock(do)
        self.branches.plan(rest, do.failure)

    def _require_told(self, recent: Sequence[Do], case: Case) -> None:
        """Asks which task is meant, where one was to be measured in one case only."""
        numbers = {do.object_id for do in recent}
        last = self.context.memory.last
        others = [c for c in last if str(c.id) not in numbers]
        if not others or len(others) == len(last):
            return
        names = listed((f"{c.name} (#{c.id})" for c in last[:6]), "or")
        message = f"this can be said of {names}"
        hint = "say it behind the task that it is said of: `check checkpoint 4; if it fails, ...`"
        self.diagnostics.refuse("ambiguous-pronoun", message, case.span, hint)

    def _require_each(self, recent: Sequence[Do], case: Case) -> None:
        """Asks about `if both fail`, as each task has a failure path of its own."""
        assert case.condition is not None
        nouns = [
            noun
            for tests in case.condition.alternatives
            for test in tests
            if isinstance(test, Test) and test.subject is not None
            for noun in test.subject.nouns
        ]
        all_ = any(isinstance(noun, Pronoun) and noun.every and not noun.either for noun in nouns)
        one = any(isinstance(noun, Pronoun) and noun.either for noun in nouns)
        if all_ or (one and len(recent) == 1):
            message = "this can be asked of each of them, or of all together"
            hint = "write `if one of them fails, ...` behind a list, or a sentence for each"
            self.diagnostics.refuse("failure", message, case.span, hint)

    def otherwise(self, do: Do, case: Case, block: ProgramBlock) -> bool:
        """Plans what is done if a task does not fail; False if a failure leads on to the same."""
        left = do.failure is not None and leads_away(do.failure.last)
        if block.last is not do or not (left or do.on_failure is not OnFailure.CONTINUE):
            return False
        self.planner.carry_out(case.orders, block)
        return True

    def turned(self, condition: SaidCondition) -> SaidCondition:
        """`If it does not fail` as `unless it fails`."""
        match condition.alternatives:
            case ((Test(predicate=InState(state=state)) as test,),) if state in _EXCEPTIONS:
                pass
            case _:
                return condition
        negated = condition.negated is not test.negated
        asked = replace(test, negated=False)
        found = replace(condition, alternatives=((asked,),), negated=negated)
        measured = {do.action for do in self.context.recent} <= {Action.MEASURE}
        if negated and not measured and state is TaskState.FAILED and _is_of_it(test):
            message = "`it` can be what is done last, or what is measured last"
            hint = "name the checkpoint: `if checkpoint #1 has not failed, ...`"
            self.diagnostics.refuse("ambiguous-pronoun", message, test.span, hint)
        return found if test.negated else condition

    def too_late(self, case: Case, condition: SaidCondition) -> None:
        """What is done if the window of the last task is missed."""
        recent = self.context.recent
        alone = len(condition.alternatives) == len(condition.alternatives[0]) == 1
        if not alone or len(recent) != 1 or recent[0].window is None:
            message = "this has to follow one task that is to be done by a certain time"
            hint = "write `Check checkpoint #1 not later than 10 minutes after the start. If it is "
            hint += "too late, go to step 5.`"
            self.diagnostics.refuse("too-late", message, case.span, hint)
        (do,) = recent
        if do.missed is not None:
            message = "what is done if it is too late is said already"
            self.diagnostics.refuse("second-route", message, case.span, "leave one of the two out")
        do.missed = ProgramBlock(do)
        self.branches.plan(case.orders, do.missed)


def _policy(said: Sequence[ScriptOrder]) -> OnFailure | None:
    """What a mission does by itself in a failure, if that is all that is ordered."""
    match said:
        case [orders.Plain(word=word, manner=None, name=None)]:
            return _POLICIES.get(word)
        case [orders.Home(dock=DockLocation(area=None), manner=None, name=None)]:
            return OnFailure.RETURN
    return None


def is_failure(condition: SaidCondition) -> bool:
    """Whether it asks only whether the last task has failed."""
    match condition.alternatives:
        case ((Test(predicate=InState(state=TaskState.FAILED), negated=False) as test,),):
            return _is_of_it(test) and not condition.negated
    return False


def _is_of_it(test: Test) -> bool:
    return test.subject is None or all(isinstance(n, Pronoun) for n in test.subject.nouns)
