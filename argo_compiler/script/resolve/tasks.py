"""The tasks that an order plans."""

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import Do
from argo_compiler.script.resolve.starting import Starting
from argo_compiler.script.resolve.waiting import wait_rule
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.nouns import AllOf, Labelled
from argo_compiler.script.syntax.tree.orders import PlainWord, ScriptOrder
from argo_compiler.script.syntax.tree.places import FloorName


class TaskMaker:
    """Makes tasks of orders. Raises RefusedError where it can't."""

    def __init__(self, context: Context, starting: Starting, manners: Manners) -> None:
        self.context = context
        self.starting = starting
        self.manners = manners
        self.visiting: tuple[orders.VisitOrder, list[CheckpointInfo]] | None = None
        """a drive to a checkpoint, of which it has not been said yet what to do there"""

    def tasks(self, order: ScriptOrder) -> list[Do]:
        """The tasks of an order, none if that was said before."""
        span = order.span
        match order:
            case orders.Start():
                return [self.starting.set(order)]
            case orders.Measure():
                return self._measurements(order)
            case orders.Go(where=FloorName() as floor):
                return [making.waypoint(self.context.lookup.floor(floor).patrol[0], span)]
            case orders.Go(where=where):
                assert not isinstance(where, FloorName)
                return [making.waypoint(self.context.locator.locate(where, "end")[0], span)]
            case orders.Home():
                return [making.dock(self.starting.docking_area(order.dock).dock, span)]
            case orders.WaitOrder():
                return [making.wait(wait_rule(order, self.context), span)]
            case orders.Plain(word=PlainWord.MEET):
                return [making.meeting(span)]
        if isinstance(order, orders.Follow):
            message = "there are no steps within this one"
            hint = "write `repeat this three times`, or the steps as sub-steps below it"
            self.context.diagnostics.refuse("route", message, span, hint)
        message = "this can't be done here"
        self.context.diagnostics.refuse("route", message, span, "write it as a step of its own")

    def _measurements(self, order: orders.Measure) -> list[Do]:
        nouns, what = self.context.nouns, order.what
        self._require_known(order)
        if order.manner is not None and order.manner.floors:
            what = nouns.on(order.manner.floors, what)
        found = nouns.all(what)
        if order.manner is not None and all(isinstance(noun, Labelled) for noun in what.nouns):
            nouns.warn_of_empty(order.manner.floors, found, "one of these", order.span)
        self.context.memory.measured(found)
        if order.manner is not None and order.manner.backwards:
            found.reverse()
        tasks = [making.measurement(c.id, order.span) for c in found]
        if self.visiting is not None and self.visiting[1] == found[:1]:
            self.manners.furnish(self.visiting[0], tasks[:1])
            self.visiting = None
        self.leave_unvisited()
        return tasks

    def _require_known(self, order: orders.Measure) -> None:
        """That `the whole list` is not said where something was measured before."""
        whole = any(isinstance(n, AllOf) and n.whole and not n.floors for n in order.what.nouns)
        if whole and not order.what.but and self.context.measured:
            message = "this can mean all that was done so far, or all checkpoints of the site"
            hint = "write `repeat everything once more`, or `check all checkpoints`"
            self.context.diagnostics.refuse("ambiguous-all", message, order.span, hint)

    def visit(self, order: orders.VisitOrder) -> None:
        """Drives to a checkpoint; what to do there is said next."""
        found = self.context.nouns.all(order.what)
        self.context.memory.measured(found)
        self.visiting = (order, found)

    def leave_unvisited(self) -> None:
        """Says where a drive to a checkpoint is not followed by what is to be done there."""
        if self.visiting is None:
            return
        (order, (checkpoint, *_)), self.visiting = self.visiting, None
        message = f"this does not say what to do at {checkpoint.name} (#{checkpoint.id})"
        hint = f"write `check checkpoint {checkpoint.id}`"
        self.context.diagnostics.error("visit", message, order.span, hint)
