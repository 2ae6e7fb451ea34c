"""Analysis of a mission over all its execution paths, in a separate process."""

import asyncio
import os

from loky.backend.context import LokyContext
from loky.process_executor import BrokenProcessPool

from argo_compiler.analysis import Analysis, analyse
from argo_compiler.base.errors import ArgoError, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.process_pool import ProcessPool
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.il import Mission
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.planning.site_warnings import not_seen_from_pose_warnings
from argo_env.worker_processes import ignore_sigint_and_end_with_parent
from argo_planner.service.processes.context import CONTEXT
from argo_planner.use_cases.checking import MAX_POSES


class AnalysisFound(Worded):
    """Result of the analysis of a revision."""

    revision: int
    analysis: Analysis | None = None
    """analysis without its witnesses; None: `problem` states why there is none"""
    problem: Text | None = None
    problem_wording: Wording | None = wording_field("problem")


class Analyst:
    """Analyst of missions on one site. Owns a process, which opens the site once."""

    def __init__(self, site: OpenedSite) -> None:
        self._site = site.reference
        self._pool = _make_pool()

    async def analyse_revision(self, mission: Mission, revision: int) -> AnalysisFound:
        """Analyse a mission, and return the analysis or the problem that prevented it.

        The result has one or the other; no error is raised, except after `close`. `revision` is the
        number of the mission's revision, which the result repeats. Analyses run one after the
        other.
        """
        for _ in range(2):  # the second time in a new process
            pool = self._pool
            try:
                # The first process starts after its modules are loaded, which takes seconds.
                job = await asyncio.to_thread(pool.submit, _analyse, self._site, mission, revision)
                return await asyncio.wrap_future(job)
            except BrokenProcessPool:
                problem = Message("the analysis process has died")
                pool.shutdown(wait=False)
                if pool is self._pool:  # unless another analysis has replaced it
                    self._pool = _make_pool()
            except OSError as error:
                problem = Message(
                    "the analysis process can't start: {reason}", reason=reason_text(error)
                )
        return AnalysisFound(revision=revision, problem=problem)

    def close(self) -> None:
        """Kill the process; an `analyse_revision` under way then raises an error."""
        self._pool.shutdown(wait=True, kill_workers=True)


def _make_pool() -> ProcessPool:
    # A pool of Python 3.11 that breaks may accept a job and never end it; loky's pool does not.
    context = LokyContext()
    context.Process = CONTEXT.Process
    return ProcessPool(
        1, context=context, initializer=ignore_sigint_and_end_with_parent, initargs=(os.getpid(),)
    )


def _analyse(reference: str, mission: Mission, revision: int) -> AnalysisFound:
    try:
        site = open_site(reference)
        if has_errors(check(mission, site.catalog)):
            return AnalysisFound(revision=revision, problem=Message("the mission has errors"))
        poses = len({task.pose for task in mission.tasks if task.pose is not None})
        travel = None if poses > MAX_POSES else site.travel
        analysis = analyse(mission, site.catalog, travel)
        unseen = tuple(not_seen_from_pose_warnings(mission, site))
    except ArgoError as error:
        return AnalysisFound(revision=revision, problem=str(error))
    without_witnesses = analysis.model_copy(
        update={"witnesses": None, "diagnostics": (*analysis.diagnostics, *unseen)}
    )
    return AnalysisFound(revision=revision, analysis=without_witnesses)
