"""Rounds with branches: what is carried out is what the sentences say, read anew by an
interpreter that knows neither tasks nor groups."""

from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    Occurred,
    Outcome,
    Tick,
    lower,
)
from argo_compiler.il import Action, EventKind, Mission
from argo_compiler.script.write.protocol import format_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.argo_compiler.script.sentences import HORIZON, Interpreter, Writer, script, value
from tests.conftest import examples
from tests.whole_scripts import import_whole


def carried_out(mission: Mission) -> list[tuple[float, object]]:
    """What a mission does, and when, as the interpreter tells it: each action takes a second."""
    executor = Executor(lower(mission))
    now = 0.0
    executor.start(now)
    done: list[tuple[float, object]] = []
    visits: Counter[int] = Counter()
    while not executor.finished and now <= HORIZON:
        task = executor.running
        if task is None:
            assert executor.next_deadline is not None
            now = executor.next_deadline
            executor.handle(Tick(), now)
            continue
        at = now
        now += 1.0
        if task.action is not Action.MEASURE:
            planned = mission.task(task.name) is not None and not task.name.startswith("DOCK")
            done.append((at, "drive" if planned else "home"))
            executor.handle(ActionSucceeded(task.name), now)
            continue
        number = int(task.object_id or 0)
        visits[number] += 1
        read = value(number, visits[number])
        done.append((at, number))
        ended = ActionFailed(task.name, "") if read is None else ActionSucceeded(task.name, read)
        executor.handle(ended, now)
    return done


@pytest.mark.rule("G14", "G5")
def test_what_is_carried_out_is_what_the_sentences_say() -> None:
    met: Counter[str] = Counter()

    @settings(max_examples=examples(400))
    @given(st.integers(0, 2**32))
    def compare(seed: int) -> None:
        steps, rounds = Writer(seed).protocol()
        text = script(steps, rounds)
        try:
            mission = import_whole(text, CATALOG).mission
        except DiagnosticError as error:
            met.update({d.code for d in error.diagnostics if d.severity == "error"})
            return
        done = carried_out(mission)
        assert done == Interpreter(steps, rounds).run(), text
        met["run"] += 1
        met["joined"] += any(t.name.startswith("end of") for t in mission.tasks)
        met["decided behind"] += any(t.name.startswith("after") for t in mission.tasks)
        again = import_whole(format_script(mission, CATALOG), CATALOG).mission
        assert carried_out(again) == done, text

    compare()
    assert met["run"] > 0.9 * (met.total() - met["joined"] - met["decided behind"])
    assert min(met["joined"], met["decided behind"]) > 0.1 * met["run"]


# ---- examples


def read(lines: str, catalog: Catalog) -> Mission:
    return import_whole(f"Mission Protocol\nStart area: 1\n{lines}", catalog).mission


@pytest.mark.rule("G10", "G14")
@pytest.mark.parametrize("value", [4.0, 6.0])
def test_what_is_decided_behind_a_patrol_is_decided_when_its_time_is_up(
    value: float, catalog: Catalog
) -> None:
    lines = (
        "1. Check #1.\n2. Patrol floor 1 for 10 min.\n"
        "If #1 is above 5, check #2; otherwise check #3."
    )
    executor = Executor(lower(read(lines, catalog)))
    executor.start(0.0)
    executor.handle(ActionSucceeded("MEASURE 1", value), 1.0)
    executor.handle(ActionSucceeded("WAYPOINT 1"), 2.0)
    (cancelled,) = executor.handle(Tick(), 601.0)
    assert isinstance(cancelled, CancelAction)
    executor.handle(ActionStopped(cancelled.task), 602.0)
    assert executor.running is not None
    assert executor.running.name == ("MEASURE 2" if value > 5 else "MEASURE 3")


