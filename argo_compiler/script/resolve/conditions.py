"""From the conditions of a script to those of the intermediate language."""

from collections.abc import Sequence
from itertools import product

from argo_compiler.base.catalog import CheckpointInfo, CheckpointKind
from argo_compiler.il import Condition, ConditionType
from argo_compiler.il.exclusive_conditions import are_contradictory, are_surely_exhaustive
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.resolve.lookup import told
from argo_compiler.script.resolve.nouns import NounResolver
from argo_compiler.script.resolve.program import Alternatives
from argo_compiler.script.resolve.units import ABSOLUTE, converted
from argo_compiler.script.sentences.tree.conditions import (
    Amount,
    Asked,
    Bounded,
    InState,
    SaidCondition,
    TaskState,
    Test,
    ValvePosition,
)
from argo_compiler.script.sentences.tree.nouns import AllOf, Labelled, Nouns, Pronoun

_MOST = 64
"""alternatives of one condition"""
_Bound = tuple[ConditionType, float | None, float | None, bool]
"""the type of a condition, its bounds, and whether a value may be at them"""
POSITIONS_DEG: dict[ValvePosition, tuple[float | None, float | None]] = {
    ValvePosition.OPEN: (80.0, None),
    ValvePosition.HALF_OPEN: (35.0, 55.0),
    ValvePosition.CLOSED: (None, 10.0),
}
"""bounds of the positions of valves, in degrees: 90 is open and 0 is closed, 10 are tolerated"""
_STATES = {
    TaskState.ABNORMAL: ConditionType.ABNORMAL,
    TaskState.UNREADABLE: ConditionType.UNREADABLE,
    TaskState.UNREACHABLE: ConditionType.UNREACHABLE,
    TaskState.FAILED: ConditionType.FAILED,
    TaskState.STALE: ConditionType.STALE,
}


