"""Tests of the exported state chart in its own engine, in lockstep with the executor."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest
from hypothesis import given, settings

from argo_compiler.base.model import Pose
from argo_compiler.export.scxml import to_scxml
from argo_compiler.export.scxml_data import DEADLINES
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    GiveBack,
    Occurred,
    Outcome,
    Pause,
    Resume,
    Tick,
    lower,
)
from argo_compiler.il import EventKind, Group, Mission, OnFailure, Stop, Task, TimeWindow
from tests.argo_compiler.export.charts import ARGO, NS, Chart
from tests.argo_compiler.export.lockstep import Lockstep
from tests.argo_compiler.hfsm.random_missions import busy_cases, cases
from tests.argo_compiler.hfsm.world import World
from tests.conftest import examples
from tests.mission_parts import HERE, assume_sound
from tests.mission_writing import drive, reaction, start, wait
from tests.mission_writing import measure as a


def without_manual_tasks(case):
    """Return the case without the tasks done by hand, which a chart has no event for."""
    script = [
        (at, GiveBack() if isinstance(event, GiveBack) else event) for at, event in case.script
    ]
    return replace(case, script=script)


@settings(max_examples=examples(50))
@given(cases())
def test_chart_does_what_the_executor_does(case):
    World(Lockstep(assume_sound(case.mission)), without_manual_tasks(case)).run()


@settings(max_examples=examples(30))
@given(busy_cases())
def test_chart_is_interrupted_like_the_executor(case):
    World(Lockstep(assume_sound(case.mission)), without_manual_tasks(case)).run()


def occurs(event):
    return Occurred(EventKind(event))


def test_cancelled_on_the_way_to_the_dock():
    """The drive to the dock still succeeds after a person has cancelled the mission."""
    machines = Lockstep(Mission(tasks=(a("A", on_failure=OnFailure.RETURN),), dock=HERE))
    machines.handle_at(1, ActionFailed("A", "stuck"))
    machines.handle_at(2, Cancel())
    machines.handle_at(3, ActionSucceeded("return to dock"))
    assert machines.executor.outcome is Outcome.CANCELLED


def test_event_that_is_awaited_and_has_a_reaction_of_higher_rank_waits_while_paused():
    back = reaction("low_battery", "return", until="all_clear", priority=1)
    hold = reaction("all_clear", "pause", priority=2)
    machines = Lockstep(Mission(tasks=(a("A"),), dock=HERE, reactions=(back, hold)))
    machines.handle_at(1, occurs("low_battery"))
    machines.handle_at(2, Pause())
    machines.handle_at(3, ActionStopped("A"))
    machines.handle_at(4, occurs("all_clear"))
    assert [pending.event for pending in machines.executor.progress().waiting] == [
        EventKind.ALL_CLEAR
    ]
    machines.handle_at(5, Resume())
    assert machines.executor.reaction is EventKind.ALL_CLEAR
    assert "react_all_clear_hold" in machines.chart.active


@pytest.mark.parametrize("priority", [None, 0, 100])
def test_emergency_stop_aborts_on_the_way_to_the_dock(priority):
    back = reaction("low_battery", "return", until="battery_charged", priority=99)
    stop = reaction("emergency_stop", "abort", priority=priority)
    machines = Lockstep(Mission(tasks=(a("A"),), dock=HERE, reactions=(back, stop)))
    machines.handle_at(1, occurs("low_battery"))
    machines.handle_at(2, ActionStopped("A"))
    machines.handle_at(3, occurs("emergency_stop"))
    assert (machines.executor.outcome, machines.chart.stopping) == (Outcome.ABORTED, True)
    machines.handle_at(4, ActionStopped("react to low_battery"))
    assert machines.chart.finished


def test_mission_resumes_after_recharging():
    fields = {"until": "battery_charged", "afterwards": "resume", "priority": 1}
    back = reaction("low_battery", "return", **fields)
    machines = Lockstep(Mission(tasks=(a("A"),), dock=HERE, reactions=(back,)))
    machines.handle_at(1, occurs("low_battery"))
    machines.handle_at(2, ActionStopped("A"))
    machines.handle_at(3, ActionSucceeded("react to low_battery"))
    machines.handle_at(4, occurs("low_battery"))
    machines.handle_at(5, occurs("battery_charged"))
    assert machines.chart.running == "A"


def test_limits_windows_waits_and_planned_rounds_are_time_outs():
    tasks = (
        a("A", "T", time_limit=4, retries=1, window=TimeWindow(earliest=2)),
        wait("T", "B", event="all_clear", limit=5),
        a("B", "C", window=TimeWindow(latest=40, missed_target="C")),
        a("C"),
    )
    group = Group(name="G", start="A", end="T", max_repeat_count=2, every=30)
    machines = Lockstep(Mission(tasks=tasks, groups=(group,)))
    seen = []
    for now in (6, 7, 11, 16, 30, 31, 40, 41):
        stops = ActionStopped(machines.executor.running.name) if machines.stopping else Tick()
        machines.handle_at(now, ActionSucceeded("A", 1.0) if now == 31 else stops)
        seen.append((now, machines.executor.active_task, machines.chart.running, machines.stopping))
    assert seen == [
        (6, "A", "A", True),
        (7, "A", "A", False),
        (11, "T", "A", True),
        (16, "A", None, False),
        (30, "A", "A", False),
        (31, "T", None, False),
        (40, "C", "C", False),
        (41, "C", "C", False),
    ]


@pytest.mark.parametrize("target", ["C", None])
def test_window_that_closes_before_its_round_starts(target):
    window = TimeWindow(latest=20, missed_target=target)
    groups = (
        Group(name="G", start="A", end="B", max_repeat_count=2, every=30),
        Group(name="G/H", start="A", end="A", max_repeat_count=2, every=4, max_repeat_duration=9),
    )
    tasks = (a("A", "B", window=window), a("B", "C"), a("C"))
    machines = Lockstep(Mission(tasks=tasks, groups=groups))
    machines.handle_at(1, ActionSucceeded("A", 1.0))
    machines.handle_at(4, Tick())
    machines.handle_at(5, ActionSucceeded("A", 2.0))
    machines.handle_at(6, ActionSucceeded("B", 3.0))
    # The window is missed when the round starts, and without a target again in the next round of H.
    assert (machines.executor.active_task, machines.chart.deadline) == ("A", 30)
    machines.handle_at(30, Tick())
    assert machines.executor.active_task == (target or "A")
    if target is None:
        machines.handle_at(34, Tick())
        assert machines.executor.active_task == "B"


def test_hold_has_a_limit_and_a_supervised_mission_starts_paused():
    hold = reaction("gas_leak", "pause", until="all_clear", hold_limit=5, on_limit="end")
    mission = Mission(tasks=(a("A"),), mode="supervisory", reactions=(hold,))
    machines = Lockstep(mission)
    assert machines.chart.running is None
    machines.handle_at(1, Resume())
    machines.handle_at(2, occurs("gas_leak"))
    machines.handle_at(3, ActionStopped("A"))
    machines.handle_at(4, Pause())
    machines.handle_at(9, Tick())
    assert machines.executor.outcome is None
    machines.handle_at(10, Resume())
    assert machines.executor.outcome is Outcome.ABORTED


def test_the_outcome_shows_failures():
    machines = Lockstep(Mission(tasks=(a("A"),)))
    machines.handle_at(1, ActionFailed("A", "dark", unreadable=True))
    assert machines.executor.outcome is Outcome.COMPLETED_WITH_FAILURES


def test_names_are_labels():
    name = "a \"b\" <c> & 'd'\n\x00é"
    task = Task(name=name, action="MEASURE", object_id=name)
    group = Group(name="]]>", start=name, end=name, max_repeat_count=2)
    mission = Mission(tasks=(task,), groups=(group,))
    chart = Chart(to_scxml(mission, lower(mission)))
    assert chart.names["t1"] == name.replace("\x00", "\\x00")
    assert chart.names["g1"] == "]]>"
    chart.start()
    for now in (1, 2):
        chart.handle("action.succeeded", now, value=3)
    assert chart.finished


def test_states_have_the_attributes_that_a_driver_needs():
    there = drive("A", pose=Pose(x=1, y=2.5, z=0), velocity=0.25)
    mission = Mission(tasks=(start("S", "A", velocity=0.5), there), max_duration=60)
    root = ET.fromstring(to_scxml(mission, lower(mission)))
    assert root.get(f"{ARGO}max_duration") == "60"
    states = {e.get("id"): e for e in root.iter(f"{{{NS['s']}}}state")}
    assert states["start"].get(f"{ARGO}velocity") == "0.5"
    attributes = {k: states["t1"].get(ARGO + k) for k in ("action", "x", "y", "yaw", "velocity")}
    assert attributes == {
        "action": "WAYPOINT", "x": "1", "y": "2.5", "yaw": "0", "velocity": "0.25"
    }  # fmt: skip


@pytest.mark.parametrize("response", ["return", "report"])
def test_the_battery_level_is_exported(response):
    react = reaction("low_battery", response, battery_below=0.37)
    mission = Mission(tasks=(a("A"),), reactions=(react,), dock=HERE)
    root = ET.fromstring(to_scxml(mission, lower(mission)))
    levels = [e.get(f"{ARGO}battery_below") for e in root.iter(f"{{{NS['s']}}}data")]
    assert [level for level in levels if level] == ["0.37"]


def test_timers_of_the_engine():
    tasks = (a("A"), a("B"))
    groups = (
        Group(name="G", start="A", end="A", max_repeat_duration=13),
        Group(name="H", start="B", end="B", max_repeat_duration=5, stop=Stop.SOFT),
    )
    mission = Mission(tasks=tasks, groups=groups, max_duration=60)
    hfsm = lower(mission)
    assert "<send" not in to_scxml(mission, hfsm)
    root = ET.fromstring(to_scxml(mission, hfsm, timers=True))
    sent = {e.get("event") for e in root.iterfind(".//s:send", NS)}
    assert sent == {"timeout.g1", "event.time_up"}
    # Both timers run while the group is active and the mission is not interrupted.
    for state in ("g1", "going"):
        element = root.find(f".//s:state[@id='{state}']", NS)
        assert element.find("s:onentry//s:send", NS).get("id") == "timer_1"
        assert element.find("s:onexit/s:cancel", NS).get("sendid") == "timer_1"


def test_the_chart_has_only_the_timers_that_the_mission_needs():
    tasks = (
        a("A", time_limit=4, window=TimeWindow(latest=9)),
        wait("T", event="all_clear", limit=5),
    )
    group = Group(name="G", start="A", end="T", max_repeat_count=2, every=30)
    hold = reaction("gas_leak", "pause", hold_limit=5)
    mission = Mission(tasks=tasks, groups=(group,), reactions=(hold,))
    root = ET.fromstring(to_scxml(mission, lower(mission), timers=True))
    sent = {e.get("event") for e in root.iterfind(".//s:send", NS)}
    assert sent == {f"timeout.{due}" for due in DEADLINES}


def test_deep_nesting_is_written_flat_and_in_linear_size():
    def size(depth):
        groups = tuple(
            Group(name="/".join(["g"] * n), start="A", end="A", max_repeat_count=2)
            for n in range(1, depth + 1)
        )
        task = Task(name="A", action="MEASURE", object_id="1")
        mission = Mission(tasks=(task,), groups=groups)
        return to_scxml(mission, lower(mission)).count("\n")

    assert size(400) - size(200) == size(200) - size(0)
