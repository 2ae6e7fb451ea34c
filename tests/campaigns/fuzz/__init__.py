"""Mutated scripts and mission files, and sentences made from the grammar, through the whole
compiler: each ends in a mission or in diagnostics, and keeps the laws of the script front end."""

import random
import re
import resource
import signal
import tempfile
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from argo_compiler.base.errors import ArgoError
from argo_compiler.script import import_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.fuzz.laws import try_sentence
from tests.campaigns.fuzz.mutating import Composer, Mutator, Restructurer
from tests.campaigns.fuzz.sentences import Sayer, sayer, text_of
from tests.campaigns.fuzz.trying import try_mission, try_script

ROOT = Path(__file__).parents[3]
MEMORY = Path("/dev/shm")
MEMORY_BYTES = 4_000_000_000
SECONDS = 60
"""of a single input; far above what any takes"""


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


def _hung(*_: object) -> None:
    raise TimeoutError(f"no end after {SECONDS} s")


def bound() -> None:
    """Bounds this process' memory, and the time of each input."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    signal.signal(signal.SIGALRM, _hung)


@dataclass(frozen=True)
class Failure:
    """An input that ended in neither a mission nor diagnostics, or that breaks a law."""

    number: int
    data: bytes
    traceback: str
    """or the law, and the sentence that breaks it"""


@cache
def _makers() -> tuple[Restructurer, Mutator, Mutator, Mutator]:
    texts = scripts()
    files = missions(texts)
    return Restructurer(files), Mutator(texts), Mutator(files), Composer(texts)


def fuzz(runs: range, seed: int) -> tuple[Counter[str], list[Failure]]:
    """What became of the inputs with these numbers."""
    makers = _makers()
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


def fuzz_sentences(runs: range, seed: int) -> tuple[Counter[str], list[Failure]]:
    """What became of made sentences with these numbers."""
    outcomes: Counter[str] = Counter()
    failures = []
    speaker: Sayer = sayer(random.Random())
    for number in runs:
        rng = random.Random(f"{seed}:{number}")
        speaker.rng = rng
        words = speaker.sentence()
        try:
            outcome, breaches = try_sentence(words, speaker, rng)
        except Exception:
            outcomes["sentence: FAILED"] += 1
            failures.append(Failure(number, text_of(words).encode(), traceback.format_exc()))
            continue
        outcomes[f"sentence: {outcome}"] += 1
        for breach in breaches:
            outcomes["sentence: BREACH"] += 1
            failures.append(
                Failure(number, breach.sentence.encode(), f"{breach.law}: {breach.sentence}")
            )
    return outcomes, failures
