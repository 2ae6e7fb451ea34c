"""A route problem that was read from a file, and what the file calls its parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from argo_compiler.route.problem import Objective, RouteProblem, Tour


class Kind(StrEnum):
    """The kinds of problems that files hold, as they name them."""

    TSP = "TSP"
    ATSP = "ATSP"
    """asymmetric: from a node through all others and back"""
    SOP = "SOP"
    """sequential ordering: from the first node to the last, with precedence"""
    OP = "OP"
    """orienteering: as much score as a cost limit allows"""
    TSPTW = "TSPTW"
    """with time windows; waiting costs nothing"""


@dataclass(frozen=True, eq=False)
class NamedProblem:
    """The problem, and how its visits and values are those of the file."""

    name: str
    kind: Kind
    problem: RouteProblem
    nodes: tuple[int, ...]
    """the number of the node of each visit, as the file counts, which is from 1"""
    start_score: int = 0
    """what the start itself is worth: files count it, a route problem does not"""

    def value(self, prize: int, cost: int) -> float:
        """What the file's literature tells of a route, or a bound, with that prize and cost: the
        score where it is the aim, else the cost in the file's unit."""
        if self.problem.objective == Objective.PRIZE:
            return prize + self.start_score
        return cost * self.problem.unit

    def route(self, nodes: Sequence[int]) -> Tour:
        """The route through these nodes; the start and the end may be among them."""
        visits = {node: visit for visit, node in enumerate(self.nodes)}
        return Tour(tuple(visits[node] for node in nodes if node in visits))
