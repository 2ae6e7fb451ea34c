"""What is said of an order is in the plan, or an error at its place: each clause, each order."""

from itertools import product

import pytest

from argo_compiler.diagnostics import DiagnosticError
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

ORDERS = {
    "measure": "Check checkpoint 4{}.",
    "measure several": "Check checkpoints 4 and 5{}.",
    "bare": "Checkpoint 4{}.",
    "keep": "Keep reading checkpoint 4{}.",
    "go": "Go to the front of the site{}.",
    "wait": "Wait 5 minutes{}.",
    "wait until": "Wait until checkpoint 1 is below 3{}.",
    "patrol": "Patrol the first floor three times{}.",
    "patrol for": "Patrol the first floor for 10 minutes{}.",
    "repeat": "Repeat step 2 three times{}.",
    "add": "Add checkpoint 4 after checkpoint 1{}.",
    "delete": "{}: delete checkpoint 1.",
    "move": "{}: move checkpoint 1 after checkpoint 2.",
    "replace": "{}: replace checkpoint 1 by checkpoint 4.",
    "jump": "{}: go to step 2.",
    "end": "End the mission{}.",
    "go on": "Go on{}.",
    "report": "Report it{}.",
    "retry": "Retry twice{}.",
    "home": "Return to the docking station{}.",
    "amend": "{}.",
    "case": "If checkpoint 1 is above 5, check checkpoint 4{}.",
    "case home": "If checkpoint 1 is above 5, return to the docking station{}.",
    "case end": "If checkpoint 1 is above 5, end the mission{}.",
    "failure": "If it fails, retry twice{}.",
    "failure home": "If it fails, return to the docking station{}.",
    "failure end": "If it fails, end the mission{}.",
    "reaction pause": "If a gas leak is detected, pause{}.",
    "reaction home": "If a gas leak is detected, return to the docking station{}.",
    "reaction report": "If a gas leak is detected, report it{}.",
    "reaction abort": "If a gas leak is detected, abort the mission{}.",
    "reaction wait": "If a gas leak is detected, wait until the danger is over{}.",
    "follow": "Do the following three times{}:\n   a) check checkpoint 4\n   b) check checkpoint 5",
}
CLAUSES = {
    "speed": "at 0.25 m/s",
    "leaving": "leaving at 0.25 m/s",
    "delay": "after 7 minutes",
    "time limit": "at most 8 minutes",
    "reading limit": "trying to read for 20 s",
    "optional": "if there is time",
    "priority": "with priority 7",
    "earliest": "not before 11 minutes after the start",
    "latest": "not later than 12 minutes after the start",
    "window": "between 11 and 12 minutes after the start",
    "times": "four times",
    "again": "again",
    "twice more": "two more times",
    "at most": "at most four times",
    "every": "every 13 minutes",
    "duration": "for 14 minutes",
    "until": "until checkpoint 2 is below 4",
    "until event": "until the danger is over",
    "finishing": "finishing the round",
    "stopping": "stopping at once",
    "interruptions": "interruptions included",
    "endless": "endlessly",
    "circles": "in circles",
    "condition": "if checkpoint 2 is above 4",
    "unless": "unless checkpoint 2 is above 4",
    "standing": "standing at x 3 y 4",
    "shown": 'shown in "Alpha"',
    "about": 'about object "pump"',
    "between": "between checkpoint 1 and checkpoint 2",
    "joints": 'with joints ["arm"] at [1.5]',
    "any order": "in any order",
    "mission time": "no more than 25 minutes in total",
    "high priority": "with high priority",
    "by importance": "by importance",
}
PLANNED_ONCE_MORE = (
    "wait",
    "wait until",
    "measure",
    "measure several",
    "bare",
    "go",
    "home",
    "add",
    "case",
)
SAME = {
    *product(("patrol", "patrol for", "repeat", "follow"), ("stopping", "circles")),
    *((order, "again") for order in PLANNED_ONCE_MORE),
}
"""what a plan has anyway: a round goes in circles and stops at once, and what is planned once more
is in it once more"""


@pytest.mark.parametrize("order", ORDERS)
def test_each_clause_is_in_the_plan_or_an_error(order, catalog):
    plain, plainly = None, set()
    unused = []
    for clause, words in {"": "", **CLAUSES}.items():
        mission, said = _planned(order, words, catalog)
        if mission is None:
            assert None not in said, (order, clause)
            continue
        if not clause:
            plain, plainly = mission, said
        elif mission == plain and said <= plainly and (order, clause) not in SAME:
            unused.append(clause)
    assert unused == []


def _planned(order, clause, catalog):
    """The mission and the codes of its warnings, or none and where the errors are."""
    said = ORDERS[order]
    line = said.format(f" {clause}" if clause else "")
    if said.startswith("{}"):
        line = said.format(clause).removeprefix(": ")
    lines = ["Start in starting area 1.", "1. Check checkpoint 1.", "2. Check checkpoint 2."]
    if line != ".":
        lines.append(f"3. {line}")
    try:
        resolved = import_whole("\n".join(lines), catalog)
    except DiagnosticError as error:
        return None, {d.span for d in error.diagnostics}
    return unplaced(resolved.mission), {d.code for d in resolved.diagnostics}
