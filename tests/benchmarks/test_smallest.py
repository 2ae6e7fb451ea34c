"""Tests of each benchmark in its smallest size: it runs to its end, and prints its table.

The test of published route problems is in `test_routes.py`.
"""

import os
import re
import sys
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
SMALL = "generated:floors=1,size=12x12,checkpoints=2,seed=1"

pytestmark = pytest.mark.long

COMMANDS = {
    "compile --sizes 20 --repeats 1 --states 10": r"20 total .*\n.* MB of text",
    "env route --window 0.005": r"Route-v0 \(vector\) +[\d,]+ steps/s",
    "env drive inspect --window 0.005": r"Drive-v0 +[\d,]+ steps/s(.|\n)* s simulated in a step",
    "evaluate --power --comparisons 20": r"a plan and itself: a difference in 0 of 20 ",
    "hfsm --events 50 --repeats 1": r"Argo +[\d,]+ +",
    f"install_sizes --python-version {PYTHON} --only": r"\| plain \| \d{3} \| ",
    "hfsm --states": r"Argo: 4 states",
    "route_parts --problems plain --count 1 --size 4 --time-limit 0.1 --only PyVRP --alone": (
        r"\nPyVRP (.|\n)*\nall but PyVRP "
    ),
    "routes_limits --sizes 4 --limits 10": r"\| 4 \| rounds \| 10 s \| [\d.]+ s \| yes \| ",
    "routes_robust --problems 1 --minutes 10 --shares 1.1 --time-limit 1": (
        r"10 min: usual \d+ readings(.|\n)*1.1 times the shortest"
    ),
    "routes_sites --missions 2 --large 0 --peer 0 --sites umad": r"2 of 2 proven",
    "startup --repeats 1 --only mission": r"argo check, a mission +[\d.]+ +[\d.]+ +[\d.]+ s",
    "tracked --laps slab --repeats 1": r"slab +[\d.]+ s in ",
    "noise mail --size 500": r"mail +[\d.]+ s +[\d.]+ x +\d+ MiB +\d+ of \d+ lines left",
    "compile --canonical 20": r"^Mission Protocol #1\n(.|\n)*\n2\. Check checkpoint ",
    "against . import --repeats 1": r"import +[\d.]+ +[\d.]+ +[\d.]+ ",
    f"drives --missions 1 --seed 12 --site {SMALL} --workers 1": r"tracked +0.00 % ",
    "env resets --count 2": r"Inspect-v0 +2 resets: ",
    "env expert --count 1 --max-way 10": r"same floor +1 of 1 reached",
    "env batches --count 1 --rounds 1": r"Inspect-v0: [\d.]+ times as many with \d+ processes",
    "evaluate --runs 2 --kinematic 0 --backend processes": r"processes +route +2 runs: ",
    f"paths --pairs 2 --site {SMALL} --large {SMALL}": r"travel times of 2 checkpoints: [\d.]+ s",
    "draft_page --lines 30 --confirm 2 --pause 0": (
        r"key to shown +[\d.]+ (.|\n)*key to stored +[\d.]+ "
    ),
    "service --tasks 10 --edits 3 --subscribers 2 --seconds 3": (
        r"2 followers of a run: (.|\n)*one reads nothing: received by all +[\d.]+ "
    ),
    "service_uploads --uploads 2 --seconds 2 --tasks 10": r"with 2 uploads at once +\d+ edits: ",
    f"service_world --site {SMALL}": r"preview with obstacles +1 parts",
}
"""pattern of the output of each command, the name of a module and its arguments"""


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.replace(SMALL, "SMALL"))
def test_runs_to_its_end(command, capfd, monkeypatch):
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("ARGO_CACHE_DIR", os.environ["ARGO_CACHE_DIR"])  # one benchmark changes it
    name, *arguments = command.split()
    import_module(f"benchmarks.{name}").main(arguments)
    assert re.search(COMMANDS[command], capfd.readouterr().out)
