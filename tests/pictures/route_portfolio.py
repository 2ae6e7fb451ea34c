"""A picture of a search by the portfolio: the turns of its solvers, best route and bound over time.

    python -m tests.pictures.route_portfolio docs/images/route-portfolio.png
    python -m tests.pictures.route_portfolio out.png --time-limit 10 --workers 1

The command searches for routes of one problem of each kind, made from random positions, and draws
the solvers' turns above the curve of the best route and its bound. Nothing else should run on the
machine.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from argo_compiler.route import RouteProblem, RouteSuggestion, suggest_route
from benchmarks.routes_limits import KINDS, random_problem

CASES = {
    "any order, 70 visits": ("plain", 70),
    "prizes within a limit, 60": ("optional", 60),
    "order, 50": ("order", 50),
    "time windows, 80": ("windows", 80),
    "a battery, 30": ("battery", 30),
    "rounds, 25": ("rounds", 25),
}


def make_problem(kind: str, count: int) -> RouteProblem:
    """Return a random problem of that kind (see `benchmarks.routes_limits`)."""
    rng = np.random.default_rng(count)
    return KINDS[kind](random_problem(count, rng), rng)


def draw_search(name: str, made: RouteSuggestion, turns: Axes, curve: Axes) -> None:
    """Draw the turns of one search, and below them its best route and bound over time."""
    solvers = list(dict.fromkeys(turn.solver for turn in made.turns))
    end = max((turn.end for turn in made.turns), default=0.0)
    for turn in made.turns:
        row = solvers.index(turn.solver)
        length = max(turn.end - turn.begin, 0.004 * end)
        turns.barh(row, length, left=turn.begin, color=f"C{row}", height=0.7)
    turns.set_yticks(range(len(solvers)), solvers, fontsize=8)
    turns.invert_yaxis()
    result = "proven" if made.proven else f"gap {made.gap:.1%}" if made.gap is not None else "none"
    turns.set_title(f"{name}: {result} after {end:.1f} s", fontsize=10)
    turns.tick_params(axis="x", labelsize=8)
    curve.tick_params(labelsize=8)
    curve.set_xlabel("s", fontsize=8)
    if made.history:
        draw_history(made, end, curve)


def draw_history(made: RouteSuggestion, end: float, curve: Axes) -> None:
    """Draw the best route and the bound that were known at each time, up to the `end` (s)."""
    prizes = made.prize_bound > 0 and any(p.prize != made.prize for p in made.history if p.prize)
    times = [p.time for p in made.history] + [end]
    best = [(p.prize if prizes else p.cost) for p in made.history]
    bound = [(p.prize_bound if prizes else p.bound) for p in made.history]
    values = [np.nan if value is None else value for value in best]
    curve.step(times, [*values, values[-1]], where="post", color="black", label="best route")
    curve.step(times, [*bound, bound[-1]], where="post", color="tab:red", ls="--", label="bound")
    curve.set_ylabel("prize" if prizes else "cost, s", fontsize=8)
    known = [value for value in [*values, *bound] if np.isfinite(value) and value > 0]
    found = [value for value in values if np.isfinite(value)]
    if known and found:
        curve.set_ylim(0.9 * min(known), 1.05 * max(known if prizes else found))


def main(arguments: Sequence[str] | None = None) -> None:
    """Search and draw."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--time-limit", type=float, default=5.0, help="s for each problem")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args(arguments)
    figure, axes = plt.subplots(
        6, 2, figsize=(11, 13), height_ratios=[1.2, 1] * 3, sharex="none", layout="constrained"
    )
    suggest_route(make_problem("plain", 3))  # imports the libraries
    for number, (name, (kind, count)) in enumerate(CASES.items()):
        made = suggest_route(make_problem(kind, count), given.time_limit, workers=given.workers)
        row, column = 2 * (number // 2), number % 2
        axes[row + 1, column].sharex(axes[row, column])
        draw_search(name, made, axes[row, column], axes[row + 1, column])
    axes[1, 0].legend(fontsize=8)
    figure.savefig(given.output, dpi=110)


if __name__ == "__main__":
    main()
