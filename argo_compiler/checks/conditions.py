"""Checks of conditions: their fields, and whether they can be satisfied."""

from collections.abc import Iterator

from argo_compiler.base.records import dataclass
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Condition, ConditionType, Group, Task


@dataclass(frozen=True)
class ConditionChecks:
    """Checkpoints that conditions may refer to, and the checks of conditions."""

    measured: set[str | None]
    """those that tasks of the mission measure"""
    known: frozenset[str] | None
    """those of the site; None if the site is not known"""

    def diagnostics(
        self, item: CheckedItem, part: Task | Group, condition: Condition, field: str
    ) -> Iterator[Diagnostic]:
        """Yield the diagnostics of a condition of a task or group.

        `field` is the path from the task or group to the condition, such as `.until[0]`.
        """
        which = f"a {condition.type} condition of {_name(part)}"
        yield from _check_bounds(item, condition, field, which)
        if self.known is not None and condition.object_id not in self.known:
            yield item.diagnostic(
                "il.unknown-object",
                f"{_name(part)} names checkpoint '{condition.object_id}', which the site does not "
                "have",
                "use the number of a checkpoint in the site's catalogue",
                field + ".object_id",
            )
        elif condition.object_id not in self.measured:
            yield item.diagnostic(
                "il.never-measured",
                f"a condition of {_name(part)} depends on checkpoint '{condition.object_id}', "
                "which no task measures, so it never holds unless another source gives a value",
                f"measure checkpoint '{condition.object_id}' before",
                field + ".object_id",
            )


def _name(part: Task | Group) -> str:
    return f"{'task' if isinstance(part, Task) else 'group'} '{part.name}'"


def _check_bounds(
    item: CheckedItem, condition: Condition, field: str, which: str
) -> Iterator[Diagnostic]:
    if not condition.type.compares:
        yield from _check_state(item, condition, field, which)
        return
    low, high = condition.param1, condition.param2
    if low is None:
        yield item.diagnostic(
            "il.condition-bound",
            f"{which} has no param1",
            "set it to the bound that the value is compared with",
            field,
        )
    elif condition.type is not ConditionType.WITHIN:
        if high is not None:
            yield item.diagnostic(
                "il.unused-field",
                f"{which} has a param2, which has no effect",
                "only WITHIN has an upper bound as well: remove it",
                field + ".param2",
            )
    elif high is None:
        yield item.diagnostic(
            "il.within-bounds",
            f"{which} has no param2",
            "set it to the upper bound",
            field,
        )
    elif low > high or (low == high and not condition.inclusive):
        yield item.diagnostic(
            "il.within-bounds",
            f"{which} never holds: no value lies between {low:g} and {high:g}",
            "param1 is the lower bound, param2 the upper one",
            field,
        )


def _check_state(
    item: CheckedItem, condition: Condition, field: str, which: str
) -> Iterator[Diagnostic]:
    """Yield diagnostics of missing and unused fields of a condition that has no bounds.

    It tests the kind or the age of a reading. `which` names the condition in messages.
    """
    if condition.type is ConditionType.STALE and condition.max_age is None:
        yield item.diagnostic(
            "il.stale-without-age",
            f"{which} has no max_age",
            "set it to the age (s) from which on a value is stale",
            field,
        )
    unused = {
        "param1": condition.param1 is not None,
        "param2": condition.param2 is not None,
        "inclusive": condition.inclusive,
        "max_age": condition.max_age is not None
        and condition.type
        in (ConditionType.UNREADABLE, ConditionType.UNREACHABLE, ConditionType.FAILED),
    }
    for name in (name for name, is_unused in unused.items() if is_unused):
        yield item.diagnostic(
            "il.unused-field",
            f"{which} has a {name}, which has no effect",
            "remove it",
            f"{field}.{name}",
        )
