"""What a mission does in an event, put together from the orders for it."""

from dataclasses import dataclass, replace
from typing import NoReturn

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Span
from argo_compiler.il import Afterwards, EventKind, Response
from argo_compiler.script.resolve.accepting import said, words_of
from argo_compiler.script.resolve.locating import Locator
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.conditions import Occurs, SaidCondition
from argo_compiler.script.syntax.tree.manner import Manner
from argo_compiler.script.syntax.tree.orders import Case, PlainWord, ScriptOrder
from argo_compiler.script.syntax.tree.places import FloorName

_USED = frozenset({"priority", "until", "duration", "time_limit", "on_limit"})


@dataclass(frozen=True, slots=True)
class Answer:
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

    @property
    def drives(self) -> bool:
        return self.response in (Response.RETURN, Response.SAFE_AREA)

    @property
    def pausing(self) -> "Answer":
        """The answer with a pause if nothing else is done."""
        return replace(self, response=self.response or Response.PAUSE)


class Answering:
    """Puts answers together. Raises RefusedError where orders are none of an answer."""

    def __init__(self, locator: Locator, diagnostics: Diagnostics) -> None:
        self.locator = locator
        self.diagnostics = diagnostics

    def answer(self, case: Case) -> Answer:
        """What is done in a case with events as its condition."""
        answer = Answer()
        for order in case.orders:
            answer = self._with(order, self._furnished(order, answer))
        return self._held(answer, case.span)

    def _with(self, order: ScriptOrder, answer: Answer) -> Answer:
        """The answer with one order more."""
        match order:
            case orders.Amend():
                return answer
            case orders.Plain(word=PlainWord.REPORT):
                return replace(answer, reported=True)
            case orders.Plain(word=PlainWord.PAUSE):
                return answer.pausing
            case orders.Plain(word=PlainWord.RECHARGE):
                return self._until(EventKind.BATTERY_CHARGED, answer, order.span).pausing
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

    def _furnished(self, order: ScriptOrder, answer: Answer) -> Answer:
        """What is said of how long it holds, for what, and how urgent it is."""
        manner = order.manner or Manner()
        own = {orders.Home: {"pose"}, orders.WaitOrder: {"person"}}.get(type(order), set())
        left = sorted(said(manner) - _USED - own)
        if left or order.name is not None:
            message = f"of a reaction this can't be said: {words_of(left) if left else 'a name'}"
            hint = "leave it out; how urgent it is, is said by a number: `with priority 90`"
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
        if manner.until is None:
            return answer
        return self._until(self._awaited(manner.until), answer, order.span)

    def _awaited(self, condition: SaidCondition) -> EventKind:
        match condition.alternatives:
            case ((Occurs(event=EventKind() as event),),):
                return event
        hint = "write, say, `until the all clear`"
        self.diagnostics.refuse("reaction", "a reaction waits for one event", condition.span, hint)

    def _until(self, event: EventKind, answer: Answer, span: Span) -> Answer:
        if answer.until not in (None, event):
            self._twice(span)
        return replace(answer, until=event)

    def _responds(self, answer: Answer, response: Response, order: ScriptOrder) -> Answer:
        goes_on = answer.afterwards is not None and response is Response.ABORT
        stops = answer.ended and response is Response.RETURN  # `stop the mission and go home`
        if goes_on or not (stops or answer.response in (None, Response.PAUSE, response)):
            message = "two things to do at once in this event"
            self.diagnostics.refuse("reaction", message, order.span, "leave one of them out")
        return replace(answer, response=response)

    def _afterwards(self, order: ScriptOrder, answer: Answer, afterwards: Afterwards) -> Answer:
        if answer.response is Response.ABORT or answer.afterwards not in (None, afterwards):
            self._twice(order.span)
        return replace(answer, afterwards=afterwards)

    def _waits(self, order: orders.WaitOrder, answer: Answer) -> Answer:
        person = order.manner is not None and order.manner.person
        held = answer.until is not None or answer.hold_limit is not None
        if order.stays and answer.response is Response.RETURN and not (person or held):
            return self._afterwards(order, answer, Afterwards.END)  # it stays in its dock
        if answer.drives and (person or not held):
            return self._afterwards(order, answer, Afterwards.WAIT)
        return answer.pausing

    def _home(self, order: orders.Home, answer: Answer) -> Answer:
        pose, number = None, None
        if order.dock.area is not None:
            area = self.locator.lookup.area(order.dock.area.area, order.dock.span)
            pose, number = area.dock, area.number
        answer = self._responds(answer, Response.RETURN, order)
        if order.manner is not None and order.manner.pose is not None:
            pose = self.locator.point(order.manner.pose)
        return replace(answer, pose=pose, area=number)

    def _goes(self, order: orders.Go, answer: Answer) -> Answer:
        if isinstance(order.where, FloorName):
            message = "a reaction drives to a place, not to a floor"
            self.diagnostics.refuse("reaction", message, order.span, "name a place of the site")
        pose, _ = self.locator.locate(order.where, "end")
        return replace(self._responds(answer, Response.SAFE_AREA, order), pose=pose)

    def _held(self, answer: Answer, span: Span) -> Answer:
        """The answer with what happens when the time for which it holds is over."""
        if answer.hold_limit is None:
            return answer
        if answer.drives and answer.until is None:
            message = "after its drive a reaction holds until an event, not for a time"
            hint = "write, say, `return and wait until the all-clear for at most 10 minutes`"
            self.diagnostics.refuse("reaction", message, span, hint)
        on_limit = answer.on_limit or answer.afterwards
        if on_limit is None and answer.until is not None:
            message = "this does not say what happens if the time is over before that event"
            hint = "add `or else go on`, `or else end the mission` or `or else wait`"
            self.diagnostics.refuse("reaction", message, span, hint)
        return replace(answer, on_limit=on_limit or Afterwards.RESUME)

    def _twice(self, span: Span) -> NoReturn:
        message = "this is not what was said before of the same event"
        self.diagnostics.refuse("reaction", message, span, "leave one of the two out")
