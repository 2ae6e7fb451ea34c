"""Leave out a word or a line of a script that imports: the mission or a message differs, or the
language names the place as one without effect. `tests.campaigns.deletions` tries all of them."""

import random
from collections.abc import Iterable

import pytest

from tests.argo_compiler.script.deletion import DeletionTrial
from tests.argo_compiler.script.importing_scripts import (
    ImportingScript,
    generated_scripts,
    written_scripts,
)
from tests.conftest import FIRST_SEED, examples, sample, seeds

WORDS = 2
"""words of a script that are left out, one at a time, and one line"""


def swallowed(scripts: Iterable[ImportingScript]) -> list[str]:
    """Return what may be left out of the scripts, of some words and a line of each."""
    rng = random.Random(FIRST_SEED)
    found = []
    for script in scripts:
        trial = DeletionTrial(script)
        words = rng.sample(trial.tokens, min(WORDS, len(trial.tokens)))
        deletions = [
            *map(trial.swallowed_word, words),
            trial.swallowed_line(*rng.choice(trial.lines)),
        ]
        found += [f"{script.name}: {one.context}" for one in deletions if one is not None]
    return found


@pytest.mark.long
def test_no_word_of_written_scripts_is_swallowed() -> None:
    written = written_scripts()
    random.Random(FIRST_SEED).shuffle(written)
    imported = [script.imported() for script in sample(written)]
    scripts = [script for script in imported if script is not None]
    assert len(scripts) > 80
    assert not swallowed(scripts)


def test_no_word_of_generated_scripts_is_swallowed() -> None:
    scripts = list(generated_scripts(seeds(400)))
    assert len(scripts) > examples(50)
    assert not swallowed(scripts)
