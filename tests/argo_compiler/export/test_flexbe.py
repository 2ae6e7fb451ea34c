"""Tests of exported FlexBE behaviours, run on a replacement for FlexBE's core."""

import ast
import importlib
import sys
import types
import xml.etree.ElementTree as ET
from itertools import cycle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.export.flexbe import to_flexbe
from argo_compiler.hfsm import lower
from argo_compiler.il import EventKind, Mission, Reaction, Response, Task
from tests.argo_compiler.export import missions as m
from tests.argo_compiler.export.tree_missions import executed, tree_missions
from tests.conftest import examples
from tests.mission_parts import assume_sound
from tests.mission_writing import measure

STEPS = 40


class EventState:
    def __init__(self, outcomes, input_keys=(), output_keys=()):
        self.outcomes = set(outcomes)
        self.keys = set(input_keys), set(output_keys)

    def on_enter(self, userdata):
        pass

    def on_exit(self, userdata):
        pass

    def run(self, userdata, wait):
        """Execute the state until it has an outcome, and return that."""
        self.on_enter(userdata)
        while (outcome := self.execute(userdata)) is None:
            wait(self)
        self.on_exit(userdata)
        assert outcome in self.outcomes
        return outcome


class OperatableStateMachine:
    opened = None

    def __init__(self, outcomes, **keys):
        assert all(value == ["memory"] for value in keys.values())
        self.outcomes = set(outcomes)
        self.userdata = types.SimpleNamespace()
        self.states = {}

    def __enter__(self):
        assert OperatableStateMachine.opened is None
        OperatableStateMachine.opened = self

    def __exit__(self, *_):
        OperatableStateMachine.opened = None

    @staticmethod
    def add(label, state, transitions, autonomy, remapping):
        opened = OperatableStateMachine.opened
        assert label not in opened.states
        assert set(transitions) == set(autonomy) == state.outcomes
        assert remapping == {"memory": "memory"}
        opened.states[label] = state, transitions

    def validate(self):
        for state, transitions in self.states.values():
            assert set(transitions.values()) <= set(self.states) | self.outcomes
            if isinstance(state, OperatableStateMachine):
                state.validate()

    def run(self, userdata, wait):
        label = next(iter(self.states))
        while label in self.states:
            state, transitions = self.states[label]
            label = transitions[state.run(userdata, wait)]
        return label


class Behavior:
    def __init__(self):
        self.name = "unnamed"


class Stop(Exception):
    pass


class Robot:
    """Robot with given outcomes on a virtual clock; it logs the actions that it starts."""

    def __init__(self, outcomes):
        self.outcomes = cycle(outcomes)
        self.time = 0
        self.log = []
        self.action = None

    def now(self):
        return self.time

    def measure(self, task, *_, **_way):
        self.start(task, measures=True)

    def drive(self, task, *_, **_way):
        self.start(task, measures=False)

    def start(self, task, measures):
        assert self.action is None
        if len(self.log) == STEPS:
            raise Stop
        self.log.append((self.time, task))
        duration, value, failed = next(self.outcomes)
        self.action = self.time + duration, value if measures else None, failed

    def result(self):
        end, value, failed = self.action
        if self.time < end:
            return None
        self.action = None
        if failed:
            kind = "failed" if value is None else "unreachable" if value % 2 else "unreadable"
            return kind, None
        return "done", None if value is None else (value, value >= 5)

    def cancel(self):
        self.action = None

    def wait(self, state):
        """Let one second pass if there is something to wait for; all times are whole seconds."""
        is_acting = self.action is not None and self.action[0] > self.time
        self.time += is_acting or type(state).__name__ == "WaitState"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """Module `robot` of the exported states, imported with a replacement for `flexbe_core`."""
    folder = tmp_path_factory.mktemp("flexbe")
    mission = Mission(tasks=(Task(name="A", action="WAYPOINT", pose=m.HERE),))
    for path, content in to_flexbe(mission, lower(mission)).items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content)
    core = types.ModuleType("flexbe_core")
    core.EventState = EventState
    core.OperatableStateMachine = OperatableStateMachine
    core.Behavior = Behavior
    core.Autonomy = types.SimpleNamespace(Off=-1)
    modules_before = dict(sys.modules)
    sys.modules["flexbe_core"] = core
    sys.path.insert(0, str(folder))
    yield importlib.import_module("argo_flexbe_states.robot")
    sys.path.remove(str(folder))
    for name in sys.modules.keys() - modules_before.keys():
        if name.startswith(("flexbe_core", "argo_flexbe")):
            del sys.modules[name]


def exported(mission):
    """Return an instance of the behaviour's class, found by its manifest."""
    contents = to_flexbe(mission, lower(mission))
    manifest = ET.fromstring(next(v for k, v in contents.items() if k.startswith("manifest/")))
    executable = manifest.find("executable").attrib
    path = executable["package_path"].replace(".", "/") + ".py"
    namespace = {}
    exec(compile(contents[path], path, "exec"), namespace)
    behavior = namespace[executable["class"]]()
    assert behavior.name == manifest.attrib["name"]
    return behavior


def run(package, mission, outcomes):
    machine = exported(mission).create()
    machine.validate()
    robot = Robot(outcomes)
    package.connect(robot)
    try:
        outcome = machine.run(machine.userdata, robot.wait)
    except Stop:
        outcome = None
    return robot.log, outcome


@settings(max_examples=examples(60))
@given(mission=st.one_of(m.missions(), tree_missions(windows=False)), outcomes=m.outcome_lists)
def test_behaviour_does_what_the_executor_does(package, mission, outcomes):
    assume_sound(mission)
    log, outcome = run(package, mission, outcomes)
    expected = executed(mission, outcomes, STEPS)
    assert log == expected[0]
    assert outcome is None or outcome.replace("_", " ") == expected[1]


@given(st.text(min_size=1))
def test_any_name_is_exported_as_data(package, name):
    result = run(package, m.repeated(measure(name)), [(1, 2, False)])
    assert result == ([(0, name), (1, name)], "completed")


def test_files_are_two_packages_and_a_manifest():
    mission = Mission(tasks=(measure("A"),), designation="9 o'clock round")
    contents = to_flexbe(mission, lower(mission))
    assert {path.partition("/")[0] for path in contents} == {
        "argo_flexbe_states",
        "argo_flexbe_behaviors",
        "manifest",
    }
    assert "argo_flexbe_behaviors/m_9_o_clock_round_sm.py" in contents
    for path, content in contents.items():
        if path.endswith(".py"):
            ast.parse(content)


def test_reactions_are_refused():
    reactions = (
        Reaction(event=EventKind.GAS_LEAK, response=Response.PAUSE),
        Reaction(event=EventKind.HOT_SPOT, response=Response.REPORT),
    )
    mission = Mission(tasks=(measure("A"),), reactions=reactions)
    with pytest.raises(DiagnosticError, match="reaction to 'gas_leak' can't be exported") as caught:
        to_flexbe(mission, lower(mission))
    assert [d.code for d in caught.value.diagnostics] == ["export.reaction"]


def test_mission_without_tasks_ends_at_once(package):
    mission = Mission(tasks=(Task(name="S", action="START"),))
    assert run(package, mission, [(1, None, False)]) == ([], "completed")
