"""A line that stands again in a script says the same at its new place, and one that differs in its
figures only says what it would say by itself."""

import random
import re
from itertools import chain

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import LineState, import_script, parse
from argo_compiler.script.parsing.repeats import repeats
from argo_compiler.script.parsing.script import Script
from tests.argo_compiler.script.conftest import CATALOG, measured_in
from tests.campaigns.fuzz.sentences import english_generator, text_of
from tests.whole_scripts import import_whole

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
    mission = import_whole("\n".join(lines), CATALOG).mission
    spans = [task.source for task in mission.tasks if task.source is not None]
    assert {(span.line, span.column) for span in spans} >= {(2, 4), (3, 4), (4, 5)}


def test_an_error_in_what_is_said_twice_is_said_at_both_places() -> None:
    script = parse("1. Start in starting area 1.\n2. Check #1.\n3. Go to #x.\n4. Go to #x.", PLACES)
    lines = [d.span.line for d in script.diagnostics if d.span is not None]
    assert {3, 4} <= set(lines)


FIGURED = [
    *LINES,
    'Go to (12.50, 3.25, 0) heading 270 degrees at 0.4 m/s, then "look 27": check #27.',
    "Patrol floor 2 in circles for 25 minutes and 30 seconds, at most 12 times.",
    "Check #12; if it is above 75.5 bar, skip to step 27.",
    "Check checkpoint #23. If the value is between 20 and 35, go to step 2; otherwise go on.",
    "Measure checkpoint #5, retry 3 times, with priority 2.",
    "Wait 2 h 15, then check checkpoints 2 to 7, but not checkpoint 4.",
    "Check the 2 valves on floor 3.",
    "If the battery drops below 25 %, return to the docking station.",
    'Go to (1, 2, 0), with joints ["arm 1", "arm 2"] at [0.5, -1] velocities [0.1, 0.1].',
]


def _others(line: str, draw: random.Random) -> str:
    """The line with other figures, each with as many digits."""
    return re.sub("[0-9]", lambda digit: draw.choice(f"{digit[0]}23456789"), line)


def _alone(lines: list[str]) -> Script:
    """The script of the last of the lines, none of the others known."""
    fill = ["Check checkpoint #9.".ljust(len(line)) for line in lines[:-1]]
    repeats.cache_clear()
    return _script([*fill, lines[-1]])


def _script(lines: list[str]) -> Script:
    text = "\n".join(f"{100 + k}. {line}" for k, line in enumerate(lines))
    return parse(f"Start in starting area 1.\n\n{text}\n", PLACES)


def _is_same_with_other_figures(line: str, draw: random.Random) -> None:
    lines = [line, *(_others(line, draw) for _ in range(4))]
    repeats.cache_clear()
    found, alone = _script(lines), _alone(lines)
    assert found.steps[-1] == alone.steps[-1], lines
    last = len(lines) + 2
    here = [d for d in found.diagnostics if d.span is not None and d.span.line == last]
    assert here == [d for d in alone.diagnostics if d.span is not None and d.span.line == last]


@pytest.mark.parametrize("line", FIGURED)
def test_a_line_says_the_same_of_other_figures(line: str) -> None:
    draw = random.Random(line)
    for _ in range(10):
        _is_same_with_other_figures(line, draw)


def test_made_sentences_say_the_same_of_other_figures() -> None:
    draw = random.Random(7)
    makes = english_generator(draw)
    lines = (f"{text_of(makes.sentence())}." for _ in range(400))
    for line in lines:
        # Lines of several fields are rows of a sheet, and what `within` counts from hangs on
        # whether a task stands above.
        other = any(part in line for part in ("\n", ";,", " within "))
        if any(sign.isdigit() for sign in line) and not other:
            _is_same_with_other_figures(line, draw)


def test_a_number_in_the_name_of_a_place_is_no_figure() -> None:
    lines = ["Go to dock 3.", "Go to dock 5.", "Go to dock 6.", "Go to dock 7."]
    text = "\n".join(["Check #1.", *(f"{k}. {line}" for k, line in enumerate(lines, 2))])
    repeats.cache_clear()
    last = parse(text, [*PLACES, "dock 7"]).steps[-1]
    repeats.cache_clear()
    head = "\n".join(["Check #1.", *(f"{k}. Check checkpoint #1." for k in range(2, 5))])
    assert last == parse(f"{head}\n5. Go to dock 7.", [*PLACES, "dock 7"]).steps[-1]


def test_a_number_alone_says_nothing_for_other_scripts(catalog: Catalog) -> None:
    """In a list it is a checkpoint; on a line of its own it can be a page's number as well."""
    repeats.cache_clear()
    known = import_script("Start in starting area 1.\n- 1\n- 3\n- three", catalog)
    assert measured_in(known.require_mission()) == ["1", "3", "3"]
    for number in ("3", "three"):
        text = f"Start in starting area 1.\nPressure gauges\n1\n{number}"
        draft = import_script(text, catalog)
        assert [line.text for line in draft.lines if line.state is LineState.OPEN] == [number]
