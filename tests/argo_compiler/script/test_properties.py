"""Generated scripts: good ones mean what they say, broken ones never crash the compiler."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.catalog import Catalog, CheckpointKind
from tests.argo_compiler.script.conftest import findings
from tests.whole_scripts import import_whole

QUANTITY = {
    CheckpointKind.PRESSURE_GAUGE: "value on",
    CheckpointKind.VALVE: "position of",
    CheckpointKind.LIQUID_LEVEL_GAUGE: "level on",
}
numbers = st.lists(st.integers(1, 20), min_size=1, max_size=8)
CASES = st.sampled_from([str, str.upper, str.lower, str.title])


def sheet(catalog: Catalog, checkpoints: list[int]) -> str:
    lines = [
        "Mission's designation: Mission #3",
        "Main mode: supervisory",
        "Maximum total duration: 45 min",
        'Initial position: docked in "Starting area" 2',
        'End of the mission: docked in "Starting area" 1',
        "Read the checkpoints in any order:",
    ]
    for step, number in enumerate(checkpoints, start=1):
        checkpoint = catalog.checkpoint(number)
        assert checkpoint is not None
        reading = f"read the {QUANTITY[checkpoint.kind]} {checkpoint.name}"
        lines.append(f"{step}. Checkpoint #{number}: {reading}")
    return "\n".join(lines)


def measured(text: str, catalog: Catalog) -> list[int]:
    result = import_whole(text, catalog)
    assert result.diagnostics == ()
    return [int(t.object_id) for t in result.mission.tasks if t.object_id]


@given(checkpoints=numbers, case=CASES)
def test_sheets(checkpoints: list[int], case: type[str], catalog: Catalog) -> None:
    assert measured(case(sheet(catalog, checkpoints)), catalog) == checkpoints


@given(edits=st.lists(st.tuples(st.integers(0, 9), st.booleans(), st.booleans()), max_size=12))
def test_protocols_with_edits(edits: list[tuple[int, bool, bool]], catalog: Catalog) -> None:
    """The plan is that of a plain list on which the same edits are made."""
    plan = [20]
    unused = list(range(1, 20))
    lines = ["Mission Protocol", "Set a starting point in starting area 1", "Check checkpoint #20"]
    for pick, delete, before in edits:
        anchor = plan[pick % len(plan)]
        if delete and len(plan) > 1:
            plan.remove(anchor)
            unused.append(anchor)
            lines.append(f"Delete the measuring of checkpoint #{anchor}")
        else:
            new = unused.pop(0)
            plan.insert(plan.index(anchor) + (not before), new)
            side = "before" if before else "after"
            lines.append(f"Add checkpoint #{new} {side} checkpoint #{anchor}")
    assert measured("\n".join(lines), catalog) == plan


GOOD = """\
Mission Protocol #2
1. Set a starting point in front of the site
2. Patrol the first floor in circles for 10 minutes
3. Check checkpoint #14 and add checkpoint #2 before checkpoint #14
4. Return to the docking station in starting area 1; done!
"""
PIECES = st.sampled_from(
    [
        *("\t", "\n", " ", "", "\x00", "\u2028", "\ufeff"),
        *("'", "**", "#", ":", "²", "٣", "İ", "§", "-"),
        *("1", "999999999999", "R25", "starting area", "hint:"),
        *("and", "or", "check", "for", "the", "done"),
    ]
)


@st.composite
def mutations(draw: st.DrawFn, text: str) -> str:
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(text)))
        end = min(len(text), at + draw(st.integers(0, 12)))
        text = text[:at] + draw(PIECES | st.text(max_size=4)) + text[end:]
    return text


def assert_handled(text: str, catalog: Catalog) -> None:
    """Whatever it is, it is a mission or a message; every place lies in the text."""
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for finding in findings(text, catalog):
        if finding.span is not None:
            line = lines[finding.span.line - 1]
            assert 1 <= finding.span.column <= len(line) + 1
            assert finding.span.column + finding.span.length <= len(line) + 2


@settings(max_examples=300)
@given(text=mutations(GOOD))
def test_mutated_protocols(text: str, catalog: Catalog) -> None:
    assert_handled(text, catalog)


@settings(max_examples=300)
@given(data=st.data())
def test_mutated_sheets(data: st.DataObject, catalog: Catalog, missions: Path) -> None:
    good = (missions / "mission_1.txt").read_text().replace("1 or 2", "1")
    assert_handled(data.draw(mutations(good)), catalog)


@given(text=st.text(max_size=200))
def test_any_text(text: str, catalog: Catalog) -> None:
    assert_handled("Mission Protocol\n" + text, catalog)
    assert_handled("Main mode: autonomous\n" + text, catalog)


@pytest.mark.parametrize(
    "text",
    [
        "Mission Protocol\n" + "a " * 500_000,
        "Mission Protocol\n" + ("done; " * 330 + "\n") * 100,
        "Mission Protocol\n" + ("Patrol floor 1 for " + "1 h " * 490 + "\n") * 300,
        "Main mode: autonomous\nInitial position: starting\n" + "word word\n" * 15_000,
        "Main mode: autonomous\n" + "q\t" * 400_000,
        "Main mode: autonomous\n" + "q\tq\n" * 5_000,
    ],
    ids=["one line", "commands", "durations", "long cell", "tabs", "cuts"],
)
def test_hostile_scripts_are_handled(text: str, catalog: Catalog) -> None:
    assert_handled(text, catalog)
