"""From `if a gas leak is detected, ...` to a reaction of the mission."""

from typing import NamedTuple

from argo_compiler.diagnostics import Span
from argo_compiler.il import Afterwards, EventKind, Reaction, Response
from argo_compiler.script.resolve.answering import Answering
from argo_compiler.script.resolve.locating import Locator
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.conditions import (
    Asked,
    BatteryDrops,
    Occurs,
    Relation,
    SaidCondition,
)
from argo_compiler.script.syntax.tree.orders import Case


class _Trigger(NamedTuple):
    event: EventKind
    span: Span
    battery_below: float | None = None


class Reactions:
    """The reactions that a script asks for, at most one for each event."""

    def __init__(self, locator: Locator, diagnostics: Diagnostics) -> None:
        self.answering = Answering(locator, diagnostics)
        self.diagnostics = diagnostics
        self.found: list[Reaction] = []
        self.lines: dict[EventKind, Span] = {}

    def add(self, case: Case) -> None:
        """Adds the reaction that a case with events as its condition asks for."""
        assert case.condition is not None
        triggers = self._triggers(case.condition)
        answer = self.answering.answer(case)
        response = answer.response
        if response is None and answer.until is not None:
            response = Response.PAUSE
        elif response is None and answer.reported:
            response = Response.REPORT
        if response is None:
            hint = "add, say, `report it` or `pause`"
            self.diagnostics.refuse("unfinished", "this does not say what to do", case.span, hint)
        for event, span, level in triggers:
            before = self.lines.get(event)
            if before is not None:
                message = f"line {before.line} already says what to do in this event"
                hint = "leave one of the two out"
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
                    source=case.span,
                )
            )

    def _triggers(self, condition: SaidCondition) -> list[_Trigger]:
        if any(len(tests) > 1 for tests in condition.alternatives):
            message = "a reaction follows one event, not several at the same time"
            self.diagnostics.refuse("reaction", message, condition.span, "join them by `or`")
        return [self._trigger(test) for (test,) in condition.alternatives]

    def _trigger(self, test: Asked) -> _Trigger:
        if isinstance(test, BatteryDrops):
            return _Trigger(EventKind.LOW_BATTERY, test.span, self._level(test))
        if not isinstance(test, Occurs):
            message = "values and events can't be asked for in one condition"
            self.diagnostics.refuse("reaction", message, test.span, "write a sentence for each")
        if test.event is None:
            message = "an obstacle may be positive or negative: in the way, or a part missing"
            hint = "write `a positive obstacle` or `a negative obstacle`"
            self.diagnostics.refuse("ambiguous-event", message, test.span, hint)
        return _Trigger(test.event, test.span)

    def _level(self, battery: BatteryDrops) -> float:
        """The share of the charge below which the battery is to be called low."""
        amount = battery.level
        hint = "write, say, `if the battery drops below 30 %`"
        if battery.relation not in (Relation.LESS, Relation.AT_MOST):
            message = "a reaction follows a battery that is low, not one that is charged"
            hint += ", or `wait until the battery is charged`"
        elif amount.unit != "%":
            unit = f"in {amount.unit}" if amount.unit else "without a unit"
            message = f"the battery's charge is a share of it, in %, not a number {unit}"
        elif not 0.0 < amount.value < 100.0:
            message = "no battery ever drops below this, or each is below it"
        else:
            return amount.value / 100.0
        self.diagnostics.refuse("battery", message, battery.span, hint)
