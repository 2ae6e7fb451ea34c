"""Whether the conditions of transitions can hold."""

from collections.abc import Iterator
from dataclasses import dataclass

from argo_compiler.checks.about import About
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Condition, ConditionType, Group, Task


@dataclass(frozen=True)
class ConditionChecks:
    """What is known of the checkpoints that a condition may look at."""

    measured: set[str | None]
    """by the mission's tasks"""
    known: frozenset[str] | None
    """on the site; None: not known"""

    def diagnostics(
        self, about: About, part: Task | Group, condition: Condition, field: str
    ) -> Iterator[Diagnostic]:
        """Yield the diagnostics of a condition of the part, in that field."""
        which = f"a {condition.type} condition of {_name(part)}"
        yield from _check_bounds(about, condition, field, which)
        if self.known is not None and condition.object_id not in self.known:
            yield about.diagnostic(
                "il.unknown-object",
                f"{_name(part)} names checkpoint '{condition.object_id}', which the site does not "
                "have",
                "use the number of a checkpoint in the site's catalogue",
                field + ".object_id",
            )
        elif condition.object_id not in self.measured:
            yield about.diagnostic(
                "il.never-measured",
                f"a condition of {_name(part)} looks at checkpoint '{condition.object_id}', which "
                "no task measures, so it never holds unless somebody else tells a value",
                f"measure checkpoint '{condition.object_id}' before",
                field + ".object_id",
            )


def _name(part: Task | Group) -> str:
    return f"{'task' if isinstance(part, Task) else 'group'} '{part.name}'"


def _check_bounds(
    about: About, condition: Condition, field: str, which: str
) -> Iterator[Diagnostic]:
    if not condition.type.compares:
        yield from _check_state(about, condition, field, which)
        return
    low, high = condition.param1, condition.param2
    if low is None:
        yield about.diagnostic(
            "il.condition-bound",
            f"{which} has no param1",
            "give it as the bound that the value is compared with",
            field,
        )
    elif condition.type is not ConditionType.WITHIN:
        if high is not None:
            yield about.diagnostic(
                "il.unused-field",
                f"{which} has a param2, which has no effect",
                "only WITHIN has an upper bound as well: remove it",
                field + ".param2",
            )
    elif high is None:
        yield about.diagnostic(
            "il.within-bounds",
            f"{which} has no param2",
            "give it as the upper bound",
            field,
        )
    elif low > high or (low == high and not condition.inclusive):
        yield about.diagnostic(
            "il.within-bounds",
            f"{which} never holds: no value lies between {low:g} and {high:g}",
            "param1 is the lower bound, param2 the upper one",
            field,
        )


def _check_state(
    about: About, condition: Condition, field: str, which: str
) -> Iterator[Diagnostic]:
    """What a condition that looks at the state of a reading has too much or too little of."""
    if condition.type is ConditionType.STALE and condition.max_age is None:
        yield about.diagnostic(
            "il.stale-without-age",
            f"{which} has no max_age",
            "say from which age on (s) a value is stale",
            field,
        )
    unused = {
        "param1": condition.param1 is not None,
        "param2": condition.param2 is not None,
        "inclusive": condition.inclusive,
        "max_age": condition.max_age is not None
        and condition.type in (ConditionType.UNREADABLE, ConditionType.FAILED),
    }
    for name in (name for name, given in unused.items() if given):
        yield about.diagnostic(
            "il.unused-field",
            f"{which} has a {name}, which has no effect",
            "remove it",
            f"{field}.{name}",
        )
