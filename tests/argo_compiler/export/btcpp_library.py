"""Tests of exported behaviour trees in BehaviorTree.CPP itself.

    ARGO_BTCPP_RUNNER=./runner python -m pytest tests/argo_compiler/export/btcpp_library.py

The suite does not collect this file, as the library has no wheel; `docs/export.md` describes how to
build the runner.
"""

import math
import os
import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.export.btcpp import to_btcpp
from argo_compiler.il import (
    Condition,
    ConditionType,
    Mission,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from tests.argo_compiler.export import missions as m
from tests.argo_compiler.export.test_btcpp import STEPS, codes, task
from tests.argo_compiler.export.tree_missions import OUTCOMES, executed, tree_missions
from tests.conftest import examples
from tests.mission_parts import assume_sound

RUNNER = os.environ["ARGO_BTCPP_RUNNER"]


def runner_output(folder, mission, outcomes, steps=9):
    """Return the runner's lines of output for a mission's tree, run with these outcomes."""
    path = folder / "tree.xml"
    path.write_text(to_btcpp(mission), encoding="utf-8")
    command = [RUNNER, str(path), str(steps)]
    done = subprocess.run(command, input=outcomes, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


@settings(max_examples=examples(40))
@given(tree_missions(timed=False), m.outcome_lists)
def test_the_library_itself_does_the_same(tmp_path_factory, mission, outcomes):
    assume_sound(mission)
    script = "".join(
        f"{duration} {int(value is not None)} {value or 0} {int((value or 0) >= 5)} {int(failed)}\n"
        for duration, value, failed in outcomes
    )
    *lines, last = runner_output(tmp_path_factory.mktemp("tree"), mission, script, STEPS)
    log = [(float(t), name) for t, _, name in (line.partition(" ") for line in lines)]
    expected = executed(mission, outcomes, STEPS)
    assert log == expected[0]
    if len(log) < STEPS:
        assert OUTCOMES[int(float(last)) - 1] == expected[1]


def test_the_library_waits_and_limits(tmp_path):
    wait = Task(name="W", action="WAIT", wait=WaitRule(duration=0.02))
    late = task("A", "W", time_limit=60.0, retries=1, velocity=0.25)
    early = task("C", window=TimeWindow(earliest=7.0), optional=True)
    ways = (Transition(target="C"),)
    mission = Mission(tasks=(late, wait.model_copy(update={"transitions": ways}), early))
    lines = runner_output(tmp_path, mission, "1 0 0 0 1\n2 0 0 0 0\n1 0 0 0 1\n")
    assert lines == ["0 A", "1 A", "3 C", "1"]


@settings(max_examples=examples(40))
@given(st.text(min_size=1), st.text(min_size=1))
def test_the_library_reads_any_name(tmp_path_factory, name, object_id):
    measure = Task(name=name, action="MEASURE", object_id=object_id)
    mission = assume_sound(Mission(tasks=(measure,), designation=object_id))
    if any(character in object_id for character in "{};") or object_id.startswith("json:"):
        assert codes(mission) == ["export.name"]
        return
    assert runner_output(tmp_path_factory.mktemp("tree"), mission, "1 1 2 0 0\n")[-1] == "1"


@pytest.mark.parametrize("bound", [-5.0, -1e-7, 1e-12, 0.1, 123456789.125, 1e22, -1e300])
@pytest.mark.parametrize("inclusive", [False, True])
def test_the_library_compares_numbers_as_they_are(tmp_path, bound, inclusive):
    less = Condition(
        type=ConditionType.LESS, object_id="1", param1=bound, inclusive=inclusive, max_age=0.25
    )
    ways = (Transition(target="C", conditions=(less,)), Transition(target="B"))
    measure = Task(name="A", action="MEASURE", object_id="1", velocity=0.3, transitions=ways)
    mission = Mission(tasks=(measure, task("B", "C"), task("C")))
    for value in (math.nextafter(bound, -math.inf), bound, math.nextafter(bound, math.inf)):
        lines = runner_output(tmp_path, mission, f"0.5 1 {value!r} 0 0\n")
        taken = value <= bound if inclusive else value < bound
        assert ("B" not in "".join(lines)) == taken
