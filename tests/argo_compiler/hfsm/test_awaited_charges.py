"""Charges of the battery for which a mission waits."""

import pytest

from argo_compiler.hfsm import (
    ActionStopped,
    ActionSucceeded,
    AwaitedCharge,
    Executor,
    Occurred,
    lower,
)
from argo_compiler.il import Afterwards, EventKind, Mission, Reaction, Response, WaitRule
from tests.mission_writing import drive, wait

CHARGED, LOW = EventKind.BATTERY_CHARGED, EventKind.LOW_BATTERY


def low_battery(**fields):
    return Reaction(
        event=LOW,
        response=Response.PAUSE,
        **{"until": CHARGED, "afterwards": Afterwards.RESUME, **fields},
    )


def holding(**fields):
    """Return an executor whose reaction to a low battery holds since 3 s."""
    mission = Mission(tasks=(drive("A"),), reactions=(low_battery(**fields),))
    executor = Executor(lower(mission))
    executor.start(0.0)
    executor.handle(Occurred(LOW), 3.0)
    executor.handle(ActionStopped("A"), 4.0)
    return executor


@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("fields", "awaited"),
    [
        ({}, AwaitedCharge(None, 3.0)),
        ({"charge_to": 0.6}, AwaitedCharge(0.6, 3.0)),
        ({"charge_for": 60}, AwaitedCharge(0.0, 63.0, while_charging=True)),
        ({"charge_to": 0.6, "charge_for": 60}, AwaitedCharge(0.6, 63.0, while_charging=True)),
    ],
)
def test_a_hold_waits_for_a_charge_until_it_is_over(fields, awaited):
    executor = holding(**fields)
    assert executor.awaited_charges == (awaited,)
    executor.handle(Occurred(CHARGED), 70.0)
    assert executor.awaited_charges == ()
    assert executor.reaction is None


@pytest.mark.rule("R12")
def test_a_hold_for_something_else_waits_for_no_charge():
    assert holding(until=EventKind.ALL_CLEAR).awaited_charges == ()


@pytest.mark.rule("R12")
def test_a_wait_and_a_hold_wait_for_both_charges():
    rule = WaitRule(event=CHARGED, charge_to=0.8)
    tasks = (drive("A", "W"), wait("W", wait=rule))
    executor = Executor(lower(Mission(tasks=tasks, reactions=(low_battery(charge_to=0.6),))))
    assert executor.awaited_charges == ()
    executor.start(0.0)
    executor.handle(ActionSucceeded("A"), 5.0)
    assert executor.awaited_charges == (AwaitedCharge(0.8, 5.0),)
    executor.handle(Occurred(LOW), 6.0)
    assert set(executor.awaited_charges) == {AwaitedCharge(0.8, 5.0), AwaitedCharge(0.6, 6.0)}


@pytest.mark.rule("R12")
def test_a_restored_hold_counts_its_time_from_its_beginning():
    executor = holding(charge_for=60)
    again = Executor.restore(executor.hfsm, executor.progress(), now=100.0, away=10.0)
    again.start(100.0)
    (awaited,) = again.awaited_charges
    assert awaited.not_before == pytest.approx(100.0 - 1.0 - 10.0 + 60.0)
