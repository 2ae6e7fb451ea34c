"""What is done if a task fails, or comes too late."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from argo_compiler.il import OnFailure
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import ProgramBlock
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import InState, SaidCondition, TaskState, Test
from argo_compiler.script.syntax.tree.nouns import Pronoun
from argo_compiler.script.syntax.tree.orders import Case, PlainWord, ScriptOrder

if TYPE_CHECKING:  # a case's orders are planned as any others are
    from argo_compiler.script.resolve.planning import Planner

POLICIES = {
    PlainWord.ABORT: OnFailure.ABORT,
    PlainWord.END: OnFailure.ABORT,
    PlainWord.GO_ON: OnFailure.CONTINUE,
}


class Failures:
    """Plans what follows failures."""

    def __init__(
        self, context: Context, planner: "Planner", branch: Callable[[Case, ProgramBlock], None]
    ) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.planner = planner
        self.branch = branch
        """plans what is done in one case only"""

    def failure(self, case: Case, block: ProgramBlock) -> None:
        """What is done if the last task fails."""
        recent = self.context.recent
        if not recent:
            message = "there is no task before this that could fail"
            hint = "write it behind the task that it is said of"
            self.diagnostics.error("no-task", message, case.span, hint)
            return
        rest: list[ScriptOrder] = []
        for order in case.orders:
            if isinstance(order, orders.Retry):
                self.planner.order(order, block)
            else:
                rest.append(order)
        if not rest:
            return
        if any(do.failure or do.on_failure is not OnFailure.CONTINUE for do in recent):
            message = "what is done if it fails is said already"
            self.diagnostics.error("second-route", message, case.span, "leave one of the two out")
            return
        if len(rest) == 1 and rest[0].manner is None and rest[0].name is None:
            match rest[0]:
                case orders.Plain(word=word) if word in POLICIES:
                    self.planner.manners.on_failure(POLICIES[word])
                    return
                case orders.Home(dock=dock) if dock.area is None:
                    self.planner.manners.on_failure(OnFailure.RETURN)
                    return
        if len(recent) > 1:
            message = "several tasks are meant here, and each would need orders of its own"
            hint = "write one sentence for each of them"
            self.diagnostics.error("failure", message, case.span, hint)
            return
        do = recent[-1]
        do.failure = ProgramBlock(do)
        self.branch(Case(span=case.span, condition=None, orders=tuple(rest)), do.failure)

    # ---- windows that are missed

    def too_late(self, case: Case, condition: SaidCondition) -> None:
        """What is done if the window of the last task is missed."""
        recent = self.context.recent
        alone = len(condition.alternatives) == len(condition.alternatives[0]) == 1
        if not alone or len(recent) != 1 or recent[0].window is None:
            message = "this has to follow one task that is to be done by a certain time"
            hint = "write `Check checkpoint #1 not later than 10 minutes after the start. If it is "
            hint += "too late, go to step 5.`"
            self.diagnostics.error("too-late", message, case.span, hint)
            return
        (do,) = recent
        if do.missed is not None:
            message = "what is done if it is too late is said already"
            self.diagnostics.error("second-route", message, case.span, "leave one of the two out")
            return
        do.missed = ProgramBlock(do)
        self.branch(Case(span=case.span, condition=None, orders=case.orders), do.missed)


def is_failure(condition: SaidCondition) -> bool:
    """Whether it asks only whether the last task has failed."""
    match condition.alternatives:
        case ((Test(predicate=InState(state=TaskState.FAILED), subject=subject),),):
            return subject is None or all(isinstance(n, Pronoun) for n in subject.nouns)
    return False
