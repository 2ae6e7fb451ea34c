"""Comparison of policies on fixed test sets: prize, gap to the best known routes, and time.

    python -m baselines.evaluate                                   # all policies on random-20-v1
    python -m baselines.evaluate --family noisy-20-v1 umad-20-v1 --policy learned portfolio-resolved
    python -m baselines.evaluate --policy my_module:MyPolicy --instances 10 --out out/mine

Intervals are 95 % intervals of a bootstrap over instances, paired between policies. The gap is the
relative difference of the prizes to those of the best known routes (see `python -m
baselines.references`). s/instance is processor time. A star marks the Pareto front: no other policy
wins as much in less time.
"""

import argparse
import csv
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_compiler.base.stages import listen_to_stages, stage
from argo_env.files.folders import make_folder
from argo_env.policies import POLICIES
from baselines.comparison import BetterRoute, PolicyComparison, compare_policies
from baselines.episodes import play
from baselines.families import TEST_SETS, find_test_set
from baselines.intervals import ConfidenceInterval
from baselines.policy import OWN_POLICIES, Policy, make_policy
from baselines.references import load_references
from baselines.stage_lines import StageLines

_DEFAULT = "random-20-v1"
_WIDTH = 150  # characters of a line of a table that is written to a file


COLUMNS = (
    "", "policy", "s/instance", "prize", "gap vs best known %", "behind the first",
    "docked after s", "feasible %",
)  # fmt: skip


def comparison_title(comparison: PolicyComparison) -> str:
    """Return the test set, the number of instances and how far the best known routes are proven."""
    title = (
        f"{comparison.test_set}: {comparison.instances} instances, the best known route is proven "
        f"optimal for {comparison.proven}"
    )
    if comparison.proven == comparison.instances:
        return title
    return f"{title}; no routes win more than {100 * comparison.open:.1f} % above the best known"


def beaten_reference_warnings(comparison: PolicyComparison) -> list[str]:
    """Return one warning for each policy that beats the best known route of any instance."""
    better: dict[str, list[BetterRoute]] = {}
    for route in comparison.better_routes:
        better.setdefault(route.policy, []).append(route)
    return [
        f"{name} BEATS the best known routes of {comparison.test_set} on {len(routes)} of "
        f"{comparison.instances} instances (first {routes[0].instance}: {routes[0].prize:.2f}, "
        f"known {routes[0].known:.2f}): they are out of date, and the gaps are too small. Write "
        "results with --out DIR, and run `python -m baselines.references "
        f"{comparison.test_set} --results DIR/results.json`"
        for name, routes in better.items()
    ]


def table_rows(comparison: PolicyComparison) -> list[tuple[str, ...]]:
    """Return the cells of the table, a row for each policy, the highest mean prize first."""
    return [
        (
            "*" if row in comparison.pareto_front else "",
            row.policy,
            f"{row.seconds.value:.2g}",
            _format_interval(row.prize, 1, 2),
            _format_interval(row.gap, 100, 2),
            _format_interval(row.behind, 1, 2),
            _format_interval(row.time, 1, 0),
            _format_interval(row.feasible, 100, 0),
        )
        for row in sorted(comparison.rows, key=lambda row: -row.prize.value)
    ]


def _format_interval(interval: ConfidenceInterval, scale: float, digits: int) -> str:
    numbers = (interval.value, interval.low, interval.high)
    value, low, high = (f"{round(scale * n, digits) + 0.0:.{digits}f}" for n in numbers)
    return value if low == high else f"{value} [{low}, {high}]"


def make_table(comparison: PolicyComparison) -> Table:
    """Return the table of a comparison for the terminal, with title and caption."""
    caption = (
        "*: no other wins as much in less time; in brackets: 95 % intervals, bootstrap over "
        "instances, paired"
    )
    table = Table(title=comparison_title(comparison), caption=caption)
    for name in COLUMNS:
        table.add_column(name, justify="left" if name == "policy" else "right")
    for row in table_rows(comparison):
        table.add_row(*row)
    return table


def to_markdown(comparison: PolicyComparison) -> str:
    """Return title, table and warnings of a comparison as Markdown text."""
    rows = [COLUMNS, ("---",) * len(COLUMNS), *table_rows(comparison)]
    text = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    warnings = "".join(f"\n{warning}\n" for warning in beaten_reference_warnings(comparison))
    return f"{comparison_title(comparison)}\n\n{text}{warnings}"


