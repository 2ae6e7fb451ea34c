"""Tests that a format exports each field, refuses it by name, or is known to leave it out."""

import pytest

from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, Span, has_errors
from argo_compiler.export import EXPORTERS, ExportInput
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from argo_compiler.ros import ros2_types, to_message
from tests.mission_writing import drive, measure, wait, way

HERE, THERE = Pose(x=0, y=0, z=0), Pose(x=1, y=2, z=3, yaw=1)
HIGH = Condition(type=ConditionType.GREATER, object_id="1", param1=5.0)
BETWEEN = Condition(type=ConditionType.WITHIN, object_id="1", param1=5.0, param2=7.0)
SOFT = TimeWindow(latest=50, hard=False)
JOINTS = JointState(names=("arm",), positions=(1.0,), velocities=(1.0,), efforts=(1.0,))
PAUSE = Reaction(
    event=EventKind.GAS_LEAK, response=Response.PAUSE, until=EventKind.ALL_CLEAR, hold_limit=60
)
LOW = Reaction(event=EventKind.LOW_BATTERY, response=Response.RETURN, battery_below=0.3)
CHARGING = LOW.model_copy(
    update={"until": EventKind.BATTERY_CHARGED, "afterwards": Afterwards.RESUME}
)
RETURN = Reaction(event=EventKind.GAS_LEAK, response=Response.RETURN)


def mission(a=(), b=(), w=(), group=(), reactions=(), condition=HIGH, last="C", **fields):
    """Return a mission: a measurement, a group of a drive and a wait, another measurement.

    The arguments change fields of its parts.
    """
    tasks = (
        Task(name="S", action=Action.START, transitions=(way("A"),)),
        measure("A", way(last, condition), "B", **{"object_id": "1", **dict(a)}),
        drive("B", "W", **dict(b)),
        wait("W", last, **{"duration": 5, **dict(w)}),
        measure(last, object_id="2"),
    )
    group_fields = {"name": "G", "start": "B", "end": "W", "max_repeat_count": 2, **dict(group)}
    mission_fields = {"dock": HERE, "reactions": reactions, **fields}
    return Mission(**{"tasks": tasks, "groups": (Group(**group_fields),), **mission_fields})


def task(base=(), **fields):
    return mission(a=base), mission(a={**dict(base), **fields})


def waiting(base, **fields):
    return mission(w={"wait": base}), mission(w={"wait": base.model_copy(update=fields)})


def windowed(base=SOFT, **fields):
    return mission(a={"window": base}), mission(a={"window": base.model_copy(update=fields)})


def condition(base=BETWEEN, **fields):
    return mission(condition=base), mission(condition=base.model_copy(update=fields))


def grouped(base=(), **fields):
    return mission(group=base), mission(group={**dict(base), **fields})


def reacting(base=PAUSE, **fields):
    return mission(reactions=(base,)), mission(reactions=(base.model_copy(update=fields),))


def joints(**fields):
    moved = JOINTS.model_copy(update=fields)
    return mission(b={"joint_states": JOINTS}), mission(b={"joint_states": moved})


def mission_change(**fields):
    return mission(), mission(**fields)


