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
from argo_compiler.route.suggest import suggest_route
from argo_compiler.route.suggestion import Point, RouteSuggestion

__all__ = [
    "NEVER",
    "Battery",
    "Evaluation",
    "Objective",
    "Point",
    "Precedence",
    "Round",
    "Route",
    "RouteProblem",
    "RouteSuggestion",
    "Visit",
    "evaluate",
    "suggest_route",
]
