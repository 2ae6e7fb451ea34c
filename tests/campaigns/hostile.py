"""What the worst inputs of a megabyte cost: `argo check` of each kind, in a process of its own.

    python -m tests.campaigns.hostile
    python -m tests.campaigns.hostile --only "nested groups" "a time of 1e300 s"

Reads, checks, lowers and analyses what it can, with the travel times of a site. Memory is limited
to 2 GB; the processor's time and the greatest memory are measured by the system. Ends with status 1
if an input takes more than 10 s or is answered by a traceback.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import Any

SIZE = 1_000_000
"""characters of each input"""
TASK_SIZE = 290_000
"""and of one task; of larger ones a file is refused at once"""
MEMORY_BYTES = 2_000_000_000
LIMIT_S = 10.0
GIVE_UP_S = 120

Json = Any


def condition(object_id: object = 1, bound: float = 5) -> Json:
    kind = "MEASURED_VALUE_GREATER"
    return {"type": kind, "object_id": str(object_id), "param1": bound}


def way(target: str, *conditions: Json) -> Json:
    return {"target": target, "conditions": list(conditions)}


def measure(name: str, *ways: Json, object_id: object = 1, **more: Json) -> Json:
    task = {"name": name, "action": "MEASURE", "object_id": str(object_id)}
    return task | {"transitions": list(ways)} | more


def _drive(name: str, *ways: Json, x: float = -1.0, **more: Json) -> Json:
    pose = {"x": x, "y": 4.0, "z": 0.0}
    return {"name": name, "action": "WAYPOINT", "pose": pose, "transitions": list(ways)} | more


def _wait(name: str, *ways: Json, **rule: Json) -> Json:
    return {"name": name, "action": "WAIT", "wait": rule, "transitions": list(ways)}


def filled(make: Callable[[int], Json], size: int = SIZE) -> Json:
    """As many items as a list of that size has."""
    items, taken = [], 0
    for k in count():
        item = make(k)
        taken += len(json.dumps(item)) + 2
        if taken > size:
            return items
        items.append(item)
    raise AssertionError


def mission(tasks: Json, groups: Json = (), **more: Json) -> Json:
    return {"version": 3, "tasks": list(tasks), "groups": list(groups)} | more


def nested(depth: int, **rule: Json) -> Json:
    """Groups in groups with one task each; names grow with the depth."""
    names = ["/".join(["g"] * (i + 1)) for i in range(depth)]
    tasks = [_drive(f"T{i}", way(f"T{i + 1}")) for i in range(depth)] + [_drive(f"T{depth}")]
    groups = [{"name": n, "start": f"T{i}", "end": f"T{depth}"} | rule for i, n in enumerate(names)]
    return mission(tasks, groups)


def _siblings(rule: Json, make: Callable[[int], Json]) -> Json:
    tasks = filled(lambda k: [make(2 * k), make(2 * k + 1), rule, " " * 80])
    pairs = [task for pair in tasks for task in pair[:2]]
    groups = [
        {"name": f"g{k}", "start": f"T{2 * k}", "end": f"T{2 * k + 1}"} | rule
        for k in range(len(tasks))
    ]
    return mission([*pairs, _drive(f"T{len(pairs)}")], groups)


def chained(make: Callable[[int, str], Json]) -> Json:
    """A chain of tasks, each of which leads to the next one."""
    tasks = filled(lambda k: make(k, f"T{k + 1}"))
    return mission([*tasks[:-1], _drive(f"T{len(tasks) - 1}")])


def jumps(k: int) -> list[Json]:
    """Conditional ways to tasks all over the mission."""
    return [way(f"T{(k * 7919 + 31 * j) % 1500}", condition(j + 1, k % 11)) for j in range(5)]


def _unlimited(number: str) -> str:
    one = json.dumps(mission([_drive("T0")], [{"name": "g", "start": "T0", "end": "T0"}]))
    return one.replace('"end": "T0"', f'"end": "T0", "max_repeat_count": {number}')


def _timed(number: str) -> str:
    one = json.dumps(mission([_drive("T0", x=0.0)]))
    return one.replace('"version"', f'"max_duration": {number}, "version"')


MISSIONS: dict[str, Callable[[], Json]] = {
    "a chain of short tasks": lambda: chained(lambda k, n: measure(f"T{k}", way(n))),
    "drives to and fro": lambda: chained(lambda k, n: _drive(f"T{k}", way(n), x=-1 - k % 7)),
    "drives to places all different": lambda: chained(
        lambda k, n: _drive(f"T{k}", way(n), x=-1 - k / 1e4)
    ),
    "tasks that lead anywhere": lambda: mission(filled(lambda k: measure(f"T{k}", *jumps(k)))),
    "each task decides by a checkpoint of its own": lambda: chained(
        lambda k, n: _drive(f"T{k}", way(f"T{k // 2}", condition(k)), way(n))
    ),
    "each task measures what another compares": lambda: chained(
        lambda k, n: measure(f"T{k}", way("T0", condition(k * 7 % 3000)), way(n), object_id=k)
    ),
    "bounds all different": lambda: chained(
        lambda k, n: measure(f"T{k}", way("T0", condition(1, k)), way(n))
    ),
    "bounds of another checkpoint, all different": lambda: chained(
        lambda k, n: _drive(f"T{k}", way("T0", condition(1 + k % 9, k)), way(n))
    ),
    "one task with very many ways": lambda: mission(
        [measure("A", *filled(lambda k: way("A", condition(1, k)), TASK_SIZE))]
    ),
    "one task with very many ways by other checkpoints": lambda: mission(
        [_drive("A", *filled(lambda k: way("A", condition(k, 1)), TASK_SIZE))]
    ),
    "one way with very many conditions": lambda: mission(
        [measure("A", way("A", *filled(lambda k: condition(1, k), TASK_SIZE)))]
    ),
    "one way with very many conditions on checkpoints": lambda: mission(
        [_drive("A", way("A", *filled(lambda k: condition(k, 1), TASK_SIZE)))]
    ),
    "unconditional ways": lambda: mission([_drive("A", *filled(lambda _: way("A"), TASK_SIZE))]),
    "a wait for very many conditions": lambda: mission(
        [_wait("A", conditions=filled(lambda k: condition(k, 1), TASK_SIZE))]
    ),
    "waits of no time": lambda: chained(lambda k, n: _wait(f"T{k}", way(n), duration=0)),
    "waits of no time in a circle": lambda: mission(
        [*filled(lambda k: _wait(f"T{k}", way(f"T{k + 1}"), duration=0))[:-1]]
    ),
    "a group until very many conditions hold": lambda: mission(
        [measure("A")],
        [
            {
                "name": "g",
                "start": "A",
                "end": "A",
                "until": filled(lambda k: condition(1, k), TASK_SIZE),
            }
        ],
    ),
    "nested groups": lambda: nested(900, max_repeat_count=2),
    "nested groups with a hard stop": lambda: nested(900, max_repeat_duration=100),
    "nested groups with a soft stop": lambda: nested(
        900, max_repeat_duration=100, stop="soft", every=7
    ),
    "groups beside each other": lambda: _siblings(
        {"max_repeat_count": 5}, lambda k: _drive(f"T{k}", way(f"T{k + 1}"))
    ),
    "groups with a hard stop, entered and left anywhere": lambda: _siblings(
        {"max_repeat_duration": 50},
        lambda k: measure(f"T{k}", way(f"T{k * 31 % 1900}", condition(1, k % 9)), way(f"T{k + 1}")),
    ),
    "groups of one name": lambda: mission(
        [_drive("A")],
        filled(lambda _: {"name": "g", "start": "A", "end": "A", "max_repeat_count": 2}),
    ),
    "groups of the same range": lambda: mission(
        [_drive("A")],
        filled(lambda k: {"name": f"g{k}", "start": "A", "end": "A", "max_repeat_count": 2}),
    ),
    "tasks of one name": lambda: mission(filled(lambda _: _drive("A", way("A")))),
    "misspelt targets": lambda: mission(filled(lambda k: _drive(f"Task {k}", way(f"Tusk {k}")))),
    "two thousand ways to a name of 400 letters": lambda: mission(
        [_drive("A" * 400), *filled(lambda k: _drive(f"T{k}", way("A" * 400)))[:2000]]
    ),
    "reactions to one event": lambda: mission(
        [_drive("A")], reactions=filled(lambda _: {"event": "gas_leak", "response": "pause"})
    ),
    "windows": lambda: chained(
        lambda k, n: _drive(
            f"T{k}", way(n), window={"earliest": k, "latest": k + 1, "missed_target": "T0"}
        )
    ),
    "branches after failures": lambda: chained(
        lambda k, n: measure(
            f"T{k}", way(n), on_failure="branch", failure_target=f"T{k // 2}", object_id=k % 50
        )
    ),
    "what was left out": lambda: mission([_drive("A")], left_out=filled(lambda k: f"B{k}")),
    "joints": lambda: mission(
        [_drive("A", joint_states={"names": filled(lambda k: f"j{k}", TASK_SIZE), "positions": []})]
    ),
    "unknown fields": lambda: mission([_drive("A")]) | {f"field {k}": k for k in range(50_000)},
    "tasks of a wrong form": lambda: mission(filled(lambda k: {"nme": k})),
    "a name of a megabyte": lambda: mission([_drive("A" * SIZE)]),
    "a number of rounds of 400 digits": lambda: _unlimited("1" + "0" * 400),
    "a number of rounds of 4,000 digits": lambda: _unlimited("1" + "0" * 4000),
    "a number of a megabyte": lambda: _unlimited("1" + "0" * SIZE),
    "a time of 1e300 s": lambda: _timed("1e300"),
    "a time of 1e400 s": lambda: _timed("1e400"),
    "a time of 1e-300 s": lambda: _timed("1e-300"),
    "coordinates of 1e300 m": lambda: mission([_drive("A", x=1e300), _drive("B", x=-1e308)]),
    "a speed of 1e-300 m/s": lambda: mission([_drive("A", velocity=1e-300)]),
    "bounds of 1e308": lambda: mission([measure("A", way("A", condition(1, 1e308)))]),
    "lists in lists": lambda: "[" * SIZE,
    "objects in objects": lambda: '{"a":' * (SIZE // 5),
    "one object's keys, all the same": lambda: "{" + '"a": 1, ' * (SIZE // 8) + '"a": 1}',
    "zeros": lambda: "\0" * SIZE,
}

SCRIPTS: dict[str, Callable[[], str]] = {
    "steps": lambda: _lines("Check checkpoint #1."),
    "steps that decide": lambda: _lines("Check checkpoint #1; if it is above 5, go to step 1."),
    "steps that are repeated": lambda: _lines("Check checkpoint #1.", "Repeat step 1 2 times."),
    "waits": lambda: _lines("Wait 5 minutes."),
    "misspelt steps": lambda: _lines("Chekc teh chekpoint #1"),
    "different misspelt words": lambda: (
        "Mission Protocol #1\n"
        + "".join(f"{i}. Check chec{i:05d}point #1\n" for i in range(SIZE // 28))
    ),
    "empty lines": lambda: "Mission Protocol #1\n" + "\n" * SIZE,
    "one line of unknown words": lambda: "Mission Protocol #1\n1. Check " + "xyzzy " * (SIZE // 6),
    "one line of commands": lambda: (
        "Mission Protocol #1\n1. " + " and ".join(["check checkpoint #1"] * (SIZE // 24))
    ),
    "one line of conditions": lambda: (
        "Mission Protocol #1\n1. Check checkpoint #1; if it is "
        + " or ".join(["above 5"] * (SIZE // 11))
        + ", go to step 1"
    ),
    "brackets": lambda: "Mission Protocol #1\n1. Go to " + "(" * SIZE,
    "quotation marks": lambda: 'Mission Protocol #1\n1. "' + '\\"' * (SIZE // 2),
    "a script's number of a megabyte": lambda: "Mission Protocol #1\n1. Check #" + "9" * SIZE,
    "a duration of a thousand million years": lambda: (
        "Mission Protocol #1\n"
        "Maximum duration: 9999999999999999999 h\n"
        "1. Check checkpoint #1, retry 99999999999 times.\n"
    ),
    "steps of several sentences in German": lambda: _lines(
        "Prüfe Manometer 5. Wenn der Wert über 4,5 bar liegt, prüfe Checkpoint 8, sonst weiter."
    ),
    "edits": lambda: _lines("Add checkpoint #2 after checkpoint #1."),
    "ranges": lambda: _lines("Check checkpoints 1 to 20 and 3 to 9."),
    "reactions": lambda: _lines("If a gas leak is detected, return to the docking station."),
    "repetitions": lambda: _lines("Repeat steps 1 to 3 2 times."),
    "a table": lambda: "| Step | Checkpoint | Priority |\n" + "| 1 | #4 | high |\n" * (SIZE // 17),
    "bullets within bullets": lambda: "".join(
        f"{' ' * (k % 60)}- Check #{k % 20}\n" for k in range(SIZE // 48)
    ),
    "wrapped lines": lambda: "1. Start in starting area 1.\n" + "check #1 and\n" * (SIZE // 13),
    "figures": lambda: "12 345 6.7\n" * (SIZE // 11),
    "commas": lambda: ",,, , ,\n" * (SIZE // 8),
    "a word of a megabyte": lambda: "a" * SIZE,
    "quoted lines": lambda: '"Check" ("#1")\n' * (SIZE // 15),
    "tabs": lambda: "Mission Protocol #1\n1. Check" + "\t" * SIZE + "checkpoint #1",
}


def _lines(said: str, last: str = "") -> str:
    one = f"10000. {said}\n"
    steps = "".join(f"{k + 1}. {said}\n" for k in range(SIZE // len(one)))
    return f"Mission Protocol #1\n{steps}{last}\n"


def inputs() -> Iterator[tuple[str, str, str]]:
    """Name, ending of the file and text of each kind."""
    for name, make in MISSIONS.items():
        made = make()
        yield name, ".json", made if isinstance(made, str) else json.dumps(made)
    for name, script in SCRIPTS.items():
        yield name, ".txt", script()


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (GIVE_UP_S, GIVE_UP_S))


def answer(path: Path, site: str) -> tuple[str, float, float]:
    """How an input is answered, the processor's time (s), and the greatest memory (MB)."""
    command = [sys.executable, "-m", "argo_planner", "check", str(path), "--site", site, "--quiet"]
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(command, stdout=said, stderr=said, preexec_fn=_limit)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().decode(errors="replace")
    how = {0: "accepted", 2: "refused"}.get(child.returncode, f"status {child.returncode}")
    if "Traceback" in text or "MemoryError" in text:
        how = "TRACEBACK " + text.strip().splitlines()[-1][:100]
    return how, used.ru_utime + used.ru_stime, used.ru_maxrss / 1000


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=(), help="names of inputs")
    parser.add_argument("--site", default="umad")
    given = parser.parse_args(arguments)
    worst = (0.0, 0.0)
    bad = 0
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, ending, text) in enumerate(inputs()):
            if given.only and name not in given.only:
                continue
            path = Path(folder) / f"{number}{ending}"
            path.write_text(text)
            how, seconds, memory = answer(path, given.site)
            path.unlink()
            over = seconds > LIMIT_S or how not in ("accepted", "refused")
            bad += over
            worst = max(worst[0], seconds), max(worst[1], memory)
            mark = "  <--" if over else ""
            size = len(text) / 1e6
            print(f"{name:<55} {size:5.2f} MB {seconds:7.2f} s {memory:6.0f} MB  {how}{mark}")
    print(f"worst: {worst[0]:.2f} s, {worst[1]:.0f} MB; {time.monotonic() - began:.0f} s in all")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
