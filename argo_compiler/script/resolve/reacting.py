"""From `if a gas leak is detected, ...` to a reaction of the mission."""

from dataclasses import dataclass, replace

from argo_compiler.diagnostics import Span
from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_compiler.model import Pose
from argo_compiler.script.resolve.accepting import said, words_of
from argo_compiler.script.resolve.locating import Locator
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.conditions import (
    BatteryDrops,
    Occurs,
    Relation,
    SaidCondition,
)
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import (
    Amend,
    Case,
    Go,
    Home,
    Plain,
    PlainWord,
    ScriptOrder,
    WaitOrder,
)
from argo_compiler.script.syntax.tree.places import DockLocation, FloorName


@dataclass(frozen=True, slots=True)
class _Reacting:
    """What a reaction does, as far as the orders have been gone through."""

    response: Response | None = None
    reported: bool = False
    ended: bool = False
    """by words that may be followed by the way home: `stop the mission and ...`"""
    pose: Pose | None = None
    area: int | None = None
    until: EventKind | None = None
    afterwards: Afterwards | None = None
    """None: not said"""
    hold_limit: float | None = None
    on_limit: Afterwards | None = None
    """None: not said"""
    priority: int | None = None

    @property
    def drives(self) -> bool:
        return self.response in (Response.RETURN, Response.SAFE_AREA)


