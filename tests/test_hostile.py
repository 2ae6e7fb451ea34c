"""Input far larger than any mission needs bounded memory and time, and gets a proper answer.

Each case runs in a process of its own whose memory and processor time the system limits.
"""

import json
import multiprocessing
import resource
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from argo_compiler.analysis import analyse
from argo_compiler.base.errors import ArgoError
from argo_compiler.files.mission_file import read_mission
from argo_compiler.hfsm import Executor, lower
from argo_compiler.il import Mission
from argo_compiler.script import format_script, read_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.hostile import MEMORY_BYTES, Json, condition, measure, mission, transition
from tests.conftest import examples
from tests.whole_scripts import import_whole

pytestmark = pytest.mark.long

CPU_SECONDS = 120

PROCESSES = multiprocessing.get_context("spawn")


def everything(mission: Mission) -> Mission:
    executor = Executor(lower(mission))
    executor.start(0.0)
    executor.progress()
    analyse(mission, CATALOG)
    return import_whole(format_script(mission, CATALOG), CATALOG).mission


def read_within_limits(path: Path, answers: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
    try:
        if path.suffix == ".json":
            everything(read_mission(path))
        else:
            everything(import_whole(read_script(str(path)), CATALOG).mission)
        answers.send("mission")
    except ArgoError as error:
        answers.send(f"refused {str(error)[-400:]}")


def answer(path: Path, content: str) -> str:
    """Write a file with this content, and return the answer of a limited process that reads it."""
    path.write_text(content, encoding="utf-8")
    answers, sending = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=read_within_limits, args=(path, sending))
    process.start()
    sending.close()
    try:
        said = answers.recv() if answers.poll(600) else "nothing within 600 s"
    except EOFError:
        said = "nothing"
    process.join(10)
    assert process.exitcode == 0, said
    return said


def nested(depth: int) -> Json:
    """Return nested groups: the group of depth i reaches from the first task to the i-th last."""
    groups = [
        {
            "name": "/".join(["g"] * (i + 1)),
            "start": "T0",
            "end": f"T{depth - i}",
            "max_repeat_count": 2,
        }
        for i in range(depth)
    ]
    return mission([*chain(depth), measure(f"T{depth}")], groups)


def chain(count: int) -> list[Json]:
    return [measure(f"T{i}", transition(f"T{i + 1}")) for i in range(count)]


SCRIPTS = {
    "a million lines": "Mission Protocol #1\n" + "1. Check checkpoint #1\n" * 1_000_000,
    "a million empty lines": "Mission Protocol #1\n" + "\n" * 1_000_000 + "1. Check checkpoint #1",
    "a million unknown words": "Mission Protocol #1\n1. Check " + "xyzzy " * 1_000_000,
    "a name of a megabyte": "Mission Protocol #1\n1. Check the valve " + "R" * 1_000_000,
    "a number of a megabyte": "Mission Protocol #1\n1. Check checkpoint #" + "9" * 1_000_000,
    "a million tabs": "Mission Protocol #1\n1. Check" + "\t" * 1_000_000 + "checkpoint #1",
    "misspelt lines": "Mission Protocol #1\n" + "1. Chekc teh chekpoint #1\n" * 20_000,
    "different misspelt words": "Mission Protocol #1\n"
    + "".join(f"{i}. Check chec{i:05d}point #1\n" for i in range(20_000)),
    "brackets a megabyte deep": "Mission Protocol #1\n1. Go to " + "(" * 1_000_000,
}

# Each is made by the test that reads it.
FILES = {
    "groups a thousand deep": partial(nested, 1000),
    "a name of a megabyte": lambda: mission([measure("A" * 1_000_000)]),
    "a hundred thousand tasks, a quarter of them in the suite": lambda: mission(
        [*chain(examples(100_000) - 1), measure(f"T{examples(100_000) - 1}")]
    ),
    "ten thousand transitions from one task": lambda: mission(
        [measure("A", *(transition("A", condition(1, i)) for i in range(10_000)))]
    ),
}


@pytest.mark.parametrize("name", SCRIPTS)
def test_hostile_scripts(name: str, tmp_path: Path) -> None:
    assert answer(tmp_path / "script.txt", SCRIPTS[name]).split()[0] in ("mission", "refused")


@pytest.mark.parametrize("name", FILES)
def test_hostile_files(name: str, tmp_path: Path) -> None:
    content = json.dumps(FILES[name]())
    assert answer(tmp_path / "mission.json", content).split()[0] in ("mission", "refused")


HUGE = "1" + "0" * 400


@pytest.mark.parametrize(
    ("field", "said"),
    [
        (f'"groups": [{{"name": "g", "start": "A", "end": "A", "max_repeat_count": {HUGE}}}]', ""),
        ('"groups": [{"name": "g", "start": "A", "end": "A", "max_repeat_duration": 1e300}]', ""),
        ('"max_duration": 1e13', "max_duration: input should be less than or equal to"),
        (f'"start_area": {HUGE}', "start_area: input should be less than or equal to"),
    ],
)
def test_numbers_beyond_reason_are_refused(tmp_path: Path, field: str, said: str) -> None:
    task = '{"name": "A", "action": "WAYPOINT", "pose": {"x": 0, "y": 0, "z": 0}}'
    content = f'{{"version": 4, "tasks": [{task}], {field}}}'
    given = answer(tmp_path / "mission.json", content)
    assert given.startswith("refused")
    assert said in given


def test_json_nested_beyond_reason(tmp_path: Path) -> None:
    assert answer(tmp_path / "mission.json", "[" * 1_000_000).startswith("refused")
