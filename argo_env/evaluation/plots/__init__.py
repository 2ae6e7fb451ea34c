"""Pictures of evaluations: functions that draw on the axes that they are given, and return them."""

from argo_env.evaluation.plots.delays import detection_delays
from argo_env.evaluation.plots.differences import paired_differences
from argo_env.evaluation.plots.duration_curves import durations
from argo_env.evaluation.plots.forest import forest_of_rates
from argo_env.evaluation.plots.outcomes import outcomes_by_faults
from argo_env.evaluation.plots.pairs import pairs_that_differ
from argo_env.evaluation.plots.places import failure_places

__all__ = [
    "detection_delays",
    "durations",
    "failure_places",
    "forest_of_rates",
    "outcomes_by_faults",
    "paired_differences",
    "pairs_that_differ",
]
