"""The command.

    python -m tests.campaigns.fuzz --runs 1000000 --jobs 2 --seed 0
    python -m tests.campaigns.fuzz --sentences --runs 1000000 --jobs 2 --seed 0

What ends otherwise than in a mission or in diagnostics, or breaks a law, is written to
`fuzz-<seed>-<run>.bin` with its traceback or the law on the terminal, and the exit status is 1.
Memory and time of a single input are bounded by the operating system.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from multiprocessing import get_context
from pathlib import Path

from tests.campaigns.fuzz import bound, fuzz, fuzz_sentences


def _batches(runs: int, size: int = 2000) -> Iterator[range]:
    return (range(start, min(start + size, runs)) for start in range(0, runs, size))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description="Mutated and made inputs through the whole compiler."
    )
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--sentences", action="store_true", help="made from the grammar")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    work = fuzz_sentences if options.sentences else fuzz
    total: Counter[str] = Counter()
    failed = 0
    started = time.monotonic()
    with ProcessPoolExecutor(
        options.jobs, mp_context=get_context("spawn"), initializer=bound
    ) as pool:
        batches = list(_batches(options.runs))
        for outcomes, failures in pool.map(work, batches, repeat(options.seed)):
            total += outcomes
            failed += len(failures)
            for failure in failures:
                path = Path(f"fuzz-{options.seed}-{failure.number}.bin")
                path.write_bytes(failure.data)
                print(f"{path}\n{failure.traceback}", file=sys.stderr)
            took = time.monotonic() - started
            print(f"{total.total()} runs in {took:.0f} s: {dict(sorted(total.items()))}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
