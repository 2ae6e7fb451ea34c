"""What beams of labels have found, and what is known by them of all paths."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.network import StepNetwork


@dataclass(frozen=True)
class LabelSolution:
    """A path of nodes, and what is known of all paths."""

    path: tuple[int, ...] | None
    """None: none was found"""
    prize: int
    cost: int
    prize_bound: int
    """no path wins more"""
    bound: int
    """no path that wins `prize_bound` costs less"""
    proven: bool
    """whether the path is a best one, or there is none"""
    charges: Mapping[int, int] = field(default_factory=dict)
    """the charger by the position in the path before which it is used"""

    def better_than(self, other: "LabelSolution | None") -> bool:
        """Whether its path wins more, or as much at less cost."""
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
    """The path with what it is worth. Raises AssertionError if it breaks a rule: no solver may."""
    route = network.route(path, dict(charges))
    worth = evaluate(network.problem, route)
    assert worth.feasible, (route, worth.violations)
    cost = worth.cost(network.objective)
    prize = worth.prize
    proven = network.exact and prize >= prize_bound and cost <= bound
    return LabelSolution(
        path, prize, cost, max(prize_bound, prize), min(bound, cost), proven, charges
    )


def no_solution(network: StepNetwork, *, proven: bool, bound: int = 0) -> LabelSolution:
    """No path; `proven`: there is none."""
    return LabelSolution(None, 0, 0, int(network.prize.sum()), bound, proven)
