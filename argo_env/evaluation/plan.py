"""Plan of an evaluation as data: its cases, its seeds, and the rule to stop early."""

import hashlib
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from pydantic import Field

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_env.evaluation.case import EvaluationCase, PlanName
from argo_env.evaluation.requirement import RateRequirement
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.faults.loading import NOTHING
from argo_env.run.extensions import packages_of_run
from argo_env.run.spec import RunSpec

if TYPE_CHECKING:
    from argo_env.evaluation.row import RunRow


NO_REQUIREMENT_ON_STRATA = Message(
    "strata have no worlds in common, so that no requirement can be checked "
    "repeatedly: give `stop: {width: ...}` instead"
)


class Stopping(Model):
    """Rule to stop an evaluation before all seeds are used."""

    width: float | None = Field(default=None, gt=0, lt=1)
    """width that the 95 % interval of each plan's success rate must reach; None: any"""
    require: tuple[RateRequirement, ...] = ()
    """requirements on each plan; the evaluation stops when all are decided for all plans"""
    every: int = Field(default=20, ge=1)
    """number of seeds between two checks of the rule"""


class EvaluationPlan(Model):
    """Plan of an evaluation; each seed is one world, in which all cases are run.

    It has the runs of one or several evaluated plans (`PlanName`), which are compared.
    """

    name: str = "evaluation"
    cases: tuple[EvaluationCase, ...] = Field(min_length=1)
    seeds: tuple[int, ...] = Field(min_length=1)
    variation: Variation = NO_VARIATION
    """values that vary from world to world, in addition to those that each run draws by seed"""
    stopping: Stopping = Stopping()
    strata: bool = False
    """whether runs are allocated to the cases by their uncertainty (stratified sampling), instead
    of equally"""
    added: str = ""
    """objects that were added to the site's description, in words; if there are any, no run can be
    repeated from its spec alone"""

    def __repr_args__(self) -> Iterator[tuple[str, object]]:
        """Yield the name and the size; all fields would fill many screens."""
        yield "name", self.name
        yield "cases", len(self.cases)
        yield "seeds", len(self.seeds)

    def with_changes(self, **fields: Any) -> "EvaluationPlan":
        """Return the plan with new values of the given fields.

        Use it instead of `model_copy`, which would copy the cached names that belong to the old
        cases.
        """
        same = {name: getattr(self, name) for name in EvaluationPlan.model_fields}
        return EvaluationPlan(**{**same, **fields})

    @cached_property
    def plans(self) -> tuple[PlanName, ...]:
        """Names of the evaluated plans, in the order of the cases."""
        return tuple(dict.fromkeys(case.plan for case in self.cases))

    def planned_run(self, case: int, seed: int) -> "PlannedRun":
        """Return the run of the case with this index in the world of the seed."""
        return PlannedRun(case, seed, self.variation.apply(self.cases[case].spec, seed))

    def runs(self, seeds: Sequence[int] | None = None) -> Iterator["PlannedRun"]:
        """Yield the runs of these seeds (None: all seeds), seed by seed.

        All cases of a seed come before the next seed, so that cases are compared in the same worlds
        whenever the evaluation stops.
        """
        for seed in self.seeds if seeds is None else seeds:
            for case in range(len(self.cases)):
                yield self.planned_run(case, seed)

    def key(self, run: "PlannedRun") -> str:
        """Return a run's key, by which its row is found: a hash of all that the run depends on.

        The names of its case, and the versions of Argo and of the packages that the run uses are
        part of the hash.
        """
        case = self.cases[run.case]
        names = case.digest, case.mission, case.policy, case.faults
        parts = (__version__, *names, *packages_of_run(run.spec))
        text = "\n".join((*parts, run.spec.model_dump_json()))
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @cached_property
    def _case_indices(self) -> dict[tuple["PlanName", str], int]:
        """Indices of the cases, by name of the evaluated plan and name of the faults."""
        return {(case.plan, case.faults): k for k, case in enumerate(self.cases)}

    def case_index(self, row: "RunRow") -> int | None:
        """Return the index of the row's case; None if the row belongs to no case of this plan."""
        return self._case_indices.get((row.plan, row.faults))

    def contains(self, row: "RunRow", seeds: Container[int]) -> bool:
        """Return True if the row belongs to a run of this plan with one of these seeds."""
        case = self.case_index(row)
        if case is None or row.seed not in seeds:
            return False
        return self.key(self.planned_run(case, row.seed)) == row.key

    def faults_for(self, case: str, seed: int) -> str:
        """Return the name of the faults drawn for a run, or `case` if the plan never draws any.

        It is `NOTHING` if the plan draws faults, but none for this seed. `case` is the name of the
        case's set of faults.
        """
        return self.drawn_faults(seed) or case

    def drawn_faults(self, seed: int) -> str:
        """Return the name of the faults drawn for the seed's world.

        It is empty for a plan that never draws faults. A plan that draws faults, but none for this
        world, gives `NOTHING`.
        """
        if self.variation.faults is None:
            return ""
        return self.variation.faults_name_if_drawn(seed) or NOTHING

    def check(self) -> None:
        """Raise ArgoError for an invalid plan.

        That is a plan with a seed twice, two cases of the same name, a requirement on detections
        without any faults, or strata with several evaluated plans or with requirements.
        """
        if len(set(self.seeds)) < len(self.seeds):
            raise Conflict("a seed is there twice: give each seed once, as each is one world")
        names = [(case.plan, case.faults) for case in self.cases]
        duplicates = [name for name in dict.fromkeys(names) if names.count(name) > 1]
        if duplicates:
            plan, faults = duplicates[0]
            raise Conflict(
                Message(
                    "{plan} with faults {faults} is there twice: rename one of them",
                    plan=plan,
                    faults=faults,
                )
            )
        faultless = self.variation.faults is None and not any(c.spec.faults for c in self.cases)
        if faultless and any(r.quantity == "detected" for r in self.stopping.require):
            raise Invalid(
                "the requirement `detected` needs faults, and there are none: name some faults"
            )
        if self.strata and len(self.plans) > 1:
            raise Invalid("strata allow only one plan: give one mission, drive and policy")
        if self.strata and self.stopping.require:
            raise Invalid(NO_REQUIREMENT_ON_STRATA)


