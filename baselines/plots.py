"""Plots of the arena.

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
from baselines.comparison import PolicyComparison, Row
from baselines.episodes import EpisodeOutcome
from baselines.families import InstanceSet, TurnTaking, find_set
from baselines.intervals import ConfidenceInterval
from baselines.policy import Policy, make_policy
from baselines.problem import HUNDREDTH, hindsight
from baselines.references import BestKnown

_FOUND, _BOUND, _BEHIND = "#1f5f99", "#b45309", "#64707c"
_TICKS = (-20, -10, -5, -2, 0, 2, 5, 10, 20, 50)  # %


def plot_ranking(results: Path, folder: Path) -> list[Path]:
    """For each test set in a `results.json`, each policy by its time and its gap to the best known
    routes, with the Pareto front. Raises ArgoError if it is no such file."""
    return [
        _ranking(one, folder / f"ranking-{one.test_set}.png") for one in read_comparisons(results)
    ]


def plot_gaps(results: Path, folder: Path) -> list[Path]:
    """A box plot for each test set in a `results.json`: by what share of the best known route's
    prize each policy is below it, instance by instance. Raises ArgoError if it is no such file."""
    return [
        _box_plot(one.test_set, _gaps(one), folder / f"gaps-{one.test_set}.png")
        for one in read_comparisons(results)
    ]


def _ranking(comparison: PolicyComparison, picture: Path) -> Path:
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    front = comparison.front
    last = 10 * max(row.seconds.value for row in comparison.rows)
    axes.step(
        [*(row.seconds.value for row in front), last],
        [100 * row.gap.value for row in (*front, front[-1])],
        where="post", color=_FOUND, linewidth=1, zorder=1,
        label="Pareto front: no other wins as much in less time",
    )  # fmt: skip
    for row in comparison.rows:
        gap, colour = row.gap, _FOUND if row in front else _BEHIND
        axes.errorbar(
            row.seconds.value, 100 * gap.value, color=colour, marker="o", capsize=2, linewidth=1,
            yerr=[[100 * (gap.value - gap.low)], [100 * (gap.high - gap.value)]],
        )  # fmt: skip
        axes.annotate(
            f"{row.policy}  {100 * gap.value:.1f}", (row.seconds.value, 100 * gap.value),
            xytext=(6, 5 if row in front else -11), textcoords="offset points", fontsize=8,
            color=colour,
        )  # fmt: skip
    _best_known_lines(axes, comparison)
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
    return _saved(figure, picture)


def _best_known_lines(axes: Axes, comparison: PolicyComparison) -> None:
    """At the best known routes; and above, what is not proven to be out of reach."""
    open_ = 100 * comparison.open
    proven = f"proven for {comparison.proven} of {comparison.instances}"
    axes.axhline(0.0, color=_BOUND, linewidth=1, label=f"best known routes ({proven})")
    if open_ > 0.0:
        label = f"none wins more than {open_:.1f} % above them"
        axes.axhspan(-open_, 0.0, color=_BOUND, alpha=0.12, linewidth=0, label=label)


def read_comparisons(results: Path) -> list[PolicyComparison]:
    """What `python -m baselines.evaluate --out DIR` wrote as `results.json`. Raises ArgoError if it
    is no such file."""
    try:
        return [_comparison(one) for one in json.loads(results.read_text(encoding="utf-8"))]
    except OSError as error:
        raise Unavailable(f"{results} can't be read: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise Invalid(
            f"{results} has no results of `python -m baselines.evaluate --out DIR`: give the "
            "results.json that it writes"
        ) from None


def _comparison(data: dict[str, Any]) -> PolicyComparison:
    """Lists are read as tuples."""
    rows = [
        {name: ConfidenceInterval(**part) for name, part in row.items() if name != "policy"}
        for row in data["rows"]
    ]
    parts = {
        "rows": tuple(
            Row(policy=row["policy"], **figures)
            for row, figures in zip(data["rows"], rows, strict=True)
        ),
        "best": tuple(BestKnown(**one | {"route": tuple(one["route"])}) for one in data["best"]),
        "outcomes": {
            name: tuple(EpisodeOutcome(**one | {"route": tuple(one["route"])}) for one in found)
            for name, found in data["outcomes"].items()
        },
    }
    return PolicyComparison(**data | parts)


def _gaps(comparison: PolicyComparison) -> dict[str, list[float]]:
    """Of each policy, in %, the best on average first; instances without a prize are left out."""
    best = [reference.prize for reference in comparison.best]
    found = {
        policy: [100 * (1 - o.prize / b) for o, b in zip(outcomes, best, strict=True) if b > 0]
        for policy, outcomes in comparison.outcomes.items()
    }
    return dict(sorted(found.items(), key=lambda item: float(np.mean(item[1]))))


def _box_plot(name: str, gaps: dict[str, list[float]], picture: Path) -> Path:
    figure, axes = plt.subplots(figsize=(8, 0.8 + 0.45 * len(gaps)), layout="constrained")
    axes.boxplot(
        list(gaps.values()),
        orientation="horizontal",
        tick_labels=list(gaps),
        showmeans=True,
        widths=0.6,
        medianprops={"color": _BOUND},
        meanprops={"marker": "D", "markerfacecolor": _FOUND, "markeredgecolor": _FOUND,
                   "markersize": 4},
        flierprops={"marker": ".", "markersize": 4, "markeredgecolor": "#64707c"},
    )  # fmt: skip
    axes.invert_yaxis()
    axes.axvline(0.0, color="#64707c", linewidth=0.8)
    axes.set_xlabel("gap to the best known route, % of its prize (line: median, diamond: mean)")
    axes.set_title(f"{name}, {len(next(iter(gaps.values())))} instances", fontsize=10)
    axes.grid(axis="x", alpha=0.3)
    return _saved(figure, picture)


def plot_convergence(name: str, problem: RouteProblem, time_limit: float, picture: Path) -> Path:
    """The prize of the best route so far and what no route can exceed, over the time of search."""
    suggestion = suggest_route(problem, time_limit)
    history = suggestion.history
    if not history:
        raise Invalid(f"{name}: the optimiser says nothing of its search, there is no history")
    first, last = max(history[0].time, 1e-3), max(history[-1].time, 1e-3)
    everything = sum(visit.prize for visit in problem.visits)
    bounds = [(first / 2, everything), *((point.time, point.prize_bound) for point in history)]
    bounds.append((last, suggestion.prize_bound))
    prizes = [(point.time, point.prize) for point in history if point.prize]
    prizes.append((last, suggestion.prize))
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for points, colour, marker, label in (
        (bounds, _BOUND, "", "no route wins more"),
        (prizes, _FOUND, ".", "best route so far"),
    ):
        times = [max(time, 1e-3) for time, _ in points]
        values = [HUNDREDTH * value for _, value in points]
        axes.step(times, values, where="post", color=colour, marker=marker, label=label)
    axes.set_xscale("log")
    axes.set_xlabel("s since the search began")
    axes.set_ylabel("prize")
    proof = "proven" if suggestion.proven else "not proven"
    title = f"{name}\n{suggestion.method}, {proof} after {history[-1].time:.2g} s"
    axes.set_title(title, fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend()
    return _saved(figure, picture)


def draw_tour(tests: InstanceSet, policy: Policy, number: int, picture: Path) -> Path:
    """The route of a policy on the plans of the floors."""
    source = tests.family.source
    if isinstance(source, TurnTaking):
        source = source.of(number)
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


def _saved(figure: Any, picture: Path) -> Path:
    make_folder(picture.parent)
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return picture


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 2 if there is nothing to draw."""
    parser = argparse.ArgumentParser(
        prog="python -m baselines.plots",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    ranking = kinds.add_parser("ranking", help="time and gap of each policy")
    gaps = kinds.add_parser("gaps", help="box plots of gaps")
    for kind in (ranking, gaps):
        kind.add_argument("results", type=Path, metavar="RESULTS.json")
    tour = kinds.add_parser("tour", help="a policy's route on the floors")
    tour.add_argument("--policy", default="portfolio", metavar="NAME")
    convergence = kinds.add_parser("convergence", help="best prize and bound over time")
    convergence.add_argument("--time-limit", type=float, default=20.0, metavar="S")
    for kind in (tour, convergence):
        kind.add_argument("--family", default="random-20-v1", metavar="NAME")
        kind.add_argument("--instance", type=int, default=1_000_000, metavar="NUMBER")
    for kind in (ranking, gaps, tour, convergence):
        kind.add_argument("--out", type=Path, default=Path("out/plots"), metavar="DIR")
    given = parser.parse_args(arguments)
    try:
        for picture in _draw(given):
            print(picture)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _draw(given: argparse.Namespace) -> list[Path]:
    if given.kind == "ranking":
        return plot_ranking(given.results, given.out)
    if given.kind == "gaps":
        return plot_gaps(given.results, given.out)
    tests, number = find_set(given.family), given.instance
    if number not in tests.numbers:
        raise Invalid(
            f"test set {tests.name} has the instances {tests.numbers[0]} to {tests.numbers[-1]}, "
            f"not {number}"
        )
    if given.kind == "tour":
        picture = given.out / f"tour-{tests.name}-{number}-{given.policy.replace(':', '-')}.png"
        return [draw_tour(tests, make_policy(given.policy), number, picture)]
    problem = hindsight(tests.family.source.draw(number)).problem
    picture = given.out / f"convergence-{tests.name}-{number}.png"
    return [plot_convergence(f"{tests.name}, {number}", problem, given.time_limit, picture)]


if __name__ == "__main__":
    sys.exit(main())
