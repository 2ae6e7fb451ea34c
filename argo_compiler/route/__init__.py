"""The best order of a mission's checkpoints: the problem, its solvers, and what they suggest."""

from argo_compiler.route.evaluation import Evaluation, evaluate
from argo_compiler.route.problem import (
    NEVER,
    Battery,
    Objective,
    Precedence,
    Round,
    Route,
    RouteProblem,
    Visit,
)

__all__ = [
    "NEVER",
    "Battery",
    "Evaluation",
    "Objective",
    "Precedence",
    "Round",
    "Route",
    "RouteProblem",
    "Visit",
    "evaluate",
]
