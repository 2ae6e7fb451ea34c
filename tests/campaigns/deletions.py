"""Campaign: leave out each word and each line of all scripts that import, one at a time.

    python -m tests.campaigns.deletions
    python -m tests.campaigns.deletions --generated 0 --only drafts/ --part 1 --parts 2

A word or a line that can be left out without a difference, and that nothing shows to be read, is
written down; the exit status is 1 if there is any. See `tests/argo_compiler/script/deletion.py`.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence

from tests.argo_compiler.script.deletion import Deletion, DeletionTrial
from tests.argo_compiler.script.importing_scripts import (
    ImportingScript,
    generated_scripts,
    written_scripts,
)


def _swallowed(trial: DeletionTrial) -> Iterator[Deletion]:
    found = (*map(trial.swallowed_word, trial.tokens),)
    found += tuple(trial.swallowed_line(*line) for line in trial.lines)
    yield from (deletion for deletion in found if deletion is not None)


def _scripts(options: argparse.Namespace) -> Iterator[ImportingScript]:
    written = [script for script in written_scripts() if options.only in script.name]
    yield from filter(None, (script.imported() for script in written))
    yield from generated_scripts(range(options.first, options.first + options.generated))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--generated", type=int, default=10_000, help="number of generated scripts")
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    parser.add_argument("--only", default="", help="part of the names of written scripts")
    parser.add_argument("--part", type=int, default=0, help="which part, from 0 on")
    parser.add_argument("--parts", type=int, default=1, help="number of parts of the scripts")
    options = parser.parse_args(arguments)
    began = time.monotonic()
    scripts = words = lines = swallowed = 0
    for i, script in enumerate(_scripts(options)):
        if i % options.parts != options.part:
            continue
        trial = DeletionTrial(script)
        scripts, words, lines = scripts + 1, words + len(trial.tokens), lines + len(trial.lines)
        if scripts % 100 == 0:
            print(
                f"{scripts} scripts, {words} words and {lines} lines", file=sys.stderr, flush=True
            )
        for deletion in _swallowed(trial):
            swallowed += 1
            what = deletion.terminal or "-"
            print(f"{script.name}: `{deletion.text}` {what}: {deletion.context}", flush=True)
    took_s = time.monotonic() - began
    tried = f"{scripts} scripts, {words} words and {lines} lines in {took_s:.0f} s"
    print(f"{tried}: {swallowed} swallowed")
    return int(swallowed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
