"""From the comparisons of a script to the conditions of the intermediate language."""

from collections.abc import Callable, Sequence
from itertools import product

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.il import Condition, ConditionType
from argo_compiler.script.syntax.commands import Comparison, Normality
from argo_compiler.script.syntax.source import Diagnostics

_UNITS = {"degree": "deg", "degrees": "deg", "°": "deg", "percent": "%", "bars": "bar"}

Find = Callable[[Comparison], CheckpointInfo | None]
"""the checkpoint that a comparison means; None if there is none, with an error"""


def resolve_alternatives(
    alternatives: Sequence[Sequence[Comparison]], find: Find, diagnostics: Diagnostics
) -> tuple[tuple[Condition, ...], ...]:
    """The conditions of each alternative; what is not normal becomes two of them."""
    found: list[tuple[Condition, ...]] = []
    for tests in alternatives:
        each = [_conditions(test, find, diagnostics) for test in tests]
        if sum(len(conditions) > 1 for conditions in each) > 4:
            message = "more than four `abnormal` joined by `and`"
            hint = "name the values, or divide the condition"
            diagnostics.error("condition", message, tests[0].span, hint)
            continue
        found += product(*each)
    return tuple(found)


def _conditions(test: Comparison, find: Find, diagnostics: Diagnostics) -> tuple[Condition, ...]:
    """The conditions of which one must hold."""
    checkpoint = find(test)
    if checkpoint is None:
        return ()
    for unit in test.units:
        if _plain(unit) != _plain(checkpoint.unit):
            message = f"{checkpoint.name} (#{checkpoint.id}) is measured in {checkpoint.unit}"
            hint = f"write the value in {checkpoint.unit}, not in {unit}"
            diagnostics.error("unit", message, test.span, hint)
    nominal = checkpoint.nominal
    bounds: list[tuple[ConditionType, float, float | None, bool]]
    if test.test is Normality.NORMAL:
        bounds = [(ConditionType.WITHIN, nominal.low, nominal.high, True)]
    elif test.test is Normality.ABNORMAL:
        bounds = [
            (ConditionType.LESS, nominal.low, None, False),
            (ConditionType.GREATER, nominal.high, None, False),
        ]
    else:
        bounds = [(ConditionType(test.test), test.param1, test.param2, test.inclusive)]
        high = test.param2
        empty = high is not None and (
            test.param1 > high or (test.param1 == high and not test.inclusive)
        )
        if test.test is ConditionType.WITHIN and empty:
            message = "no value lies between these"
            hint = "write the lower one first"
            diagnostics.error("condition", message, test.span, hint)
    return tuple(
        Condition(
            type=kind,
            id=test.id,
            object_id=str(checkpoint.id),
            param1=param1,
            param2=param2,
            inclusive=inclusive,
            max_age=test.max_age,
        )
        for kind, param1, param2, inclusive in bounds
    )


def _plain(unit: str) -> str:
    unit = unit.lower()
    return _UNITS.get(unit, unit)
