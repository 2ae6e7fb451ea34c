"""Wrong command lines that people may type: each error is named with its place; no file changes."""

import json
import re
import shlex
import sys
from pathlib import Path

import pytest

SCRIPT = """\
Mission Protocol #1
1. Set the starting point in starting area 1.
2. Check checkpoint #1.
3. Check checkpoint #4.
"""
MISSION = """\
{
 "version": 2,
 "tasks": [
  {"name": "A", "action": "MEASURE", "object_id": "1", "transitions": [{"target": "B"}]},
  {"name": "B", "action": "MEASURE", "object_id": "4"}
 ]
}
"""


def faults(line: str) -> str:
    return f"faults:\n  - kind: {line}\n"


FILES: dict[str, str | bytes] = {
    "s.txt": SCRIPT,
    "my mission.txt": SCRIPT,
    "m.json": MISSION,
    "taken.json": "{}",
    "taken.yaml": "mine\n",
    "folder/mine.txt": "mine\n",
    "out/report.json": json.dumps({"version": 4, "mission": {}, "result": {}, "trace": []}),
    "out/report.html": "<html></html>",
    "machine.json": '{"composites": [], "initial": "A", "leaves": [], "events": []}',
    "service.plan": '00000000 {"n":0,"format":"argo plan","version":1}\n',
    # documents
    "mission.docx": b"PK\3\4\x14\0\0\0\0\0\0\0!\0",
    "mission.pdf": b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n1 0 obj\n",
    "photo.png": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1",
    "photo.jpg": b"\xff\xd8\xff\xe0\0\x10JFIF\0\1\1\0",
    "notes.rtf": "{\\rtf1\\ansi\\f0 Mission Protocol #1\\par\n}\n",
    "latin1.txt": "Prüfung\n".encode("latin-1"),
    "letter.txt": "Dear team,\nplease inspect gauge 1 tomorrow.\nRegards\n",
    "mission.bag": b"not a bag",
    # scripts
    "any.txt": SCRIPT.replace("\n", "\nOrder: any\n", 1),
    "elsewhere.txt": SCRIPT.replace("\n", '\nSite: "darmstadt"\n', 1),
    "ninety-nine.txt": SCRIPT.replace("#4", "#99"),
    "mismatch.txt": SCRIPT.replace("#4", "#4: read the value on pressure gauge 5"),
    "step9.txt": SCRIPT.replace("#1.", "#1. If the value is above 7 bar, skip to step 9."),
    "clock.txt": SCRIPT.replace("\n", "\nMaximum duration: 12:30\n", 1),
    # missions
    "key.json": MISSION.replace("object_id", "objekt_id", 1),
    "action.json": MISSION.replace("MEASURE", "MEASUR", 1),
    "comma.json": MISSION.replace('"4"}', '"4"},'),
    "target.json": MISSION.replace('"target": "B"', '"target": "C"'),
    "quotes.json": MISSION.replace('"', "'"),
    "comment.json": "// mine\n" + MISSION,
    "number.json": MISSION.replace('"4"', '"99"'),
    "future.json": MISSION.replace('"version": 2', '"version": 5'),
    "twins.json": MISSION.replace('"name": "B"', '"name": "A"'),
    "minus.json": MISSION.replace('2,\n "tasks"', '2, "max_duration": -5,\n "tasks"'),
    # faults
    "field.yaml": faults("hot_spot\n    tempreature: 90"),
    "minutes.yaml": faults("gas_leak\n    at: 1min"),
    "backwards.yaml": faults("gas_leak\n    at: 100\n    until: 20"),
    "flat.yaml": faults("gas_leak\n    place: [9.0, 3.5]"),
    "far.yaml": faults("gas_leak\n    place: [900, 3.5, 0.8]"),
    "seventy.yaml": faults("abnormal_value\n    checkpoint: 77"),
    "floor9.yaml": faults("brick\n    floor: 9"),
    "shadow9.yaml": faults("connection_loss\n    floor: 9"),
    "nan.yaml": faults("gas_leak\n    rate: .nan"),
    "percent.yaml": faults("low_battery\n    charge: 20"),
    "twice.yaml": faults("gas_leak\n    at: 10\n    at: 20"),
    "indent.yaml": "faults:\n- kind: gas_leak\n    at: 20\n",
    "kindless.yaml": "faults:\n  - at: 20\n",
    "bare.yaml": "- kind: gas_leak\n  at: 20\n",
    "none.yaml": "faults:\n",
    "brick.yaml": faults("brick\n    floor: 1"),
    # requirements
    "budgett.yaml": "budgett: 20 min\n",
    "soon.yaml": "budget: soon\n",
    "before.yaml": "before: 8, 4\n",
    "window.yaml": "windows:\n- {what: 1, earliest: 10 min, latest: 5 min}\n",
    "likely.yaml": "likelihoods:\n- {task: A, target: B, probability: 1.5}\n",
    "priority.yaml": "optional:\n- {what: 4, priority: -3}\n",
    "list.yaml": "- before: [8, 4]\n",
    "braces.yaml": '{"budget": 20 min, }}\n',
    "maybe.yaml": "keep_order: maybe\n",
    "unknown.yaml": "mandatory: [99]\n",
    # other kinds of files
    "titel.yaml": "name: bad\ntitel: Bad\n",
    "list.json": "[1, 2]",
    "config.json": '{"name": "my project"}',
    "broken.json": '{"tasks": [',
    "faults.yaml": "faults:\n  - kind: low_battery\n    at: 10\n",
    "fire.yaml": "faults:\n  - kind: fire\n",
    "tabs.yaml": "faults:\n\t- kind: fire\n",
    "page.html": "<html><body>Hello</body></html>\n",
    "empty": "",
}

