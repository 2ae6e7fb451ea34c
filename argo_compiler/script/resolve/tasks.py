"""The tasks that an order plans."""

from collections.abc import Sequence
from dataclasses import replace

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, EventKind, WaitRule
from argo_compiler.script.resolve.accepting import said
from argo_compiler.script.resolve.charging import FULL, awaited_event, charge_share
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.lookup import told
from argo_compiler.script.resolve.manners import Manners, make_round, timed
from argo_compiler.script.resolve.program import Do, ProgramRound, dock, measurement
from argo_compiler.script.resolve.starting import Starting
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.nouns import AllOf, Labelled
from argo_compiler.script.sentences.tree.orders import PlainWord, ScriptOrder, Side
from argo_compiler.script.sentences.tree.places import FloorName, PlaceLocation

_DEMANDS = frozenset(["latest", "earliest", "priority", "rank"])


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
                return [_waypoint(self._patrol(floor)[0], span)]
            case orders.Go(where=where):
                assert not isinstance(where, FloorName)
                return [_waypoint(self.context.lookup.locate(where, "end")[0], span)]
            case orders.Home():
                return [dock(self.starting.docking_area(order.dock).dock, span)]
            case orders.WaitOrder():
                return [Do("WAIT", Action.WAIT, span, wait=self._wait_rule(order))]
            case orders.Plain(word=PlainWord.MEET):
                return [Do("MEET", Action.WAIT, span, wait=WaitRule(duration=0))]
        if isinstance(order, orders.Follow):
            hint = "write `repeat this three times`, or write the sub-steps below it"
            self.context.diagnostics.refuse("route", "this step has no sub-steps", span, hint)
        message = "this is not possible here"
        self.context.diagnostics.refuse("route", message, span, "write it as a separate step")

    def _measurements(self, order: orders.Measure) -> list[Do]:
        nouns, what = self.context.nouns, order.what
        self._require_known(order)
        if order.manner.floors:
            what = nouns.on(order.manner.floors, what)
        found = nouns.all(what)
        if all(isinstance(noun, Labelled) for noun in what.nouns):
            nouns.warn_of_empty(order.manner.floors, found, "one of these", order.span)
        self._require_first(order, found)
        self.context.memory.measured(found)
        if order.manner.backwards:
            self._require_several(order, found)
            found.reverse()
        tasks = [measurement(c, order.span) for c in found]
        if self.visiting is not None and self.visiting[1] == found[:1]:
            self.manners.furnish(self.visiting[0], tasks[:1])
            self.visiting = None
        self.leave_unvisited()
        return tasks

    def _require_several(
        self, order: orders.Measure, checkpoints: Sequence[CheckpointInfo]
    ) -> None:
        """Ask what the reverse order of a single checkpoint is."""
        if len(checkpoints) == 1:
            message = "a single checkpoint has no reverse order; other lines may be meant, too"
            hint = "write the checkpoints in one list, or in the intended order"
            self.context.diagnostics.refuse("ambiguous-order", message, order.span, hint)

    def _require_first(self, order: orders.Measure, checkpoints: Sequence[CheckpointInfo]) -> None:
        """Ask about `check #4 again` where checkpoint 4 was not measured before."""
        memory = self.context.memory
        manner = order.manner
        if not manner.more or manner.times != 1 or not memory.known:
            return
        for checkpoint in checkpoints:
            if checkpoint.id not in memory.so_far:
                message = f"checkpoint #{checkpoint.id} is not measured before this; `again` can "
                message += "mean twice, or once more after an earlier mission"
                hint = "write `twice`, or remove `again`"
                self.context.diagnostics.refuse("ambiguous-measure", message, order.span, hint)

    def _require_known(self, order: orders.Measure) -> None:
        """That `the whole list` is not said where something was measured before."""
        whole = any(isinstance(n, AllOf) and n.whole and not n.floors for n in order.what.nouns)
        if whole and not order.what.but and self.context.measured:
            message = "this can mean all tasks so far, or all checkpoints of the site"
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

    # ---- waits and patrols

    def _wait_rule(self, order: orders.WaitOrder) -> WaitRule:
        """How long it waits, or for what. Raises RefusedError if that is not clear."""
        diagnostics = self.context.diagnostics
        manner = order.manner
        until, duration, limit = manner.until, manner.duration, manner.time_limit
        if order.recharges:
            return self._recharge_rule(order, manner)
        if manner.person:
            hint = "an operator can pause the run; or write a duration: `wait 5 minutes`"
            diagnostics.refuse("wait", "a mission can't wait for a person", order.span, hint)
        if until is None:
            if duration is None:
                message = "this has no duration and no condition"
                hint = "write `wait 90 s`, `wait until #1 is below 3` or `wait for the all-clear`"
                diagnostics.refuse("wait", message, order.span, hint)
            if limit is not None:
                message = "a wait with a duration can't have another limit"
                diagnostics.refuse("wait", message, order.span, "remove one of them")
            return WaitRule(duration=duration)
        if limit is not None and duration is not None:
            message = "the limit of the wait is given twice"
            diagnostics.refuse("repeated-limit", message, order.span, "remove one of them")
        limit = duration if limit is None else limit
        event: EventKind | None = None
        charge: float | None = None
        match until.alternatives:
            case ((test,), *others) if len(others) < 2:
                if (awaited := awaited_event(test, diagnostics)) is not None:
                    event, charge = awaited
                    until = replace(until, alternatives=tuple(others))
        charge, charge_time = self._charge(order, manner, event, charge)
        conditions = self.context.conditions.alternatives(until)
        if len(conditions) > 1:
            message = "a wait can end when all conditions are satisfied, not when one of several is"
            hint = "join them with `and` if all are meant, or wait for one of them only"
            diagnostics.refuse("wait", message, until.span, hint)
        return WaitRule(
            event=event,
            conditions=conditions[0] if conditions else (),
            limit=limit,
            charge_to=FULL if charge is None and charge_time is not None else charge,
            charge_for=charge_time,
        )

    def _recharge_rule(self, order: orders.WaitOrder, manner: Manner) -> WaitRule:
        """Return the rule of a WAIT that recharges; raises RefusedError if it has two limits."""
        diagnostics = self.context.diagnostics
        limits = [t for t in (manner.duration, manner.time_limit) if t is not None]
        if manner.until is not None or len(limits) > 1:
            message = "this says twice how long it recharges"
            diagnostics.refuse("repeated-limit", message, order.span, "remove one of them")
        charge, charge_time = self._charge(order, manner, EventKind.BATTERY_CHARGED, None)
        return WaitRule(
            event=EventKind.BATTERY_CHARGED,
            limit=limits[0] if limits else None,
            charge_to=charge,
            charge_for=charge_time,
        )

    def _charge(
        self,
        order: orders.WaitOrder,
        manner: Manner,
        event: EventKind | None,
        charge: float | None,
    ) -> tuple[float | None, float | None]:
        """Return the charge (0 to 1) and the least time (s) of a wait; its condition has `charge`.

        Raises RefusedError if it waits for something else than the battery, or names two charges.
        """
        diagnostics = self.context.diagnostics
        if manner.charge is not None:
            if charge is not None:
                message = "the charge is given twice"
                diagnostics.refuse("repeated-limit", message, order.span, "remove one of them")
            charge = charge_share(manner.charge, manner.charge.span, diagnostics)
        charges = charge is not None or manner.charge_time is not None
        if charges and event is not EventKind.BATTERY_CHARGED:
            message = "only a battery that is charged has a level or a least time"
            hint = "write, for example, `wait until the battery is charged to 80 %`"
            diagnostics.refuse("wait", message, order.span, hint)
        return charge, manner.charge_time

    def patrol_rounds(self, order: orders.Patrol) -> tuple[list[ProgramRound], list[Do]]:
        """Return a patrol's rounds, one for each floor or one through the places, and stops."""
        context = self.context
        limited = timed(order, context.diagnostics)
        rounds: list[ProgramRound] = []
        tasks: list[Do] = []
        for base, poses in self._patrol_places(order):
            round_ = make_round(limited, base, context, order.name)
            stops = [_waypoint(pose, order.span) for pose in poses]
            self.manners.furnish(limited, stops)
            context.put(stops, round_.body, None)
            tasks += stops
            rounds.append(round_)
        return rounds, tasks

    def _patrol_places(self, order: orders.Patrol) -> list[tuple[str, list[Pose]]]:
        """What the rounds are called, and through which places they lead."""
        context, manner = self.context, order.manner
        floors = [p for p in order.places if isinstance(p, FloorName)]
        if len(floors) > 1 and manner.duration is not None:
            message = "this duration can apply to each floor, or to all together"
            hint = "write one patrol for each floor, each with its own duration"
            context.diagnostics.refuse("ambiguous-duration", message, order.span, hint)
        rounds: list[tuple[str, list[Pose]]] = []
        through: list[Pose] = []
        label = ""
        for place in order.places:
            if isinstance(place, FloorName):
                floor = context.lookup.floor(place)
                rounds.append((f"Patrol floor {floor.number}", self._patrol(place)))
                continue
            pose, area = context.lookup.locate(place, "end")
            if isinstance(place, PlaceLocation):
                label = label or place.name.removeprefix("the ")
            label = label or (f"area {area.number}" if area else "place")
            through.append(pose)
        if through:
            rounds.append((f"Patrol {label}", through))
        if order.name is not None and len(rounds) > 1:
            message = "this name is in front of a command with several patrols"
            hint = "write a line and a name for each of them"
            context.diagnostics.error("one-name", message, order.span, hint)
        return rounds

    def _patrol(self, name: FloorName) -> list[Pose]:
        """Return the poses of a floor's patrol. Raises RefusedError if there is none."""
        floor = self.context.lookup.floor(name)
        if not floor.patrol:
            message = f"floor {floor.number} has no three places that the robot can drive between"
            hint = "name a checkpoint or a place of the floor, or check the site"
            self.context.diagnostics.refuse("no-patrol", message, name.span, hint)
        return list(floor.patrol)

    # ---- what is measured before already, or elsewhere

    def demanded_of(self, order: orders.Measure) -> list[Do]:
        """Return the tasks of which a sentence in the passive only says when they are due, or how
        important; none if it plans them. Raises RefusedError if both may be meant."""
        asked = said(order.manner) if order.passive else frozenset()
        if not asked or not asked <= _DEMANDS:
            return []
        context = self.context
        planned = [context.measurements(c) for c in context.nouns.all(order.what)]
        if not all(planned):
            return []
        own_step = bool(context.steps) and not context.step
        if own_step or any(len(tasks) > 1 for tasks in planned):
            message = "this can apply to the measurement before, or ask for it once more"
            hint = "write it with the measurement: `check checkpoint 4 within 5 minutes`"
            context.diagnostics.refuse("ambiguous-demand", message, order.span, hint)
        return [task for tasks in planned for task in tasks]

    def measured_beside(self, order: orders.Beside) -> list[orders.Measure]:
        """Return what is measured, in its order; what comes first may be measured already."""
        context = self.context
        anchor = context.nouns.all(order.anchor)
        done = [c for c in anchor if context.measured.get(str(c.id))]
        other = orders.Measure(span=order.span, what=order.anchor)
        if order.side is Side.AFTER:
            both = [order.order] if len(done) == len(anchor) else [other, order.order]
        elif done:
            message = f"{told(done[0])} is already measured before this"
            hint = "write this before it, or ask for another measurement"
            context.diagnostics.refuse("ambiguous-edit", message, order.span, hint)
        else:
            both = [order.order, other]
        context.once.update((str(c.id), order.span) for c in anchor if c not in done)
        return both


def _waypoint(pose: Pose, source: Span) -> Do:
    return Do("WAYPOINT", Action.WAYPOINT, source, pose)