class Reactions:
    """The reactions that a script asks for, at most one for each event."""

    def __init__(self, locator: Locator, diagnostics: Diagnostics) -> None:
        self.locator = locator
        self.diagnostics = diagnostics
        self.found: list[Reaction] = []
        self.lines: dict[EventKind, Span] = {}

    def add(self, case: Case) -> None:
        """Adds the reaction that a case with events as its condition asks for."""
        assert case.condition is not None
        events = self._events(case.condition)
        doing = _Reacting()
        for order in case.orders:
            step = self._order(order, doing)
            if step is None:
                return
            doing = step
        held = self._held(doing, case.span)
        if held is None:
            return
        doing = held
        response = doing.response
        if response is None and doing.until is not None:
            response = Response.PAUSE
        elif response is None and doing.reported:
            response = Response.REPORT
        if response is None or events is None:
            self._unfinished(case) if events is not None else None
            return
        for event, span, level in events:
            self._react(event, level, span, response, doing, case.span)

    def _react(
        self,
        event: EventKind,
        level: float | None,
        span: Span,
        response: Response,
        doing: _Reacting,
        whole: Span,
    ) -> None:
        before = self.lines.get(event)
        if before is not None:
            message = f"line {before.line} already says what to do in this event"
            hint = "leave one of the two out"
            self.diagnostics.error("second-reaction", message, whole, hint)
            return
        self.lines[event] = span
        self.found.append(
            Reaction(
                event=event,
                response=response,
                pose=doing.pose,
                area=doing.area,
                until=doing.until,
                afterwards=doing.afterwards or Afterwards.END,
                hold_limit=doing.hold_limit,
                on_limit=doing.on_limit or Afterwards.WAIT,
                priority=doing.priority,
                battery_below=level,
                source=whole,
            )
        )

    def _events(
        self, condition: SaidCondition
    ) -> list[tuple[EventKind, Span, float | None]] | None:
        found: list[tuple[EventKind, Span, float | None]] = []
        for tests in condition.alternatives:
            if len(tests) > 1:
                message = "a reaction follows one event, not several at the same time"
                hint = "join them by `or`"
                self.diagnostics.error("reaction", message, condition.span, hint)
                return None
            (test,) = tests
            if isinstance(test, BatteryDrops):
                level = self._level(test)
                if level is None:
                    return None
                found.append((EventKind.LOW_BATTERY, test.span, level))
            elif not isinstance(test, Occurs):
                message = "values and events can't be asked for in one condition"
                hint = "write a sentence for each"
                self.diagnostics.error("reaction", message, test.span, hint)
                return None
            elif test.event is None:
                message = "an obstacle may be positive or negative: in the way, or a part missing"
                hint = "write `a positive obstacle` or `a negative obstacle`"
                self.diagnostics.error("ambiguous-event", message, test.span, hint)
                return None
            else:
                found.append((test.event, test.span, None))
        return found

    def _level(self, battery: BatteryDrops) -> float | None:
        """The share of the charge below which the battery is to be called low."""
        amount = battery.level
        message, hint = "", "write, say, `if the battery drops below 30 %`"
        if battery.relation not in (Relation.LESS, Relation.AT_MOST):
            message = "a reaction follows a battery that is low, not one that is charged"
            hint += ", or `wait until the battery is charged`"
        elif amount.unit != "%":
            unit = f"in {amount.unit}" if amount.unit else "without a unit"
            message = f"the battery's charge is a share of it, in %, not a number {unit}"
        elif not 0.0 < amount.value < 100.0:
            message = "no battery ever drops below this, or each is below it"
        if message:
            self.diagnostics.error("battery", message, battery.span, hint)
            return None
        return amount.value / 100.0

    def _order(self, order: ScriptOrder, doing: _Reacting) -> _Reacting | None:
        """What the reaction does with one order more; None if it can't."""
        if order.manner is not None:
            furnished = self._furnished(order, order.manner, doing)
            if furnished is None:
                return None
            doing = furnished
        match order:
            case Amend():
                return doing
            case Plain(word=PlainWord.REPORT):
                return replace(doing, reported=True)
            case Plain(word=PlainWord.PAUSE):
                return replace(doing, response=doing.response or Response.PAUSE)
            case Plain(word=PlainWord.RECHARGE):
                if doing.until not in (None, EventKind.BATTERY_CHARGED):
                    self._twice(order)
                    return None
                response = doing.response or Response.PAUSE
                return replace(doing, until=EventKind.BATTERY_CHARGED, response=response)
            case Plain(word=PlainWord.GO_ON):
                return self._afterwards(order, doing, Afterwards.RESUME)
            case Plain(word=PlainWord.ABORT) | Plain(word=PlainWord.END) if not doing.drives:
                ended = order.word is PlainWord.END
                aborts = self._responds(doing, Response.ABORT, order)
                return None if aborts is None else replace(aborts, ended=ended)
            case Plain(word=PlainWord.END):
                return self._afterwards(order, doing, Afterwards.END)
            case WaitOrder(where=where) if where is not None:
                there = self._goes(Go(span=order.span, where=where), doing)
                return None if there is None else self._waits(order, there)
            case WaitOrder():
                return self._waits(order, doing)
            case Home():
                return self._home(order, order.dock, doing)
            case Go():
                return self._goes(order, doing)
        message = "a reaction can't do this"
        hint = "it can report, pause, return, drive to a place, recharge, wait, resume or abort"
        self.diagnostics.error("reaction", message, order.span, hint)
        return None

    def _afterwards(
        self, order: ScriptOrder, doing: _Reacting, afterwards: Afterwards
    ) -> _Reacting | None:
        ended = doing.response is Response.ABORT
        if ended or doing.afterwards not in (None, afterwards):
            self._twice(order)
            return None
        return replace(doing, afterwards=afterwards)

    def _twice(self, order: ScriptOrder) -> None:
        message = "this is not what was said before of the same event"
        self.diagnostics.error("reaction", message, order.span, "leave one of the two out")

    def _held(self, doing: _Reacting, span: Span) -> _Reacting | None:
        """The reaction with what happens when the time for which it holds is over."""
        if doing.hold_limit is None:
            return doing
        message = hint = ""
        if doing.drives and doing.until is None:
            message = "after its drive a reaction holds until an event, not for a time"
            hint = "write, say, `return and wait until the all-clear for at most 10 minutes`"
        elif doing.on_limit is None and doing.until is not None and doing.afterwards is None:
            message = "this does not say what happens if the time is over before that event"
            hint = "add `or else go on`, `or else end the mission` or `or else wait`"
        if message:
            self.diagnostics.error("reaction", message, span, hint)
            return None
        on_limit = doing.on_limit or doing.afterwards or Afterwards.RESUME
        return replace(doing, on_limit=on_limit)

    def _furnished(self, order: ScriptOrder, manner: Manner, doing: _Reacting) -> _Reacting | None:
        """What is said of how long it holds, for what, and how urgent it is."""
        used = {"priority", "until", "duration", "time_limit", "on_limit"}
        used |= {"pose"} if isinstance(order, Home) else set()
        used |= {"person"} if isinstance(order, WaitOrder) else set()
        left = sorted(said(manner) - used)
        if left or order.name is not None:
            what = words_of(left) if left else "a name"
            message = f"of a reaction this can't be said: {what}"
            hint = "leave it out; how urgent it is, is said by a number: `with priority 90`"
            self.diagnostics.error("stray-clause", message, order.span, hint)
            return None
        if manner.time_limit is not None and manner.duration is not None:
            self._twice(order)
            return None
        limit = manner.time_limit if manner.time_limit is not None else manner.duration
        if limit is not None:
            doing = replace(doing, hold_limit=limit)
        if manner.on_limit is not None:
            doing = replace(doing, on_limit=manner.on_limit)
        if manner.priority is not None:
            doing = replace(doing, priority=manner.priority)
        if manner.until is not None:
            awaited = self._awaited(order)
            if awaited is None:
                return None
            if doing.until not in (None, awaited):
                self._twice(order)
                return None
            doing = replace(doing, until=awaited)
        return doing

    def _responds(
        self, doing: _Reacting, response: Response, order: ScriptOrder
    ) -> _Reacting | None:
        said = doing.afterwards is not None and response is Response.ABORT
        stops = doing.ended and response is Response.RETURN  # `stop the mission and go home`
        fits = doing.response in (None, Response.PAUSE, response) or stops
        if fits and not said:
            return replace(doing, response=response)
        message = "two things to do at once in this event"
        self.diagnostics.error("reaction", message, order.span, "leave one of them out")
        return None

    def _waits(self, order: WaitOrder, doing: _Reacting) -> _Reacting | None:
        if order.manner is not None and order.manner.person and doing.drives:
            return self._afterwards(order, doing, Afterwards.WAIT)
        if doing.until is not None or (order.manner and order.manner.until):
            return replace(doing, response=doing.response or Response.PAUSE)
        if doing.hold_limit is not None:
            return replace(doing, response=doing.response or Response.PAUSE)
        if doing.drives:
            return self._afterwards(order, doing, Afterwards.WAIT)
        return replace(doing, response=doing.response or Response.PAUSE)

    def _home(self, order: ScriptOrder, dock: DockLocation, doing: _Reacting) -> _Reacting | None:
        pose, number = None, None
        if dock.area is not None:
            area = self.locator.lookup.area(dock.area.area, dock.span)
            if area is None:
                return None
            pose, number = area.dock, area.number
        found = self._responds(doing, Response.RETURN, order)
        if order.manner is not None and order.manner.pose is not None:
            pose = self.locator.point(order.manner.pose)
        return None if found is None else replace(found, pose=pose, area=number)

    def _goes(self, order: Go, doing: _Reacting) -> _Reacting | None:
        if isinstance(order.where, FloorName):
            message = "a reaction drives to a place, not to a floor"
            self.diagnostics.error("reaction", message, order.span, "name a place of the site")
            return None
        pose, _ = self.locator.locate(order.where, "end")
        found = self._responds(doing, Response.SAFE_AREA, order)
        return None if found is None or pose is None else replace(found, pose=pose)

    def _awaited(self, order: ScriptOrder) -> EventKind | None:
        assert order.manner is not None
        assert order.manner.until is not None
        match order.manner.until.alternatives:
            case ((Occurs(event=event),),):
                return event
        message = "a reaction waits for one event"
        hint = "write, say, `until the all clear`"
        self.diagnostics.error("reaction", message, order.manner.until.span, hint)
        return None

    def _unfinished(self, case: Case) -> None:
        message = "this does not say what to do"
        hint = "add, say, `report it` or `pause`"
        self.diagnostics.error("unfinished", message, case.span, hint)