class ConditionResolver:
    """Looks up what conditions ask for. Raises RefusedError where it is not clear what."""

    def __init__(self, nouns: NounResolver, diagnostics: Diagnostics) -> None:
        self.nouns = nouns
        self.diagnostics = diagnostics

    def alternatives(self, condition: SaidCondition) -> Alternatives:
        """The conditions of each alternative."""
        found: list[tuple[Condition, ...]] = []
        for tests in condition.alternatives:
            each = [self._test(test) for test in tests]
            combined = [sum(parts, ()) for parts in product(*each)]
            combined = [held for held in combined if not are_contradictory(held)]
            if not combined:
                said = self.diagnostics.source.said(tests[0].span, tests[-1].span)
                span, hint = tests[-1].span, "is `or` meant?"
                self.diagnostics.refuse("condition", f"no value satisfies `{said}`", span, hint)
            found += combined
            if len(found) > _MOST:
                message = f"this condition has more than {_MOST} alternatives"
                hint = "divide it into several sentences"
                self.diagnostics.refuse("condition", message, condition.span, hint)
        if are_surely_exhaustive(tuple(found)):
            said = self.diagnostics.source.said(condition.span)
            message = f"every value satisfies `{said}`"
            hint = "is `and` meant, or another bound?"
            self.diagnostics.warning("always-holds", message, condition.span, hint)
        return tuple(found)

    def _test(self, test: Asked) -> list[tuple[Condition, ...]]:
        """Alternatives for one test; of several checkpoints all, or one with `or`."""
        if not isinstance(test, Test):
            message = "one condition can't contain both values and events"
            self.diagnostics.refuse("condition", message, test.span, "write a sentence for each")
        checkpoints = self._subjects(test)
        self._require_value(test, checkpoints)
        for checkpoint in checkpoints:
            self._note_unmeasured(checkpoint, test)
        ways = self.diagnostics.each(lambda one: self._of(test, one), checkpoints)
        if test.subject is not None and test.subject.either:
            return [one for way in ways for one in way]
        return [sum(parts, ()) for parts in product(*ways)]

    def _require_value(self, test: Test, checkpoints: Sequence[CheckpointInfo]) -> None:
        """Asks about `if 1 is above 8`, where 8 may be a value or what checkpoint 8 shows."""
        nouns = test.subject.nouns if test.subject is not None else ()
        bare = all(isinstance(n, Labelled) and n.kind is None and not n.hash for n in nouns)
        bounds = test.predicate.bounds if isinstance(test.predicate, Bounded) else ()
        if not nouns or not bare or len(bounds) != 1:
            return
        (bound,) = bounds
        measured = self.nouns.memory.so_far.values()
        other = next((c for c in measured if c.id == bound.value), None)
        if other is None or bound.unit or other in checkpoints:
            return
        if all(checkpoint.unit == other.unit for checkpoint in checkpoints):
            message = f"`{other.id}` can be {other.id} {other.unit}, or the value of {told(other)}"
            hint = f"write `{other.id} {other.unit}`; two checkpoints can't be compared"
            self.diagnostics.refuse("ambiguous-number", message, bound.span, hint)

    def _note_unmeasured(self, checkpoint: CheckpointInfo, test: Test) -> None:
        if checkpoint.id in self.nouns.memory.so_far or not self.nouns.memory.known:
            return
        message = f"checkpoint {checkpoint.id} ({checkpoint.name}) is not measured before this"
        hint = f"write `Check checkpoint {checkpoint.id}` before it"
        self.diagnostics.warning("not-measured", message, test.span, hint)

    def _subjects(self, test: Test) -> Sequence[CheckpointInfo]:
        """Which checkpoints are asked for; `it` is the only one whose unit is that of the value."""
        if test.subject is not None and test.subject.but:
            message = "the excepted checkpoint can have any value, or must not satisfy the "
            message += "condition"
            hint = "if any value is allowed, remove the exception; otherwise write "
            hint += "`if #1 is above 5 and #4 is at most 5`"
            if not any(isinstance(noun, AllOf) for noun in test.subject.nouns):
                self.diagnostics.refuse("condition", message, test.subject.span, hint)
        match test.subject:
            case None | Nouns(nouns=(Pronoun(every=False),)):
                measured = self.nouns.memory.last
                fitting = [c for c in measured if _fits(test, c)]
                if len(fitting) == 1 < len(measured):
                    return fitting
        return self.nouns.last(test.span) if test.subject is None else self.nouns.each(test.subject)

    def _of(self, test: Test, checkpoint: CheckpointInfo) -> list[tuple[Condition, ...]]:
        """Alternatives for one checkpoint."""
        found: list[tuple[Condition, ...]] = []
        for kind, low, high, inclusive in self._bounds(test, checkpoint):
            condition = Condition(
                type=kind,
                id=test.id,
                object_id=str(checkpoint.id),
                param1=low,
                param2=test.second_bound if high is None else high,
                inclusive=inclusive,
                max_age=test.max_age,
            )
            found.append((condition,))
        return found

    def _bounds(self, test: Test, checkpoint: CheckpointInfo) -> list[_Bound]:
        predicate = test.predicate
        if isinstance(predicate, Bounded):
            return self._between(predicate, test, checkpoint)
        if isinstance(predicate.state, ValvePosition):
            return self._position(predicate.state, test, checkpoint)
        return [self._state(predicate.state, test, checkpoint)]

    def _state(self, state: TaskState, test: Test, checkpoint: CheckpointInfo) -> _Bound:
        if test.negated and state in (TaskState.NORMAL, TaskState.ABNORMAL):
            state = TaskState.ABNORMAL if state is TaskState.NORMAL else TaskState.NORMAL
        elif test.negated:
            message = f"`not {state}` is not a possible condition"
            hint = "write it the other way round: `if ..., go on; otherwise ...`"
            self.diagnostics.refuse("condition", message, test.predicate.span, hint)
        if state is TaskState.NORMAL:
            return ConditionType.WITHIN, checkpoint.nominal.low, checkpoint.nominal.high, True
        return _STATES[state], None, None, False

    def _position(
        self, position: ValvePosition, test: Test, checkpoint: CheckpointInfo
    ) -> list[_Bound]:
        """Return the bounds of a position, in degrees, or those of all other positions."""
        if checkpoint.kind is not CheckpointKind.VALVE:
            message = f"{told(checkpoint)} is no valve, and can't be open or closed"
            hint = f"write a value in {checkpoint.unit}, or name a valve"
            self.diagnostics.refuse("condition", message, test.span, hint)
        return _bounds(*POSITIONS_DEG[position], True, test.negated)

    def _between(self, predicate: Bounded, test: Test, checkpoint: CheckpointInfo) -> list[_Bound]:
        each = self.diagnostics.each
        values = each(lambda one: self._bound(one, checkpoint), predicate.bounds)
        empty = not predicate.inclusive and len(values) > len({*values})
        if empty or values != sorted(values):
            message, hint = "no value is between these bounds", "write the lower bound first"
            self.diagnostics.refuse("condition", message, test.span, hint)
        low = None if predicate.low is None else values[0]
        high = None if predicate.high is None else values[-1]
        return _bounds(low, high, predicate.inclusive, test.negated)

    def _bound(self, amount: Amount, checkpoint: CheckpointInfo) -> float:
        """The amount in the checkpoint's unit."""
        value = _in_unit_of(checkpoint, amount)
        if value is None and amount.unit.endswith(ABSOLUTE):
            text = self.diagnostics.source.said(amount.span)
            message = f"{told(checkpoint)} shows gauge pressure, and `{text}` is absolute"
            hint = f"write the gauge pressure in {checkpoint.unit}: about 1 bar less"
            self.diagnostics.refuse("unit", message, amount.span, hint)
        if value is None:
            message = f"{told(checkpoint)} is measured in {checkpoint.unit}"
            hint = f"write the value in {checkpoint.unit}, not in {amount.unit}"
            self.diagnostics.refuse("unit", message, amount.span, hint)
        return value


def _bounds(low: float | None, high: float | None, inclusive: bool, negated: bool) -> list[_Bound]:
    """Return what holds of a value within bounds, or of one outside of them."""
    if low is not None and high is not None and not negated:
        return [(ConditionType.WITHIN, low, high, inclusive)]
    below, above = (low, high) if negated else (high, low)
    found = ((ConditionType.LESS, below), (ConditionType.GREATER, above))
    held = inclusive is not negated
    return [(kind, bound, None, held) for kind, bound in found if bound is not None]


def _in_unit_of(checkpoint: CheckpointInfo, amount: Amount) -> float | None:
    """The amount in the checkpoint's unit; None if it has a unit that does not fit."""
    return converted(amount.value, amount.unit or checkpoint.unit, checkpoint.unit)


def _fits(test: Test, checkpoint: CheckpointInfo) -> bool:
    """Whether the units that are said are those of values that a checkpoint has."""
    match test.predicate:
        case Bounded(bounds=bounds):
            return all(_in_unit_of(checkpoint, amount) is not None for amount in bounds)
        case InState(state=ValvePosition()):
            return checkpoint.kind is CheckpointKind.VALVE
    return True
