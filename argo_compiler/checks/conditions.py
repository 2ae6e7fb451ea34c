"""Checks of conditions: their fields, and whether they can be satisfied."""

from collections.abc import Iterator
from dataclasses import dataclass

from argo_compiler.base.message import Message, identifier
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
        which = Message("a {type} condition of {part}", type=condition.type, part=_name(part))
        yield from _check_bounds(item, condition, field, which)
        if self.known is not None and condition.object_id not in self.known:
            yield item.diagnostic(
                "il.unknown-object",
                Message(
                    "{part} names checkpoint '{object_id}', which the site does not have",
                    part=_name(part),
                    object_id=condition.object_id,
                ),
                "use the number of a checkpoint in the site's catalogue",
                field + ".object_id",
            )
        elif condition.object_id not in self.measured:
            yield item.diagnostic(
                "il.never-measured",
                Message(
                    "a condition of {part} depends on checkpoint '{object_id}', which no task "
                    "measures, so it never holds unless another source gives a value",
                    part=_name(part),
                    object_id=condition.object_id,
                ),
                Message("measure checkpoint '{object_id}' before", object_id=condition.object_id),
                field + ".object_id",
            )


def _name(part: Task | Group) -> Message:
    if isinstance(part, Task):
        return Message("task '{task}'", task=part.name)
    return Message("group '{group}'", group=part.name)


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
            Message("{which} has no param1", which=which),
            "set it to the bound that the value is compared with",
            field,
        )
    elif condition.type is not ConditionType.WITHIN:
        if high is not None:
            yield item.diagnostic(
                "il.unused-field",
                Message("{which} has a param2, which has no effect", which=which),
                "only WITHIN has an upper bound as well: remove it",
                field + ".param2",
            )
    elif high is None:
        yield item.diagnostic(
            "il.within-bounds",
            Message("{which} has no param2", which=which),
            "set it to the upper bound",
            field,
        )
    elif low > high or (low == high and not condition.inclusive):
        yield item.diagnostic(
            "il.within-bounds",
            Message(
                "{which} never holds: no value lies between {low:g} and {high:g}",
                which=which,
                low=low,
                high=high,
            ),
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
            Message("{which} has no max_age", which=which),
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
            Message(
                "{which} has a {name}, which has no effect", which=which, name=identifier(name)
            ),
            "remove it",
            f"{field}.{name}",
        )
