"""Plots of compared policies, of a route, and of the search for a route.

python -m baselines.plots ranking out/arena/results.json --out out/plots
python -m baselines.plots gaps out/arena/results.json --out out/plots
python -m baselines.plots tour --family umad-20-v1 --policy insertion --instance 1000000 --out …
python -m baselines.plots convergence --family random-40-v1 --instance 1000000 --out out/plots
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from PIL import Image

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_compiler.route import RouteProblem, suggest_route
from argo_env.envs.route import RouteEnv
from argo_env.files.folders import make_folder
from baselines.comparison import PolicyComparison, PolicyStatistics
from baselines.episodes import EpisodeOutcome
from baselines.families import AlternatingSources, InstanceSet, find_test_set
from baselines.intervals import ConfidenceInterval
from baselines.policy import Policy, make_policy
from baselines.problem import PRIZE_UNIT, hindsight_problem
from baselines.references import BestKnown

_BEST, _BOUND, _DOMINATED = "#1f5f99", "#b45309", "#64707c"  # colours
_TICKS = (-20, -10, -5, -2, 0, 2, 5, 10, 20, 50)  # %


def plot_ranking(results_file: Path, folder: Path) -> list[Path]:
    """Plot processor time and gap to the best known routes of each policy, with the Pareto front.

    Returns the paths of the pictures in `folder`, one for each test set in the file `results`.
    Raises ArgoError if that is not a `results.json` of `python -m baselines.evaluate`.
    """
    return [
        _plot_ranking(comparison, folder / f"ranking-{comparison.test_set}.png")
        for comparison in read_comparisons(results_file)
    ]


def plot_gaps(results_file: Path, folder: Path) -> list[Path]:
    """Draw box plots of the gap of each policy to the best known route of each instance.

    Returns the paths of the pictures in `folder`, one for each test set in the file `results`.
    Raises ArgoError if that is not a `results.json` of `python -m baselines.evaluate`.
    """
    return [
        _box_plot(
            comparison.test_set, _gaps(comparison), folder / f"gaps-{comparison.test_set}.png"
        )
        for comparison in read_comparisons(results_file)
    ]


def _plot_ranking(comparison: PolicyComparison, picture: Path) -> Path:
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    front = comparison.pareto_front
    last = 10 * max(row.seconds.value for row in comparison.rows)
    axes.step(
        [*(row.seconds.value for row in front), last],
        [100 * row.gap.value for row in (*front, front[-1])],
        where="post", color=_BEST, linewidth=1, zorder=1,
        label="Pareto front: no other wins as much in less time",
    )  # fmt: skip
    for row in comparison.rows:
        gap, colour = row.gap, _BEST if row in front else _DOMINATED
        axes.errorbar(
            row.seconds.value, 100 * gap.value, color=colour, marker="o", capsize=2, linewidth=1,
            yerr=[[100 * (gap.value - gap.low)], [100 * (gap.high - gap.value)]],
        )  # fmt: skip
        axes.annotate(
            f"{row.policy}  {100 * gap.value:.1f}", (row.seconds.value, 100 * gap.value),
            xytext=(6, 5 if row in front else -11), textcoords="offset points", fontsize=8,
            color=colour,
        )  # fmt: skip
    _draw_best_known(axes, comparison)
    axes.set_xscale("log")
    axes.set_xlim(right=last)
    axes.set_yscale("symlog", linthresh=5.0)
    axes.set_yticks(_TICKS, [str(tick) for tick in _TICKS])
    axes.set_yticks([], minor=True)
    best = min(-100 * comparison.open, *(100 * row.gap.low for row in comparison.rows))
    axes.set_ylim(115 * max(row.gap.high for row in comparison.rows) + 1, 1.2 * best - 1)
    axes.set_xlabel("s of processor time for an instance")
    axes.set_ylabel("gap to the best known routes, %")
    axes.set_title(f"{comparison.test_set}, {comparison.instances} instances", fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", fontsize=8)
    return _save(figure, picture)


def _draw_best_known(axes: Axes, comparison: PolicyComparison) -> None:
    """Draw a line at the best known routes, and shade the gaps that the bounds leave possible."""
    open_ = 100 * comparison.open
    proven = f"proven for {comparison.proven} of {comparison.instances}"
    axes.axhline(0.0, color=_BOUND, linewidth=1, label=f"best known routes ({proven})")
    if open_ > 0.0:
        label = f"none wins more than {open_:.1f} % above them"
        axes.axhspan(-open_, 0.0, color=_BOUND, alpha=0.12, linewidth=0, label=label)


def read_comparisons(results_file: Path) -> list[PolicyComparison]:
    """Return the comparisons in a `results.json` of `python -m baselines.evaluate --out DIR`.

    Raises ArgoError if it can't be read or is no such file.
    """
    try:
        return [
            _to_comparison(data) for data in json.loads(results_file.read_text(encoding="utf-8"))
        ]
    except OSError as error:
        raise Unavailable(f"{results_file} can't be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise Invalid(
            f"{results_file} has no results of `python -m baselines.evaluate --out DIR`: give the "
            "results.json that it writes"
        ) from None


def _to_comparison(data: dict[str, Any]) -> PolicyComparison:
    """Return a comparison from its JSON; lists become tuples."""
    rows = [
        {name: ConfidenceInterval(**part) for name, part in row.items() if name != "policy"}
        for row in data["rows"]
    ]
    parts = {
        "rows": tuple(
            PolicyStatistics(policy=row["policy"], **intervals)
            for row, intervals in zip(data["rows"], rows, strict=True)
        ),
        "best": tuple(BestKnown(**one | {"route": tuple(one["route"])}) for one in data["best"]),
        "outcomes": {
            name: tuple(EpisodeOutcome(**one | {"route": tuple(one["route"])}) for one in outcomes)
            for name, outcomes in data["outcomes"].items()
        },
    }
    return PolicyComparison(**data | parts)


def _gaps(comparison: PolicyComparison) -> dict[str, list[float]]:
    """Return the gaps of each policy in %, the policy with the lowest mean first.

    Instances whose best known route has no prize are left out.
    """
    best = [reference.prize for reference in comparison.best]
    gaps = {
        policy: [100 * (1 - o.prize / b) for o, b in zip(outcomes, best, strict=True) if b > 0]
        for policy, outcomes in comparison.outcomes.items()
    }
    return dict(sorted(gaps.items(), key=lambda item: float(np.mean(item[1]))))


def _box_plot(name: str, gaps: dict[str, list[float]], picture: Path) -> Path:
    figure, axes = plt.subplots(figsize=(8, 0.8 + 0.45 * len(gaps)), layout="constrained")
    axes.boxplot(
        list(gaps.values()),
        orientation="horizontal",
        tick_labels=list(gaps),
        showmeans=True,
        widths=0.6,
        medianprops={"color": _BOUND},
        meanprops={"marker": "D", "markerfacecolor": _BEST, "markeredgecolor": _BEST,
                   "markersize": 4},
        flierprops={"marker": ".", "markersize": 4, "markeredgecolor": "#64707c"},
    )  # fmt: skip
    axes.invert_yaxis()
    axes.axvline(0.0, color="#64707c", linewidth=0.8)
    axes.set_xlabel("gap to the best known route, % of its prize (line: median, diamond: mean)")
    axes.set_title(f"{name}, {len(next(iter(gaps.values())))} instances", fontsize=10)
    axes.grid(axis="x", alpha=0.3)
    return _save(figure, picture)


def plot_prize_and_bound(
    name: str, problem: RouteProblem, time_limit: float, picture: Path
) -> Path:
    """Search for a route; plot its prize and the bound on the prize over the time of the search.

    Args:
        name: name of the instance, for the title.
        problem: the route problem.
        time_limit: time limit of the search in s.
        picture: file to write, which is also returned.

    Raises:
        ArgoError: if the optimiser returns no history of its search.
    """
    suggestion = suggest_route(problem, time_limit)
    history = suggestion.history
    if not history:
        raise Invalid(f"{name}: the optimiser returned no history of its search to plot")
    first, last = max(history[0].time, 1e-3), max(history[-1].time, 1e-3)
    everything = sum(visit.prize for visit in problem.visits)
    bounds = [(first / 2, everything), *((point.time, point.prize_bound) for point in history)]
    bounds.append((last, suggestion.prize_bound))
    prizes = [(point.time, point.prize) for point in history if point.prize]
    prizes += [] if suggestion.prize is None else [(last, suggestion.prize)]
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for points, colour, marker, label in (
        (bounds, _BOUND, "", "no route wins more"),
        (prizes, _BEST, ".", "best route so far"),
    ):
        times = [max(time, 1e-3) for time, _ in points]
        values = [PRIZE_UNIT * value for _, value in points]
        axes.step(times, values, where="post", color=colour, marker=marker, label=label)
    axes.set_xscale("log")
    axes.set_xlabel("s since the search began")
    axes.set_ylabel("prize")
    proof = "proven" if suggestion.proven else "not proven"
    title = f"{name}\n{suggestion.method}, {proof} after {history[-1].time:.2g} s"
    axes.set_title(title, fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend()
    return _save(figure, picture)


def draw_tour(test_set: InstanceSet, policy: Policy, number: int, picture: Path) -> Path:
    """Draw a policy's route on the instance `number` over the floor plans; return `picture`."""
    source = test_set.family.source
    if isinstance(source, AlternatingSources):
        source = source.source_for(number)
    env = RouteEnv(source=source, full=True, render_mode="rgb_array")
    observation, _ = env.reset(options={"instance": number})
    policy.begin(observation, env.instance.budget, 0)
    over = False
    while not over:
        observation, _, over, _, _ = env.step(policy.act(observation))
    image = env.render()
    make_folder(picture.parent)
    Image.fromarray(np.asarray(image)).save(picture)
    return picture


