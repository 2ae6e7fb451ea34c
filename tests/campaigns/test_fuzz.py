"""Tests of the whole compiler with mutated scripts and mission files, and generated sentences.

Each input results in a mission or in diagnostics, and satisfies the laws of the script front end.
The system limits the memory and the time of each input. CONTRIBUTING.md has the commands for more
inputs.
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
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.fuzz.laws import try_sentence
from tests.campaigns.fuzz.mutating import Composer, Mutator, Restructurer
from tests.campaigns.fuzz.sentences import english_generator
from tests.campaigns.fuzz.trying import try_mission, try_script
from tests.conftest import examples
from tests.whole_scripts import import_whole

ROOT = Path(__file__).parents[2]
MEMORY_BYTES = 4_000_000_000
SECONDS = 60
"""limit for a single input, far above what any takes"""
NUMBERS = st.integers(0, 2**32)
"""number of an input, from which it is drawn"""


def scripts() -> list[bytes]:
    """Return the shipped scripts, and the examples of docs/script.md."""
    shipped = [path.read_bytes() for path in (ROOT / "scenarios").glob("*/missions/*.txt")]
    reference = (ROOT / "docs" / "script.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\w*\n(.*?)^```", reference, re.DOTALL | re.MULTILINE)
    return shipped + [block.encode() for block in blocks]


def missions(texts: Sequence[bytes]) -> list[bytes]:
    """Return the missions of those scripts that result in one, as JSON."""
    files = []
    for text in texts:
        try:
            mission = import_whole(text.decode(), CATALOG, start_area=1, end_area=2).mission
        except ArgoError:
            continue
        files.append(mission.model_dump_json(exclude_defaults=True).encode())
    return files


@cache
def make_generators() -> tuple[Restructurer, Mutator, Mutator, Composer]:
    """Return the generators, alternately of mission files and of scripts."""
    texts = scripts()
    files = missions(texts)
    return Restructurer(files), Mutator(texts), Mutator(files), Composer(texts)


@pytest.fixture(autouse=True)
def bounded_memory() -> Iterator[None]:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    limit = pages * resource.getpagesize() + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (limit, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@contextmanager
def bounded_time() -> Iterator[None]:
    def raise_timeout(*_: object) -> None:
        raise TimeoutError(f"not finished after {SECONDS} s")

    before = signal.signal(signal.SIGALRM, raise_timeout)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.long
def test_mutated_scripts_and_files_result_in_missions_or_diagnostics(tmp_path: Path) -> None:
    outcomes: Counter[str] = Counter()

    @settings(max_examples=examples(2000))
    @given(NUMBERS)
    def attempt(number: int) -> None:
        generator = make_generators()[number % 4]
        generator.rng = rng = random.Random(number)
        data = generator.make()
        note(repr(data))
        with bounded_time():
            if number % 2:
                outcomes[f"script: {try_script(data, rng)}"] += 1
            else:
                outcomes[f"file: {try_mission(data, rng, tmp_path)}"] += 1

    attempt()
    for kind in ("script: mission", "script: refused", "file: mission", "file: refused"):
        assert outcomes[kind] > examples(2000) // 100


def test_generated_sentences_satisfy_the_laws() -> None:
    outcomes: Counter[str] = Counter()
    generator = english_generator(random.Random())

    @settings(max_examples=examples(200))
    @given(NUMBERS)
    def attempt(number: int) -> None:
        generator.rng = rng = random.Random(number)
        words = generator.sentence()
        with bounded_time():
            outcome, breaches = try_sentence(words, generator, rng)
        assert not breaches
        outcomes[outcome] += 1

    attempt()
    assert outcomes["mission"] > examples(200) // 8
    assert outcomes["refused"] > examples(200) // 8