def write_results(comparisons: Sequence[PolicyComparison], folder: Path) -> None:
    """Write three files with the comparisons into a folder, which is made if needed.

    `results.json` has all data, `results.csv` a line for each route, `results.md` the tables.
    """
    make_folder(folder)
    data = [asdict(comparison) for comparison in comparisons]
    (folder / "results.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    text = "\n".join(to_markdown(comparison) for comparison in comparisons)
    (folder / "results.md").write_text(text, encoding="utf-8")
    routes = [
        {
            "test_set": comparison.test_set,
            "policy": name,
            "best": best.prize,
            "bound": best.bound,
            **asdict(outcome),
            "route": " ".join(map(str, outcome.route)),
        }
        for comparison in comparisons
        for name, outcomes in comparison.outcomes.items()
        for outcome, best in zip(outcomes, comparison.best, strict=True)
    ]
    with (folder / "results.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(routes[0]))
        writer.writeheader()
        writer.writerows(routes)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status, 2 after an error that is reported."""
    parser = argparse.ArgumentParser(
        prog="python -m baselines.evaluate",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--family",
        nargs="+",
        default=[_DEFAULT],
        metavar="NAME",
        help=f"test sets, from {', '.join(TEST_SETS)}; default {_DEFAULT}",
    )
    parser.add_argument(
        "--policy",
        nargs="+",
        default=None,
        metavar="NAME",
        help=f"policies, from {', '.join(POLICIES)}, or module:class; default all of Argo's that "
        "are installed",
    )
    parser.add_argument(
        "--instances",
        type=int,
        default=100,
        metavar="N",
        help="number of first instances of each test set; default 100, all of them",
    )
    parser.add_argument(
        "--seed", type=int, default=0, help="seed of the policies and the bootstrap; default 0"
    )
    parser.add_argument("--out", type=Path, metavar="DIR",
                        help="folder for results.json, results.csv and results.md")  # fmt: skip
    options = parser.parse_args(arguments)
    try:
        with listen_to_stages(StageLines(lambda line: print(line, file=sys.stderr, flush=True))):
            _evaluate(options)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return 0


def _policies(names: Sequence[str]) -> Iterator[tuple[str, Policy]]:
    for name in names:
        yield name, make_policy(name)


def _installed_policies() -> Iterator[tuple[str, Policy]]:
    """Yield Argo's policies; without the extra that the learned ones need, name those left out."""
    for name in OWN_POLICIES:
        try:
            yield name, make_policy(name)
        except Unavailable as error:
            print(f"left out: {name} ({error})", file=sys.stderr)


def _evaluate(options: argparse.Namespace) -> None:
    test_sets = [find_test_set(name) for name in dict.fromkeys(options.family)]
    available = min(len(test_set.numbers) for test_set in test_sets)
    if not 1 <= options.instances <= available:
        raise Invalid(
            f"--instances is {options.instances}: give a number of instances from 1 to {available}"
        )
    if options.seed < 0:
        raise Invalid(f"--seed is {options.seed}: give a number of at least 0")
    best = {s.name: load_references(s.name)[: options.instances] for s in test_sets}
    policies = dict(_installed_policies() if options.policy is None else _policies(options.policy))
    if options.out is not None:
        make_folder(options.out)
    console, notes = Console(), Console(stderr=True)
    if not console.is_terminal:
        console = Console(width=_WIDTH)
    comparisons = []
    for test_set in test_sets:
        outcomes = {}
        for name, policy in policies.items():
            notes.print(f"{test_set.name}: {name} …", highlight=False)
            # The measured time does not include what is loaded or compiled on first use.
            for _ in play(policy, test_set, 1, options.seed):
                pass
            done = []
            with stage(f"{test_set.name}: {name}") as report:
                for outcome in play(policy, test_set, options.instances, options.seed):
                    done.append(outcome)
                    report(len(done) / options.instances)
            outcomes[name] = tuple(done)
        comparisons.append(compare_policies(test_set, outcomes, best[test_set.name], options.seed))
        console.print(make_table(comparisons[-1]))
        for warning in beaten_reference_warnings(comparisons[-1]):
            notes.print(f"WARNING: {warning}", style="bold red", highlight=False, soft_wrap=True)
        if options.out is not None:
            write_results(comparisons, options.out)


if __name__ == "__main__":
    sys.exit(main())
