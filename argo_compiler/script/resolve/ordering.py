"""Whether the order of the tasks is free, and what has to come before what."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import field
from functools import partial
from itertools import groupby, pairwise, product

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.records import dataclass
from argo_compiler.checks.precedence import check_precedence
from argo_compiler.diagnostics import Severity, Span
from argo_compiler.il import Action, Mission, Order
from argo_compiler.script.documents.source import RefusedError
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import (
    Do,
    ProgramBlock,
    ProgramNode,
    all_nodes,
    inner_blocks,
)
from argo_compiler.script.sentences.tree.nouns import Nouns
from argo_compiler.script.sentences.tree.orders import DoneBefore
from argo_compiler.script.sentences.tree.places import Steps
from argo_compiler.script.sentences.tree.script import ScriptHeader

_Things = Sequence[CheckpointInfo | Steps]


@dataclass
class Ordering:
    """What the script has said of the order so far. Mutable: each sentence may add to it."""

    context: Context
    header: ScriptHeader
    free: list[tuple[Span, list[ProgramNode]]] = field(default_factory=list)
    """what is said to be done in any order; nothing: all"""
    precise: list[tuple[Span, list[ProgramNode]]] = field(default_factory=list)
    """what is said to be done in the order in which it is written"""
    asked: list[tuple[Span, _Things, _Things]] = field(default_factory=list)
    """what comes before what"""
    left_out: list[Span] = field(default_factory=list)
    """where it is said that what does not fit is left out: then each task may be"""
    between: list[tuple[Span, ProgramNode, ProgramNode, ProgramNode]] = field(default_factory=list)
    """waits between two neighbours: the first of these, the wait, the second"""
    pairs: list[tuple[Span, Do | str, Do | str]] = field(default_factory=list)
    """what has to come before what, names if it was left out; known when all is planned"""

    def say(self, order: Order, nodes: Iterable[ProgramNode], span: Span) -> None:
        """The order of these is said; of nothing: of all."""
        said = self.free if order is Order.ANY else self.precise
        said.append((span, list(nodes)))

    def precede(self, fact: DoneBefore) -> None:
        """Takes down that checkpoints, or steps, come before others."""

        def things(said: Nouns | Steps) -> _Things:
            return [said] if isinstance(said, Steps) else self.context.nouns.all(said)

        first, second = self.context.diagnostics.each(things, (fact.first, fact.second))
        self.asked.append((fact.span, first, second))

    def finish(self, program: ProgramBlock) -> Order:
        """The order of the mission, when all is planned."""
        order, diagnostics = self._order(program), self.context.diagnostics
        for do in _tasks(program) if self.left_out else ():
            do.optional = do.optional or _may_move(do)
        self._require_between(program, order)
        if order is Order.ANY:
            for span, nodes in self.precise:
                self.pairs += [(span, a, b) for a, b in pairwise(_tasks(nodes))]
        asked = [(span, *pair) for span, one, two in self.asked for pair in product(one, two)]
        for span, *pair in sorted(asked, key=lambda one: isinstance(one[1], Steps)):
            with suppress(RefusedError):
                before, after = diagnostics.each(partial(self._tasks_of, span), pair)
                self.pairs += [(span, a, b) for a, b in product(before, after)]
        return order

    def _require_between(self, program: ProgramBlock, order: Order) -> None:
        """Add an error for each wait between two tasks that is not, or not surely, between them."""
        nodes = all_nodes(program) if self.between else ()
        places = {id(node): i for i, node in enumerate(nodes, start=1)}
        for span, *three in self.between:
            first, wait, second = (places.get(id(node), 0) for node in three)
            if not 0 < first < wait < second:
                message = "a later line changes these tasks, so that the wait is not between them"
                hint = "write the wait after that line"
            elif order is Order.ANY:
                message = "these two tasks may change places with others"
                hint = "remove this wait, or the words that leave the order open"
            else:
                continue
            self.context.diagnostics.error("not-neighbours", message, span, hint)

    def _tasks_of(self, span: Span, thing: CheckpointInfo | Steps) -> Sequence[Do | str]:
        return self._of_steps(thing) if isinstance(thing, Steps) else [self._planned(span, thing)]

    def _of_steps(self, steps: Steps) -> list[Do | str]:
        """The tasks of steps; those that were left out, by their names."""
        if set(steps.points) <= set(self.header.left_out):
            return [str(point) for point in steps.points]
        tasks = _tasks(self.context.nodes_of(steps))
        if not tasks:
            hint = "name a step that measures or drives"
            message = "no task of this step is in the mission"
            self.context.diagnostics.refuse("not-planned", message, steps.span, hint)
        return list(tasks)

    def _order(self, program: ProgramBlock) -> Order:
        diagnostics = self.context.diagnostics
        said = self.header.order
        for span, nodes in self.precise:
            if not nodes and (said is Order.ANY or self.free):
                self._contradiction(span)
        if not self.free:
            if self.left_out and said is None and not self.precise:
                message = "other parts have no effect: the order is free as well"
                diagnostics.note("order-taken", message, self.left_out[0])
                return Order.ANY
            return said or Order.PRECISE
        span = self.free[0][0]
        if said is Order.PRECISE:
            self._contradiction(span)
        free = {id(do): k for k, (_, nodes) in enumerate(self.free) for do in _tasks(nodes)}
        tasks = [do for do in _tasks(program) if _may_move(do)]
        fixed = next((do for do in tasks if id(do) not in free), None)
        if not all(nodes for _, nodes in self.free) or (fixed is None and len(self.free) == 1):
            return Order.ANY
        if all(isinstance(node, Do) and _is_plain(node) for node in program):
            # `#4 and #8 in any order, then #1`: what is not said so keeps its place.
            groups = [list(g) for _, g in groupby(tasks, lambda do: free.get(id(do), id(do)))]
            for before, after in pairwise(groups):
                self.pairs += [(span, a, b) for a, b in product(before, after)]
            return Order.ANY
        message = "only some tasks here have any order: Argo keeps them in the order as written"
        hint = "write `The order is free.` if that applies to all tasks"
        diagnostics.warning("partly-free", message, span, hint)
        return Order.PRECISE

    def _contradiction(self, span: Span) -> None:
        message = "another line of the script sets another order"
        self.context.diagnostics.error("repeated-field", message, span, "remove one of the two")

    def _planned(self, span: Span, checkpoint: CheckpointInfo) -> Do:
        """The only measurement of a checkpoint."""
        context = self.context
        planned = context.measurements(checkpoint)
        name = f"checkpoint #{checkpoint.id}"
        if len(planned) == 1:
            return planned[0]
        if planned:
            message = f"{name} is measured more than once, so it is not clear which one comes first"
            hint = "remove this, or write the order of the measurements"
            context.diagnostics.refuse("ambiguous-edit", message, span, hint)
        hint = f"add it: `Check the {name}`"
        context.refuse_missing("not-planned", f"{name} is not in the mission", span, hint)

    def named(self, names: Mapping[int, str]) -> tuple[tuple[str, str], ...]:
        """The pairs by the names of their tasks."""

        def name(one: Do | str) -> str:
            return one if isinstance(one, str) else names[id(one)]

        return tuple(dict.fromkeys((name(a), name(b)) for _, a, b in self.pairs))

    def check(self, mission: Mission) -> None:
        """Says where the order that is written does not keep to what has to come before what."""
        if not self.pairs:
            return
        span = self.pairs[0][0]
        for found in check_precedence(mission):
            if found.severity is Severity.ERROR:
                self.context.diagnostics.error("precedence", found.message, span, found.hint)
            else:
                self.context.diagnostics.warning("precedence", found.message, span, found.hint)


def _tasks(nodes: Iterable[ProgramNode]) -> list[Do]:
    """The tasks that nodes are, or have in them."""
    found: list[Do] = []
    for node in nodes:
        if isinstance(node, Do):
            found.append(node)
        for block in inner_blocks(node):
            found += [do for do in all_nodes(block) if isinstance(do, Do)]
    return found


def _is_plain(do: Do) -> bool:
    """Whether a task may stand among others whose order is free in part."""
    return not do.ways and (_may_move(do) or do.docks or do.action is Action.START)


def _may_move(do: Do) -> bool:
    return do.action in (Action.MEASURE, Action.WAYPOINT) and not do.docks
