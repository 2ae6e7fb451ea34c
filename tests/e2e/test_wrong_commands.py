"""Command lines as a newcomer gets them wrong: each is answered with what is wrong and where."""

import json
import re
import shlex
from pathlib import Path

import pytest

SCRIPT = (
    "Mission Protocol #1\n1. Set the starting point in starting area 1.\n2. Check checkpoint #1.\n"
)
MISSION = {"version": 2, "tasks": [{"name": "A", "action": "MEASURE", "object_id": "1"}]}
FILES = {
    "s.txt": SCRIPT,
    "m.json": json.dumps(MISSION),
    "list.json": "[1, 2]",
    "config.json": '{"name": "my project"}',
    "broken.json": '{"tasks": [',
    "faults.yaml": "faults:\n  - kind: low_battery\n    at: 10\n",
    "fire.yaml": "faults:\n  - kind: fire\n",
    "tabs.yaml": "faults:\n\t- kind: fire\n",
    "page.html": "<html><body>Hello</body></html>\n",
    "empty": "",
}

WRONG = {
    # misspelt
    "rum s.txt": "rum",
    "run s.txt --sed 3": "--sed",
    "run s.txt --report-dir out": "--report-dir",
    "run s.txt -o out": "-o",
    "check s.txt --format jsno": "jsno",
    "export s.txt --to mermiad -o d.mmd": "mermiad",
    "run s.txt --drive Kinematic": "Kinematic",
    "run s.txt --sensor cam": "cam",
    "run s.txt --site UMAD": "UMAD",
    "check s.txt --site darmstad": "darmstad",
    "schema missions": "missions",
    "-version": "No such option",
    "help": "is --help meant?",
    # missing
    "run": "SCRIPT|MISSION",
    "check": "SCRIPT|MISSION",
    "import s.txt": "--output",
    "compile s.txt": "--output",
    "export s.txt -o d.mmd": "--to",
    "export s.txt --to dot": "--output",
    "resume": "JOURNAL",
    "replay": "RECORDING",
    "run s.txt --report": "--report",
    "run no.txt": "no.txt",
    "run s.txt --faults no.yaml": "no.yaml",
    "route s.txt --requirements no.yaml": "no.yaml",
    "resume no.journal": "no.journal",
    "replay no.mcap": "no.mcap",
    "sites no.yaml": "no.yaml",
    # swapped, or one too many
    "s.txt run": "s.txt",
    "run umad s.txt": "s.txt",
    "run s.txt m.json": "m.json",
    "import m.json s.txt -o n.json": "s.txt",
    "replay s.txt": "s.txt",
    "resume s.txt": "s.txt",
    "run s.txt --site s.txt": "s.txt",
    "run s.txt --faults s.txt": "s.txt",
    "sites m.json": "m.json",
    "run faults.yaml": "faults.yaml",
    # places for results
    "run no.txt --report new": "no.txt",
    "run s.txt --report a/new --faults fire.yaml": "fire.yaml:2:",
    "route s.txt --budget 1s --pictures new": "",
    "run s.txt --report s.txt/new": "s.txt/new: can't be made a folder",
    "run s.txt --report x.mcap --record x.mcap": "x.mcap is to be written twice",
    # files of the wrong kind
    "run list.json": "list.json",
    "run config.json": "config.json",
    "run broken.json": "broken.json:1:",
    "run page.html": "page.html",
    "run empty": "empty",
    "run s.txt --faults fire.yaml": "fire.yaml:2:",
    "run s.txt --faults tabs.yaml": "tabs.yaml:2:",
    "route s.txt --requirements faults.yaml": "faults.yaml:1:",
    "run s.txt --site faults.yaml": "faults.yaml:1:",
    "import m.json -o n.json": "m.json",
    "import s.txt -o n.txt": "n.txt",
    "run s.txt --record r.mp4": "r.mp4",
    "run s.txt --render r.mcap": "r.mcap",
    "sites darmstadt -o site.json": "site.json",
    # values, units, empty and huge ones
    "run s.txt --seed -1": "--seed",
    "run s.txt --seed 1.5": "--seed",
    "run s.txt --value 1": "ID=VALUE",
    "run s.txt --value 1=4.2bar": "4.2bar",
    "run s.txt --value gauge=3": "gauge",
    "run s.txt --value 1=1e99": "1e+99",
    "run s.txt --value 77=1": "has no checkpoint 77; there are: 1 to 20",
    "run s.txt --event gas_leak": "gas_leak",
    "run s.txt --event 60s=gas_leak": "60s",
    "run s.txt --event 60=gasleak": "gasleak",
    "run s.txt --event -5=gas_leak": "-5",
    "run s.txt --event 10=time_up": "time_up",
    "run s.txt --start-area 7": "7",
    "run s.txt --start-area one": "--start-area",
    "run m.json --start-area 1": "m.json",
    "run s.txt --pace 2": "--gui",
    "run s.txt --site ''": "site",
    "run s.txt --drive ''": "drive",
    "run ''": "an argument is empty",
    "run s.txt --report ''": "--report: its value is empty",
    "run s.txt --report=": "--report: its value is empty",
    "import s.txt -o ''": "-o: its value is empty",
    "route s.txt --budget 'a while'": "a while",
    "route s.txt --budget -5min": "-5min",
    "route s.txt --before 1": "--before",
    "route s.txt --before 1,77": "77",
    "route s.txt --time-limit 0": "--time-limit",
    "route s.txt --risk high": "high",
    "sites generated:floors=99": "floors",
    "sites generated:storeys=3": "storeys",
    "run s.txt --site generated:seed=x": "seed",
}
"""By command line: what its answer names."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wrong")
    for name, content in FILES.items():
        (folder / name).write_text(content, encoding="utf-8")
    return folder


@pytest.mark.parametrize("line", WRONG)
def test_what_is_wrong_is_named_and_nothing_is_touched(argo, folder: Path, line: str) -> None:
    result = argo(*shlex.split(line), cwd=folder)
    said = re.sub(r"\s+", " ", re.sub("[│╭╮╰╯─]", " ", result.stderr))
    assert result.returncode == 2, result.stdout + said
    assert "Traceback" not in said + result.stdout
    assert WRONG[line] in said
    assert {p.name: p.read_text(encoding="utf-8") for p in folder.iterdir()} == FILES
