"""Pictures of `docs/evaluating.md`: mission #1 with a lower time limit, and several faults.

python -m tests.pictures.evaluation docs/images
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from argo_compiler.il.mission import Order
from argo_env.evaluation.comparison import compare_plans
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.plots import (
    forest_of_rates,
    heat_map_of_outcomes_by_faults,
    histogram_of_duration_differences,
    success_share_over_time,
)
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.worlds import Variation
from argo_env.faults.loading import read_faults
from argo_env.planning.opening import open_site
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission
from argo_planner.use_cases.routing import suggest_order

UMAD = Path(__file__).parents[2] / "scenarios" / "umad"
FAULTS = ("connection_loss", "drive_dysfunction", "emergency_stop", "low_battery", "worn_battery")


def evaluate_mission(worlds: int) -> EvaluationResults:
    """Evaluate mission #1 as written and in the best order, with a lower time limit."""
    site = open_site("umad").prepare()
    script = UMAD / "missions" / "mission_1.txt"
    upload = Upload(script.name, script.read_bytes())
    mission = import_mission(upload, site, 1, 2).mission
    free = mission.model_copy(update={"order": Order.ANY})
    suggested = suggest_order(ImportedMission(free, script.name, (), ()), site).mission
    plans = {
        name: plan.model_copy(update={"max_duration": 430.0})
        for name, plan in (("as written", mission), ("optimised", suggested))
    }
    faults = {name: read_faults(UMAD / "faults" / f"{name}.yaml") for name in FAULTS}
    return Evaluation(
        plans,
        site,
        faults={"none": (), **faults},
        seeds=range(worlds),
        worlds=Variation(speed=(0.75, 1.0), charge=(0.5, 1.0)),
        name="mission #1",
    ).run()


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--worlds", type=int, default=60)
    given = parser.parse_args(arguments)
    results = evaluate_mission(given.worlds)
    first, second = results.plan.plans
    rates = Figure(figsize=(11, 4.6), layout="constrained")
    left, right = rates.subplots(1, 2)
    forest_of_rates(results, left)
    success_share_over_time(results, right)
    why = Figure(figsize=(11, 3.2), layout="constrained")
    left, right = why.subplots(1, 2)
    heat_map_of_outcomes_by_faults(results, left, first)
    histogram_of_duration_differences(compare_plans(results, results, first, second), right)
    for figure, name in ((rates, "evaluation-rates"), (why, "evaluation-why")):
        path = given.folder / f"{name}.png"
        figure.savefig(path, dpi=110)
        print(path)


if __name__ == "__main__":
    main()