SPAN = Span(line=1, column=1, length=1)
EVENT = WaitRule(event=EventKind.ALL_CLEAR, limit=60)
CHARGED = WaitRule(event=EventKind.BATTERY_CHARGED, limit=60)
CHANGES = {
    "Task.name": mission_change(last="D"),
    "Task.action": (mission(), mission(b={"action": Action.MEASURE, "object_id": "3"})),
    "Task.group": task(group="shown"),
    "Task.object_id": task(object_id="3"),
    "Task.pose": task(pose=THERE),
    "Task.wait": (mission(), mission(w={"wait": WaitRule(duration=6)})),
    "Task.velocity": (mission(), mission(a={"velocity": 0.5})),
    "Task.joint_states": (mission(), mission(b={"joint_states": JOINTS})),
    "Task.retries": task(retries=2),
    "Task.on_failure": task(on_failure=OnFailure.ABORT),
    "Task.failure_target": task(
        {"on_failure": OnFailure.BRANCH, "failure_target": "B"}, failure_target="C"
    ),
    "Task.time_limit": task(time_limit=60),
    "Task.reading_limit": task(reading_limit=60),
    "Task.optional": task(optional=True),
    "Task.priority": task(priority=3),
    "Task.window": task(window=TimeWindow(earliest=10)),
    "Task.transitions": task(transitions=(Transition(target="B"),)),
    "Task.source": task(source=SPAN),
    "WaitRule.duration": waiting(WaitRule(duration=5), duration=7.0),
    "WaitRule.event": waiting(EVENT, event=EventKind.BATTERY_CHARGED),
    "WaitRule.conditions": waiting(EVENT, conditions=(HIGH,)),
    "WaitRule.limit": waiting(EVENT, limit=70.0),
    "WaitRule.charge_to": waiting(CHARGED, charge_to=0.6),
    "WaitRule.charge_for": waiting(CHARGED, charge_for=30.0),
    "TimeWindow.earliest": windowed(earliest=20.0),
    "TimeWindow.latest": windowed(latest=60.0),
    "TimeWindow.hard": windowed(hard=True),
    "TimeWindow.missed_target": windowed(TimeWindow(latest=50), missed_target="C"),
    "Condition.type": condition(HIGH, type=ConditionType.LESS),
    "Condition.id": condition(id="for people"),
    "Condition.object_id": condition(object_id="2"),
    "Condition.param1": condition(param1=4.0),
    "Condition.param2": condition(param2=8.0),
    "Condition.inclusive": condition(inclusive=True),
    "Condition.max_age": condition(max_age=60.0),
    "Transition.target": task(
        {"transitions": (Transition(target="B"),)}, transitions=(Transition(target="C"),)
    ),
    "Transition.conditions": condition(HIGH, param1=6.0),
    "JointState.names": joints(names=("leg",)),
    "JointState.positions": joints(positions=(2.0,)),
    "JointState.velocities": joints(velocities=(2.0,)),
    "JointState.efforts": joints(efforts=(2.0,)),
    "Group.name": grouped(name="H"),
    "Group.start": grouped(start="A"),
    "Group.end": grouped(end="B"),
    "Group.max_repeat_count": grouped(max_repeat_count=3),
    "Group.max_repeat_duration": grouped(max_repeat_duration=60),
    "Group.count_interruptions": grouped({"max_repeat_duration": 60}, count_interruptions=True),
    "Group.stop": grouped({"max_repeat_duration": 60}, stop=Stop.SOFT),
    "Group.every": grouped(every=60),
    "Group.until": grouped(until=(HIGH,)),
    "Group.source": grouped(source=SPAN),
    "Reaction.event": reacting(event=EventKind.HOT_SPOT),
    "Reaction.response": reacting(RETURN, response=Response.ABORT),
    "Reaction.pose": reacting(RETURN, pose=THERE),
    "Reaction.area": reacting(RETURN.model_copy(update={"pose": THERE}), area=2),
    "Reaction.until": reacting(until=EventKind.BATTERY_CHARGED),
    "Reaction.afterwards": reacting(RETURN, afterwards=Afterwards.RESUME),
    "Reaction.hold_limit": reacting(hold_limit=70.0),
    "Reaction.on_limit": reacting(on_limit=Afterwards.RESUME),
    "Reaction.priority": reacting(priority=7),
    "Reaction.battery_below": reacting(LOW, battery_below=0.4),
    "Reaction.charge_to": reacting(CHARGING, charge_to=0.6),
    "Reaction.charge_for": reacting(CHARGING, charge_for=600.0),
    "Reaction.source": reacting(source=SPAN),
    "Mission.designation": mission_change(designation="named"),
    "Mission.site": mission_change(site="umad"),
    "Mission.mode": mission_change(mode=Mode.SUPERVISORY),
    "Mission.max_duration": mission_change(max_duration=600),
    "Mission.start_area": mission_change(start_area=1),
    "Mission.end_area": mission_change(end_area=1),
    "Mission.dock": (
        mission(a={"on_failure": OnFailure.RETURN}),
        mission(a={"on_failure": OnFailure.RETURN}, dock=THERE),
    ),
    "Mission.order": mission_change(order=Order.ANY),
    "Mission.anomaly_specification": mission_change(anomaly_specification="text"),
    "Mission.real_time_reporting": mission_change(real_time_reporting="text"),
    "Mission.after_mission_report": mission_change(after_mission_report="text"),
    "Mission.tasks": (mission(), mission(b={"retries": 3})),
    "Mission.groups": mission_change(groups=()),
    "Mission.reactions": mission_change(reactions=(PAUSE,)),
    "Mission.current": mission_change(current="A"),
    "Mission.left_out": mission_change(left_out=("Z",)),
    "Mission.before": mission_change(before=(("A", "C"),)),
}
"""For each field a mission, and the same mission with another value in that field."""

