"""Random machines and the reference: `python -m tests.campaigns.machines --count 40000`.

Each machine has a number, from which it is drawn again: `--first 17 --count 1`. The last line tells
what has happened, and how often.
"""

import argparse
import json
import sys
import traceback
from collections import Counter

import hypothesis

from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from tests import plain_strategies
from tests.argo_compiler.hfsm.counted import Counted
from tests.argo_compiler.hfsm.world import Hears, compare


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="machines that `check` accepts")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    options = parser.parse_args()
    hypothesis.strategies = sys.modules["hypothesis.strategies"] = plain_strategies
    from tests.argo_compiler.hfsm.random_missions import busy_cases, cases

    kinds = (cases(), cases(), cases(), busy_cases())
    seen = Counter()
    number = options.first
    while seen["run"] < options.count:
        case = plain_strategies.example(kinds[number % len(kinds)], number)
        if has_errors(check(case.mission)):
            seen["refused by check"] += 1
        else:
            seen["run"] += 1
            try:
                reference = compare(case, list(Hears)[number % 3], Counted)
                seen.update(reference.happened)
            except Exception:
                seen["differ"] += 1
                print(f"machine {number} differs:\n{traceback.format_exc()}", flush=True)
        number += 1
    print(f"machines {options.first} to {number - 1}")
    print(json.dumps(seen))
    sys.exit(bool(seen["differ"]))


if __name__ == "__main__":
    main()
