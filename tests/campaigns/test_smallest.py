"""Tests of each campaign in its smallest size: it runs to its end, and finds no error.

The test of random machines is in `tests/argo_compiler/hfsm/test_random_missions.py`.
"""

import re
from importlib import import_module

import pytest

pytestmark = pytest.mark.long

COMMANDS = {
    "charging --missions 5": r"5 missions, \d+ reports of a low battery, .* 0 faults",
    "deletions --only people/email --generated 20": r"\d+ scripts, .* 0 swallowed",
    "fault_pairs --runs 1 --drive route": r"of \d findings 0 without a cause; 0 missions failed",
    "faults --clean 1 --drive route --site darmstadt": r"0 false alarms, 0 missions without succ",
    "faults --bricks 1 --seed 1": r"detected in 1, contacts in 0, successful all the same 1",
    "gas_leaks --leaks 2 --near-limit 0 --drives 1 --duration 60": r"false all-clears: 0 of 2 ",
    "hostile --only zeros": r"zeros .* refused\nworst: ",
    "perception --trials 1 --jobs 1": r"wrong readings: 0 of 1 \(0.0 %\) of all readings",
    "readers --count 3 --only sqlite mcap recording isar": r"sqlite +3 inputs: .*; slowest ",
    "readers --count 3 --only workbook pages": r"pages +3 inputs: .*; slowest ",
    "route_missions --sizes 3 --sheets 1 --drive route": r"predicted and driven differ by 0.00%",
    "signals --placements 1 --missions 1 --drives 1 --duration 30": r"false alarms: 0 in 1 clean",
    "storage --places 2": r"part swapped: 2 refused",
    "stairs --seeds 1 --towers west --storeys 1 --processes 1": r"west tower down +1 +1 +0 ",
}
"""pattern of the output of each command, the name of a module and its arguments"""


@pytest.mark.parametrize("command", COMMANDS)
def test_finds_no_error(command, capfd):
    name, *arguments = command.split()
    assert not import_module(f"tests.campaigns.{name}").main(arguments)
    assert re.search(COMMANDS[command], capfd.readouterr().out)