def _save(figure: Any, picture: Path) -> Path:
    make_folder(picture.parent)
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return picture


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status, 2 after an error that is reported."""
    parser = argparse.ArgumentParser(
        prog="python -m baselines.plots",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    ranking = kinds.add_parser("ranking", help="plot time and gap of each policy")
    gaps = kinds.add_parser("gaps", help="draw box plots of the gaps")
    for kind in (ranking, gaps):
        kind.add_argument("results", type=Path, metavar="RESULTS.json")
    tour = kinds.add_parser("tour", help="draw a policy's route on the floor plans")
    tour.add_argument("--policy", default="portfolio", metavar="NAME")
    convergence = kinds.add_parser("convergence", help="plot best prize and bound over time")
    convergence.add_argument("--time-limit", type=float, default=20.0, metavar="S")
    for kind in (tour, convergence):
        kind.add_argument("--family", default="random-20-v1", metavar="NAME")
        kind.add_argument("--instance", type=int, default=1_000_000, metavar="NUMBER")
    for kind in (ranking, gaps, tour, convergence):
        kind.add_argument("--out", type=Path, default=Path("out/plots"), metavar="DIR")
    options = parser.parse_args(arguments)
    try:
        for picture in _draw(options):
            print(picture)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _draw(options: argparse.Namespace) -> list[Path]:
    """Draw the pictures that the options ask for; return their files."""
    if options.kind == "ranking":
        return plot_ranking(options.results, options.out)
    if options.kind == "gaps":
        return plot_gaps(options.results, options.out)
    test_set, number = find_test_set(options.family), options.instance
    if number not in test_set.numbers:
        raise Invalid(
            f"test set {test_set.name} has the instances {test_set.numbers[0]} to "
            f"{test_set.numbers[-1]}, not {number}"
        )
    if options.kind == "tour":
        policy = options.policy.replace(":", "-")
        picture = options.out / f"tour-{test_set.name}-{number}-{policy}.png"
        return [draw_tour(test_set, make_policy(options.policy), number, picture)]
    problem = hindsight_problem(test_set.family.source.draw(number)).problem
    picture = options.out / f"convergence-{test_set.name}-{number}.png"
    return [
        plot_prize_and_bound(f"{test_set.name}, {number}", problem, options.time_limit, picture)
    ]


if __name__ == "__main__":
    sys.exit(main())
