"""From `if a gas leak is detected, ...` to a reaction of the mission: what it does is put together
from the orders for it."""

from dataclasses import dataclass, replace
from typing import NamedTuple, NoReturn

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Span
from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.resolve.accepting import said, words_of
from argo_compiler.script.resolve.charging import (
    FULL,
    AwaitedEvent,
    awaited_event,
    charge_share,
    low_level,
)
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.conditions import (
    Asked,
    BatteryLevel,
    Occurs,
    SaidCondition,
)
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.orders import Case, PlainWord, ScriptOrder
from argo_compiler.script.sentences.tree.places import FloorName

_USED = frozenset(
    {"priority", "until", "duration", "time_limit", "on_limit", "charge", "charge_time"}
)

_CHARGED = EventKind.BATTERY_CHARGED


@dataclass(frozen=True, slots=True)
class _Answer:
    """What is done in an event, as far as its orders have been gone through. None: not said."""

    response: Response | None = None
    reported: bool = False
    ended: bool = False
    """by words that may be followed by the way home: `break off and ...`"""
    pose: Pose | None = None
    area: int | None = None
    until: EventKind | None = None
    afterwards: Afterwards | None = None
    hold_limit: float | None = None
    on_limit: Afterwards | None = None
    priority: int | None = None
    charge: float | None = None
    """0 to 1, to which the battery is charged"""
    charge_time: float | None = None
    """s for which it is charged at least"""
    fully: bool = False
    """whether it waits until the battery is charged, by these words"""

    @property
    def drives(self) -> bool:
        return self.response in (Response.RETURN, Response.SAFE_AREA)

    @property
    def pausing(self) -> "_Answer":
        """The answer with a pause if nothing else is done."""
        return replace(self, response=self.response or Response.PAUSE)

    @property
    def recharging(self) -> "_Answer":
        """The answer with a return to the dock, unless the robot drives somewhere already."""
        return self if self.drives else replace(self, response=Response.RETURN)


class _Trigger(NamedTuple):
    event: EventKind
    span: Span
    battery_below: float | None = None


