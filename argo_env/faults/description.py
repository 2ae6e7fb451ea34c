"""Description of the kinds of faults on a site, from which front ends make their forms."""

from collections.abc import Mapping, Sequence
from typing import Any

from argo_compiler.base.model import Model
from argo_env.faults.fault import Fault, TimedFault
from argo_env.faults.kinds import FAULTS
from argo_env.site import Site

_COMMON = ("kind", "seed")


class NumberLimits(Model):
    """NumberLimits of a number; those that are None do not exist."""

    least: float | None = None
    above: float | None = None
    """limit that the number must exceed"""
    most: float | None = None
    below: float | None = None
    """limit that the number must stay below"""


class FaultField(Model):
    """Field of a kind of fault, without `kind` and `seed`."""

    name: str
    unit: str | None = None
    """such as `m`; `1` for a share of a whole; None: it has none, or that of a checkpoint"""
    numbers: tuple[NumberLimits, ...] = ()
    """limits of its number, or of the numbers of a vector; empty for names and choices"""
    choices: tuple[str | int, ...] | None = None
    """all values that the kind or the site allows; None: there is no such list"""
    default: float | str | tuple[float, ...] | None = None
    """value if it is left out; None: the seed draws one, or None has a meaning of its own"""


class FaultDescription(Model):
    """Kind of fault with its fields."""

    kind: str
    timed: bool
    """whether it begins at a time (`at`), and may end (`until`); False: it is there from the start
    to the end"""
    needs_world: bool
    """whether it can be detected only with a drive that has a world"""
    fields: tuple[FaultField, ...]


def describe_faults(site: Site) -> tuple[FaultDescription, ...]:
    """Return all kinds of faults that can be used, with what the site allows."""
    return tuple(_describe(kind, FAULTS[kind], site) for kind in FAULTS)


def _describe(kind: str, model: type[Fault], site: Site) -> FaultDescription:
    schema = model.model_json_schema()
    choices, limits = model.choices_on(site), model.limits_on(site)
    fields = tuple(
        _field(name, _without_null(part, schema), choices.get(name), limits)
        for name, part in schema["properties"].items()
        if name not in _COMMON
    )
    return FaultDescription(
        kind=kind,
        timed=issubclass(model, TimedFault),
        needs_world=model.needs_world,
        fields=fields,
    )


def _without_null(part: Mapping[str, Any], schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON Schema of a field without references and the alternative `null`."""
    others = [one for one in part.get("anyOf", ()) if one.get("type") != "null"]
    found = {**part, **(others[0] if len(others) == 1 else {})}
    if "$ref" in found:
        found |= schema["$defs"][found["$ref"].rpartition("/")[2]]
    return found


def _field(
    name: str,
    part: Mapping[str, Any],
    choices: Sequence[str | int] | None,
    limits: Mapping[str, tuple[Sequence[float], Sequence[float]]],
) -> FaultField:
    numbers = part.get("prefixItems") or ([part] if part.get("type") in _NUMBERS else [])
    low, high = limits.get(name, ((), ()))
    default = part.get("default")
    return FaultField(
        name=name,
        unit=part.get("unit"),
        numbers=tuple(
            NumberLimits(
                least=low[k] if low else number.get("minimum"),
                above=number.get("exclusiveMinimum"),
                most=high[k] if high else number.get("maximum"),
                below=number.get("exclusiveMaximum"),
            )
            for k, number in enumerate(numbers)
        ),
        choices=part.get("enum") if choices is None else choices,
        default=tuple(default) if isinstance(default, list) else default,
    )


_NUMBERS = ("number", "integer")
