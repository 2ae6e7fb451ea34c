"""Rounds: patrols, steps that are repeated, and what limits them."""

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Condition
from argo_compiler.model import Pose
from argo_compiler.script.resolve.context import Context, topmost
from argo_compiler.script.resolve.program import Block, Do, Limits, Node, Round
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.orders import Order
from argo_compiler.script.syntax.tree.places import FloorName, PlaceLocation, Steps

_MOST = 1_000_000_000


class Repeating:
    """Makes rounds."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.pending: list[tuple[orders.Repeat, Limits, int]] = []
        """repetitions of steps that have not all been planned yet"""

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

    def round(self, order: Order, base: str) -> Round | None:
        """An empty round with the limits that are said of an order."""
        limits = limits_of(self.context, order, more_is_added=True)
        if limits is None:
            self.context.fail()
            return None
        return Round(base, limits, order.span, self.context.new_round(), name=order.name)

    # ---- steps

    def repeat(self, order: orders.Repeat, block: Block) -> None:
        """Wraps steps into a round, now or when all of them are planned."""
        manner = order.manner
        said = manner is not None and any(
            getattr(manner, name) is not None for name in ("speed", "retries", "leaving", "pose")
        )
        if said:
            message = "a repetition has no such thing of its own"
            hint = "write it behind the steps that it is said of"
            self.diagnostics.error("stray-clause", message, order.span, hint)
            return
        limits = limits_of(self.context, order, more_is_added=True)
        if limits is None:
            return
        self.pending.append((order, limits, self.context.new_round()))

    def finish(self) -> None:
        """Wraps what is to be repeated, in the order in which it was asked for."""
        for order, limits, number in self.pending:
            self._wrap(order, limits, number)
        self.pending.clear()

    def _wrap(self, order: orders.Repeat, limits: Limits, number: int) -> None:
        block, nodes = self._range(order)
        if not nodes:
            return
        steps = order.steps
        base = "Repeat"
        if steps is not None:
            ends = dict.fromkeys((steps.points[0], steps.points[-1]))
            base = f"Repeat {' to '.join(str(p) for p in ends)}".replace("/", "-")
        round_ = Round(base, limits, order.span, number, name=order.name)
        anchor = nodes[0].before
        for node in nodes:
            block.remove(node)
        block.insert_after(anchor, round_)
        for node in nodes:
            round_.body.append(node)

    def _range(self, order: orders.Repeat) -> tuple[Block, list[Node]]:
        """The neighbouring nodes of one block that are to be repeated."""
        program = self.context.program
        if order.steps is None:
            found = [n for n in program if not (isinstance(n, Do) and _stays(n))]
            return program, found
        nodes = self.context.nodes_of(order.steps)
        if nodes is None:
            return program, []
        nodes = [n for n in nodes if not (isinstance(n, Do) and n.action is Action.START)]
        if not nodes:
            self._empty(order.steps)
            return program, []
        block = _common(nodes, program)
        tops = topmost(nodes, block)
        ends = {id(node) for node in tops}
        first = tops[0]
        while first.before is not None and id(first.before) in ends:
            first = first.before
        found = [first]
        while len(found) < len(tops) and found[-1].after is not None:
            found.append(found[-1].after)
        if {id(node) for node in found} != ends:
            return block, self._between(order, tops)
        return block, found

    def _between(self, order: orders.Repeat, tops: list[Node]) -> list[Node]:
        """From the first to the last of nodes that are no neighbours, if a range was said."""
        assert order.steps is not None
        if not order.steps.through:
            message = "these steps are not next to each other"
            hint = "repeat steps that follow each other"
            self.diagnostics.error("step-range", message, order.span, hint)
            return []
        found = [tops[0]]
        while found[-1] is not tops[-1]:
            following = found[-1].after
            if following is None:
                message = "the first of these steps comes after the last one"
                hint = "write the earlier one first"
                self.diagnostics.error("step-range", message, order.span, hint)
                return []
            found.append(following)
        return found

    def _empty(self, steps: Steps) -> None:
        said = " to ".join(str(p) for p in steps.points)
        message = f"step {said} leaves nothing to do that could be repeated"
        hint = "name a step that measures or drives"
        self.diagnostics.error("empty-step", message, steps.span, hint)


def _stays(do: Do) -> bool:
    return do.action is Action.START or do.docks


def _common(nodes: list[Node], program: Block) -> Block:
    """The innermost block that all nodes lie in."""
    chains: list[list[Block]] = []
    for node in (nodes[0], nodes[-1]):
        chain: list[Block] = []
        block = node.block
        while block is not None:
            chain.append(block)
            block = block.owner.block if block.owner is not None else None
        chains.append(chain)
    inner = {id(block) for block in chains[1]}
    return next((block for block in chains[0] if id(block) in inner), program)


def limits_of(context: Context, order: Order, more_is_added: bool) -> Limits | None:
    """The limits that are said of an order; None, with an error, if nothing ends its rounds."""
    manner = order.manner
    diagnostics = context.diagnostics
    what = "patrol" if isinstance(order, orders.Patrol) else "repetition"
    if manner is None:
        _endless(context, what, order.span)
        return None
    count = manner.times or 0
    if manner.times == 0:
        message = f"a {what} of no rounds"
        diagnostics.error("rounds", message, order.span, "write how often, say, `three times`")
        return None
    if manner.more and more_is_added:
        count += 1
    if manner.at_most is not None:
        count = manner.at_most
    if count > _MOST:
        diagnostics.error("number", "this is too large a number", order.span, f"at most {_MOST}")
        return None
    until = _until(context, order)
    if until is None:
        return None
    if not (count or manner.duration or manner.time_limit or until or manner.endless):
        _endless(context, what, order.span)
        return None
    return Limits(
        count=count,
        duration=manner.duration or manner.time_limit or 0.0,
        every=manner.every or 0.0,
        until=until,
        soft=bool(manner.finishing),
        count_interruptions=manner.count_interruptions,
    )


def _endless(context: Context, what: str, span: Span) -> None:
    hint = "say how long or how often: `for 10 minutes`, `three times`, `endlessly`"
    message = f"this {what} would never end"
    code = "endless-patrol" if what == "patrol" else "endless-repeat"
    context.diagnostics.error(code, message, span, hint)


def _until(context: Context, order: Order) -> tuple[Condition, ...] | None:
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
