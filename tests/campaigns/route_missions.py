"""Mission sheets "in any order" on UMAD: what is predicted, and what the simulator drives.

    python -m tests.campaigns.route_missions
    python -m tests.campaigns.route_missions --sheets 3 --drive tracked

A sheet lists 4, 8 or 20 checkpoints, drawn and in an order drawn from its seed, and starts and ends
docked in starting area 1. Its best order is asked for as `argo route` does, and driven. The times
are those of the mission: as it is written, as predicted for the order that was suggested, and as
driven in it.
"""

import argparse
from collections.abc import Sequence

import numpy as np

from argo_compiler.base.catalog import Catalog
from argo_env.planning import open_site
from argo_env.run.drives_and_sensors import DRIVES
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.importing import Upload, import_mission
from argo_planner.use_cases.routing import suggest_order
from benchmarks.options import parse_seed

SIZES = (4, 8, 20)


def sheet(catalog: Catalog, size: int, seed: int) -> str:
    """The text of a sheet."""
    rng = np.random.default_rng((seed, size))
    chosen = rng.permutation(len(catalog.checkpoints))[:size]
    lines = [
        f"Mission's designation:\tSheet {seed} of {size}",
        "Main mode:\tAutonomous",
        "Maximum mission total duration:\t4 h",
        'Initial position:\tdocked in "Starting area" 1',
        'End of the mission:\tdocked in "Starting area" 1',
        "Inspect the checkpoints in any order:",
    ]
    ids = [catalog.checkpoints[k].id for k in chosen.tolist()]
    lines += [f"{number}. Checkpoint #{id}" for number, id in enumerate(ids, start=1)]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the sheets and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="checkpoints")
    parser.add_argument("--sheets", type=int, default=2, help="of each size")
    parser.add_argument("--seed", type=parse_seed, default=0, help="of the first sheet")
    parser.add_argument("--drive", choices=DRIVES, default="kinematic")
    options = parser.parse_args(arguments)
    site = open_site("umad")
    print("| checkpoints | sheet | as written | predicted | driven | off | proven |")
    print("|---|---|---|---|---|---|---|")
    worst = 0.0
    for size in options.sizes:
        for seed in range(options.seed, options.seed + options.sheets):
            upload = Upload("sheet.txt", sheet(site.catalog, size, seed).encode())
            found = suggest_order(import_mission(upload, site), site, seed=seed)
            predicted = found.reordering.duration
            record = simulate(
                RunSpec(mission=found.mission, drive=options.drive, seed=seed),
            )
            if not record.result.success:
                raise SystemExit(f"sheet {seed} of {size}: {record.result.verdict}")
            driven = record.result.duration
            off = (predicted - driven) / driven
            worst = max(worst, abs(off))
            print(
                f"| {size} | {seed} | {found.reordering.written_duration:.1f} s "
                f"| {predicted:.1f} s | {driven:.1f} s | {off:+.2%} "
                f"| {'yes' if found.reordering.proven else 'no'} |",
                flush=True,
            )
    print(f"\npredicted and driven differ by {worst:.2%} at most")


if __name__ == "__main__":
    main()