@dataclass(frozen=True)
class PlannedRun:
    """Run that an evaluation plan contains."""

    case: int
    """index of the case"""
    seed: int
    spec: RunSpec
    """complete spec, with all that is drawn for its world"""


def parse_seeds(text: str) -> tuple[int, ...]:
    """Parse seeds: `0..999` (999 included), `7`, or several of these with commas.

    Raises Invalid for anything else, and for seeds that are repeated, too large or too many.
    """
    seeds: list[int] = []
    for part in text.replace(" ", "").split(","):
        first, dots, last = part.partition("..")
        if not first.isdecimal() or (dots and not last.isdecimal()):
            raise Invalid(Message("seeds `{text}`: write them as 0..999, or 3,7,20..29", text=text))
        low, high = int(first), int(last or first)
        if high < low:
            raise Invalid(Message("seeds `{part}`: the last one is before the first", part=part))
        if high - low >= MOST_SEEDS - len(seeds):
            raise Invalid(
                Message(
                    "seeds `{part}`: there can be {most_seeds:,} seeds at most",
                    part=part,
                    most_seeds=MOST_SEEDS,
                )
            )
        if high > LARGEST_SEED:
            raise Invalid(
                Message(
                    "seeds `{part}`: the largest there can be is {largest_seed}",
                    part=part,
                    largest_seed=LARGEST_SEED,
                )
            )
        seeds += range(low, high + 1)
    if len(set(seeds)) < len(seeds):
        raise Invalid(Message("seeds `{text}`: one is there twice", text=text))
    return tuple(seeds)


def single_seed_note(seeds: str) -> str | None:
    """Return a note if seeds such as `5` are one seed, which may have been meant as a number."""
    if not seeds.strip().isdecimal() or int(seeds) < 2:
        return None
    number = int(seeds)
    return Message(
        "seed {number} only; for {number} seeds: 0..{number_2}", number=number, number_2=number - 1
    )


MOST_SEEDS = 1_000_000
"""largest number of seeds in an evaluation"""
LARGEST_SEED = 2**63 - 1
"""largest seed that rows can store"""
