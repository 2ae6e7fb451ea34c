"""Result of the beam searches with labels: a path, and bounds on all paths."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.network import StepNetwork


@dataclass(frozen=True)
class LabelSolution:
    """Path of nodes, and bounds on all paths."""

    path: tuple[int, ...] | None
    """best path that was found; None: none was found"""
    prize: int
    cost: int
    prize_bound: int
    """upper bound on the prize of any path"""
    bound: int
    """lower bound on the cost of the paths that win `prize_bound`"""
    proven: bool
    """true if the path is proven to be a best one, or, without a path, that there is none"""
    charges: Mapping[int, int] = field(default_factory=dict)
    """number of the charger by the position in the path before which the robot charges"""

    def better_than(self, other: "LabelSolution | None") -> bool:
        """Return True if this path wins a higher prize, or the same prize at a lower cost.

        A path is better than none; a result without a path is never better.
        """
        if self.path is None:
            return False
        return (
            other is None
            or other.path is None
            or ((-self.prize, self.cost) < (-other.prize, other.cost))
        )


def make_solution(
    network: StepNetwork,
    path: tuple[int, ...],
    charges: Mapping[int, int],
    prize_bound: int,
    bound: int,
) -> LabelSolution:
    """Return the path with its prize and cost, and with bounds on all paths.

    `prize_bound` and `bound` are those of `LabelSolution`. Raises AssertionError if the path is
    infeasible, which is a defect of the solver.
    """
    route = network.route(path, dict(charges))
    evaluation = evaluate(network.problem, route)
    assert evaluation.feasible, (route, evaluation.violations)
    cost = evaluation.cost(network.objective)
    prize = evaluation.prize
    proven = network.exact and prize >= prize_bound and cost <= bound
    return LabelSolution(
        path, prize, cost, max(prize_bound, prize), min(bound, cost), proven, charges
    )


def no_solution(network: StepNetwork, *, proven: bool, bound: int = 0) -> LabelSolution:
    """Return a result without a path; `proven`: it is proven that there is none."""
    return LabelSolution(None, 0, 0, int(network.prize.sum()), bound, proven)
