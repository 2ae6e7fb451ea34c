"""Worlds that vary: what is drawn anew for each seed, each from a stream of its own."""

from argo_compiler.model import Model
from argo_env.faults.distribution import FaultDistribution
from argo_env.run.spec import RunSpec


class Variation(Model):
    """What differs from world to world beside what seeds draw anyway. Each is drawn from a stream
    of its own, so that one more changes nothing of the others."""

    faults: FaultDistribution | None = None
    """what goes wrong in each, beside the faults that all runs of a case have"""

    def applied(self, spec: RunSpec, seed: int) -> RunSpec:
        """The spec of the run in the world of a seed."""
        update: dict[str, object] = {"seed": seed}
        drawn = self.faults.drawn(seed) if self.faults is not None else None
        if drawn is not None:
            update["faults"] = (*spec.faults, *drawn.faults)
        return spec.model_copy(update=update)

    def drawn_faults(self, seed: int) -> str | None:
        """What the faults are called that are drawn for the world of a seed; None: none are."""
        drawn = self.faults.drawn(seed) if self.faults is not None else None
        return None if drawn is None else drawn.name


NO_VARIATION = Variation()
"""Worlds differ by what seeds draw anyway: values, and what faults leave open."""
