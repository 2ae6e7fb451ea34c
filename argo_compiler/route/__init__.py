"""Search for the best order of a mission's checkpoints: problems, solvers and suggestions.

A round is here a group of visits with all its repetitions. For the solvers, a step is a visit
outside of rounds, or an outermost round; a node is one of the modes in which a step can be made; an
arc leads from one node to the next, and a path is a route as a sequence of nodes. With m nodes, row
m of a matrix stands for the start and column m for the end. The cost of a route is what the
problem's objective minimises. Times are in units, whose length is the problem's `unit`.
"""

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