CHANGES_NOTHING = {
    "Task.group",
    "Task.priority",
    "Task.source",
    "Condition.id",
    "Group.source",
    "Reaction.area",
    "Reaction.source",
    *(f"Mission.{name}" for name in ("site", "max_duration", "start_area", "end_area", "order")),
    *(f"Mission.{name}" for name in ("anomaly_specification", "real_time_reporting")),
    *(f"Mission.{name}" for name in ("after_mission_report", "current", "left_out", "before")),
}
"""Fields that do not change what a machine does, by `docs/export.md`."""

NOT_DRAWN = {
    "Task.action",
    "Task.object_id",
    "Task.pose",
    "Task.joint_states",
    "Reaction.pose",
    "Mission.dock",
    "Mission.mode",
    *(f"JointState.{name}" for name in JointState.model_fields),
}

LEFT_OUT = {
    "btcpp": CHANGES_NOTHING | {"Group.count_interruptions", "TimeWindow.latest"},
    "flexbe": CHANGES_NOTHING | {"Group.count_interruptions", "TimeWindow.latest"},
    "mermaid": CHANGES_NOTHING - {"Task.priority"} | NOT_DRAWN | {"Mission.designation"},
    "dot": CHANGES_NOTHING - {"Task.priority"} | NOT_DRAWN,
    "ros": {"Mission.left_out"},
}


def test_all_fields_of_the_models_are_covered():
    parts = (WaitRule, TimeWindow, Condition, Transition, JointState)
    models = (Mission, Task, Group, Reaction, *parts)
    fields = {f"{m.__name__}.{name}" for m in models for name in m.model_fields}
    assert CHANGES.keys() == fields - {"Mission.version"}


def test_changed_missions_differ_and_are_valid():
    for before, after in CHANGES.values():
        assert before != after
        for changed in (before, after):
            assert not has_errors(check(changed))


def exported(form, mission):
    """Return the export, or None if it is refused, and the refusals' codes and messages."""
    if form == "ros":
        types = ros2_types()
        return types.encode(to_message(mission, types)), ()
    machine = lower(mission)
    try:
        return EXPORTERS[form].export(ExportInput(mission, machine)), ()
    except DiagnosticError as error:
        return None, tuple((d.code, d.message) for d in error.diagnostics)


@pytest.mark.parametrize("form", LEFT_OUT)
def test_a_field_is_exported_or_refused_or_known_to_be_left_out(form):
    wrong = []
    for field, both in CHANGES.items():
        before, after = (exported(form, version) for version in both)
        # If both missions are refused, the field belongs to a part that the format refuses.
        refused = before[0] is None and after[0] is None
        if not refused and (before == after) != (field in LEFT_OUT[form]):
            wrong.append(field)
    assert wrong == []


@pytest.mark.parametrize("form", ["btcpp", "flexbe"])
def test_refusals_name_their_subject(form):
    names = ("'A'", "'B'", "'W'", "'G'", "'H'", "'gas_leak'", "'hot_spot'", "'low_battery'")
    names = (*names, "starts paused")
    for field, (_, after) in CHANGES.items():
        for code, message in exported(form, after)[1]:
            assert code.startswith("export."), field
            assert any(name in message for name in names), field


@pytest.mark.parametrize("form", ["btcpp", "flexbe", "mermaid", "dot", "ros"])
def test_a_battery_level_that_is_only_reported_is_exported_or_refused(form):
    levels = [
        LOW.model_copy(update={"response": Response.REPORT, "battery_below": n}) for n in (0.3, 0.4)
    ]
    one, other = (exported(form, mission().model_copy(update={"reactions": (r,)})) for r in levels)
    assert one[0] is None or one[0] != other[0]
    assert one[0] is not None or "'low_battery'" in one[1][0][1]
