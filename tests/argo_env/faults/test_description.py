"""Descriptions of the kinds of faults agree with what the kinds accept."""

import pytest
from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError
from argo_env.faults.description import FaultDescription, FaultField, NumberLimits, describe_faults
from argo_env.faults.kinds import KINDS, resolve_fault
from argo_env.planning.opening import open_site

STEP = 1e-3


@pytest.fixture(scope="module")
def described() -> dict[str, FaultDescription]:
    return {one.kind: one for one in describe_faults(open_site("umad").site)}


def test_all_kinds_and_fields_are_described(described: dict[str, FaultDescription]) -> None:
    assert described.keys() >= KINDS.keys()
    for kind, model in KINDS.items():
        names = {field.name for field in described[kind].fields}
        assert names == model.model_fields.keys() - {"kind", "seed"}
        assert described[kind].timed == ("at" in names)


def inside_and_outside(limits: NumberLimits) -> tuple[float, list[float]]:
    """Return a number within the limits, and numbers beyond them."""
    low = limits.least if limits.above is None else limits.above
    high = limits.most if limits.below is None else limits.below
    outside = [] if low is None else [low - STEP if limits.above is None else low]
    outside += [] if high is None else [high + STEP if limits.below is None else high]
    inside = (0.0 if low is None else low + STEP) if high is None else high - STEP
    return inside, outside


@pytest.mark.parametrize("kind", KINDS)
def test_limits_are_those_that_the_kind_accepts(
    described: dict[str, FaultDescription], kind: str
) -> None:
    site = open_site("umad").site

    def is_accepted(field: FaultField, numbers: list[float]) -> bool:
        value = numbers[0] if len(numbers) == 1 else numbers
        try:
            resolve_fault(KINDS[kind].model_validate({field.name: value}), 0, site, 0)
        except (ValidationError, ArgoError):
            return False
        return True

    for field in described[kind].fields:
        if field.choices is not None or field.name in ("rect", "value"):
            continue  # their limits depend on other fields
        pairs = [inside_and_outside(limits) for limits in field.numbers]
        inside = [0.0 if field.name == "offset" else value for value, _ in pairs]
        for k, (_, outside) in enumerate(pairs):
            for value in outside:
                assert not is_accepted(field, [*inside[:k], value, *inside[k + 1 :]])
        if kind != "brick" or field.name != "place":  # there must be a walkway
            assert is_accepted(field, inside)


def test_choices_are_those_of_the_site(described: dict[str, FaultDescription]) -> None:
    site = open_site("umad").site
    for kind, model in KINDS.items():
        for field in described[kind].fields:
            for choice in field.choices or ():
                resolve_fault(model.model_validate({field.name: choice}), 0, site, 0)


def test_numbers_have_units(described: dict[str, FaultDescription]) -> None:
    without = {
        (one.kind, field.name)
        for one in described.values()
        for field in one.fields
        if field.numbers and field.choices is None and field.unit is None
    }
    assert without == {("abnormal_value", "value")}, "this one has the unit of its checkpoint"
    rate = next(field for field in described["gas_leak"].fields if field.name == "rate")
    assert (rate.unit, rate.numbers) == ("kg/s", (NumberLimits(above=0.0, most=1.0),))
