"""Campaign: time and memory of `argo check` for the worst inputs of a megabyte.

    python -m tests.campaigns.hostile
    python -m tests.campaigns.hostile --only "nested groups" "a time of 1e300 s"

Each input is read, checked, lowered and analysed as far as possible, with the travel times of a
site, in a process of its own with at most 2 GB of memory. The system measures processor time and
peak memory. The exit status is 1 if an input takes more than 10 s or causes a traceback.
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
"""size of each input in characters"""
TASK_SIZE = 290_000
"""size of one task in characters; files with larger tasks are refused at once"""
MEMORY_BYTES = 2_000_000_000
LIMIT_S = 10.0
GIVE_UP_S = 120

Json = Any


def condition(object_id: object = 1, bound: float = 5) -> Json:
    kind = "MEASURED_VALUE_GREATER"
    return {"type": kind, "object_id": str(object_id), "param1": bound}


def transition(target: str, *conditions: Json) -> Json:
    return {"target": target, "conditions": list(conditions)}


def measure(name: str, *transitions: Json, object_id: object = 1, **more: Json) -> Json:
    task = {"name": name, "action": "MEASURE", "object_id": str(object_id)}
    return task | {"transitions": list(transitions)} | more


def _drive(name: str, *transitions: Json, x: float = -1.0, **more: Json) -> Json:
    pose = {"x": x, "y": 4.0, "z": 0.0}
    return {
        "name": name,
        "action": "WAYPOINT",
        "pose": pose,
        "transitions": list(transitions),
    } | more


def _wait(name: str, *transitions: Json, **rule: Json) -> Json:
    return {"name": name, "action": "WAIT", "wait": rule, "transitions": list(transitions)}


def fill_list(make: Callable[[int], Json], size: int = SIZE) -> Json:
    """Return the items with the numbers 0, 1, … that fit into a JSON list of that size."""
    items, taken = [], 0
    for k in count():
        item = make(k)
        taken += len(json.dumps(item)) + 2
        if taken > size:
            return items
        items.append(item)
    raise AssertionError


def mission(tasks: Json, groups: Json = (), **more: Json) -> Json:
    return {"version": 4, "tasks": list(tasks), "groups": list(groups)} | more


def nest_groups(depth: int, **rule: Json) -> Json:
    """Return a mission of nested groups with one more task each; names grow with the depth."""
    names = ["/".join(["g"] * (i + 1)) for i in range(depth)]
    tasks = [_drive(f"T{i}", transition(f"T{i + 1}")) for i in range(depth)] + [_drive(f"T{depth}")]
    groups = [{"name": n, "start": f"T{i}", "end": f"T{depth}"} | rule for i, n in enumerate(names)]
    return mission(tasks, groups)


def _consecutive_groups(rule: Json, make: Callable[[int], Json]) -> Json:
    tasks = fill_list(lambda k: [make(2 * k), make(2 * k + 1), rule, " " * 80])
    pairs = [task for pair in tasks for task in pair[:2]]
    groups = [
        {"name": f"g{k}", "start": f"T{2 * k}", "end": f"T{2 * k + 1}"} | rule
        for k in range(len(tasks))
    ]
    return mission([*pairs, _drive(f"T{len(pairs)}")], groups)


def chain_tasks(make: Callable[[int, str], Json]) -> Json:
    """Return a mission of tasks in sequence, as many as fit into SIZE."""
    tasks = fill_list(lambda k: make(k, f"T{k + 1}"))
    return mission([*tasks[:-1], _drive(f"T{len(tasks) - 1}")])


def make_jumps(k: int) -> list[Json]:
    """Return conditional transitions to tasks all over the mission."""
    return [
        transition(f"T{(k * 7919 + 31 * j) % 1500}", condition(j + 1, k % 11)) for j in range(5)
    ]


def _with_repeat_count(number: str) -> str:
    one = json.dumps(mission([_drive("T0")], [{"name": "g", "start": "T0", "end": "T0"}]))
    return one.replace('"end": "T0"', f'"end": "T0", "max_repeat_count": {number}')


def _with_duration(number: str) -> str:
    one = json.dumps(mission([_drive("T0", x=0.0)]))
    return one.replace('"version"', f'"max_duration": {number}, "version"')


MISSIONS: dict[str, Callable[[], Json]] = {
    "a chain of short tasks": lambda: chain_tasks(lambda k, n: measure(f"T{k}", transition(n))),
    "drives to and fro": lambda: chain_tasks(
        lambda k, n: _drive(f"T{k}", transition(n), x=-1 - k % 7)
    ),
    "drives to poses that all differ": lambda: chain_tasks(
        lambda k, n: _drive(f"T{k}", transition(n), x=-1 - k / 1e4)
    ),
    "tasks that lead anywhere": lambda: mission(
        fill_list(lambda k: measure(f"T{k}", *make_jumps(k)))
    ),
    "each task has a condition on its own checkpoint": lambda: chain_tasks(
        lambda k, n: _drive(f"T{k}", transition(f"T{k // 2}", condition(k)), transition(n))
    ),
    "each task measures the checkpoint of another condition": lambda: chain_tasks(
        lambda k, n: measure(
            f"T{k}", transition("T0", condition(k * 7 % 3000)), transition(n), object_id=k
        )
    ),
    "bounds that all differ": lambda: chain_tasks(
        lambda k, n: measure(f"T{k}", transition("T0", condition(1, k)), transition(n))
    ),
    "bounds of another checkpoint that all differ": lambda: chain_tasks(
        lambda k, n: _drive(f"T{k}", transition("T0", condition(1 + k % 9, k)), transition(n))
    ),
    "one task with very many transitions": lambda: mission(
        [measure("A", *fill_list(lambda k: transition("A", condition(1, k)), TASK_SIZE))]
    ),
    "one task with very many transitions by other checkpoints": lambda: mission(
        [_drive("A", *fill_list(lambda k: transition("A", condition(k, 1)), TASK_SIZE))]
    ),
    "one transition with very many conditions": lambda: mission(
        [measure("A", transition("A", *fill_list(lambda k: condition(1, k), TASK_SIZE)))]
    ),
    "one transition with very many conditions on checkpoints": lambda: mission(
        [_drive("A", transition("A", *fill_list(lambda k: condition(k, 1), TASK_SIZE)))]
    ),
    "unconditional transitions": lambda: mission(
        [_drive("A", *fill_list(lambda _: transition("A"), TASK_SIZE))]
    ),
    "a wait for very many conditions": lambda: mission(
        [_wait("A", conditions=fill_list(lambda k: condition(k, 1), TASK_SIZE))]
    ),
    "waits of zero duration": lambda: chain_tasks(
        lambda k, n: _wait(f"T{k}", transition(n), duration=0)
    ),
    "waits of zero duration that end at a missing task": lambda: mission(
        [*fill_list(lambda k: _wait(f"T{k}", transition(f"T{k + 1}"), duration=0))[:-1]]
    ),
    "a group until very many conditions hold": lambda: mission(
        [measure("A")],
        [
            {
                "name": "g",
                "start": "A",
                "end": "A",
                "until": fill_list(lambda k: condition(1, k), TASK_SIZE),
            }
        ],
    ),
    "nested groups": lambda: nest_groups(900, max_repeat_count=2),
    "nested groups with a hard stop": lambda: nest_groups(900, max_repeat_duration=100),
    "nested groups with a soft stop": lambda: nest_groups(
        900, max_repeat_duration=100, stop="soft", every=7
    ),
    "groups beside each other": lambda: _consecutive_groups(
        {"max_repeat_count": 5}, lambda k: _drive(f"T{k}", transition(f"T{k + 1}"))
    ),
    "groups with a hard stop, entered and left anywhere": lambda: _consecutive_groups(
        {"max_repeat_duration": 50},
        lambda k: measure(
            f"T{k}", transition(f"T{k * 31 % 1900}", condition(1, k % 9)), transition(f"T{k + 1}")
        ),
    ),
    "groups of one name": lambda: mission(
        [_drive("A")],
        fill_list(lambda _: {"name": "g", "start": "A", "end": "A", "max_repeat_count": 2}),
    ),
    "groups of the same range": lambda: mission(
        [_drive("A")],
        fill_list(lambda k: {"name": f"g{k}", "start": "A", "end": "A", "max_repeat_count": 2}),
    ),
    "tasks of one name": lambda: mission(fill_list(lambda _: _drive("A", transition("A")))),
    "misspelt targets": lambda: mission(
        fill_list(lambda k: _drive(f"Task {k}", transition(f"Tusk {k}")))
    ),
    "two thousand transitions to a name of 400 letters": lambda: mission(
        [_drive("A" * 400), *fill_list(lambda k: _drive(f"T{k}", transition("A" * 400)))[:2000]]
    ),
    "reactions to one event": lambda: mission(
        [_drive("A")], reactions=fill_list(lambda _: {"event": "gas_leak", "response": "pause"})
    ),
    "windows": lambda: chain_tasks(
        lambda k, n: _drive(
            f"T{k}", transition(n), window={"earliest": k, "latest": k + 1, "missed_target": "T0"}
        )
    ),
    "branches after failures": lambda: chain_tasks(
        lambda k, n: measure(
            f"T{k}",
            transition(n),
            on_failure="branch",
            failure_target=f"T{k // 2}",
            object_id=k % 50,
        )
    ),
    "tasks that were left out": lambda: mission(
        [_drive("A")], left_out=fill_list(lambda k: f"B{k}")
    ),
    "joints": lambda: mission(
        [
            _drive(
                "A",
                joint_states={"names": fill_list(lambda k: f"j{k}", TASK_SIZE), "positions": []},
            )
        ]
    ),
    "unknown fields": lambda: mission([_drive("A")]) | {f"field {k}": k for k in range(50_000)},
    "tasks of a wrong form": lambda: mission(fill_list(lambda k: {"nme": k})),
    "a name of a megabyte": lambda: mission([_drive("A" * SIZE)]),
    "a number of rounds of 400 digits": lambda: _with_repeat_count("1" + "0" * 400),
    "a number of rounds of 4,000 digits": lambda: _with_repeat_count("1" + "0" * 4000),
    "a number of a megabyte": lambda: _with_repeat_count("1" + "0" * SIZE),
    "a time of 1e300 s": lambda: _with_duration("1e300"),
    "a time of 1e400 s": lambda: _with_duration("1e400"),
    "a time of 1e-300 s": lambda: _with_duration("1e-300"),
    "coordinates of 1e300 m": lambda: mission([_drive("A", x=1e300), _drive("B", x=-1e308)]),
    "a speed of 1e-300 m/s": lambda: mission([_drive("A", velocity=1e-300)]),
    "bounds of 1e308": lambda: mission([measure("A", transition("A", condition(1, 1e308)))]),
    "lists in lists": lambda: "[" * SIZE,
    "objects in objects": lambda: '{"a":' * (SIZE // 5),
    "one object's keys, all the same": lambda: "{" + '"a": 1, ' * (SIZE // 8) + '"a": 1}',
    "zeros": lambda: "\0" * SIZE,
}

SCRIPTS: dict[str, Callable[[], str]] = {
    "steps": lambda: _lines("Check checkpoint #1."),
    "steps with conditions": lambda: _lines("Check checkpoint #1; if it is above 5, go to step 1."),
    "repeated steps": lambda: _lines("Check checkpoint #1.", "Repeat step 1 2 times."),
    "waits": lambda: _lines("Wait 5 minutes."),
    "misspelt steps": lambda: _lines("Chekc teh chekpoint #1"),
    "different misspelt words": lambda: (
        "Mission Protocol #1\n"
        + "".join(f"{i}. Check chec{i:05d}point #1\n" for i in range(SIZE // 28))
    ),
    "empty lines": lambda: "Mission Protocol #1\n" + "\n" * SIZE,
    "one line of unknown words": lambda: "Mission Protocol #1\n1. Check " + "xyzzy " * (SIZE // 6),
    "one line of orders": lambda: (
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


def _lines(sentence: str, last: str = "") -> str:
    longest = f"10000. {sentence}\n"
    steps = "".join(f"{k + 1}. {sentence}\n" for k in range(SIZE // len(longest)))
    return f"Mission Protocol #1\n{steps}{last}\n"


def inputs() -> Iterator[tuple[str, str, str]]:
    """Yield name, file extension and text of each input."""
    for name, make in MISSIONS.items():
        content = make()
        yield name, ".json", content if isinstance(content, str) else json.dumps(content)
    for name, script in SCRIPTS.items():
        yield name, ".txt", script()


def _limit_resources() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (GIVE_UP_S, GIVE_UP_S))


def check_input(path: Path, site: str) -> tuple[str, float, float]:
    """Run `argo check`; return its answer, processor time (s) and peak memory (MB)."""
    command = [sys.executable, "-m", "argo_planner", "check", str(path), "--site", site, "--quiet"]
    with tempfile.TemporaryFile() as output:
        child = subprocess.Popen(command, stdout=output, stderr=output, preexec_fn=_limit_resources)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode(errors="replace")
    answer = {0: "accepted", 2: "refused"}.get(child.returncode, f"status {child.returncode}")
    if "Traceback" in text or "MemoryError" in text:
        answer = "TRACEBACK " + text.strip().splitlines()[-1][:100]
    return answer, used.ru_utime + used.ru_stime, used.ru_maxrss / 1000


def main(arguments: Sequence[str] | None = None) -> int:
    """Check the inputs and print the table; return 1 if one of them fails, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=(), help="names of the inputs to check")
    parser.add_argument("--site", default="umad", help="site of the travel times")
    options = parser.parse_args(arguments)
    worst = (0.0, 0.0)
    failures = 0
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, ending, text) in enumerate(inputs()):
            if options.only and name not in options.only:
                continue
            path = Path(folder) / f"{number}{ending}"
            path.write_text(text)
            answer, seconds, memory = check_input(path, options.site)
            path.unlink()
            failed = seconds > LIMIT_S or answer not in ("accepted", "refused")
            failures += failed
            worst = max(worst[0], seconds), max(worst[1], memory)
            mark = "  <--" if failed else ""
            size = len(text) / 1e6
            print(f"{name:<55} {size:5.2f} MB {seconds:7.2f} s {memory:6.0f} MB  {answer}{mark}")
    print(f"worst: {worst[0]:.2f} s, {worst[1]:.0f} MB; {time.monotonic() - begun:.0f} s in all")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
