"""Mutated scripts and mission files, and sentences made from the grammar, through the whole
compiler: each ends in a mission or in diagnostics, and keeps the laws of the script front end.

The system bounds the memory and the time of each input. CONTRIBUTING says how to try more.
"""

import random
import re
import resource
import signal
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.script import import_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.fuzz.laws import try_sentence
from tests.campaigns.fuzz.mutating import Composer, Mutator, Restructurer
from tests.campaigns.fuzz.sentences import sayer
from tests.campaigns.fuzz.trying import try_mission, try_script
from tests.conftest import examples

ROOT = Path(__file__).parents[2]
MEMORY_BYTES = 4_000_000_000
SECONDS = 60
"""of a single input; far above what any takes"""
NUMBERS = st.integers(0, 2**32)
"""of inputs: each is drawn from its number"""


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


@cache
def makers() -> tuple[Restructurer, Mutator, Mutator, Composer]:
    """Return the makers of files, scripts, files and scripts, which take turns."""
    texts = scripts()
    files = missions(texts)
    return Restructurer(files), Mutator(texts), Mutator(files), Composer(texts)


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    most = pages * resource.getpagesize() + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@contextmanager
def bounded_time() -> Iterator[None]:
    def hung(*_: object) -> None:
        raise TimeoutError(f"no end after {SECONDS} s")

    before = signal.signal(signal.SIGALRM, hung)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.long
def test_mutated_scripts_and_files_end_in_missions_or_diagnostics(tmp_path: Path) -> None:
    outcomes: Counter[str] = Counter()

    @settings(max_examples=examples(2000))
    @given(NUMBERS)
    def attempt(number: int) -> None:
        maker = makers()[number % 4]
        maker.rng = rng = random.Random(number)
        data = maker.make()
        note(repr(data))
        with bounded_time():
            if number % 2:
                outcomes[f"script: {try_script(data, rng)}"] += 1
            else:
                outcomes[f"file: {try_mission(data, rng, tmp_path)}"] += 1

    attempt()
    for kind in ("script: mission", "script: refused", "file: mission", "file: refused"):
        assert outcomes[kind] > examples(20)


def test_sentences_made_from_the_grammar_keep_the_laws() -> None:
    outcomes: Counter[str] = Counter()
    speaker = sayer(random.Random())

    @settings(max_examples=examples(200))
    @given(NUMBERS)
    def attempt(number: int) -> None:
        speaker.rng = rng = random.Random(number)
        words = speaker.sentence()
        with bounded_time():
            outcome, breaches = try_sentence(words, speaker, rng)
        assert not breaches
        outcomes[outcome] += 1

    attempt()
    assert outcomes["mission"] > examples(30)
    assert outcomes["refused"] > examples(30)
