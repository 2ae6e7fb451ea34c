"""Search for the best order of a mission's checkpoints: problems, solvers and suggestions."""

from argo_compiler.route.evaluation import RouteEvaluation, evaluate
from argo_compiler.route.problem import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    Tour,
    Visit,
)
from argo_compiler.route.stop import SearchProgress
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route

__all__ = [
    "NEVER",
    "EnergyBudget",
    "Objective",
    "Precedence",
    "Round",
    "RouteEvaluation",
    "RouteProblem",
    "RouteSuggestion",
    "SearchProgress",
    "Tour",
    "Visit",
    "evaluate",
    "suggest_route",
]
