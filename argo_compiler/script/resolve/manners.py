"""Applies what is said of an order's manner: to its tasks, or as a round or choice around them."""

from collections.abc import Sequence
from dataclasses import replace

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Condition, OnFailure, TimeWindow, WaitRule
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.resolve.accepting import ROUND, said
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import (
    Alternatives,
    Choice,
    Do,
    Limits,
    ProgramNode,
    ProgramRound,
)
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.conditions import SaidCondition
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.orders import ScriptOrder

_FRESH = Do("", Action.MEASURE)
"""what a task has of which nothing is said"""
_MOST_PRIORITY = 1_000_000
_SHOWN = 8
"""priorities that a note names"""
_MOST_ROUNDS = 1_000_000_000


class Manners:
    """What is said of orders besides what they do."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics

    def name(self, order: ScriptOrder, tasks: Sequence[Do]) -> None:
        """Gives the task of an order the name that the script gives it."""
        if order.name is None:
            return
        if len(tasks) > 1:
            message = "this name is in front of a command with several tasks"
            hint = "write a line and a name for each of them"
            self.diagnostics.error("one-name", message, order.span, hint)
        tasks[0].name = order.name

    def with_prefix(self, order: ScriptOrder, prefix: ScriptOrder) -> ScriptOrder:
        """An order with the manner that stands before it: `three times: check checkpoint 17`."""
        if order.name is None:
            order = replace(order, name=prefix.name)
        given = {name: getattr(prefix.manner, name) for name in said(prefix.manner)}
        for name in said(order.manner) & given.keys():
            if getattr(order.manner, name) != given[name]:
                message = f"the {name.replace('_', ' ')} is given twice"
                self.diagnostics.error("repeated-limit", message, order.span, "remove one of them")
        return replace(order, manner=replace(order.manner, **given))

    # ---- tasks

    def apply(self, order: ScriptOrder, tasks: Sequence[Do]) -> list[ProgramNode]:
        """The tasks as nodes, with a wait before them, a round or a choice around them."""
        if isinstance(order, orders.WaitOrder):
            # What limits a wait ends it, and is no limit of the task.
            order = replace(order, manner=replace(order.manner, time_limit=None))
        if not _is_round(order):
            self.furnish(order, tasks)
            return self.around(order, list(tasks))
        round_order = timed(order, self.diagnostics)
        self.furnish(round_order, tasks)
        manner = round_order.manner
        if manner.times == 1 and (manner.more or manner.every is not None):
            # `once every ten minutes`, `again every ten minutes`
            round_order = replace(round_order, manner=replace(manner, times=None, more=None))
        base = f"Repeat {' and '.join(do.base for do in tasks)}"
        round_ = make_round(round_order, base, self.context)
        self.context.put(tasks, round_.body, None)
        return self.around(order, [round_])

    def around(self, order: ScriptOrder, nodes: Sequence[ProgramNode]) -> list[ProgramNode]:
        """The nodes with a wait before them, in the case that is said of them only."""
        manner = order.manner
        if manner.delay is not None and isinstance(order, orders.Go | orders.Home):
            message = "this can be a wait before the task, or a time since the start"
            hint = "write `wait 20 minutes, then return home`, or `return home not before 20 "
            hint += "minutes after the start`; `maximum duration: 20 minutes` ends the mission"
            self.diagnostics.refuse("ambiguous-duration", message, order.span, hint)
        if manner.delay is not None:
            rule = WaitRule(duration=manner.delay)
            nodes = [Do("WAIT", Action.WAIT, order.span, wait=rule), *nodes]
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
            message = "this condition can apply to the last of these only, or to all of them"
            hint = "write a sentence for each: `check #1. Check #4 only if #1 is above 4`"
            self.diagnostics.refuse("ambiguous-manner", message, order.span, hint)

    def furnish(self, order: ScriptOrder, tasks: Sequence[Do]) -> None:
        """Applies to each of the tasks what is said of each."""
        if order.manner:
            self.furnish_each(order.manner, order.span, tasks)

    def furnish_each(self, manner: Manner, span: Span, tasks: Sequence[Do]) -> None:
        """Applies it to each of the tasks; what is said twice and differs is an error."""
        if manner.priority is not None and not 1 <= manner.priority <= _MOST_PRIORITY:
            message = f"{manner.priority} is not a valid priority of a task"
            hint = f"write a number from 1 to {_MOST_PRIORITY}"
            self.diagnostics.refuse("number", message, span, hint)
        if manner.priority == 1:
            message = "priority 1 can be the highest or the lowest"
            hint = "write `with high priority`, or a higher number for more important tasks"
            self.diagnostics.error("ambiguous-priority", message, span, hint)
        if manner.rank is not None and manner.priority not in (None, manner.rank):
            message = "the priority is given twice"
            self.diagnostics.error("repeated-limit", message, span, "remove one of them")
        if manner.by_importance:
            self._by_importance(manner, span, tasks)
        given = {
            "velocity": manner.speed,
            "time_limit": manner.time_limit,
            "reading_limit": manner.reading_limit,
            "optional": manner.optional or None,
            "priority": manner.rank if manner.priority is None else manner.priority,
            "joints": manner.joints,
            "shown_in": manner.shown_in,
            "pose": None if manner.pose is None else self.context.lookup.point(manner.pose),
        }
        for do in tasks:
            for name, value in given.items():
                self._set(do, name, value, span)
            self._window(do, manner, span)
            if manner.object_id is not None:
                if do.action is Action.MEASURE:
                    message = "a measurement always concerns its checkpoint"
                    self.diagnostics.error("stray-clause", message, span, "remove `about object`")
                do.object_id = manner.object_id
        if tasks:
            self._set(tasks[-1], "leaving", manner.leaving, span)

    def _by_importance(self, manner: Manner, span: Span, tasks: Sequence[Do]) -> None:
        """Gives the first of the tasks the highest priority, and the last one 1."""
        if len(tasks) < 2 or manner.priority is not None or manner.rank is not None:
            message = "this needs several tasks, the most important one first"
            hint = "write `Check checkpoints 3, 7 and 12, the most important first`"
            self.diagnostics.refuse("stray-clause", message, span, hint)
        names = ", ".join(f"`{do.base}` {len(tasks) - i}" for i, do in enumerate(tasks[:_SHOWN]))
        more = ", and so on" if len(tasks) > _SHOWN else ""
        self.diagnostics.note("priority-taken", f"assumed priorities: {names}{more}", span)
        for i, do in enumerate(tasks):
            self._set(do, "priority", len(tasks) - i, span)

    def _set(self, do: Do, name: str, value: object, span: Span) -> None:
        if value is None:
            return
        if getattr(do, name) not in (getattr(_FRESH, name), value):
            self._twice(do, name, span)
        setattr(do, name, value)

    def _twice(self, do: Do, name: str, span: Span) -> None:
        what = name.replace("_", " ")
        message = f"`{do.base}` already has another {what}"
        self.diagnostics.error("repeated-limit", message, span, "remove one of the two")

    def _window(self, do: Do, manner: Manner, span: Span) -> None:
        if manner.earliest is None and manner.latest is None:
            if manner.soft_window and do.window is None:
                message = "this does not say by when, or whether the task is optional"
                hint = "write `preferably not later than 10 minutes after the start`, or `if there "
                hint += "is time`"
                self.diagnostics.error("ambiguous-manner", message, span, hint)
            elif manner.soft_window and do.window is not None:
                do.window = do.window.model_copy(update={"hard": False})
            return
        before = do.window if do.window is not None else TimeWindow()
        earliest, latest = manner.earliest, manner.latest
        if earliest is not None and before.earliest not in (0.0, earliest):
            self._twice(do, "earliest", span)
        if latest is not None and before.latest not in (None, latest):
            self._twice(do, "latest", span)
        do.window = TimeWindow(
            earliest=before.earliest if earliest is None else earliest,
            latest=before.latest if latest is None else latest,
            hard=before.hard and not manner.soft_window,
        )

    # ---- what is said of tasks that are planned already

    def amend(self, order: ScriptOrder) -> None:
        """Applies a sentence or clause of manner to the tasks before it."""
        recent: Sequence[Do] = self.context.recent
        if isinstance(order, orders.Retry) and order.every:
            recent = self.context.readings()
        if not recent:
            message = "there is no task before this to which it could apply"
            hint = "write it after the task that it applies to"
            self.context.refuse_missing("no-task", message, order.span, hint)
        if isinstance(order, orders.Retry):
            self._retry(order, recent)
            return
        if order.manner.time_limit is not None and len(recent) > 1:
            message = "this time can be that of each of these tasks, or of the whole mission"
            hint = "write `Maximum duration: 30 minutes`, or name the time at each task"
            self.diagnostics.refuse("ambiguous-manner", message, order.span, hint)
        self.furnish(order, recent)

    def _retry(self, order: orders.Retry, recent: Sequence[Do]) -> None:
        if order.again:
            message = "this can mean once more in any case, or only after a failure"
            hint = "write `check it again`, or `if it fails, retry once`"
            self.diagnostics.refuse("ambiguous-repeat", message, order.span, hint)
        manner = order.manner
        counts = [n for n in (manner.times, manner.at_most) if n is not None]
        retries = counts[0] if counts else 1
        if len(counts) > 1 or any(do.retries not in (0, retries) for do in recent):
            message = "the number of retries is given twice"
            self.diagnostics.error("repeated-limit", message, order.span, "remove one of them")
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
    found = said(order.manner) & ROUND
    return bool(found) and not (found <= {"times", "more"} and order.manner.times == 1)


# ---- what ends a round's repetitions


def make_round(
    order: ScriptOrder, base: str, context: Context, name: str | None = None
) -> ProgramRound:
    """An empty round with the limits that are said of an order. Raises RefusedError if nothing
    ends it, or if that is not clear."""
    limits = _limits(timed(order, context.diagnostics), context)
    context.rounds += 1
    return ProgramRound(base.replace("/", "-"), limits, order.span, context.rounds, name)


def timed(order: ScriptOrder, diagnostics: Diagnostics) -> ScriptOrder:
    """The order of a round with the limit of time that is said of all its rounds as how long they
    last. Raises RefusedError if it is not clear whether each or all are meant."""
    manner = order.manner
    if manner.time_limit is None:
        return order
    single = isinstance(order, orders.Measure | orders.Add | orders.Go | orders.Home)
    keeps = isinstance(order, orders.Measure) and order.keep
    if single and manner.duration is not None:
        return order
    others = manner.times is not None or manner.at_most is not None or manner.until is not None
    if single and not keeps and (others or manner.every is None):
        message = "this limit can apply to each attempt, or to all together"
        hint = "write `for 10 minutes` to limit all rounds together, or the limit of "
        hint += "each attempt in a separate sentence"
        diagnostics.refuse("ambiguous-duration", message, order.span, hint)
    if manner.duration is not None:
        message = "the duration is given twice"
        diagnostics.refuse("repeated-limit", message, order.span, "remove one of them")
    return replace(order, manner=replace(manner, duration=manner.time_limit, time_limit=None))


def _limits(order: ScriptOrder, context: Context) -> Limits:
    manner = order.manner
    refuse, span = context.diagnostics.refuse, order.span
    what = "patrol" if isinstance(order, orders.Patrol) else "repetition"
    if manner.times == 0 or manner.at_most == 0:
        hint = "write a number of rounds, for example `three times`"
        refuse("rounds", f"a {what} needs at least one round", span, hint)
    if manner.times is not None and manner.at_most is not None:
        refuse("repeated-limit", "the number of rounds is given twice", span, "remove one of them")
    ended = manner.until is not None or manner.duration is not None or manner.every is not None
    if manner.at_most is not None and not ended and not manner.endless:
        message = "this can be the exact number, or a maximum with a condition that is missing"
        hint = "write `three times`, or add a condition: `until it is above 5, at most three times`"
        refuse("ambiguous-repeat", message, span, hint)
    count = manner.times or manner.at_most or 0
    if manner.more and isinstance(order, orders.Repeat):
        count += 1  # what is repeated has been done once
    if count > _MOST_ROUNDS:
        refuse("number", "this is too large a number", span, f"at most {_MOST_ROUNDS}")
    until = () if manner.until is None else _until(manner.until, order, context)
    limited = count or manner.duration or until
    if manner.endless and limited:
        message = f"this {what} has an end, but is also endless"
        refuse("repeated-limit", message, span, "remove one of them")
    if not limited and not manner.endless:
        message = f"this {what} would never end"
        hint = "write a duration or a number: `for 10 minutes`, `three times`, `endlessly`"
        refuse("endless-patrol" if what == "patrol" else "endless-repeat", message, span, hint)
    return Limits(
        count=count,
        duration=manner.duration or 0.0,
        every=manner.every or 0.0,
        pause=manner.pause or 0.0,
        until=until,
        soft=bool(manner.finishing),
        count_interruptions=manner.count_interruptions,
    )


def _until(said: SaidCondition, order: ScriptOrder, context: Context) -> tuple[Condition, ...]:
    found = context.conditions.alternatives(said)
    if len(found) > 1:
        message = "a round can end when all conditions are satisfied, not when one of several is"
        hint = (
            "join them with `and` if all are meant, or leave the round with `if ..., go to step 7`"
        )
        context.diagnostics.refuse("condition", message, order.span, hint)
    return found[0]
