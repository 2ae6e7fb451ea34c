"""From the conditions of a script to those of the intermediate language."""

from collections.abc import Sequence
from itertools import product

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.il import Condition, ConditionType
from argo_compiler.script.resolve import units
from argo_compiler.script.resolve.nouns import NounResolver
from argo_compiler.script.resolve.program import Alternatives
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree import conditions as said
from argo_compiler.script.syntax.tree.conditions import (
    Amount,
    Asked,
    Between,
    Compared,
    InState,
    Relation,
    TaskState,
    Test,
)
from argo_compiler.script.syntax.tree.nouns import Pronoun

_MOST = 64
"""alternatives of one condition"""
_OPPOSITE = {
    Relation.GREATER: Relation.AT_MOST,
    Relation.LESS: Relation.AT_LEAST,
    Relation.AT_LEAST: Relation.LESS,
    Relation.AT_MOST: Relation.GREATER,
}
_STATES = {
    TaskState.ABNORMAL: ConditionType.ABNORMAL,
    TaskState.UNREADABLE: ConditionType.UNREADABLE,
    TaskState.FAILED: ConditionType.FAILED,
    TaskState.STALE: ConditionType.STALE,
}


class ConditionResolver:
    """Looks up what conditions ask for."""

    def __init__(self, nouns: NounResolver, diagnostics: Diagnostics) -> None:
        self.nouns = nouns
        self.diagnostics = diagnostics

    def alternatives(self, condition: said.SaidCondition) -> Alternatives | None:
        """The conditions of each alternative; None if it is not clear what they are."""
        found: list[tuple[Condition, ...]] = []
        for tests in condition.alternatives:
            each: list[list[tuple[Condition, ...]]] = []
            for test in tests:
                if not isinstance(test, Test):
                    message = "values and events can't be asked for in one condition"
                    hint = "write a sentence for each"
                    self.diagnostics.error("condition", message, test.span, hint)
                    return None
                ways = self._test(test)
                if ways is None:
                    return None
                each.append(ways)
            combined = [sum(parts, ()) for parts in product(*each)]
            if all(self._empty(conditions, tests) for conditions in combined):
                return None
            found += combined
            if len(found) > _MOST:
                message = f"this condition has more than {_MOST} alternatives"
                hint = "divide it into several sentences"
                self.diagnostics.error("condition", message, condition.span, hint)
                return None
        return tuple(found)

    def _empty(self, conditions: tuple[Condition, ...], tests: Sequence[Asked]) -> bool:
        """Whether no value satisfies all the bounds for one checkpoint: then an error says so."""
        if not contradict(conditions):
            return False
        said = self.nouns.said(tests[0].span, tests[-1].span)
        message = f"no value is `{said}`"
        self.diagnostics.error("condition", message, tests[-1].span, "is `or` meant?")
        return True

    def _test(self, test: Test) -> list[tuple[Condition, ...]] | None:
        """Alternatives for one test; of several checkpoints all, or one with `or`."""
        checkpoints = self._subjects(test)
        if checkpoints is None:
            return None
        for checkpoint in checkpoints:
            self._note_unmeasured(checkpoint, test)
        each = [self._of(test, checkpoint) for checkpoint in checkpoints]
        ways = [way for way in each if way is not None]
        if len(ways) < len(each):
            return None
        if test.subject is not None and test.subject.either:
            return [one for way in ways for one in way]
        return [sum(parts, ()) for parts in product(*ways)]

    def _note_unmeasured(self, checkpoint: CheckpointInfo, test: Test) -> None:
        if checkpoint.id in self.nouns.memory.measured_ids or not self.nouns.memory.known:
            return
        message = f"checkpoint {checkpoint.id} ({checkpoint.name}) is not measured before this"
        hint = f"write `Check checkpoint {checkpoint.id}` before it"
        self.diagnostics.warning("not-measured", message, test.span, hint)

    def _subjects(self, test: Test) -> Sequence[CheckpointInfo] | None:
        subject = test.subject
        it = subject is None or (
            len(subject.nouns) == 1
            and isinstance(subject.nouns[0], Pronoun)
            and not subject.nouns[0].every
        )
        if subject is not None and not it:
            return self.nouns.each(subject)
        measured = self.nouns.memory.last
        fitting = [c for c in measured if self._fits(test, c)]
        if len(fitting) == 1 < len(measured):
            return fitting
        return self.nouns.last(test.span) if subject is None else self.nouns.each(subject)

    def _fits(self, test: Test, checkpoint: CheckpointInfo) -> bool:
        """Whether the units that are said are those of values that a checkpoint has."""
        match test.predicate:
            case Compared(bound=bound):
                amounts = [bound]
            case Between(low=low, high=high):
                amounts = [low, high]
            case _:
                return True
        return all(
            not amount.unit
            or units.converted(amount.value, amount.unit, checkpoint.unit) is not None
            for amount in amounts
        )

    def _of(self, test: Test, checkpoint: CheckpointInfo) -> list[tuple[Condition, ...]] | None:
        """Alternatives for one checkpoint."""
        predicate = test.predicate
        if isinstance(predicate, InState):
            bounds = self._state(predicate, test.negated, checkpoint)
        elif isinstance(predicate, Between):
            bounds = self._between(predicate, test, checkpoint)
        else:
            bounds = self._compared(predicate, test, checkpoint)
        if bounds is None:
            return None
        return [
            (
                Condition(
                    type=kind,
                    id=test.id,
                    object_id=str(checkpoint.id),
                    param1=low,
                    param2=test.second_bound if high is None else high,
                    inclusive=inclusive,
                    max_age=test.max_age,
                ),
            )
            for kind, low, high, inclusive in bounds
        ]

    def _state(
        self, predicate: InState, negated: bool, checkpoint: CheckpointInfo
    ) -> "list[_Bound] | None":
        state = predicate.state
        if negated and state in (TaskState.NORMAL, TaskState.ABNORMAL):
            state = TaskState.ABNORMAL if state is TaskState.NORMAL else TaskState.NORMAL
        elif negated:
            message = f"`not {state}` can't be asked for"
            hint = "turn it round: `if ..., go on; otherwise ...`"
            self.diagnostics.error("condition", message, predicate.span, hint)
            return None
        if state is TaskState.NORMAL:
            nominal = checkpoint.nominal
            return [(ConditionType.WITHIN, nominal.low, nominal.high, True)]
        return [(_STATES[state], None, None, False)]

    def _compared(
        self, predicate: Compared, test: Test, checkpoint: CheckpointInfo
    ) -> "list[_Bound] | None":
        bound = self._bound(predicate.bound, checkpoint)
        if bound is None:
            return None
        relation = _OPPOSITE[predicate.relation] if test.negated else predicate.relation
        greater = relation in (Relation.GREATER, Relation.AT_LEAST)
        inclusive = relation in (Relation.AT_LEAST, Relation.AT_MOST)
        kind = ConditionType.GREATER if greater else ConditionType.LESS
        return [(kind, bound, None, inclusive)]

    def _between(
        self, predicate: Between, test: Test, checkpoint: CheckpointInfo
    ) -> "list[_Bound] | None":
        low, high = (self._bound(b, checkpoint) for b in (predicate.low, predicate.high))
        if low is None or high is None:
            return None
        if low > high or (low == high and not predicate.inclusive):
            message = "no value lies between these"
            self.diagnostics.error("condition", message, test.span, "write the lower one first")
            return None
        if test.negated:
            inclusive = not predicate.inclusive
            return [
                (ConditionType.LESS, low, None, inclusive),
                (ConditionType.GREATER, high, None, inclusive),
            ]
        return [(ConditionType.WITHIN, low, high, predicate.inclusive)]

    def _bound(self, amount: Amount, checkpoint: CheckpointInfo) -> float | None:
        """The amount in the checkpoint's unit."""
        if not amount.unit:
            return amount.value
        value = units.converted(amount.value, amount.unit, checkpoint.unit)
        if value is None:
            message = f"{checkpoint.name} (#{checkpoint.id}) is measured in {checkpoint.unit}"
            hint = f"write the value in {checkpoint.unit}, not in {amount.unit}"
            self.diagnostics.error("unit", message, amount.span, hint)
        return value


def contradict(conditions: Sequence[Condition]) -> bool:
    """Whether no value satisfies all the bounds for one of the checkpoints."""
    for condition in conditions:
        others = [c for c in conditions if c.object_id == condition.object_id]
        low = [c for c in others if c.type in (ConditionType.GREATER, ConditionType.WITHIN)]
        high = [c for c in others if c.type is ConditionType.LESS]
        for one, other in product(low, high):
            a, b = one.param1, other.param1
            both = one.inclusive and other.inclusive
            if a is not None and b is not None and (a > b or (a == b and not both)):
                return True
    return False


_Bound = tuple[ConditionType, float | None, float | None, bool]
