"""Evaluations from Python: missions, worlds and faults in, results out."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Mission
from argo_env.evaluation.case import NO_FAULTS, EvaluationCase
from argo_env.evaluation.evaluating import Evaluating, EvaluationProgress
from argo_env.evaluation.folder import digest_of, open_rows
from argo_env.evaluation.plan import EvaluationPlan, Stopping
from argo_env.evaluation.pool.backend import WorkerBackend
from argo_env.evaluation.pool.backends import PROCESSES, make_backend
from argo_env.evaluation.requirement import parse_requirement
from argo_env.evaluation.results import EvaluationResults
from argo_env.evaluation.store import RowStore
from argo_env.evaluation.worlds import NO_VARIATION, Variation
from argo_env.faults.kinds import AnyFault
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec


class Evaluation:
    """What is to be evaluated: each mission with each set of faults, in the world of each seed.

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
        """Missions and sets of faults by what they are called; no faults: nothing goes wrong.

        With `require`, such as `["success >= 0.98"]`, or the `width` of intervals, it stops as soon
        as that is decided or reached. Raises ArgoError for what can't be run.
        """
        named = {"mission": missions} if isinstance(missions, Mission) else missions
        if not named:
            raise Invalid("there is nothing to evaluate: give a mission")
        opened = open_site(site) if isinstance(site, str) else site
        worlds.check(opened.site)
        cases = []
        for mission_name, mission in named.items():
            for faults_name, own in (faults or {NO_FAULTS: ()}).items():
                spec = RunSpec(
                    mission=mission,
                    site=opened.reference,
                    drive=drive,
                    sensor=sensor,
                    faults=tuple(own),
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
        """what is run"""
        self.plan.check()

    def run(
        self,
        workers: int | None = None,
        folder: Path | str | None = None,
        *,
        backend: str | WorkerBackend = PROCESSES,
        address: str | None = None,
        replace: bool = False,
        heard: Callable[[EvaluationProgress], None] = lambda _: None,
    ) -> EvaluationResults:
        """Makes the runs, by so many workers (as many as there are processors), and returns what
        came of them. With a `folder` rows are kept there, and what is there is not run again;
        `heard` is told how far it is after each run. Where another evaluation is in the folder, it
        gives way if it is to be replaced, and only those of its rows stay that fit.

        Raises ArgoError if there are no such workers, or the folder can't be used, as where another
        evaluation is in it.
        """
        with ExitStack() as stack:
            store: RowStore | None = None
            if folder is not None:
                digest = digest_of(self.plan.model_dump_json().encode())
                rows = open_rows(Path(folder), self.plan, digest, replace=replace)
                store = stack.enter_context(rows)
            if isinstance(backend, str):
                backend = make_backend(backend, workers, address)
                stack.callback(backend.close)
            evaluating = Evaluating(self.plan, backend, store)
            for _ in evaluating.rows_as_they_come():
                heard(evaluating.progress)
            return evaluating.results
