"""From `if a gas leak is detected, ...` to a reaction of the mission: what it does is put together
from the orders for it."""

from typing import NamedTuple, NoReturn

from argo_compiler.base.model import Pose
from argo_compiler.base.records import dataclass
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
from argo_compiler.script.sentences.tree.orders import Case, PlainWord, ScriptOrder
from argo_compiler.script.sentences.tree.places import FloorName, Location

_USED = frozenset(
    {"priority", "until", "duration", "time_limit", "on_limit", "charge", "charge_time"}
)

_CHARGED = EventKind.BATTERY_CHARGED


@dataclass(slots=True)
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
        said = Response.PAUSE if answer.until is not None else None
        response = answer.response or said or (Response.REPORT if answer.reported else None)
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
            self._furnish(answer, order)
            self._add(answer, order)
        self._hold(answer, case.span)
        return answer

    def _add(self, answer: _Answer, order: ScriptOrder) -> None:
        """Adds one order more."""
        match order:
            case orders.Amend():
                pass
            case orders.Plain(word=PlainWord.REPORT):
                answer.reported = True
            case orders.Plain(word=PlainWord.PAUSE):
                answer.response = answer.response or Response.PAUSE
            case orders.Plain(word=PlainWord.RECHARGE):
                self._await(answer, _CHARGED, order.span)
                answer.response = answer.response if answer.drives else Response.RETURN
            case orders.Plain(word=PlainWord.GO_ON):
                self._go_on(answer, Afterwards.RESUME, order.span)
            case orders.Plain(word=PlainWord.ABORT | PlainWord.END) if not answer.drives:
                self._respond(answer, Response.ABORT, order.span)
                answer.ended = True
            case orders.Plain(word=PlainWord.END):
                self._go_on(answer, Afterwards.END, order.span)
            case orders.WaitOrder():
                if order.where is not None:
                    self._drive(answer, order.where, order.span)
                self._wait(answer, order)
            case orders.Home():
                self._return(answer, order)
            case orders.Go():
                self._drive(answer, order.where, order.span)
            case _:
                hint = "it can report, pause, return, drive to a place, recharge, wait, resume or "
                message = "a reaction can't do this"
                self.diagnostics.refuse("reaction", message, order.span, f"{hint}abort")

    def _furnish(self, answer: _Answer, order: ScriptOrder) -> None:
        """Adds what is said of how long it holds, for what, and how urgent it is."""
        manner = order.manner
        own = {orders.Home: {"pose"}, orders.WaitOrder: {"person"}}.get(type(order), set())
        left = sorted(said(manner) - _USED - own)
        if left or order.name is not None:
            message = f"a reaction can't have this: {words_of(left) if left else 'a name'}"
            hint = "remove it; to say how urgent it is, write a number: `with priority 90`"
            self.diagnostics.refuse("stray-clause", message, order.span, hint)
        if manner.time_limit is not None and manner.duration is not None:
            self._twice(order.span)
        limit = manner.time_limit if manner.time_limit is not None else manner.duration
        answer.hold_limit = answer.hold_limit if limit is None else limit
        answer.on_limit = manner.on_limit or answer.on_limit
        answer.priority = answer.priority if manner.priority is None else manner.priority
        if manner.charge is not None:
            share = charge_share(manner.charge, manner.charge.span, self.diagnostics)
            self._charge(answer, share, order.span)
        if manner.charge_time is not None:
            if answer.charge_time is not None:
                self._twice(order.span)
            answer.charge_time = manner.charge_time
        if manner.until is not None:
            event, charge = self._awaited(manner.until)
            answer.fully = event is _CHARGED
            self._await(answer, event, order.span)
            if charge is not None:
                self._charge(answer, charge, order.span)

    def _charge(self, answer: _Answer, charge: float, span: Span) -> None:
        if answer.charge is not None:
            self._twice(span)
        answer.charge = charge

    def _awaited(self, condition: SaidCondition) -> AwaitedEvent:
        match condition.alternatives:
            case ((test,),):
                if (found := awaited_event(test, self.diagnostics)) is not None:
                    return found
        hint = "write, for example, `until the all clear`"
        self.diagnostics.refuse("reaction", "a reaction waits for one event", condition.span, hint)

    def _await(self, answer: _Answer, event: EventKind, span: Span) -> None:
        if answer.until not in (None, event):
            self._twice(span)
        answer.until = event

    def _respond(self, answer: _Answer, response: Response, span: Span) -> None:
        goes_on = answer.afterwards is not None and response is Response.ABORT
        stops = answer.ended and response is Response.RETURN  # `stop the mission and go home`
        if goes_on or not (stops or answer.response in (None, Response.PAUSE, response)):
            message = "the reaction has two actions at once"
            self.diagnostics.refuse("reaction", message, span, "remove one of them")
        answer.response = response

    def _go_on(self, answer: _Answer, afterwards: Afterwards, span: Span) -> None:
        if answer.response is Response.ABORT or answer.afterwards not in (None, afterwards):
            self._twice(span)
        answer.afterwards = afterwards

    def _wait(self, answer: _Answer, order: orders.WaitOrder) -> None:
        person = order.manner.person
        held = answer.until is not None or answer.hold_limit is not None
        if order.stays and answer.response is Response.RETURN and not (person or held):
            self._go_on(answer, Afterwards.END, order.span)  # it stays in its dock
        elif answer.drives and (person or not held):
            self._go_on(answer, Afterwards.WAIT, order.span)
        else:
            answer.response = answer.response or Response.PAUSE

    def _return(self, answer: _Answer, order: orders.Home) -> None:
        answer.pose = answer.area = None
        if order.dock.area is not None:
            area = self.lookup.area(order.dock.area.area, order.dock.span)
            answer.pose, answer.area = area.dock, area.number
        self._respond(answer, Response.RETURN, order.span)
        if order.manner.pose is not None:
            answer.pose = self.lookup.point(order.manner.pose)

    def _drive(self, answer: _Answer, where: Location | FloorName, span: Span) -> None:
        if isinstance(where, FloorName):
            message = "a reaction can drive to a place, but not to a floor"
            self.diagnostics.refuse("reaction", message, span, "name a place of the site")
        answer.pose, _ = self.lookup.locate(where, "end")
        self._respond(answer, Response.SAFE_AREA, span)

    def _hold(self, answer: _Answer, span: Span) -> None:
        """Adds what happens when the time for which it holds is over."""
        charges = answer.charge is not None or answer.charge_time is not None
        if charges and answer.until is not _CHARGED:
            message = "only a battery that is charged has a level or a least time"
            hint = "write, for example, `return, recharge to 80 % and resume`"
            self.diagnostics.refuse("reaction", message, span, hint)
        if answer.charge_time is not None and answer.charge is None and answer.fully:
            answer.charge = FULL
        if answer.hold_limit is None:
            return
        if answer.drives and answer.until is None:
            message = "after its drive a reaction can wait for an event, but not for a duration"
            hint = "write, for example, `return and wait until all clear for at most 10 minutes`"
            self.diagnostics.refuse("reaction", message, span, hint)
        if answer.drives and answer.on_limit is Afterwards.RESUME:  # `..., or else resume`
            answer.afterwards = answer.afterwards or Afterwards.RESUME
        answer.on_limit = answer.on_limit or answer.afterwards
        if answer.on_limit is None and answer.until is not None:
            message = "this does not say what to do if the event does not occur in this time"
            hint = "add `or else go on`, `or else end the mission` or `or else wait`"
            self.diagnostics.refuse("reaction", message, span, hint)
        answer.on_limit = answer.on_limit or Afterwards.RESUME

    def _twice(self, span: Span) -> NoReturn:
        message = "this contradicts an earlier reaction to the same event"
        self.diagnostics.refuse("reaction", message, span, "remove one of the two")
