"""Charging in missions: to a level, for a time, cut short by limits and by people."""

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import Outcome, Resume
from argo_compiler.il import Action, Afterwards, EventKind, Group, Task, WaitRule
from argo_env.run.spec import RunConditions, logged_events
from tests.mission_writing import reaction as react
from tests.yard import measure, mission, simulated, waypoint

DOCK = Pose(x=1.05, y=1.05, z=0.02)
LOW, CHARGED = EventKind.LOW_BATTERY, EventKind.BATTERY_CHARGED
SMALL = RunConditions(charge=0.32, capacity=0.02)
"""a battery of 15 Wh, which is charged by 1 % in about a second"""
MEDIUM = RunConditions(charge=0.305, capacity=0.2)
"""a battery of 150 Wh, of which the way home takes less than 1 %"""


def charging(**fields):
    fields = {"until": CHARGED, "afterwards": Afterwards.RESUME, "battery_below": 0.3, **fields}
    return react(LOW, "return", **fields)


def rounds(count, reaction):
    """Return a mission that measures again and again, and charges when the battery is low."""
    group = Group(name="G", start="MEASURE 1", end="MEASURE 2", max_repeat_count=count)
    return mission(measure(1), measure(2), groups=(group,), reactions=(reaction,), dock=DOCK)


def charges_at(record, kind):
    """Return the battery's charge at each finding of this kind."""
    return [
        min(record.path, key=lambda sample: abs(sample.t - found.t)).charge
        for found in record.anomalies
        if found.kind is kind
    ]


@pytest.mark.physics
@pytest.mark.rule("R11")
@pytest.mark.parametrize(("limit", "count"), [(15.0, 4), (40.0, 10)])
def test_a_battery_whose_charging_a_limit_cuts_short_never_runs_empty(yard, limit, count):
    plan = rounds(count, charging(hold_limit=limit, on_limit=Afterwards.RESUME))
    record = simulated(plan, yard, conditions=MEDIUM)
    assert record.result.outcome is Outcome.COMPLETED
    assert len(charges_at(record, LOW)) > 1
    assert min(sample.charge for sample in record.path) > 0.25


@pytest.mark.physics
@pytest.mark.rule("R11")
def test_a_battery_whose_charging_people_cut_short_never_runs_empty(yard):
    events = logged_events(*((float(t), Resume()) for t in range(10, 1200, 30)))
    record = simulated(rounds(6, charging()), yard, conditions=MEDIUM, events=events)
    assert record.result.outcome is Outcome.COMPLETED
    assert len(charges_at(record, LOW)) > 1
    assert min(sample.charge for sample in record.path) > 0.25


@pytest.mark.physics
@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("fields", "low", "high"),
    [({"charge_to": 0.6}, 0.59, 0.65), ({}, 0.98, 1.0), ({"charge_for": 20.0}, 0.3, 0.6)],
)
def test_a_battery_is_charged_to_a_level_or_for_a_time(yard, fields, low, high):
    record = simulated(rounds(3, charging(**fields)), yard, conditions=SMALL)
    assert record.result.outcome is Outcome.COMPLETED
    charges = charges_at(record, CHARGED)
    assert charges
    assert all(low <= charge <= high for charge in charges)
    if "charge_for" in fields:
        (held, *_) = [wait.end - wait.start for wait in record.interruptions]
        assert held >= 20.0


@pytest.mark.physics
@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("rule", "charge", "least"),
    [
        (WaitRule(event=CHARGED, charge_to=0.6), 0.4, 0.59),
        (WaitRule(event=CHARGED, charge_to=0.6), 0.9, 0.8),
        (WaitRule(event=CHARGED), 1.0, 0.98),
    ],
)
def test_a_step_that_waits_for_a_charge_ends_at_once_with_it(yard, rule, charge, least):
    charge_there = Task(name="W", action=Action.WAIT, wait=rule)
    plan = mission(waypoint("D", 1.05, 1.05), charge_there)
    conditions = RunConditions(charge=charge, capacity=0.02)
    record = simulated(plan, yard, conditions=conditions)
    assert record.result.outcome is Outcome.COMPLETED
    assert record.path[-1].charge >= least
    assert charges_at(record, CHARGED)[-1] >= least
