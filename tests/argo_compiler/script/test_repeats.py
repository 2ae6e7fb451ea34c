"""A line that stands again in a script says the same at its new place."""

from itertools import chain

import pytest

from argo_compiler.script import import_script, parse
from tests.argo_compiler.script.conftest import CATALOG

PLACES = [place.name for place in CATALOG.places]
LINES = [
    "Check checkpoint #4; if it is above 5, check checkpoint #8 twice.",
    "Go to (1.5, 2, 0) at 0.3 m/s, then check valve R25 and checkpoints 1 to 3.",
    "Check checkpoint #1. If it is between 2 and 3 bar or abnormal, wait 10 minutes.",
    "Patrol the first floor until a gas leak is detected.",
    "Check checkpoint #4. If it cannot be read, go on; otherwise check all valves.",
    "Prüfe Manometer 5.",
]


@pytest.mark.parametrize("line", LINES)
def test_a_line_said_again_is_what_it_is_by_itself(line: str) -> None:
    head = "Start in starting area 1.\n\n"
    again = parse(f"{head}100. {line}\n2. {line}\n", PLACES).steps[-1]
    # A line of its own length that asks for something else stands where the first one did.
    other = "Check checkpoint #9.".ljust(len(line))
    alone = parse(f"{head}100. {other}\n2. {line}\n", PLACES).steps[-1]
    assert again == alone


def test_what_is_said_twice_points_at_both_places() -> None:
    lines = chain(["1. Start in starting area 1."], (f"{k}. Check #4 and #1." for k in (2, 3, 10)))
    mission = import_script("\n".join(lines), CATALOG).mission
    spans = [task.source for task in mission.tasks if task.source is not None]
    assert {(span.line, span.column) for span in spans} >= {(2, 4), (3, 4), (4, 5)}


def test_an_error_in_what_is_said_twice_is_said_at_both_places() -> None:
    script = parse("1. Start in starting area 1.\n2. Check #1.\n3. Go to #x.\n4. Go to #x.", PLACES)
    lines = [d.span.line for d in script.diagnostics if d.span is not None]
    assert {3, 4} <= set(lines)
