"""Applies what is said of an order's manner: to its tasks, or as a round or a choice around them."""

from collections.abc import Sequence
from dataclasses import fields, replace

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, JointState, OnFailure, TimeWindow, WaitRule
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Choice, Do, Node, Round
from argo_compiler.script.resolve.repeating import Repeating, limits_of
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import Order

_ROUND = ("times", "every", "until", "duration", "at_most", "finishing")
"""what makes a round of an order"""


class Manners:
    """What is said of orders besides what they do."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.repeating = Repeating(context)

    def name(self, order: Order, tasks: Sequence[Do]) -> None:
        """Gives the task of an order the name that the script gives it."""
        if order.name is None:
            return
        if len(tasks) > 1:
            message = "this name stands before a command with several tasks"
            hint = "give each of them a line and a name"
            self.diagnostics.error("one-name", message, order.span, hint)
        tasks[0].name = order.name

    def with_prefix(self, order: Order, prefix: Order) -> Order:
        """An order with the manner that stands before it: `three times: check checkpoint 17`."""
        if order.manner is None:
            return replace(order, manner=prefix.manner)
        merged = self._merged(prefix.manner, order.manner, order.span)
        return replace(order, manner=merged)

    def _merged(self, first: Manner | None, second: Manner, span: Span) -> Manner:
        if first is None:
            return second
        values = {f.name: getattr(second, f.name) for f in fields(Manner)}
        for field in fields(Manner):
            value = getattr(first, field.name)
            if value in (None, False):
                continue
            if values[field.name] not in (None, False, value):
                what = field.name.replace("_", " ")
                message = f"the {what} is said twice"
                self.diagnostics.error("repeated-limit", message, span, "leave one of them out")
            values[field.name] = value
        return Manner(**values)

    # ---- tasks

    def apply(self, order: Order, tasks: Sequence[Do]) -> list[Node]:
        """The tasks as nodes, with a wait before them, a round or a choice around them."""
        nodes: list[Node] = list(tasks)
        manner = order.manner
        if manner is None:
            return nodes
        self.furnish(order, tasks)
        if isinstance(order, orders.Wait):
            return self._conditional(manner, order, nodes)
        if manner.delay is not None:
            wait = making.wait(WaitRule(duration=manner.delay), order.span)
            nodes.insert(0, wait)
        again = manner.more and manner.times == 1
        once = manner.times == 1 and not manner.more
        asked = manner.endless or any(getattr(manner, name) is not None for name in _ROUND)
        if asked and not again and not once and tasks[0].action is not Action.START:
            round_ = self._round(order, manner, nodes)
            nodes = nodes if round_ is None else [round_]
        return self._conditional(manner, order, nodes)

    def _round(self, order: Order, manner: Manner, nodes: Sequence[Node]) -> Round | None:
        limits = limits_of(self.context, order, more_is_added=False)
        if limits is None:
            return None
        base = " and ".join(node.base for node in nodes if isinstance(node, Do))
        round_ = Round(
            f"Repeat {base}".replace("/", "-"), limits, order.span, self.context.new_round()
        )
        self.context.put(nodes, round_.body, None)
        return round_

    def _conditional(self, manner: Manner, order: Order, nodes: list[Node]) -> list[Node]:
        if manner.condition is None:
            return nodes
        found = self.context.conditions.alternatives(manner.condition)
        if found is None:
            return nodes
        choice = Choice(found, order.span, negated=manner.condition.negated)
        self.context.put(nodes, choice.then, None)
        return [choice]

    def furnish(self, order: Order, tasks: Sequence[Do]) -> None:
        """Applies to each of the tasks what is said of each."""
        manner = order.manner
        if manner is None or not tasks:
            return
        pose = self.context.locator.point(manner.pose) if manner.pose is not None else None
        for do in tasks:
            if manner.speed is not None:
                do.velocity = manner.speed
            # Of a patrol it is the limit of all its rounds, of a wait what ends it.
            if manner.time_limit is not None and not isinstance(order, orders.Patrol | orders.Wait):
                do.time_limit = manner.time_limit
            if manner.reading_limit is not None:
                do.reading_limit = manner.reading_limit
            if manner.optional:
                do.optional = True
            if manner.priority is not None:
                do.priority = manner.priority
            if manner.earliest is not None or manner.latest is not None or manner.soft_window:
                do.window = TimeWindow(
                    earliest=manner.earliest or 0.0,
                    latest=manner.latest,
                    hard=not manner.soft_window,
                )
            if manner.joints is not None:
                joints = manner.joints
                do.joints = JointState(
                    names=joints.names,
                    positions=joints.positions,
                    velocities=joints.velocities,
                    efforts=joints.efforts,
                )
            if manner.shown_in is not None:
                do.shown_in = manner.shown_in
            if pose is not None:
                do.pose = pose
            if manner.object_id is not None:
                self._about(do, manner.object_id, order.span)
        if manner.leaving is not None:
            tasks[-1].leaving = manner.leaving

    def _about(self, do: Do, object_id: str, span: Span) -> None:
        if do.action is Action.MEASURE:
            message = "a measurement is about its checkpoint"
            self.diagnostics.error("stray-clause", message, span, "leave `about object` out")
        do.object_id = object_id

    # ---- what is said of tasks that are planned already

    def amend(self, order: Order) -> None:
        """Applies a sentence or clause of manner to the tasks before it."""
        recent = self.context.recent
        if not recent:
            if self.context.whole:
                message = "there is no task before this that it could belong to"
                hint = "write it behind the task that it is said of"
                self.diagnostics.error("no-task", message, order.span, hint)
            return
        if isinstance(order, orders.Retry):
            times = order.manner.times if order.manner is not None else None
            at_most = order.manner.at_most if order.manner is not None else None
            for do in recent:
                do.retries = next((n for n in (times, at_most) if n is not None), 1)
            return
        manner = order.manner
        assert manner is not None
        asked = [n for n in _ROUND if getattr(manner, n) is not None]
        if asked or manner.condition is not None or manner.delay is not None:
            message = "it is not clear what this belongs to"
            hint = "write it in the sentence of what is to be done"
            self.diagnostics.error("stray-clause", message, order.span, hint)
        self.furnish(order, recent)

    def on_failure(self, policy: OnFailure) -> None:
        """What the last tasks do when they fail."""
        for do in self.context.recent:
            do.on_failure = policy
