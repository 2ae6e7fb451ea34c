"""Finds the travel times of the test sets' sites that are not kept yet, and keeps them.

python -m baselines.keep_times
"""

import sys

from baselines.families import TEST_SETS
from baselines.kept_times import keep_times, kept_times


def main() -> None:
    """Keeps the travel times of all sites of the test sets that are not kept yet."""
    sites = {site for one in TEST_SETS.values() for site in one.family.sites} - {"random"}
    for site in sorted(sites):
        if kept_times(site) is None:
            print(f"{site} …", file=sys.stderr, flush=True)
            keep_times(site)


if __name__ == "__main__":
    main()
