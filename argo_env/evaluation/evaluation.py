"""Python interface to evaluations: missions, worlds and faults in, results out."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Mission
from argo_env.evaluation.case import NO_FAULTS, EvaluationCase
from argo_env.evaluation.folder import digest_contents, open_rows
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import PROCESSES, make_backend
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.runner import EvaluationProgress, EvaluationRunner
from argo_env.evaluation.store import RowStore
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.faults.kinds import AnyFault
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec


class Evaluation:
    """Evaluation of each mission with each set of faults, in the world of each seed.

    >>> results = Evaluation({"as written": mission}, seeds=range(100)).run(workers=2)
    >>> results.frame.groupby("faults")["outcome"].value_counts()
    """

    def __init__(
        self,
        missions: Mapping[str, Mission] | Mission,
        site: str | OpenedSite = "umad",
        *,
        faults: Mapping[str, Sequence[AnyFault]] | None = None,
        seeds: Iterable[int] = range(100),
        drive: str = "route",
        sensor: str = "ideal",
        worlds: Variation = NO_VARIATION,
        require: Sequence[str] = (),
        width: float | None = None,
        name: str = "evaluation",
    ) -> None:
        """Prepare the evaluation of missions and sets of faults, given by their names.

        Without `faults` nothing goes wrong. With requirements in `require`, such as
        `["success >= 0.98"]`, or a `width` of intervals (from end to end, 0 to 1), the evaluation
        stops as soon as the requirements are decided and the width is reached. Raises ArgoError for
        missions, faults or worlds that can't be run.
        """
        by_name = {"mission": missions} if isinstance(missions, Mission) else missions
        if not by_name:
            raise Invalid("there is nothing to evaluate: give a mission")
        opened = open_site(site) if isinstance(site, str) else site
        worlds.check(opened.site)
        cases = []
        for mission_name, mission in by_name.items():
            for faults_name, fault_set in (faults or {NO_FAULTS: ()}).items():
                spec = RunSpec(
                    mission=mission,
                    site=opened.reference,
                    drive=drive,
                    sensor=sensor,
                    faults=tuple(fault_set),
                )
                check_spec(spec, opened.site)
                cases.append(
                    EvaluationCase(
                        mission=mission_name, faults=faults_name, spec=spec, digest=opened.digest
                    )
                )
        self.plan = EvaluationPlan(
            name=name,
            cases=tuple(cases),
            seeds=tuple(seeds),
            variation=worlds,
            stopping=Stopping(
                width=width, require=tuple(parse_requirement(text) for text in require)
            ),
        )
        """cases, seeds and the rule to stop"""
        self.plan.check()

    def run(
        self,
        workers: int | None = None,
        folder: Path | str | None = None,
        *,
        backend: str | WorkerBackend = PROCESSES,
        address: str | None = None,
        replace: bool = False,
        on_progress: Callable[[EvaluationProgress], None] = lambda _: None,
    ) -> EvaluationResults:
        """Execute the runs and return the results.

        Args:
            workers: Number of workers; None for one per usable processor, or for all of a cluster.
            folder: Folder in which rows are stored; runs whose rows it has are not repeated. None:
                nothing is stored.
            backend: Back end of the workers, or its name.
            address: Address of an existing cluster, if the back end has one.
            replace: Whether to replace another evaluation in the folder. Only those of its rows
                that belong to this evaluation are kept.
            on_progress: Function that is called with the progress after each run.

        Raises:
            ArgoError: If the back end has no such workers, or the folder can't be used, for example
                because it has another evaluation.
        """
        with ExitStack() as stack:
            store: RowStore | None = None
            if folder is not None:
                digest = digest_contents(self.plan.model_dump_json().encode())
                rows = open_rows(Path(folder), self.plan, digest, replace_and_keep_fitting=replace)
                store = stack.enter_context(rows)
            if isinstance(backend, str):
                backend = make_backend(backend, workers, address)
                stack.callback(backend.close)
            runner = EvaluationRunner(self.plan, backend, store)
            for _ in runner.rows_as_completed():
                on_progress(runner.progress)
            return runner.results
