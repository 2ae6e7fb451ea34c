"""Mutated scripts and mission files through the whole compiler: each ends in a mission or in
diagnostics.

    python -m tests.fuzz --runs 1000000 --jobs 2 --seed 0

What ends otherwise is written to `fuzz-<seed>-<run>.bin` with its traceback on the terminal, and
the exit status is 1. Memory and time of a single input are bounded by the operating system.
"""

import argparse
import copy
import json
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import repeat
from pathlib import Path

from argo_compiler.analysis import analyse
from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.errors import ArgoError
from argo_compiler.files.mission_file import read_mission
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Command,
    Event,
    Executor,
    Occurred,
    Pause,
    Progress,
    Resume,
    Tick,
    lower,
)
from argo_compiler.il import Action, EventKind, Mission, Task
from argo_compiler.script import decode_script, format_script, import_script
from tests.argo_compiler.script.conftest import CATALOG

ROOT = Path(__file__).parents[1]
MEMORY = Path("/dev/shm")
MEMORY_BYTES = 4_000_000_000
SECONDS = 60
"""of a single input; far above what any takes"""
STEPS = 30
"""events that the machine of a mission is given"""
ACTION_ENDS = (ActionSucceeded, ActionFailed, ActionStopped)


def scripts() -> list[bytes]:
    """The scripts that the project ships, and the examples in its reference of the language."""
    found = [path.read_bytes() for path in (ROOT / "scenarios").glob("*/missions/*.txt")]
    reference = (ROOT / "docs" / "script.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\w*\n(.*?)^```", reference, re.DOTALL | re.MULTILINE)
    return found + [block.encode() for block in blocks]


def missions(texts: Sequence[bytes]) -> list[bytes]:
    """The missions of those scripts that have one, as JSON."""
    found = []
    for text in texts:
        try:
            mission = import_script(text.decode(), CATALOG, start_area=1, end_area=2).mission
        except ArgoError:
            continue
        found.append(mission.model_dump_json(exclude_defaults=True).encode())
    return found