@pytest.mark.rule("G14")
def test_only_words_that_say_so_leave_a_round(catalog: Catalog) -> None:
    lines = "1. Check #1; if it is above 5, {}; otherwise {}.\n2. Repeat step 1 twice.\n3. Check #3"
    for above, otherwise in (
        ("go on", "check #2"),
        ("check #2", "check #4"),
        ("check #2", "go on"),
    ):
        mission = read(lines.format(above, otherwise), catalog)
        assert mission.groups[0].end == "end of 'Repeat 1'"
        inside = {t.name for t in mission.tasks if t.group}
        for task in mission.tasks:
            if task.name in inside and task.name != mission.groups[0].end:
                assert {way.target for way in task.transitions} <= inside
    away = read(lines.format("go to step 3", "check #2"), catalog)
    assert away.tasks[1].transitions[0].target == "MEASURE 3"
    at_once = read(lines.format("go on", "go to step 3"), catalog)
    assert [way.target for way in at_once.tasks[1].transitions] == [
        "end of 'Repeat 1'",
        "MEASURE 3",
    ]


@pytest.mark.rule("R7")
@pytest.mark.parametrize("priority", [1, 9])
def test_a_priority_of_a_script_does_not_hold_an_emergency_stop_back(
    priority: int, catalog: Catalog
) -> None:
    lines = (
        f"1. Check #1.\nOn low battery: return to the docking station, priority {priority}.\n"
        "In case of an emergency stop, abort the mission, priority 3."
    )
    executor = Executor(lower(read(lines, catalog)))
    executor.start(0.0)
    executor.handle(Occurred(EventKind.LOW_BATTERY), 1.0)
    executor.handle(ActionStopped("MEASURE 1"), 2.0)
    assert executor.running is not None
    assert executor.running.name == "react to low_battery"
    executor.handle(Occurred(EventKind.EMERGENCY_STOP), 3.0)
    executor.handle(ActionStopped("react to low_battery"), 4.0)
    assert executor.outcome is Outcome.ABORTED


@pytest.mark.rule("G6", "G14")
@pytest.mark.parametrize(
    ("lines", "ends", "ways"),
    [
        (
            "1. Check #1; if it is above 5, go to step 1; otherwise go to step 3.\n"
            "2. Repeat step 1 twice.\n3. Check #3",
            "end of 'Repeat 1'",
            {"MEASURE 1": ["MEASURE 1", "MEASURE 3"], "end of 'Repeat 1'": ["MEASURE 3"]},
        ),
        (
            "1. Check #1; if it is above 5, go on. Then go to step 4.\n"
            "2. Repeat step 1 twice.\n3. Check #3.\n4. Check #4",
            "end of 'Repeat 1'",
            {"MEASURE 1": ["end of 'Repeat 1'"] * 2, "end of 'Repeat 1'": ["MEASURE 4"]},
        ),
        (
            "1. Check #1; then go to step 4.\n2. Repeat step 1 twice; if #1 is above 5, check #2.\n"
            "3. Check #3.\n4. Check #4",
            "MEASURE 1",
            {
                "MEASURE 1": ["after 'Repeat 1'"],
                "after 'Repeat 1'": ["MEASURE 2", "MEASURE 4"],
                "MEASURE 2": ["MEASURE 3"],
            },
        ),
        (
            '1. "a": check #1; if it is above 5, check #2.\n2. Repeat step "a" twice.\n3. Check #3',
            "end of 'Repeat a'",
            {
                "a": ["MEASURE 2", "end of 'Repeat a'"],
                "MEASURE 2": ["end of 'Repeat a'"],
                "end of 'Repeat a'": ["MEASURE 3"],
            },
        ),
        (
            "1. Check #1.\n2. Check #2. In all other cases go on. If it is above 5, go to step 1.\n"
            "3. Repeat steps 1 to 2 twice.\n4. Check #3",
            "MEASURE 2",
            {"MEASURE 2": ["MEASURE 3", "MEASURE 1"]},
        ),
    ],
)
def test_where_a_round_ends_and_what_comes_then(
    lines: str, ends: str, ways: dict[str, list[str]], catalog: Catalog
) -> None:
    mission = read(lines, catalog)
    assert mission.groups[0].end == ends
    found = {t.name: [way.target for way in t.transitions] for t in mission.tasks}
    assert {name: found[name] for name in ways} == ways
