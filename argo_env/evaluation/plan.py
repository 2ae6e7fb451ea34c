"""What is to be evaluated, as data: cases, seeds, and when there are enough runs."""

import hashlib
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from pydantic import Field

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.requirement import RateRequirement
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.faults.reading import NOTHING
from argo_env.run.spec import RunSpec

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow


class Stopping(Model):
    """When there are enough runs, before all seeds have been used."""

    width: float | None = Field(default=None, gt=0, lt=1)
    """of the interval of each plan's rate of success, at 95 %"""
    require: tuple[RateRequirement, ...] = ()
    """what each plan must hold: one stops as soon as it is decided for all"""
    every: int = Field(default=20, ge=1)
    """seeds after which one looks"""


class EvaluationPlan(Model):
    """What is to be evaluated. Each seed is one world, in which all cases are run."""

    name: str = "evaluation"
    cases: tuple[EvaluationCase, ...] = Field(min_length=1)
    seeds: tuple[int, ...] = Field(min_length=1)
    variation: Variation = NO_VARIATION
    """what differs from world to world beside what seeds draw anyway"""
    stopping: Stopping = Stopping()
    strata: bool = False
    """whether runs go to the cases by how uncertain they are, and not to all alike"""
    added: str = ""
    """what stands on the site beside its description, in words: where something does, no run can
    be made again from its spec alone"""

    def changed(self, **fields: Any) -> "EvaluationPlan":
        """A plan with other `fields`, made anew: a copy would keep the names of the plans that the
        cases before had."""
        same = {name: getattr(self, name) for name in EvaluationPlan.model_fields}
        return EvaluationPlan(**{**same, **fields})

    @cached_property
    def plans(self) -> tuple[PlanName, ...]:
        """What is evaluated, in the order of the cases."""
        return tuple(dict.fromkeys(case.plan for case in self.cases))

    def run(self, case: int, seed: int) -> "PlannedRun":
        """The run of the case of that number in the world of the seed."""
        return PlannedRun(case, seed, self.variation.applied(self.cases[case].spec, seed))

    def runs(self, seeds: Sequence[int] | None = None) -> Iterator["PlannedRun"]:
        """All runs of these seeds (all), seed by seed, so that cases are compared in equal worlds
        whenever one stops."""
        for seed in self.seeds if seeds is None else seeds:
            for case in range(len(self.cases)):
                yield self.run(case, seed)

    def key(self, run: "PlannedRun") -> str:
        """What the run is known by: a hash of all that it depends on, of what its case is called,
        and of Argo's version."""
        case = self.cases[run.case]
        said = (__version__, case.digest, case.mission, case.policy, case.faults)
        text = "\n".join((*said, run.spec.model_dump_json()))
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @cached_property
    def _numbers(self) -> dict[tuple["PlanName", str], int]:
        """The numbers of the cases, by plan and faults."""
        return {(case.plan, case.faults): k for k, case in enumerate(self.cases)}

    def case_of(self, row: "RunRow") -> int | None:
        """The number of the case that a row is of; None: of none."""
        return self._numbers.get((row.plan, row.faults))

    def has(self, row: "RunRow", seeds: Container[int]) -> bool:
        """Whether a row is that of a run of this plan, with one of these seeds."""
        case = self.case_of(row)
        if case is None or row.seed not in seeds:
            return False
        return self.key(self.run(case, row.seed)) == row.key

    def faults_in(self, case: str, seed: int) -> str:
        """What goes wrong in the world of a seed: the faults of the case, or those drawn for it."""
        return self.drawn_in(seed) or case

    def drawn_in(self, seed: int) -> str:
        """What the faults are called that are drawn for the world of a seed; empty where the plan
        draws none."""
        if self.variation.faults is None:
            return ""
        return self.variation.drawn_faults(seed) or NOTHING

    def check(self) -> None:
        """Raises ArgoError for what makes no sense: equal cases, seeds twice."""
        if len(set(self.seeds)) < len(self.seeds):
            raise Conflict("a seed is there twice: each one is a world of its own")
        names = [(case.plan, case.faults) for case in self.cases]
        twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
        if twice:
            plan, faults = twice[0]
            raise Conflict(f"{plan} with faults {faults} is there twice: rename one of them")
        faultless = self.variation.faults is None and not any(c.spec.faults for c in self.cases)
        if faultless and any(one.quantity == "detected" for one in self.stopping.require):
            raise Invalid(
                "that faults are `detected` is required, and there are none: name some to find"
            )
        if self.strata and len(self.plans) > 1:
            raise Invalid("strata are of one plan: give one mission, drive and policy")


@dataclass(frozen=True)
class PlannedRun:
    """A run that is to be made."""

    case: int
    """number of the case"""
    seed: int
    spec: RunSpec
    """with all that is drawn for its world"""


def parse_seeds(text: str) -> tuple[int, ...]:
    """Seeds as people write them: `0..999`, `7`, or several of these with commas.

    Raises Invalid for anything else.
    """
    found: list[int] = []
    for part in text.replace(" ", "").split(","):
        first, dots, last = part.partition("..")
        if not first.isdecimal() or (dots and not last.isdecimal()):
            raise Invalid(f"seeds `{text}`: write them as 0..999, or 3,7,20..29")
        low, high = int(first), int(last or first)
        if high < low:
            raise Invalid(f"seeds `{part}`: the last one is before the first")
        if high - low >= MOST_SEEDS - len(found):
            raise Invalid(f"seeds `{part}`: there can be {MOST_SEEDS:,} seeds at most")
        if high > LARGEST_SEED:
            raise Invalid(f"seeds `{part}`: the largest there can be is {LARGEST_SEED}")
        found += range(low, high + 1)
    if len(set(found)) < len(found):
        raise Invalid(f"seeds `{text}`: one is there twice")
    return tuple(found)


MOST_SEEDS = 1_000_000
"""of an evaluation"""
LARGEST_SEED = 2**63 - 1
"""that rows can be kept of"""