class Reactions:
    """The reactions that a script asks for, at most one for each event."""

    def __init__(self, lookup: Lookup, diagnostics: Diagnostics) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics
        self.found: list[Reaction] = []
        self.lines: dict[EventKind, Span] = {}

    def add(self, case: Case) -> None:
        """Adds the reaction that a case with events as its condition asks for."""
        assert case.condition is not None
        if any(len(tests) > 1 for tests in case.condition.alternatives):
            message = "a reaction needs one event, not several at the same time"
            self.diagnostics.refuse("reaction", message, case.condition.span, "join them with `or`")
        triggers = [self._trigger(test) for (test,) in case.condition.alternatives]
        answer = self._answer(case)
        response = answer.response
        if response is None and answer.until is not None:
            response = Response.PAUSE
        elif response is None and answer.reported:
            response = Response.REPORT
        if response is None:
            hint = "add, for example, `report it` or `pause`"
            self.diagnostics.refuse("unfinished", "this does not say what to do", case.span, hint)
        for event, span, level in triggers:
            before = self.lines.get(event)
            if before is not None:
                message = f"line {before.line} already has a reaction to this event"
                hint = "remove one of the two"
                self.diagnostics.error("second-reaction", message, case.span, hint)
                continue
            self.lines[event] = span
            self.found.append(
                Reaction(
                    event=event,
                    response=response,
                    pose=answer.pose,
                    area=answer.area,
                    until=answer.until,
                    afterwards=answer.afterwards or Afterwards.END,
                    hold_limit=answer.hold_limit,
                    on_limit=answer.on_limit or Afterwards.WAIT,
                    priority=answer.priority,
                    battery_below=level,
                    charge_to=answer.charge,
                    charge_for=answer.charge_time,
                    source=case.span,
                )
            )

    def _trigger(self, test: Asked) -> _Trigger:
        if isinstance(test, BatteryLevel):
            level = low_level(test, self.diagnostics)
            return _Trigger(EventKind.LOW_BATTERY, test.span, level)
        if not isinstance(test, Occurs):
            message = "one condition can't contain both values and events"
            self.diagnostics.refuse("reaction", message, test.span, "write a sentence for each")
        if test.event is None:
            message = "an obstacle is positive (in the way) or negative (a part is missing)"
            hint = "write `a positive obstacle` or `a negative obstacle`"
            self.diagnostics.refuse("ambiguous-event", message, test.span, hint)
        return _Trigger(test.event, test.span)

    # ---- what is done

    def _answer(self, case: Case) -> _Answer:
        """What is done in a case with events as its condition."""
        answer = _Answer()
        for order in case.orders:
            answer = self._with(order, self._furnished(order, answer))
        return self._held(answer, case.span)

    def _with(self, order: ScriptOrder, answer: _Answer) -> _Answer:
        """The answer with one order more."""
        match order:
            case orders.Amend():
                return answer
            case orders.Plain(word=PlainWord.REPORT):
                return replace(answer, reported=True)
            case orders.Plain(word=PlainWord.PAUSE):
                return answer.pausing
            case orders.Plain(word=PlainWord.RECHARGE):
                return self._until(_CHARGED, answer, order.span).recharging
            case orders.Plain(word=PlainWord.GO_ON):
                return self._afterwards(order, answer, Afterwards.RESUME)
            case orders.Plain(word=PlainWord.ABORT | PlainWord.END) if not answer.drives:
                aborted = self._responds(answer, Response.ABORT, order)
                return replace(aborted, ended=True)
            case orders.Plain(word=PlainWord.END):
                return self._afterwards(order, answer, Afterwards.END)
            case orders.WaitOrder(where=where):
                if where is not None:
                    answer = self._goes(orders.Go(span=order.span, where=where), answer)
                return self._waits(order, answer)
            case orders.Home():
                return self._home(order, answer)
            case orders.Go():
                return self._goes(order, answer)
        hint = "it can report, pause, return, drive to a place, recharge, wait, resume or abort"
        self.diagnostics.refuse("reaction", "a reaction can't do this", order.span, hint)

    def _furnished(self, order: ScriptOrder, answer: _Answer) -> _Answer:
        """What is said of how long it holds, for what, and how urgent it is."""
        manner = order.manner or Manner()
        own = {orders.Home: {"pose"}, orders.WaitOrder: {"person"}}.get(type(order), set())
        left = sorted(said(manner) - _USED - own)
        if left or order.name is not None:
            message = f"a reaction can't have this: {words_of(left) if left else 'a name'}"
            hint = "remove it; to say how urgent it is, write a number: `with priority 90`"
            self.diagnostics.refuse("stray-clause", message, order.span, hint)
        if manner.time_limit is not None and manner.duration is not None:
            self._twice(order.span)
        limit = manner.time_limit if manner.time_limit is not None else manner.duration
        answer = replace(
            answer,
            hold_limit=answer.hold_limit if limit is None else limit,
            on_limit=manner.on_limit or answer.on_limit,
            priority=answer.priority if manner.priority is None else manner.priority,
        )
        if manner.charge is not None:
            answer = self._charges(
                charge_share(manner.charge, manner.charge.span, self.diagnostics), answer, order
            )
        if manner.charge_time is not None:
            if answer.charge_time is not None:
                self._twice(order.span)
            answer = replace(answer, charge_time=manner.charge_time)
        if manner.until is None:
            return answer
        event, charge = self._awaited(manner.until)
        answer = self._until(event, replace(answer, fully=event is _CHARGED), order.span)
        return answer if charge is None else self._charges(charge, answer, order)

    def _charges(self, charge: float, answer: _Answer, order: ScriptOrder) -> _Answer:
        if answer.charge is not None:
            self._twice(order.span)
        return replace(answer, charge=charge)

    def _awaited(self, condition: SaidCondition) -> AwaitedEvent:
        match condition.alternatives:
            case ((test,),):
                if (found := awaited_event(test, self.diagnostics)) is not None:
                    return found
        hint = "write, for example, `until the all clear`"
        self.diagnostics.refuse("reaction", "a reaction waits for one event", condition.span, hint)

    def _until(self, event: EventKind, answer: _Answer, span: Span) -> _Answer:
        if answer.until not in (None, event):
            self._twice(span)
        return replace(answer, until=event)

    def _responds(self, answer: _Answer, response: Response, order: ScriptOrder) -> _Answer:
        goes_on = answer.afterwards is not None and response is Response.ABORT
        stops = answer.ended and response is Response.RETURN  # `stop the mission and go home`
        if goes_on or not (stops or answer.response in (None, Response.PAUSE, response)):
            message = "the reaction has two actions at once"
            self.diagnostics.refuse("reaction", message, order.span, "remove one of them")
        return replace(answer, response=response)

    def _afterwards(self, order: ScriptOrder, answer: _Answer, afterwards: Afterwards) -> _Answer:
        if answer.response is Response.ABORT or answer.afterwards not in (None, afterwards):
            self._twice(order.span)
        return replace(answer, afterwards=afterwards)

    def _waits(self, order: orders.WaitOrder, answer: _Answer) -> _Answer:
        person = order.manner is not None and order.manner.person
        held = answer.until is not None or answer.hold_limit is not None
        if order.stays and answer.response is Response.RETURN and not (person or held):
            return self._afterwards(order, answer, Afterwards.END)  # it stays in its dock
        if answer.drives and (person or not held):
            return self._afterwards(order, answer, Afterwards.WAIT)
        return answer.pausing

    def _home(self, order: orders.Home, answer: _Answer) -> _Answer:
        pose, number = None, None
        if order.dock.area is not None:
            area = self.lookup.area(order.dock.area.area, order.dock.span)
            pose, number = area.dock, area.number
        answer = self._responds(answer, Response.RETURN, order)
        if order.manner is not None and order.manner.pose is not None:
            pose = self.lookup.point(order.manner.pose)
        return replace(answer, pose=pose, area=number)

    def _goes(self, order: orders.Go, answer: _Answer) -> _Answer:
        if isinstance(order.where, FloorName):
            message = "a reaction can drive to a place, but not to a floor"
            self.diagnostics.refuse("reaction", message, order.span, "name a place of the site")
        pose, _ = self.lookup.locate(order.where, "end")
        return replace(self._responds(answer, Response.SAFE_AREA, order), pose=pose)

    def _held(self, answer: _Answer, span: Span) -> _Answer:
        """The answer with what happens when the time for which it holds is over."""
        charges = answer.charge is not None or answer.charge_time is not None
        if charges and answer.until is not _CHARGED:
            message = "only a battery that is charged has a level or a least time"
            hint = "write, for example, `return, recharge to 80 % and resume`"
            self.diagnostics.refuse("reaction", message, span, hint)
        if answer.charge_time is not None and answer.charge is None and answer.fully:
            answer = replace(answer, charge=FULL)
        if answer.hold_limit is None:
            return answer
        if answer.drives and answer.until is None:
            message = "after its drive a reaction can wait for an event, but not for a duration"
            hint = "write, for example, `return and wait until all clear for at most 10 minutes`"
            self.diagnostics.refuse("reaction", message, span, hint)
        on_limit = answer.on_limit or answer.afterwards
        if on_limit is None and answer.until is not None:
            message = "this does not say what to do if the event does not occur in this time"
            hint = "add `or else go on`, `or else end the mission` or `or else wait`"
            self.diagnostics.refuse("reaction", message, span, hint)
        afterwards = answer.afterwards
        if answer.drives and answer.on_limit is Afterwards.RESUME:
            afterwards = afterwards or Afterwards.RESUME  # `..., or else resume`
        return replace(answer, on_limit=on_limit or Afterwards.RESUME, afterwards=afterwards)

    def _twice(self, span: Span) -> NoReturn:
        message = "this contradicts an earlier reaction to the same event"
        self.diagnostics.refuse("reaction", message, span, "remove one of the two")
