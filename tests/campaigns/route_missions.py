"""Campaign: predicted and simulated durations of scripts "in any order" on UMAD.

    python -m tests.campaigns.route_missions
    python -m tests.campaigns.route_missions --sheets 3 --drive tracked

A script lists 4, 8 or 20 checkpoints in random order, drawn from its seed, and starts and ends
docked in starting area 1. Its best order is computed as by `argo route`, and driven. The
table has the mission's durations: in the written order, as predicted for the suggested order, and
as driven in that order.
"""

import argparse
from collections.abc import Sequence

import numpy as np

from argo_compiler.base.catalog import Catalog
from argo_env.planning import open_site
from argo_env.run.drives_and_sensors import drive_names
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.importing import Upload, import_mission
from argo_planner.use_cases.routing import suggest_order
from benchmarks.options import parse_seed

SIZES = (4, 8, 20)


def make_script(catalog: Catalog, size: int, seed: int) -> str:
    """Return the text of a random script."""
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
    """Run the scripts and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--sizes", type=int, nargs="+", default=SIZES, help="numbers of checkpoints"
    )
    parser.add_argument("--sheets", type=int, default=2, help="scripts of each size")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of the first script")
    parser.add_argument("--drive", choices=drive_names(), default="kinematic")
    options = parser.parse_args(arguments)
    site = open_site("umad")
    print("| checkpoints | seed | as written | predicted | driven | off | proven |")
    print("|---|---|---|---|---|---|---|")
    worst = 0.0
    for size in options.sizes:
        for seed in range(options.seed, options.seed + options.sheets):
            upload = Upload("sheet.txt", make_script(site.catalog, size, seed).encode())
            suggestion = suggest_order(import_mission(upload, site), site, seed=seed)
            predicted = suggestion.reordering.duration
            record = simulate(
                RunSpec(mission=suggestion.mission, drive=options.drive, seed=seed),
            )
            if not record.result.success:
                raise SystemExit(f"script {seed} of {size}: {record.result.verdict}")
            driven = record.result.duration
            error = (predicted - driven) / driven
            worst = max(worst, abs(error))
            print(
                f"| {size} | {seed} | {suggestion.reordering.written_duration:.1f} s "
                f"| {predicted:.1f} s | {driven:.1f} s | {error:+.2%} "
                f"| {'yes' if suggestion.reordering.proven else 'no'} |",
                flush=True,
            )
    print(f"\npredicted and driven differ by {worst:.2%} at most")


if __name__ == "__main__":
    main()
