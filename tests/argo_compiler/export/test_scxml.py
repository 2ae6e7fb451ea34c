"""The exported state chart in an engine of its own, beside the executor."""

import re
import xml.etree.ElementTree as ET

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from statemachine.io import load

from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.export.scxml import to_scxml
from argo_compiler.hfsm import lower
from argo_compiler.il import Group, Mission, Stop, Task, Transition
from argo_compiler.model import Pose
from tests.argo_compiler.export import missions as m
from tests.argo_compiler.export.executing import Executing
from tests.conftest import examples

NS = {"s": "http://www.w3.org/2005/07/scxml"}
TASK, GROUP = re.compile(r"t\d+"), re.compile(r"g\d+")
ARGO = "{urn:argo:mission}"


class Chart:
    """The document in python-statemachine. What it is doing is read from its own data."""

    def __init__(self, text):
        # Each class that python-statemachine loads can be started once only.
        self.load = lambda: load(text, format="scxml")()
        root = ET.fromstring(text)
        self.states = {e.get("id"): e for e in root.iter() if e.get("id")}
        self.max_duration = root.get(f"{ARGO}max_duration")
        self.names = {i: e.get(f"{ARGO}name") for i, e in self.states.items()}
        self.objects = {
            e.get("id").removeprefix("known_"): e.get(f"{ARGO}object_id")
            for e in root.iter(f"{{{NS['s']}}}data")
            if e.get(f"{ARGO}object_id") is not None
        }
        self.timed = [
            i
            for i, e in self.states.items()
            if e.find(f"s:transition[@event='timeout.{i}']", NS) is not None
        ]

    def start(self):
        self.chart = self.load()
        self.data = self.chart.model
        self.time_up = None if self.max_duration is None else float(self.max_duration)
        self.handle("tick", 0, None)

    def handle(self, event, now, value):
        while (due := self.due()) is not None and due[0] < now:
            self.send(due[1], due[0])
        starts = self.data.starts
        self.send(event, now, value)
        while (due := self.due()) is not None and due[0] <= now:
            self.send(due[1], due[0])
        # What was begun and cancelled within this moment has never been seen.
        if not self.finished and self.stopping and self.data.starts > starts:
            self.send("action.stopped", now)

    def send(self, event, now, value=None):
        if event == "event.time_up":
            self.time_up = None
        if not self.finished:
            self.chart.send(event, time=now, **({} if value is None else {"value": value}))
            assert "error" not in str(self.active)

    @property
    def active(self):
        return [s.id for s in self.chart.configuration]

    def due(self):
        """The next time-out and when it is due; the outermost one of those that are due first."""
        if self.data.mode == 3 or self.finished:
            return None
        active = set(self.active)
        due = []
        for order, group in enumerate(self.timed):
            if group in active:
                until = getattr(self.data, f"until_{group[1:]}")
                counts = self.states[group].get(f"{ARGO}clock") == "now"
                # Nothing is left while the mission is interrupted.
                at = until if counts else until + self.data.lost
                if self.data.mode == 0:
                    due.append((max(at, self.data.now), order, f"timeout.{group}"))
        if self.time_up is not None:
            due.append((self.time_up, -1, "event.time_up"))
        return (min(due)[0], min(due)[2]) if due else None

    @property
    def deadline(self):
        due = self.due()
        return None if due is None else due[0]

    @property
    def finished(self):
        return self.chart.is_terminated

    @property
    def running(self):
        data = self.data
        return (data.starts, self.names[data.running_place]) if data.running else None

    @property
    def stopping(self):
        return "stopping" in self.active

    def seen(self):
        """The task, the action, whether it is stopping, rounds, values, and how it has ended."""
        active = self.active
        values = {
            object_id: (getattr(self.data, f"value_{k}"), getattr(self.data, f"time_{k}"))
            for k, object_id in self.objects.items()
            if getattr(self.data, f"known_{k}")
        }
        if self.finished:
            return None, None, False, {}, values, active[0]
        ended = self.data.mode == 3
        tasks = [self.names[i] for i in active if TASK.fullmatch(i)]
        rounds = {
            self.names[i]: getattr(self.data, f"round_{i[1:]}")
            for i in active
            if GROUP.fullmatch(i)
        }
        return (
            tasks[0] if tasks and not ended else None,
            self.running and self.running[1],
            self.stopping,
            {} if ended else rounds,
            values,
            None,
        )


@settings(max_examples=examples(30), deadline=None)
@given(m.missions(), m.outcome_lists)
def test_chart_does_what_the_executor_does(mission, outcomes):
    agrees(mission, outcomes)


@settings(max_examples=examples(50), deadline=None)
@given(
    m.missions(),
    m.outcome_lists,
    m.cleanup_lists,
    m.intervention_lists,
    m.reactions(),
    st.sampled_from([None, None, 5, 10]),
)
def test_chart_is_interrupted_as_the_executor_is(
    mission, outcomes, cleanups, interventions, reactions, limit
):
    update = {"reactions": reactions, "max_duration": limit}
    agrees(mission.model_copy(update=update), outcomes, cleanups, interventions)


def agrees(mission, outcomes, *rest):
    assume(not any(f.severity is Severity.ERROR for f in check(mission)))
    hfsm = lower(mission)
    expected = m.Drive(Executing(hfsm), outcomes, *rest, steps=25).run()
    assert m.Drive(Chart(to_scxml(mission, hfsm)), outcomes, *rest, steps=25).run() == expected


def test_names_are_labels():
    name = "a \"b\" <c> & 'd'\n\x00é"
    task = Task(name=name, action="MEASURE", object_id=name)
    group = Group(name="]]>", start=name, end=name, max_repeat_count=2)
    mission = Mission(tasks=(task,), groups=(group,))
    chart = Chart(to_scxml(mission, lower(mission)))
    assert chart.names["t1"] == name.replace("\x00", "\\x00")
    assert chart.names["g1"] == "]]>"
    m.Drive(chart, [(1, 2, False)]).run()
    assert chart.finished


def test_states_say_what_a_driver_needs():
    start = Task(name="S", action="START", velocity=0.5, transitions=(Transition(target="A"),))
    task = Task(name="A", action="WAYPOINT", pose=Pose(x=1, y=2.5, z=0), velocity=0.25)
    mission = Mission(tasks=(start, task), max_duration=60)
    root = ET.fromstring(to_scxml(mission, lower(mission)))
    assert root.get(f"{ARGO}max_duration") == "60"
    states = {e.get("id"): e for e in root.iter(f"{{{NS['s']}}}state")}
    assert states["start"].get(f"{ARGO}velocity") == "0.5"
    attributes = {k: states["t1"].get(ARGO + k) for k in ("action", "x", "y", "yaw", "velocity")}
    assert attributes == {
        "action": "WAYPOINT", "x": "1", "y": "2.5", "yaw": "0", "velocity": "0.25"
    }  # fmt: skip


def test_timers_of_the_engine():
    tasks = tuple(Task(name=n, action="MEASURE", object_id=n) for n in "AB")
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
    # They run while the group is active and the mission goes on.
    for state in ("g1", "going"):
        element = root.find(f".//s:state[@id='{state}']", NS)
        assert element.find("s:onentry//s:send", NS).get("id") == "timer_1"
        assert element.find("s:onexit/s:cancel", NS).get("sendid") == "timer_1"


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
