"""Policies compared on fixed test sets: prize, gap to the best known routes, and time.

    python -m baselines.evaluate                                   # all policies on random-20-v1
    python -m baselines.evaluate --family noisy-20-v1 umad-20-v1 --policy learned portfolio-resolved
    python -m baselines.evaluate --policy my_module:MyPolicy --instances 10 --out out/mine

Intervals are 95 % intervals of a bootstrap over instances, paired between policies. The gap is
by how much the mean prize is below that of the best routes that are known (see `python -m
baselines.references`). s/instance is processor time. A star marks the Pareto front: no other policy
wins as much in less time.
"""

import argparse
import csv
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

from argo_compiler.base.errors import ArgoError, Invalid
from argo_compiler.base.stages import listen_to_stages, stage
from argo_env.files.folders import make_folder
from baselines.comparison import Beaten, PolicyComparison, compare
from baselines.episodes import play
from baselines.families import TEST_SETS, find_set
from baselines.intervals import ConfidenceInterval
from baselines.policy import POLICIES, make_policy
from baselines.references import references
from baselines.stage_lines import StageLines

_DEFAULT = "random-20-v1"
_WIDTH = 150  # characters of a table that goes to a file


COLUMNS = (
    "", "policy", "s/instance", "prize", "gap vs best known %", "behind the first",
    "docked after s", "feasible %",
)  # fmt: skip


def title(comparison: PolicyComparison) -> str:
    """What is compared."""
    said = (
        f"{comparison.test_set}: {comparison.instances} instances, the best known route proven to "
        f"be the best for {comparison.proven}"
    )
    if comparison.proven == comparison.instances:
        return said
    return f"{said}; no routes win more than {100 * comparison.open:.1f} % above the best known"


def warnings(comparison: PolicyComparison) -> list[str]:
    """What is wrong with the best known routes: each policy that found better ones."""
    found: dict[str, list[Beaten]] = {}
    for one in comparison.beaten:
        found.setdefault(one.policy, []).append(one)
    return [
        f"{name} BEATS the best known routes of {comparison.test_set} on {len(those)} of "
        f"{comparison.instances} instances (first {those[0].instance}: {those[0].prize:.2f}, known "
        f"{those[0].known:.2f}): they are stale, and gaps to them say too little. Write results "
        f"with --out DIR, and run `python -m baselines.references {comparison.test_set} --results "
        "DIR/results.json`"
        for name, those in found.items()
    ]


def lines(comparison: PolicyComparison) -> list[tuple[str, ...]]:
    """What is printed of each policy, the best first."""
    return [
        (
            "*" if row in comparison.front else "",
            row.policy,
            f"{row.seconds.value:.2g}",
            _said(row.prize, 1, 2),
            _said(row.gap, 100, 2),
            _said(row.behind, 1, 2),
            _said(row.time, 1, 0),
            _said(row.feasible, 100, 0),
        )
        for row in sorted(comparison.rows, key=lambda row: -row.prize.value)
    ]


def _said(interval: ConfidenceInterval, scale: float, digits: int) -> str:
    numbers = (interval.value, interval.low, interval.high)
    value, low, high = (f"{round(scale * n, digits) + 0.0:.{digits}f}" for n in numbers)
    return value if low == high else f"{value} [{low}, {high}]"


def table(comparison: PolicyComparison) -> Table:
    """The comparison as it is printed."""
    caption = (
        "*: no other wins as much in less time; in brackets: 95 % intervals, bootstrap over "
        "instances, paired"
    )
    made = Table(title=title(comparison), caption=caption)
    for name in COLUMNS:
        made.add_column(name, justify="left" if name == "policy" else "right")
    for line in lines(comparison):
        made.add_row(*line)
    return made


def markdown(comparison: PolicyComparison) -> str:
    """The same as a table in Markdown."""
    rows = [COLUMNS, ("---",) * len(COLUMNS), *lines(comparison)]
    text = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    warned = "".join(f"\n{warning}\n" for warning in warnings(comparison))
    return f"{title(comparison)}\n\n{text}{warned}"


def write(comparisons: Sequence[PolicyComparison], folder: Path) -> None:
    """Writes `results.json` with everything, `results.csv` with a line for each route, and
    `results.md` with what is printed."""
    make_folder(folder)
    data = [asdict(comparison) for comparison in comparisons]
    (folder / "results.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    text = "\n".join(markdown(comparison) for comparison in comparisons)
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
    """The exit status: 2 if something that was asked for is not there."""
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
        help=f"test sets, of {', '.join(TEST_SETS)}; default {_DEFAULT}",
    )
    parser.add_argument(
        "--policy",
        nargs="+",
        default=list(POLICIES),
        metavar="NAME",
        help=f"of {', '.join(POLICIES)}, or module:class; default all",
    )
    parser.add_argument(
        "--instances",
        type=int,
        default=100,
        metavar="N",
        help="the first ones of each test set; default all 100",
    )
    parser.add_argument("--seed", type=int, default=0, help="of policies and bootstrap; default 0")
    parser.add_argument("--out", type=Path, metavar="DIR",
                        help="write results.json, results.csv and results.md here")  # fmt: skip
    given = parser.parse_args(arguments)
    try:
        with listen_to_stages(StageLines(lambda line: print(line, file=sys.stderr, flush=True))):
            _evaluate(given)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _evaluate(given: argparse.Namespace) -> None:
    sets = [find_set(name) for name in dict.fromkeys(given.family)]
    most = min(len(tests.numbers) for tests in sets)
    if not 1 <= given.instances <= most:
        raise Invalid(f"--instances is {given.instances}, and has to be 1 to {most}")
    if given.seed < 0:
        raise Invalid(f"--seed is {given.seed}, and has to be at least 0")
    best = {tests.name: references(tests.name)[: given.instances] for tests in sets}
    policies = {name: make_policy(name) for name in dict.fromkeys(given.policy)}
    if given.out is not None:
        make_folder(given.out)
    console, notes = Console(), Console(stderr=True)
    if not console.is_terminal:
        console = Console(width=_WIDTH)
    comparisons = []
    for tests in sets:
        outcomes = {}
        for name, policy in policies.items():
            notes.print(f"{tests.name}: {name} …", highlight=False)
            # What is loaded or compiled the first time is no time to think.
            for _ in play(policy, tests, 1, given.seed):
                pass
            done = []
            with stage(f"{tests.name}: {name}") as tell:
                for outcome in play(policy, tests, given.instances, given.seed):
                    done.append(outcome)
                    tell(len(done) / given.instances)
            outcomes[name] = tuple(done)
        comparisons.append(compare(tests, outcomes, best[tests.name], given.seed))
        console.print(table(comparisons[-1]))
        for warning in warnings(comparisons[-1]):
            notes.print(f"WARNING: {warning}", style="bold red", highlight=False, soft_wrap=True)
        if given.out is not None:
            write(comparisons, given.out)


if __name__ == "__main__":
    sys.exit(main())
