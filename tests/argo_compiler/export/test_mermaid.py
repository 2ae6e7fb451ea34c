import re

import pytest

from argo_compiler.export import to_mermaid
from argo_compiler.hfsm import lower
from argo_compiler.il import (
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
)
from tests.mission_writing import above, measure, wait, way

STATE = re.compile(r'state "((?:[\w ,().-]|#\d+;)*)" as (\w+)( \{)?')
CHOICE = re.compile(r"state (\w+) <<choice>>")
ARROW = re.compile(r"(\[\*\]|\w+) --> (\[\*\]|\w+)(?: : ((?:[\w ,().-]|#\d+;)+))?")


def parse(text):
    """Return each state's parent, the labels and the arrows; fail if a line has another form."""
    first, *lines = text.splitlines()
    assert first == "stateDiagram-v2"
    parents, labels, arrows, enclosing = {}, {}, [], []
    for line in map(str.strip, lines):
        if line == "}":
            enclosing.pop()
        elif match := STATE.fullmatch(line) or CHOICE.fullmatch(line):
            id = match[match.re.groups - 1] if match.re is STATE else match[1]
            assert id not in parents
            parents[id] = enclosing[-1] if enclosing else None
            if match.re is STATE:
                labels[id] = match[1]
                if match[3]:
                    enclosing.append(id)
        else:
            match = ARROW.fullmatch(line)
            assert match, line
            arrows.append((match[1], match[2], match[3] or ""))
    assert not enclosing
    assert {id for arrow in arrows for id in arrow[:2]} <= parents.keys() | {"[*]"}
    return parents, labels, arrows


@pytest.fixture
def mission():
    hot = above("B", 7.5, max_age=60)
    return Mission(
        tasks=(
            measure("A", "B"),
            measure("B", "C", way("D", hot)),
            measure("C", "D"),
            measure("D"),
        ),
        groups=(
            Group(name="G", start="A", end="C", max_repeat_duration=60),
            Group(name="G/H", start="B", end="C", max_repeat_count=2, stop=Stop.SOFT),
        ),
    )


def test_states_are_nested_like_the_machine(mission):
    parents, labels, _ = parse(to_mermaid(lower(mission)))
    assert parents == {
        "r1": None,
        "g1": None,
        "t0": "g1",
        "r2": "g1",
        "g2": "g1",
        "t1": "g2",
        "t2": "g2",
        "t3": None,
    }
    assert labels == {"t0": "A", "t1": "B", "t2": "C", "t3": "D", "g1": "G", "g2": "G#47;H"}


def test_transition_labels_give_the_reason(mission):
    _, _, arrows = parse(to_mermaid(lower(mission)))
    assert arrows == [
        ("[*]", "t0", ""),
        ("t0", "t1", ""),
        ("t1", "t3", "#35;B #62; 7.5, at most 60 s old"),
        ("t1", "t2", ""),
        ("t2", "r2", ""),
        ("t3", "[*]", ""),
        ("r1", "t0", "repeat, for 60 s"),
        ("r1", "t3", ""),
        ("g1", "r1", "time out after 60 s"),
        ("r2", "t1", "repeat, up to 2 rounds"),
        ("r2", "r1", ""),
    ]


@pytest.mark.parametrize(
    "name",
    [
        'the "big" valve',
        "a: b; c # d",
        "two\nlines",
        "}{",
        "50 %% off",
        "[*] --> A",
        "<b>bold</b>",
        "x <<choice>>",
        "direction LR",
        "Ölstand Überlauf №4",
    ],
)
def test_names_with_a_meaning_in_mermaid_are_escaped(name):
    task = Task(name=name, action="MEASURE", object_id="1")
    text = to_mermaid(lower(Mission(tasks=(task,))))
    _, labels, _ = parse(text)
    assert re.sub(r"#(\d+);", lambda m: chr(int(m[1])), labels["t0"]) == name
    assert not re.search(r"direction\s|%%|<<|\[\*\] --> A", text.replace("[*] --> t0", ""))


def test_mission_with_only_a_start_task():
    mission = Mission(tasks=(Task(name="S", action="START"),))
    assert to_mermaid(lower(mission)) == "stateDiagram-v2\n    [*] --> [*]\n"


def test_failures_and_reactions():
    tasks = (
        measure("A", "B", on_failure=OnFailure.RETURN),
        measure("B", on_failure=OnFailure.ABORT),
    )
    reaction = Reaction(
        event=EventKind.GAS_LEAK,
        response=Response.PAUSE,
        until=EventKind.ALL_CLEAR,
        priority=2,
    )
    mission = Mission(tasks=tasks, reactions=(reaction,), dock={"x": 0, "y": 0, "z": 0})
    parents, labels, arrows = parse(to_mermaid(lower(mission)))
    assert labels["t2"] == "return to dock"
    assert ("t0", "t2", "failed") in arrows
    assert ("t1", "[*]", "failed, abort") in arrows
    assert labels["e1"] == "gas leak#58; pause, until all clear, priority 2"
    assert parents["e1"] == "reactions"


def test_boxes_and_arrows_show_the_fields_of_version_3():
    hot = above("B", 7.5)
    unreadable = Condition(type=ConditionType.UNREADABLE, object_id="B")
    window = TimeWindow(earliest=60, latest=90, missed_target="D")
    mission = Mission(
        tasks=(
            measure("A", "B", velocity=0.3, time_limit=50, optional=True),
            measure(
                "B",
                "C",
                window=window,
                on_failure=OnFailure.BRANCH,
                failure_target="C",
                priority=3,
            ),
            wait("C", "D", event=EventKind.ALL_CLEAR, conditions=(unreadable,), limit=20),
            wait("D", duration=5),
        ),
        groups=(Group(name="G", start="A", end="C", max_repeat_count=4, every=600, until=(hot,)),),
    )
    _, labels, arrows = parse(to_mermaid(lower(mission)))
    assert {id: label for id, label in labels.items() if id[0] == "t"} == {
        "t0": "A (at 0.3 m#47;s, within 50 s, optional)",
        "t1": "B (not before 60 s, by 90 s, priority 3)",
        "t2": "C (wait until all clear or #35;B unreadable, at most 20 s)",
        "t3": "D (wait 5 s)",
    }
    assert ("t1", "t2", "failed") in arrows
    assert ("t1", "t3", "window missed") in arrows
    assert ("r1", "t0", "repeat, up to 4 rounds, every 600 s, until #35;B #62; 7.5") in arrows
