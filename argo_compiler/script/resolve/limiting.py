"""What ends a round's repetitions."""

from dataclasses import replace

from argo_compiler.il import Condition
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Limits, ProgramRound
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import SaidCondition
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import ScriptOrder

_MOST = 1_000_000_000


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
        diagnostics.refuse("ambiguous-duration", message, order.span, hint)
    if manner.duration is not None:
        message = "how long is said twice"
        diagnostics.refuse("repeated-limit", message, order.span, "leave one of them out")
    return replace(order, manner=replace(manner, duration=manner.time_limit, time_limit=None))


def _limits(order: ScriptOrder, context: Context) -> Limits:
    manner = order.manner or Manner()
    refuse, span = context.diagnostics.refuse, order.span
    what = "patrol" if isinstance(order, orders.Patrol) else "repetition"
    if manner.times == 0 or manner.at_most == 0:
        refuse("rounds", f"a {what} of no rounds", span, "write how often, say, `three times`")
    if manner.times is not None and manner.at_most is not None:
        refuse("repeated-limit", "how often is said twice", span, "leave one of them out")
    ended = manner.until is not None or manner.duration is not None or manner.every is not None
    if manner.at_most is not None and not ended and not manner.endless:
        message = "this can be exactly so often, or less often if something holds that is not said"
        hint = "write `three times`, or what ends it: `until it is above 5, at most three times`"
        refuse("ambiguous-repeat", message, span, hint)
    count = manner.times or manner.at_most or 0
    if manner.more and isinstance(order, orders.Repeat):
        count += 1  # what is repeated has been done once
    if count > _MOST:
        refuse("number", "this is too large a number", span, f"at most {_MOST}")
    until = () if manner.until is None else _until(manner.until, order, context)
    limited = count or manner.duration or until
    if manner.endless and limited:
        message = f"this {what} is said to end, and not to"
        refuse("repeated-limit", message, span, "leave one of them out")
    if not limited and not manner.endless:
        message = f"this {what} would never end"
        hint = "say how long or how often: `for 10 minutes`, `three times`, `endlessly`"
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
        message = "a round ends by conditions that all hold, not by one of several"
        hint = "join them by `and`, or leave the round by `if ..., go to step 7`"
        context.diagnostics.refuse("condition", message, order.span, hint)
    return found[0]
