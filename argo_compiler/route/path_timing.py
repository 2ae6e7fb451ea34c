"""Times along a path of nodes, and the best positions to charge.

A label describes the robot after the first nodes of a path. There are several if none dominates
the others, that is, if none is at least as good in every measure.
"""

from dataclasses import dataclass

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER, Objective


@dataclass(frozen=True)
class PathLabel:
    """Time, energy and charges of the robot after some nodes of a path."""

    time: int
    used: int
    waited: int
    charges: tuple[tuple[int, int], ...] = ()
    """position in the path and number of the charger, of each charge"""


class PathTiming:
    """Labels along the paths of a network, with charges at the best positions.

    Counts the legs it has tried. The tables are plain lists, as single numbers are read faster from
    a list than from an array.
    """

    def __init__(self, network: StepNetwork) -> None:
        self.network = network
        self._time = network.time.tolist()
        self._energy = None if network.energy is None else network.energy.tolist()
        self._service = [*network.service.tolist(), 0]
        step = network.step.tolist()
        self._earliest = [*(int(network.earliest[s]) for s in step), 0]
        self._latest = [*(int(network.latest[s]) for s in step), network.limit]
        self._stations = [
            (s.to.tolist(), s.to_energy.tolist(), s.out.tolist(), s.out_energy.tolist())
            for s in network.chargers
        ]
        self._battery = network.problem.battery
        self._counts_travel = network.problem.has_free_waiting
        self.legs = 0
        """number of legs tried, those by chargers included: a measure of the work"""

    def start_labels(self) -> list[PathLabel]:
        """Return the label before the first node."""
        used = 0 if self._battery is None else self._battery.used
        return [PathLabel(0, used, 0)]

    def extend(
        self, labels: list[PathLabel], origin: int, node: int, position: int
    ) -> list[PathLabel]:
        """Return the undominated labels after the leg from `origin` to `node`.

        The leg is direct or by a charger. The result is empty if no label can be extended.

        Args:
            labels: labels of the path up to `origin`.
            origin: last node of these labels.
            node: next node; m, the number of nodes, stands for the end of the route.
            position: index of `node` in the path, which the labels' charges state.
        """
        extended: list[PathLabel] = []
        self.legs += len(labels) * (1 + len(self._stations))
        for label in labels:
            if self._battery is None:
                arrival = label.time + self._time[origin][node]
                self._arrive(extended, label, node, arrival, 0, label.charges)
                continue
            assert self._energy is not None
            used = label.used + self._energy[origin][node]
            if used <= self._battery.capacity:
                arrival = label.time + self._time[origin][node]
                self._arrive(extended, label, node, arrival, used, label.charges)
            for number, (to, to_energy, out, out_energy) in enumerate(self._stations):
                charged = label.used + to_energy[origin]
                if charged <= self._battery.capacity and out_energy[node] <= self._battery.capacity:
                    arrival = label.time + to[origin] + self._battery.overhead + charged + out[node]
                    charges = (*label.charges, (position, number))
                    self._arrive(extended, label, node, arrival, out_energy[node], charges)
        return extended if len(extended) < 2 else self._undominated(extended)

    def _arrive(
        self,
        extended: list[PathLabel],
        label: PathLabel,
        node: int,
        arrival: int,
        used: int,
        charges: tuple[tuple[int, int], ...],
    ) -> None:
        begin = max(arrival, self._earliest[node])
        if begin <= self._latest[node] and arrival < NEVER:
            waited = label.waited + begin - arrival
            extended.append(PathLabel(begin + self._service[node], used, waited, charges))

    def evaluate_path(self, path: tuple[int, ...]) -> PathLabel | None:
        """Return the label of least cost at the end of a complete path, or None if infeasible."""
        labels, origin = self.start_labels(), self.network.node_count
        for position, node in enumerate((*path, self.network.node_count)):
            labels = self.extend(labels, origin, node, position)
            if not labels:
                return None
            origin = node
        return min(labels, key=self.cost)

    def cost(self, label: PathLabel) -> int:
        """Return the cost of a label at a route's end: the value that the objective minimises."""
        match self.network.objective:
            case Objective.DURATION:
                return label.time
            case Objective.TRAVEL:
                return label.time - label.waited
            case Objective.PRIZE:
                return 0

    def _undominated(self, labels: list[PathLabel]) -> list[PathLabel]:
        """Return the labels that no other dominates in time, energy, and travel if it counts."""
        undominated: list[PathLabel] = []
        if not self._counts_travel:
            for label in sorted(labels, key=lambda s: (s.time, s.used)):
                if not undominated or label.used < undominated[-1].used:
                    undominated.append(label)
            return undominated
        for label in sorted(labels, key=lambda s: (s.time, s.used, -s.waited)):
            travel = label.time - label.waited
            if not any(k.used <= label.used and k.time - k.waited <= travel for k in undominated):
                undominated.append(label)
        return undominated
