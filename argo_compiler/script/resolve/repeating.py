"""Steps that are repeated."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from itertools import islice

from argo_compiler.il import Action
from argo_compiler.script.resolve.accepting import said
from argo_compiler.script.resolve.context import Context, topmost
from argo_compiler.script.resolve.limiting import make_round
from argo_compiler.script.resolve.program import Do, ProgramBlock, ProgramNode, ProgramRound
from argo_compiler.script.resolve.wrapping import Repetition, Wrapping
from argo_compiler.script.syntax.text.source import RefusedError
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.places import Steps

_MOST_AGAIN = 1000


class Repeating:
    """Makes rounds of steps. Raises RefusedError where it is not clear of which."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.pending: list[Repetition] = []
        """repetitions, whose steps need not all have been planned yet"""

    def repeat(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """Notes that steps are repeated: a round is put here, which they come into later."""
        context = self.context
        order = self._again(order)
        if order.last:
            self._repeat_last(order, block)
        elif order.steps is not None and self._is_once_more(order, order.steps, block):
            self._once_more(order, order.steps, block)
        else:
            points = () if order.steps is None else (order.steps.points[0], order.steps.points[-1])
            base = f"Repeat {' to '.join(str(p) for p in dict.fromkeys(points))}".rstrip()
            if order.steps is not None:
                self._say_where(order, order.steps, block)
            round_ = make_round(order, base, context, order.name)
            self.pending.append(Repetition(order, round_, context.step, len(context.step)))
            context.put([round_], block, block.last)
            context.recent = []
        context.choice = None

    def _again(self, order: orders.Repeat) -> orders.Repeat:
        """`Repeat step 2 once`: a repetition of one round in all would change nothing."""
        manner = order.manner
        if manner is None or manner.more is not None or 1 not in (manner.times, manner.at_most):
            return order
        if manner.every is not None and manner.times == 1:  # `once every ten minutes`
            return replace(order, manner=replace(manner, times=None))
        if not order.again:
            message = "this can be that the steps are done once in all, or once more"
            hint = "write `once in total`, or `once more`"
            self.diagnostics.refuse("ambiguous-repeat", message, order.span, hint)
        message = "to repeat once is taken as once more, so that it is done twice in all"
        hint = "write `once more`, or `once in total` if it is done a single time"
        self.diagnostics.warning("once-more", message, order.span, hint)
        return replace(order, manner=replace(manner, more=True))

    def _repeat_last(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """`Repeat this twice`: the step before, or what was said before in the same step."""
        context = self.context
        if not context.step and self._follows_several():
            message = "this can be the step before, or all steps so far"
            hint = "name the steps: `repeat step 3 twice`, `repeat steps 1 to 3 twice`"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        nodes = topmost(context.step or context.before, block)
        starts = any(map(_is_start, nodes))
        one = not context.step or len(nodes) == 1 or all(n in context.recent for n in nodes)
        if not nodes or starts or not one or nodes[-1] is not block.last:
            message = "it is not clear what is to be repeated"
            hint = "name the steps: `repeat steps 2 and 3 twice`"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        round_ = make_round(order, "Repeat", context, order.name)
        anchor = nodes[0].before
        for node in nodes:
            block.remove(node)
            round_.body.append(node)
        block.insert_after(anchor, round_)

    def _follows_several(self) -> bool:
        """Whether more than one step has done anything so far but start."""
        steps = (step for step in self.context.steps.values() if step)
        done = (step for step in steps if not all(map(_is_start, step)))
        return len([*islice(done, 2)]) > 1

    def limited(self, order: orders.Amend, block: ProgramBlock) -> bool:
        """`Stop with it after 5 minutes`, `wait 1 minute in between`: said of the round before.
        False: that is not what it says, or of none."""
        manner, round_ = order.manner, block.last
        if manner is None or not isinstance(round_, ProgramRound):
            return False
        if said(manner) == {"pause"} and manner.pause is not None and not round_.limits.pause:
            round_.limits = replace(round_.limits, pause=manner.pause)
            return True
        if manner.duration is None or said(manner) - {"duration", "finishing"}:
            return False
        if round_.limits.duration:
            message = "how long is said twice"
            hint = "leave one of them out"
            self.diagnostics.refuse("repeated-limit", message, order.span, hint)
        soft = bool(manner.finishing)
        round_.limits = replace(round_.limits, duration=manner.duration, soft=soft)
        return True

    def _is_once_more(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> bool:
        """Whether steps are done here again, and not in a round where they stand."""
        manner = order.manner
        if manner is None:
            return len(steps.points) == 1
        if not manner.more or manner != Manner(times=manner.times, more=True):
            return False
        known = all(self.context.steps.get(p) for p in steps.points if isinstance(p, int))
        nodes = self.context.nodes_of(steps) if known else []
        return bool(nodes) and topmost(nodes, block)[-1:] != [block.last]

    def _say_where(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> None:
        """Warns where steps that are repeated stand apart from the line that says so."""
        if not all(isinstance(p, int) and self.context.steps.get(p) for p in steps.points):
            return
        tops = topmost(self.context.nodes_of(steps), block)
        behind = block.last
        if not tops or isinstance(behind, ProgramRound) or behind in tops:
            return
        if isinstance(behind, Do) and behind.docks:
            return  # nothing can be meant behind the return
        message = "these steps are repeated where they stand, before those between them and this"
        hint = "write `repeat step 2 again` for doing them here once more"
        self.diagnostics.warning("repeated-there", message, order.span, hint)

    def _once_more(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> None:
        """`4. Repeat step 2`: what it does is done here again."""
        nodes = self.context.nodes_of(steps)
        tasks = [n for n in nodes if isinstance(n, Do) and not (n.ways or n.failure or n.missed)]
        if not nodes or len(tasks) < len(nodes):
            message = "this does not say how often, and can't be done once more"
            hint = "say how often: `twice`, `three times in total`, `until ...`"
            self.diagnostics.refuse("endless-repeat", message, order.span, hint)
        times = order.manner.times if order.manner is not None else 1
        tasks *= min(times or 1, _MOST_AGAIN)
        again = [replace(task, ways=[], name=None) for task in tasks]
        self.context.put(again, block, block.last)
        self.context.step += again
        self.context.recent = again

    def fill_known(self) -> None:
        """Fills the rounds whose steps are all planned: a change of the plan that follows is one
        of the rounds as well."""
        waiting = [r for r in self.pending if not self._is_planned(r.order.steps)]
        known = [r for r in self.pending if self._is_planned(r.order.steps)]
        self.pending = waiting
        self._fill(known)

    def _is_planned(self, steps: Steps | None) -> bool:
        named, numbered = self.context.named, self.context.steps
        return steps is None or all(p in named or p in numbered for p in steps.points)

    def finish(self) -> None:
        """Fills the rounds with what is to be repeated, in the order in which it was asked for."""
        self._fill(self.pending)
        self.pending.clear()

    def _fill(self, repetitions: Iterable[Repetition]) -> None:
        wrapping = Wrapping(self.context)
        for repetition in repetitions:
            with suppress(RefusedError):  # what is wrong with the others is said as well
                wrapping.wrap(repetition)


def _is_start(node: ProgramNode) -> bool:
    return isinstance(node, Do) and node.action is Action.START
