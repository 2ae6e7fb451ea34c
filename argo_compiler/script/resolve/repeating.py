"""Rounds: patrols, steps that are repeated, and what limits them."""

from dataclasses import replace

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Condition
from argo_compiler.model import Pose
from argo_compiler.script.resolve.context import Context, topmost
from argo_compiler.script.resolve.program import Do, Limits, ProgramBlock, ProgramRound
from argo_compiler.script.resolve.wrapping import Repetition, Wrapping
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import ScriptOrder
from argo_compiler.script.syntax.tree.places import FloorName, PlaceLocation

_MOST = 1_000_000_000
_MOST_AGAIN = 1000


class Repeating:
    """Makes rounds."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.pending: list[Repetition] = []
        """repetitions, whose steps need not all have been planned yet"""

    # ---- patrols

    def places(self, order: orders.Patrol) -> list[tuple[str, list[Pose]]]:
        """The rounds of a patrol: one for each floor, or one through the places."""
        manner = order.manner
        floors = [p for p in order.places if isinstance(p, FloorName)]
        if len(floors) > 1 and manner is not None and manner.duration is not None:
            message = "this duration can be read as that of each floor or of all together"
            hint = "write one patrol for each floor, each with its own duration"
            self.diagnostics.error("ambiguous-duration", message, order.span, hint)
            self.context.fail()
            return []
        rounds: list[tuple[str, list[Pose]]] = []
        through: list[Pose] = []
        label = ""
        for place in order.places:
            if isinstance(place, FloorName):
                floor = self.context.lookup.floor(place)
                if floor is not None:
                    rounds.append((f"Patrol floor {floor.number}", list(floor.patrol)))
                    continue
                self.context.fail()
                return []
            pose, area = self.context.locator.locate(place, "end")
            if pose is None:
                self.context.fail()
                return []
            if not through:
                label = f"area {area.number}" if area else "place"
                if isinstance(place, PlaceLocation):
                    label = place.name.removeprefix("the ")
            through.append(pose)
        if through:
            rounds.append((f"Patrol {label}".replace("/", "-"), through))
        if order.name is not None and len(rounds) > 1:
            message = "this name stands before a command with several rounds"
            hint = "give each of them a line and a name"
            self.diagnostics.error("one-name", message, order.span, hint)
        return rounds

    def round(self, order: ScriptOrder, base: str) -> ProgramRound | None:
        """An empty round with the limits that are said of an order."""
        timed_order = timed(self.context, order)
        limits = None if timed_order is None else limits_of(self.context, timed_order)
        if limits is None:
            self.context.fail()
            return None
        return ProgramRound(base, limits, order.span, self.context.new_round(), name=order.name)

    # ---- steps

    def repeat(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """Notes that steps are repeated: a round is put here, which they come into later."""
        if order.last:
            self._repeat_last(order, block)
            return
        if order.steps is not None and self._is_once_more(order, block):
            self._once_more(order, block)
            return
        base = "Repeat"
        if order.steps is not None:
            ends = dict.fromkeys((order.steps.points[0], order.steps.points[-1]))
            base = f"Repeat {' to '.join(str(p) for p in ends)}".replace("/", "-")
        round_ = self.round(order, base)
        if round_ is None:
            return
        context = self.context
        self.pending.append(Repetition(order, round_, context.step, len(context.step)))
        context.put([round_], block, block.last)
        context.recent = []
        context.choice = None

    def _repeat_last(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """`Repeat this twice`: the step before, or what was said before in the same step."""
        context = self.context
        nodes = topmost(context.step or context.before, block)
        starts = any(isinstance(n, Do) and n.action is Action.START for n in nodes)
        one = not context.step or len(nodes) == 1 or all(n in context.recent for n in nodes)
        if not nodes or starts or not one or nodes[-1] is not block.last:
            message = "it is not clear what is to be repeated"
            hint = "name the steps: `repeat steps 2 and 3 twice`"
            self.diagnostics.error("step-range", message, order.span, hint)
            return
        round_ = self.round(order, "Repeat")
        if round_ is None:
            return
        anchor = nodes[0].before
        for node in nodes:
            block.remove(node)
            round_.body.append(node)
        block.insert_after(anchor, round_)
        context.choice = None

    def _is_once_more(self, order: orders.Repeat, block: ProgramBlock) -> bool:
        """Whether steps are done here again, and not in a round where they stand."""
        manner = order.manner
        assert order.steps is not None
        if manner is None:
            return len(order.steps.points) == 1
        if not manner.more or manner != Manner(times=manner.times, more=True):
            return False
        known = all(self.context.steps.get(p) for p in order.steps.points if isinstance(p, int))
        nodes = self.context.nodes_of(order.steps) if known else None
        return bool(nodes) and topmost(nodes or (), block)[-1:] != [block.last]

    def _once_more(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """`4. Repeat step 2`: what it does is done here again."""
        assert order.steps is not None
        nodes = self.context.nodes_of(order.steps)
        if nodes is None:
            return
        plain = all(isinstance(n, Do) and not (n.ways or n.failure or n.missed) for n in nodes)
        if not nodes or not plain:
            message = "this does not say how often, and can't be done once more"
            hint = "say how often: `twice`, `three times in total`, `until ...`"
            self.diagnostics.error("endless-repeat", message, order.span, hint)
            return
        times = order.manner.times if order.manner is not None else 1
        tasks = [n for n in nodes if isinstance(n, Do)] * min(times or 1, _MOST_AGAIN)
        again = [replace(n, ways=[], name=None) for n in tasks]
        self.context.put(again, block, block.last)
        self.context.step += again
        self.context.recent = again
        self.context.choice = None

    def finish(self) -> None:
        """Fills the rounds with what is to be repeated, in the order in which it was asked for."""
        wrapping = Wrapping(self.context)
        for repetition in self.pending:
            wrapping.wrap(repetition)
        self.pending.clear()


def timed(context: Context, order: ScriptOrder) -> ScriptOrder | None:
    """The order of a round with the limit of time that is said of all its rounds as how long they
    last; None, with an error, if it is not clear whether each or all are meant."""
    manner = order.manner
    if manner is None or manner.time_limit is None:
        return order
    single = isinstance(order, orders.Measure | orders.Add | orders.Go | orders.Home)
    keeps = isinstance(order, orders.Measure) and order.keep
    if single and manner.duration is not None:
        return order
    others = manner.times is not None or manner.at_most is not None or manner.until is not None
    if single and not keeps and (others or manner.every is None):
        message = "this limit can be read as that of each attempt, or of all together"
        hint = "write `for 10 minutes` if it is how long all rounds last at most, or the limit of "
        hint += "each in a sentence of its own"
        context.diagnostics.error("ambiguous-duration", message, order.span, hint)
        return None
    if manner.duration is not None:
        message = "how long is said twice"
        context.diagnostics.error("repeated-limit", message, order.span, "leave one of them out")
        return None
    return replace(order, manner=replace(manner, duration=manner.time_limit, time_limit=None))


def limits_of(context: Context, order: ScriptOrder) -> Limits | None:
    """The limits that are said of an order; None, with an error, if nothing ends its rounds."""
    manner = order.manner
    diagnostics = context.diagnostics
    what = "patrol" if isinstance(order, orders.Patrol) else "repetition"
    if manner is None:
        _endless(context, what, order.span)
        return None
    if manner.times == 0 or manner.at_most == 0:
        message = f"a {what} of no rounds"
        diagnostics.error("rounds", message, order.span, "write how often, say, `three times`")
        return None
    if manner.times is not None and manner.at_most is not None:
        message = "how often is said twice"
        diagnostics.error("repeated-limit", message, order.span, "leave one of them out")
        return None
    count = manner.times or manner.at_most or 0
    if manner.more and isinstance(order, orders.Repeat):
        count += 1  # what is repeated has been done once
    if count > _MOST:
        diagnostics.error("number", "this is too large a number", order.span, f"at most {_MOST}")
        return None
    until = _until(context, order)
    if until is None:
        return None
    limited = count or manner.duration or until
    if manner.endless and limited:
        message = f"this {what} is said to end, and not to"
        diagnostics.error("repeated-limit", message, order.span, "leave one of them out")
        return None
    if not limited and not manner.endless:
        _endless(context, what, order.span)
        return None
    return Limits(
        count=count,
        duration=manner.duration or 0.0,
        every=manner.every or 0.0,
        until=until,
        soft=bool(manner.finishing),
        count_interruptions=manner.count_interruptions,
    )


def _endless(context: Context, what: str, span: Span) -> None:
    hint = "say how long or how often: `for 10 minutes`, `three times`, `endlessly`"
    message = f"this {what} would never end"
    if what == "patrol":
        context.diagnostics.error("endless-patrol", message, span, hint)
    else:
        context.diagnostics.error("endless-repeat", message, span, hint)


def _until(context: Context, order: ScriptOrder) -> tuple[Condition, ...] | None:
    assert order.manner is not None
    if order.manner.until is None:
        return ()
    found = context.conditions.alternatives(order.manner.until)
    if found is None:
        return None
    if len(found) > 1:
        message = "a round ends by conditions that all hold, not by one of several"
        hint = "join them by `and`, or leave the round by `if ..., go to step 7`"
        context.diagnostics.error("condition", message, order.span, hint)
        return None
    return found[0]