IN_ERRORS = {
    # misspelt
    "rum s.txt": "rum",
    "launch s.txt": "launch",
    "run s.txt --sed 3": "--sed",
    "run s.txt --report-dir out": "--report-dir",
    "run s.txt -o out": "-o",
    "check s.txt --format jsno": "jsno",
    "export s.txt --to mermiad -o d.mmd": "mermiad",
    "run s.txt --drive Kinematic": "Kinematic",
    "run s.txt --sensor cam": "cam",
    "run s.txt --sensor nose": "no sensor `nose`",
    "run s.txt --site UMAD": "UMAD",
    "run s.txt --site atlantis": "umad",
    "check s.txt --site darmstad": "darmstad",
    "schema missions": "missions",
    "-version": "No such option",
    "help": "did you mean --help?",
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
    # files for results
    "run no.txt --report new": "no.txt",
    "run s.txt --report a/new --faults fire.yaml": "fire.yaml:2:",
    "route s.txt --budget 1s --pictures new": "",
    "run s.txt --report s.txt": "folder",
    "run s.txt --report s.txt/new": "s.txt/new can't be made a folder",
    "import s.txt -o s.txt": "input",
    "import s.txt -o no/such/folder/n.json": "n.json",
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
    "run s.txt --site titel.yaml": "titel.yaml:2:1",
    "import m.json -o n.json": "m.json is a mission already",
    "import broken.json -o n.json": "is not JSON",
    "import s.txt -o n.txt": "n.txt",
    "run s.txt --record r.mp4": "r.mp4",
    "run s.txt --render r.mcap": "r.mcap",
    "run s.txt --render film.avi": ".mp4",
    "sites darmstadt -o site.json": "site.json",
    # values, units, empty and huge ones
    "run s.txt --seed -1": "--seed",
    "run s.txt --seed 1.5": "--seed",
    "run s.txt --seed x": "seed",
    "run s.txt --value 1": "ID=VALUE",
    "run s.txt --value 1=4.2bar": "4.2bar",
    "run s.txt --value gauge=3": "gauge",
    "run s.txt --value 1=11": "0 to 10 bar",
    "run s.txt --value 1=1e99": "1e+99",
    "run s.txt --value 77=1": "has no checkpoint 77; there are: 1 to 20",
    "run s.txt --event gas_leak": "gas_leak",
    "run s.txt --event 60s=gas_leak": "60s",
    "run s.txt --event 60=gasleak": "gasleak",
    "run s.txt --event -5=gas_leak": "-5",
    "run s.txt --event 10=time_up": "time_up",
    "run s.txt --start-area 2": "area",
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
"""words that standard error must have, by command line"""

IN_OUTPUT = {
    # documents, pictures and other people's files as scripts
    "run mission.docx": "mission.docx is no mission, but a damaged ZIP archive",
    "check mission.pdf": "mission.pdf is a document (PDF) that is damaged",
    "run photo.png": "photo.png is no mission, but a picture (PNG)",
    "import photo.jpg -o n.json": "photo.jpg is no mission, but a picture (JPEG)",
    "run notes.rtf": "notes.rtf is no mission, but a document (RTF): save it as plain text",
    "check latin1.txt": "latin1.txt: error: the file is not UTF-8 (byte 3, line 1)",
    "run letter.txt": "letter.txt:2:16: error: `gauge 1` can be read as",
    "run mission.bag": "mission.bag: error: the file is not a bag",
    "run folder": "folder: error: the path is a directory",
    "run .": "directory",
    # results as scripts
    "run out": "out: error: the path is a directory",
    "run out/report.json": "out/report.json: error: the file is the report of a run, not a mission",
    "run out/report.html": "out/report.html is no mission, but a web page (HTML)",
    "check taken.yaml": "taken.yaml is no mission, but YAML, in which sites, faults",
    "check out/run.journal": "hint: argo resume out/run.journal",
    "check machine.json": "the file is not a mission: it has 'composites', but no 'tasks'",
    "explain service.plan": "service.plan is a plan of the planning service, which exports",
    "run out/run.journal": "is the journal of a run, not a mission (argo resume out/run.journal)",
    "run run.mcap": "run.mcap is the recording of a run, not a mission (argo replay run.mcap)",
    # scripts and missions with a mistake
    "run ninety-nine.txt": "ninety-nine.txt:4:10: error: there is no checkpoint #99",
    "compile ninety-nine.txt -o c.json --mermaid c.mmd": "ninety-nine.txt:4:10:",
    "run mismatch.txt": "mismatch.txt:4:43: error: checkpoint #4 is valve R25",
    "run step9.txt": "step9.txt:3:62: error: there is no step 9",
    "run clock.txt": "`12:30` can be read as 12 min 30 s or as 12 h 30 min",
    "run elsewhere.txt": "choose it with --site darmstadt",
    "check key.json": "is `object_id` meant?",
    "run action.json": "'START', 'WAYPOINT', 'MEASURE' or 'WAIT'",
    "run comma.json": "comma.json:5:55: error: the file is not JSON: Illegal trailing comma"
    if sys.version_info >= (3, 13)
    else "comma.json:6:2: error: the file is not JSON",
    "run target.json": "leads to 'C', which is not a task",
    "run quotes.json": "quotes.json:2:2: error: the file is not JSON",
    "check comment.json": "comment.json:1:1: error: the file is not JSON",
    "run number.json": "names checkpoint '99'",
    "check future.json": "future.json:2:2: error: the file has version 5",
    "run twins.json": "more than one task is named 'A'",
    "run minus.json": "max_duration: input should be greater than 0",
    # options for commands
    "version": "did you mean --version?",
    "verbose run s.txt": "did you mean --verbose?",
    # files of faults
    "run s.txt --faults field.yaml": "is `temperature` meant?",
    "run s.txt --faults minutes.yaml": "minutes.yaml:3:9: error: faults[0].at: `at` has",
    "run s.txt --faults backwards.yaml": "it ends at 20 s, but begins at 100 s; it must end later",
    "run s.txt --faults flat.yaml": "`place[2]` is missing",
    "run s.txt --faults far.yaml": "there is no equipment at (900, 3.5, 0.8)",
    "run s.txt --faults seventy.yaml": "has no checkpoint 77; there are: 1 to 20",
    "run s.txt --faults floor9.yaml": "has no floor 9; there are: 1 to 6",
    "run s.txt --faults shadow9.yaml": "has no floor 9; there are: 1 to 6",
    "run s.txt --faults nan.yaml": "`rate` has to be a finite number",
    "run s.txt --faults percent.yaml": "`charge` has to be at most 1",
    "run s.txt --faults twice.yaml": "`at` is given twice; it was first given at line 3",
    "run s.txt --faults indent.yaml": "indent.yaml:3:7: error: the file is not YAML",
    "run s.txt --faults kindless.yaml": "it has no `kind`",
    "run s.txt --faults bare.yaml": "begin with `faults:`",
    "run s.txt --faults none.yaml": "begin with `faults:`",
    "run s.txt --drive route --faults brick.yaml": "choose another drive",
    "run s.txt --faults folder": "folder can't be read: it is a directory",
    "run s.txt --faults gas_leak": "gas_leak can't be read: it does not exist",
    # requirements of a route
    "route any.txt --requirements budgett.yaml": "is `budget` meant?",
    "route any.txt --requirements soon.yaml": "soon.yaml:1:9: error: budget: `soon` is not a "
    "duration",
    "route any.txt --requirements before.yaml": "`before` has to be a list",
    "route any.txt --requirements window.yaml": "latest 300 s is not after earliest 600 s",
    "route any.txt --requirements likely.yaml": "`probability` has to be at most 1",
    "route any.txt --requirements priority.yaml": "`priority` has to be at least 1",
    "route any.txt --requirements list.yaml": "list.yaml:1:1: error:",
    "route any.txt --requirements braces.yaml": "braces.yaml:1:21: error: the file is not YAML",
    "route any.txt --requirements maybe.yaml": "`keep_order` has to be true or false",
    "route any.txt --requirements unknown.yaml": "the mission has no checkpoint 99",
    "route any.txt --before 1,4 --before 4,1": "no order meets all of these",
    # numbers, times and durations
    "route any.txt --budget NaN": "`NaN` is not a duration: write `20 min`",
    "route any.txt --budget 20:00": "`20:00` can be read as 20 min 0 s or as 20 h 0 min",
    "route any.txt --budget '20 minuts'": "`20 minuts` is not a duration",
    "route any.txt --budget 20 minutes": "unexpected extra argument(s) (minutes)",
    "route any.txt --budget 1s --pictures new": "nothing fits within the budget 1 s",
    "route any.txt --before 4,4": "nothing comes before itself",
    "route any.txt --before '1;4'": 'such as --before "8, 4"',
    "route any.txt --time-limit soon": "'--time-limit': `soon` is not a duration",
    "route any.txt --robust": "give it a budget",
    "run s.txt --seed -3": "'--seed': it has to be at least 0",
    "run s.txt --seed 1e3": "'--seed': it has to be a whole number",
    "run s.txt --start-area 2,1": "'--start-area': it has to be a whole number",
    "run s.txt --value 1:4.2": "write ID=VALUE, such as 8=4.2",
    "run s.txt --value 1=4,2": "write ID=VALUE, such as 8=4.2",
    "run s.txt --value 1=nan": "write ID=VALUE, such as 8=4.2",
    "run s.txt --value 1=3 --value 1=4": "checkpoint 1 has been given a value already",
    "run s.txt --event 1:00=gas_leak": "write TIME=KIND in s",
    "run s.txt --event gas_leak=60": "write TIME=KIND in s",
    "run s.txt --event ' 60 = gas-leak '": "no event `gas-leak`",
    "sites 'generated:floors=3;seed=7'": "floors can't be `3;seed=7`",
    # stored runs
    "resume out": "out is a folder; name the journal in it: out/run.journal",
    "resume out/report.json": "out/report.json is not a journal",
    "resume head.journal --report new": "head.journal is not a journal, or its first line is "
    "damaged",
    "resume damaged.journal": "damaged.journal is damaged from line 6 on",
    "resume run.journal --report out": "out/report.json already exists",
    "resume run.journal --event 500=gas_leak": "the run has ended",
    "replay run.journal": "run.journal is not an .mcap file",
    "replay cut.mcap --report new": "cut.mcap has no record of the run",
    "replay cut.mcap --render new.gif": "cut.mcap has no record of the run",
    # files for results
    "run s.txt --report out": "out/report.json already exists",
    "run s.txt --report out/report.html --force": "out/report.html is a file, but a folder",
    "run s.txt --report new --drive car": "no drive `car`; there are: route, kinematic, tracked",
    "run s.txt -report new": "there is no option -report; did you mean --report?",
    "run s.txt --render run": "a film is an .mp4 or a .gif",
    "run s.txt --record missing/run.mcap": "folder missing does not exist",
    "run s.txt --record x.mcap --journal x.mcap": "x.mcap is to be written twice",
    "run s.txt --journal run.journal": "run.journal already exists",
    "format s.txt -o s.txt --force": "s.txt is the input as well",
    "import s.txt -o folder/ --force": "folder is a folder",
    "import s.txt -o m.json/n.json": "m.json is a file, not a folder",
    "export m.json --to ros2-bag -o s.txt --force": "s.txt is a file, but a folder is needed",
    "sites darmstadt -o taken.yaml": "taken.yaml already exists",
    # names with blanks, typographic quotation marks and dashes
    "run my mission.txt": "unexpected extra argument(s) (mission.txt)",
    "run “s.txt”": "“s.txt” can't be read: it does not exist",
    "run s.txt —report new": "unexpected extra argument(s) (—report new)",
}
"""words that output or standard error must have, by command line"""


@pytest.fixture(scope="module")
def folder(argo, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the files, a journal and a recording, and damaged copies of both."""
    folder = tmp_path_factory.mktemp("files")
    for name, content in FILES.items():
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
    options = "--drive route --journal run.journal --record run.mcap"
    assert argo("run", "s.txt", *options.split(), cwd=folder).returncode == 0
    journal, recording = (folder / name for name in ("run.journal", "run.mcap"))
    lines = journal.read_bytes().splitlines(keepends=True)
    (folder / "out" / "run.journal").write_bytes(journal.read_bytes())
    (folder / "head.journal").write_bytes(lines[0][:20])
    (folder / "damaged.journal").write_bytes(b"".join([*lines[:5], b"#", *lines[5:]]))
    whole = recording.read_bytes()
    (folder / "cut.mcap").write_bytes(whole[: len(whole) * 2 // 3])
    return folder


def contents(folder: Path) -> dict[str, bytes | None]:
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
    }


INCOMPLETE = {"letter.txt", "ninety-nine.txt", "mismatch.txt", "step9.txt", "clock.txt"}
"""scripts with a line that has to be answered"""

# Without PyBullet, most runs are refused for that reason first.
LINES = [
    pytest.param(line, marks=pytest.mark.physics)
    if line.startswith("run ") or "--render" in line
    else line
    for line in (*IN_ERRORS, *IN_OUTPUT)
]


@pytest.mark.parametrize("line", LINES)
def test_wrong_commands_name_their_error_and_change_no_file(argo, folder: Path, line: str) -> None:
    before = contents(folder)
    result = argo(*shlex.split(line), cwd=folder)
    error, output = (
        re.sub(r"\s+", " ", re.sub("[│╭╮╰╯─]", " ", text))
        for text in (result.stderr, result.stdout)
    )
    assert result.returncode == (3 if INCOMPLETE & {*shlex.split(line)} else 2), error + output
    assert "Traceback" not in error + output
    assert IN_ERRORS[line] in error if line in IN_ERRORS else IN_OUTPUT[line] in error + output
    assert contents(folder) == before
    assert max(map(len, result.stderr.splitlines()), default=0) < 400


def test_a_recording_that_breaks_off_is_shown_up_to_there(argo, folder: Path) -> None:
    before = contents(folder)
    result = argo("replay", "cut.mcap", cwd=folder, status=1)
    assert "Tasks that have ended: 1; the last: MEASURE 1 (done)." in result.stdout
    assert "the recording breaks off after" in result.stdout
    assert contents(folder) == before