class Mutator:
    """Makes new inputs from a corpus: pieces are cut, doubled, moved, swapped and replaced."""

    def __init__(self, corpus: Sequence[bytes]) -> None:
        self.rng = random.Random()
        self.corpus = corpus
        self.words = sorted({word for text in corpus for word in re.findall(rb"\w+|\W", text)})

    def make(self) -> bytes:
        return self.changed(self.rng.choice(self.corpus), (1, 1, 1, 1, 2, 3, 5, 10, 40))

    def changed(self, text: bytes, times: Sequence[int]) -> bytes:
        pieces = re.findall(rb"\w+|\W", text)
        for _ in range(self.rng.choice(times)):
            pieces = self.rng.choice(self.STEPS)(self, pieces)
        return b"".join(pieces)

    def _at(self, pieces: list[bytes]) -> int:
        return self.rng.randrange(len(pieces) + 1)

    def _cut(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return pieces[:at] + pieces[at + self.rng.choice((1, 1, 2, 8, 60)) :]

    def _insert(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], self.rng.choice(self.words), *pieces[at:]]

    def _replace(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], self.rng.choice(self.words), *pieces[at + 1 :]]

    def _double(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        piece = pieces[at : at + self.rng.choice((1, 5, 30, 200))]
        return pieces[:at] + piece * self.rng.choice((2, 2, 3, 20)) + pieces[at:]

    def _splice(self, pieces: list[bytes]) -> list[bytes]:
        other = re.findall(rb"\w+|\W", self.rng.choice(self.corpus))
        at, start = self._at(pieces), self._at(other)
        length = self.rng.choice((3, 20, 100))
        return pieces[:at] + other[start : start + length] + pieces[at:]

    def _number(self, pieces: list[bytes]) -> list[bytes]:
        numbers = [i for i, piece in enumerate(pieces) if piece.isdigit()]
        if not numbers:
            return pieces
        at = self.rng.choice(numbers)
        number = self.rng.choice((b"0", b"1", b"-1", b"99999999999", b"1e999", b"0.5", b"nan"))
        return [*pieces[:at], number, *pieces[at + 1 :]]

    def _byte(self, pieces: list[bytes]) -> list[bytes]:
        at = self._at(pieces)
        return [*pieces[:at], bytes([self.rng.randrange(256)]), *pieces[at:]]

    def _letter(self, pieces: list[bytes]) -> list[bytes]:
        at = self.rng.randrange(len(pieces)) if pieces else 0
        word = pieces[at] if pieces else b""
        if len(word) < 2:
            return pieces
        i = self.rng.randrange(len(word))
        slip = self.rng.choice((word[:i] + word[i + 1 :], word[:i] + word[i : i + 1] + word[i:]))
        return [*pieces[:at], slip, *pieces[at + 1 :]]

    STEPS = (_cut, _insert, _replace, _double, _splice, _number, _byte, _letter)


class Composer(Mutator):
    """Makes protocols of a few lines each, taken from anywhere in a corpus, changed a little."""

    BEGINNING = b"Mission Protocol #1\n1. Set a starting point in starting area 1\n2. Check #1\n"

    def make(self) -> bytes:
        lines = self.rng.choices(self.lines, k=self.rng.choice((1, 2, 3, 6)))
        return self.changed(self.BEGINNING + b"\n".join(lines), (0, 0, 0, 1, 1, 2, 5))

    @cached_property
    def lines(self) -> list[bytes]:
        return [line for text in self.corpus for line in text.splitlines() if line.strip()]


class Restructurer:
    """Makes new mission files that are JSON still: values are swapped, doubled, dropped."""

    ODD = (None, True, 0, -1, 1, 0.5, 1e300, 10**30, "", "A", "A/B", "1", [], {}, "MEASURE")

    def __init__(self, corpus: Sequence[bytes]) -> None:
        self.rng = random.Random()
        self.missions = [json.loads(text) for text in corpus]

    def make(self) -> bytes:
        mission = copy.deepcopy(self.rng.choice(self.missions))
        for _ in range(self.rng.choice((1, 1, 1, 2, 3, 8, 30))):
            if mission:
                self._change(*self._place(mission))
        return json.dumps(mission).encode()

    def _place(self, data: object) -> tuple[dict[str, object] | list[object], str | int]:
        """A value somewhere in the data: what holds it, and under which key."""
        while True:
            key = self.rng.choice(list(data) if isinstance(data, dict) else range(len(data)))
            part = data[key]
            if not part or not isinstance(part, dict | list) or self.rng.random() < 0.2:
                return data, key
            data = part

    def _change(self, holder: dict[str, object] | list[object], key: str | int) -> None:
        choice = self.rng.random()
        if choice < 0.2:
            del holder[key]
        elif choice < 0.5 and isinstance(key, int):
            holder.insert(self.rng.randrange(len(holder) + 1), copy.deepcopy(holder[key]))
        elif choice < 0.6:
            holder[key] = self.rng.choice(self.ODD)
        elif choice < 0.8 and isinstance(holder[key], int | float):
            holder[key] = self.rng.choice((holder[key] + 1, holder[key] * 2, -holder[key]))
        else:
            other, at = self._place(self.rng.choice(self.missions))
            holder[key] = copy.deepcopy(other[at])


def try_script(data: bytes, rng: random.Random) -> str:
    """What became of a script: `mission` or `refused`."""
    try:
        text = decode_script(data, "fuzz")
        area = rng.choice((None, 1, 2))
        mission = import_script(text, CATALOG, start_area=area, end_area=area).mission
    except ArgoError:
        return "refused"
    run(mission, rng)
    if not any(finding.severity is Severity.ERROR for finding in check(mission, CATALOG)):
        again = import_script(format_script(mission, CATALOG), CATALOG).mission
        assert _unplaced(again) == _unplaced(mission), "formatting changes the mission"
    return "mission"


def try_mission(data: bytes, rng: random.Random, folder: Path) -> str:
    """What became of a mission file: `mission` or `refused`."""
    path = folder / "fuzz.json"
    path.write_bytes(data)
    try:
        mission = read_mission(path)
    except ArgoError:
        return "refused"
    return run(mission, rng)


def run(mission: Mission, rng: random.Random) -> str:
    """Analyses the mission and gives its machine some events, across a snapshot."""
    check(mission, CATALOG)
    try:
        hfsm = lower(mission)
    except ArgoError:
        return "refused"
    analyse(mission, CATALOG)
    executor = Executor(hfsm)
    now = 0.0
    cancelled = _cancels(executor.start(now))
    for step in range(STEPS):
        if executor.finished:
            break
        if step == STEPS // 2:
            progress = Progress.model_validate_json(executor.progress().model_dump_json())
            executor = Executor.restore(hfsm, progress, now)
            cancelled = _cancels(executor.start(now))
            continue
        now += rng.choice((0.0, 0.5, 30.0))
        event = _event(executor.running, cancelled, rng)
        still = cancelled and not isinstance(event, ACTION_ENDS)
        cancelled = _cancels(executor.handle(event, now)) or still
    return "mission"


def _cancels(commands: Sequence[Command]) -> bool:
    return any(isinstance(command, CancelAction) for command in commands)


def _event(running: Task | None, cancelled: bool, rng: random.Random) -> Event:
    choice = rng.random()
    if choice < 0.05:
        return Pause()
    if choice < 0.1 or (running is None and choice < 0.8):
        return Resume()
    if choice < 0.15:
        return Occurred(rng.choice(list(EventKind)))
    if running is None or choice < 0.2:
        return Tick()
    if cancelled and choice < 0.8:
        return ActionStopped(running.name)
    if choice < 0.3:
        return ActionFailed(running.name, "fuzz")
    reads = running.action is Action.MEASURE
    return ActionSucceeded(running.name, rng.uniform(-1, 100) if reads else None)


def _unplaced(mission: Mission) -> object:
    """The mission without the places in its source."""

    def without(value: object) -> object:
        if isinstance(value, dict):
            return {key: without(part) for key, part in value.items() if key != "source"}
        return [without(part) for part in value] if isinstance(value, list) else value

    return without(json.loads(mission.model_dump_json()))


def _hung(*_: object) -> None:
    raise TimeoutError(f"no end after {SECONDS} s")


def bound() -> None:
    """Bounds this process' memory, and the time of each input."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    signal.signal(signal.SIGALRM, _hung)


@dataclass(frozen=True)
class Failure:
    """An input that ended in neither a mission nor diagnostics."""

    number: int
    data: bytes
    traceback: str


def fuzz(runs: range, seed: int) -> tuple[Counter[str], list[Failure]]:
    """What became of the inputs with these numbers."""
    texts = scripts()
    files = missions(texts)
    makers = (Restructurer(files), Mutator(texts), Mutator(files), Composer(texts))
    outcomes: Counter[str] = Counter()
    failures = []
    seconds = SECONDS if signal.getsignal(signal.SIGALRM) is _hung else 0
    with tempfile.TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as folder:
        for number in runs:
            rng = random.Random(f"{seed}:{number}")
            kind = "script" if number % 2 else "file"
            maker = makers[number % 4]
            maker.rng = rng
            data = maker.make()
            signal.alarm(seconds)
            try:
                if kind == "script":
                    outcome = try_script(data, rng)
                else:
                    outcome = try_mission(data, rng, Path(folder))
                outcomes[f"{kind}: {outcome}"] += 1
            except Exception:
                outcomes[f"{kind}: FAILED"] += 1
                failures.append(Failure(number, data, traceback.format_exc()))
            finally:
                signal.alarm(0)
    return outcomes, failures


def _batches(runs: int, size: int = 2000) -> Iterator[range]:
    return (range(start, min(start + size, runs)) for start in range(0, runs, size))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    total: Counter[str] = Counter()
    failed = 0
    started = time.monotonic()
    with ProcessPoolExecutor(options.jobs, initializer=bound) as pool:
        batches = list(_batches(options.runs))
        for outcomes, failures in pool.map(fuzz, batches, repeat(options.seed)):
            total += outcomes
            failed += len(failures)
            for failure in failures:
                path = Path(f"fuzz-{options.seed}-{failure.number}.bin")
                path.write_bytes(failure.data)
                print(f"{path}\n{failure.traceback}", file=sys.stderr)
            took = time.monotonic() - started
            print(f"{total.total()} runs in {took:.0f} s: {dict(sorted(total.items()))}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
