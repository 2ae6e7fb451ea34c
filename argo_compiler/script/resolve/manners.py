"""Applies what is said of an order's manner: to its tasks, or as a round or choice around them."""

from collections.abc import Sequence
from dataclasses import fields, replace

from argo_compiler.diagnostics import Span
from argo_compiler.il import OnFailure, WaitRule
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.accepting import ROUND, said
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.furnishing import Furnishing
from argo_compiler.script.resolve.limiting import make_round, timed
from argo_compiler.script.resolve.program import Alternatives, Choice, Do, ProgramNode
from argo_compiler.script.syntax.text.source import RefusedError
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import ScriptOrder

_NOTHING = Manner()


class Manners:
    """What is said of orders besides what they do."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.furnishing = Furnishing(context.locator, context.diagnostics)

    def name(self, order: ScriptOrder, tasks: Sequence[Do]) -> None:
        """Gives the task of an order the name that the script gives it."""
        if order.name is None:
            return
        if len(tasks) > 1:
            message = "this name stands before a command with several tasks"
            hint = "give each of them a line and a name"
            self.diagnostics.error("one-name", message, order.span, hint)
        tasks[0].name = order.name

    def with_prefix(self, order: ScriptOrder, prefix: ScriptOrder) -> ScriptOrder:
        """An order with the manner that stands before it: `three times: check checkpoint 17`."""
        if order.name is None:
            order = replace(order, name=prefix.name)
        if order.manner is None:
            return replace(order, manner=prefix.manner)
        return replace(order, manner=self._merged(prefix.manner, order.manner, order.span))

    def _merged(self, first: Manner | None, second: Manner, span: Span) -> Manner:
        values = {f.name: getattr(second, f.name) for f in fields(Manner)}
        for field in fields(Manner):
            value = getattr(first, field.name, field.default)
            if value == field.default:
                continue
            if values[field.name] not in (field.default, value):
                what = field.name.replace("_", " ")
                message = f"the {what} is said twice"
                self.diagnostics.error("repeated-limit", message, span, "leave one of them out")
            values[field.name] = value
        return Manner(**values)

    # ---- tasks

    def apply(self, order: ScriptOrder, tasks: Sequence[Do]) -> list[ProgramNode]:
        """The tasks as nodes, with a wait before them, a round or a choice around them."""
        if isinstance(order, orders.WaitOrder) and order.manner is not None:
            # What limits a wait ends it, and is no limit of the task.
            order = replace(order, manner=replace(order.manner, time_limit=None))
        if not _is_round(order):
            self.furnish(order, tasks)
            return self.around(order, list(tasks))
        round_order = timed(order, self.diagnostics)
        self.furnish(round_order, tasks)
        manner = round_order.manner
        if manner is not None and manner.times == 1 and (manner.more or manner.every is not None):
            # `once every ten minutes`, `again every ten minutes`
            round_order = replace(round_order, manner=replace(manner, times=None, more=None))
        base = f"Repeat {' and '.join(do.base for do in tasks)}"
        round_ = make_round(round_order, base, self.context)
        self.context.put(tasks, round_.body, None)
        return self.around(order, [round_])

    def around(self, order: ScriptOrder, nodes: Sequence[ProgramNode]) -> list[ProgramNode]:
        """The nodes with a wait before them, in the case that is said of them only."""
        manner = order.manner or _NOTHING
        if manner.delay is not None and isinstance(order, orders.Go | orders.Home):
            message = "this can be a wait of that time before, or that time since the start"
            hint = "write `wait 20 minutes, then return home`, or `return home not before 20 "
            hint += "minutes after the start`; `maximum duration: 20 minutes` ends the mission"
            self.diagnostics.refuse("ambiguous-duration", message, order.span, hint)
        if manner.delay is not None:
            nodes = [making.wait(WaitRule(duration=manner.delay), order.span), *nodes]
        if manner.condition is None:
            return list(nodes)
        memory = self.context.memory
        measured = memory.last
        if isinstance(order, orders.Measure):
            memory.last = memory.before  # it is looked at before this order measures
        found = self.context.conditions.alternatives(manner.condition)
        memory.last = measured
        self._require_of_others(order, nodes, found)
        choice = Choice(found, order.span, negated=manner.condition.negated)
        self.context.put(nodes, choice.then, None)
        return [choice]

    def _require_of_others(
        self, order: ScriptOrder, nodes: Sequence[ProgramNode], found: Alternatives
    ) -> None:
        """Asks about `check #1 and #4 if #1 is above 4`, which is looked at before both, or before
        the second."""
        done = {node.object_id for node in nodes if isinstance(node, Do)}
        asked = {condition.object_id for held in found for condition in held}
        if len(done) > 1 and done & asked:
            message = "this condition can be meant for the last of these only, or for all of them"
            hint = "write a sentence for each: `check #1. Check #4 only if #1 is above 4`"
            self.diagnostics.refuse("ambiguous-manner", message, order.span, hint)

    def furnish(self, order: ScriptOrder, tasks: Sequence[Do]) -> None:
        """Applies to each of the tasks what is said of each."""
        if order.manner is not None:
            self.furnishing.furnish(order.manner, order.span, tasks)

    # ---- what is said of tasks that are planned already

    def amend(self, order: ScriptOrder) -> None:
        """Applies a sentence or clause of manner to the tasks before it."""
        recent = self.context.recent
        if not recent:
            if not self.context.whole:
                raise RefusedError
            message = "there is no task before this that it could belong to"
            hint = "write it behind the task that it is said of"
            self.diagnostics.refuse("no-task", message, order.span, hint)
        if isinstance(order, orders.Retry):
            self._retry(order, recent)
        else:
            self.furnish(order, recent)

    def _retry(self, order: orders.Retry, recent: Sequence[Do]) -> None:
        if order.again:
            message = "this can ask to do it once more in any case, or only if it fails"
            hint = "write `check it again`, or `if it fails, retry once`"
            self.diagnostics.refuse("ambiguous-repeat", message, order.span, hint)
        manner = order.manner or Manner()
        counts = [n for n in (manner.times, manner.at_most) if n is not None]
        retries = counts[0] if counts else 1
        if len(counts) > 1 or any(do.retries not in (0, retries) for do in recent):
            message = "how often it is retried is said twice"
            self.diagnostics.error("repeated-limit", message, order.span, "leave one of them out")
        for do in recent:
            do.retries = retries

    def on_failure(self, policy: OnFailure) -> None:
        """What the last tasks do when they fail."""
        for do in self.context.recent:
            do.on_failure = policy


def _is_round(order: ScriptOrder) -> bool:
    """Whether what is said of an order makes a round of it."""
    if isinstance(order, orders.WaitOrder):
        return False  # how long it lasts, and until when, is said of the wait
    if isinstance(order, orders.Measure) and order.keep:
        return True
    if order.manner is None:
        return False
    found = said(order.manner) & ROUND
    return bool(found) and not (found <= {"times", "more"} and order.manner.times == 1)
