"""Following a path of nodes: when it is where, and where it is best charged."""

from dataclasses import dataclass

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER, Objective


@dataclass(frozen=True)
class Stand:
    """Where a robot may be after some nodes of a path: one way to have got there."""

    time: int
    used: int
    waited: int
    charges: tuple[tuple[int, int], ...] = ()
    """position in the path and charger"""


class PathTiming:
    """Goes along paths of a network, charging wherever that is best. Its tables are plain lists,
    which are faster to look single numbers up in than arrays."""

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
        self._travels = network.problem.waits
        self.legs = 0
        """that were looked at, by chargers included: what it has worked"""

    def start(self) -> list[Stand]:
        """Before the first node."""
        used = 0 if self._battery is None else self._battery.used
        return [Stand(0, used, 0)]

    def go(self, stands: list[Stand], origin: int, node: int, position: int) -> list[Stand]:
        """On to a node (m: the end); none are left if that is not possible."""
        found: list[Stand] = []
        self.legs += len(stands) * (1 + len(self._stations))
        for stand in stands:
            if self._battery is None:
                arrived = stand.time + self._time[origin][node]
                self._arrive(found, stand, node, arrived, 0, stand.charges)
                continue
            assert self._energy is not None
            used = stand.used + self._energy[origin][node]
            if used <= self._battery.capacity:
                arrived = stand.time + self._time[origin][node]
                self._arrive(found, stand, node, arrived, used, stand.charges)
            for number, (to, to_energy, out, out_energy) in enumerate(self._stations):
                at = stand.used + to_energy[origin]
                if at <= self._battery.capacity and out_energy[node] <= self._battery.capacity:
                    arrived = stand.time + to[origin] + self._battery.overhead + at + out[node]
                    charges = (*stand.charges, (position, number))
                    self._arrive(found, stand, node, arrived, out_energy[node], charges)
        return found if len(found) < 2 else self._best(found)

    def _arrive(
        self,
        found: list[Stand],
        stand: Stand,
        node: int,
        arrived: int,
        used: int,
        charges: tuple[tuple[int, int], ...],
    ) -> None:
        begin = max(arrived, self._earliest[node])
        if begin <= self._latest[node] and arrived < NEVER:
            waited = stand.waited + begin - arrived
            found.append(Stand(begin + self._service[node], used, waited, charges))

    def follow(self, path: tuple[int, ...]) -> Stand | None:
        """The best way along a whole path to the end; None: there is none."""
        stands, origin = self.start(), self.network.size
        for position, node in enumerate((*path, self.network.size)):
            stands = self.go(stands, origin, node, position)
            if not stands:
                return None
            origin = node
        return min(stands, key=self.cost)

    def cost(self, stand: Stand) -> int:
        """What the objective makes small."""
        match self.network.objective:
            case Objective.DURATION:
                return stand.time
            case Objective.TRAVEL:
                return stand.time - stand.waited
            case Objective.PRIZE:
                return 0

    def _best(self, stands: list[Stand]) -> list[Stand]:
        """Those than which none is as good in time and energy, and waiting where it counts."""
        kept: list[Stand] = []
        if not self._travels:
            for one in sorted(stands, key=lambda s: (s.time, s.used)):
                if not kept or one.used < kept[-1].used:
                    kept.append(one)
            return kept
        for one in sorted(stands, key=lambda s: (s.time, s.used, -s.waited)):
            gone = one.time - one.waited
            if not any(k.used <= one.used and k.time - k.waited <= gone for k in kept):
                kept.append(one)
        return kept
