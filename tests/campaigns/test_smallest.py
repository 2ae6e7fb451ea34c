"""Each campaign in its smallest size: it runs to its end, and finds nothing false.

That of random machines is in `tests/argo_compiler/hfsm/test_random_missions.py`.
"""

import re
from importlib import import_module

import pytest

pytestmark = pytest.mark.long

COMMANDS = {
    "fault_pairs --runs 1 --drive route": r"of \d findings 0 without a cause; 0 missions given up",
    "faults --clean 1 --drive route --site darmstadt": r"0 false alarms, 0 missions without succ",
    "faults --bricks 1 --seed 1": r"found in 1, touched in 0, the mission done all the same in 1",
    "hostile --only zeros": r"zeros .* refused\nworst: ",
    "perception --trials 1 --jobs 1": r"wrong readings: 0 of 1 \(0.0 %\) of all readings",
    "route_missions --sizes 3 --sheets 1 --drive route": r"predicted and driven differ by 0.00%",
    "signals --placements 1 --missions 1 --drives 1 --duration 30": r"false alarms: 0 in 1 clean",
    "stairs --seeds 1 --towers west --storeys 1 --processes 1": r"west tower down +1 +1 +0 ",
}
"""what is printed by each, which is the name of a module and its arguments"""


@pytest.mark.parametrize("command", COMMANDS)
def test_finds_nothing_false(command, capfd):
    name, *arguments = command.split()
    assert not import_module(f"tests.campaigns.{name}").main(arguments)
    assert re.search(COMMANDS[command], capfd.readouterr().out)
