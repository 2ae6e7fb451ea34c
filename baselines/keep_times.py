"""Command that computes and stores the missing travel times of the test sets' sites.

python -m baselines.keep_times
"""

import sys

from baselines.families import TEST_SETS
from baselines.stored_times import load_site_times, store_site_times


def main() -> None:
    """Store the travel times of all sites of the test sets that have none stored."""
    sites = {site for s in TEST_SETS.values() for site in s.family.sites} - {"random"}
    for site in sorted(sites):
        if load_site_times(site) is None:
            print(f"{site} …", file=sys.stderr, flush=True)
            store_site_times(site)


if __name__ == "__main__":
    main()
