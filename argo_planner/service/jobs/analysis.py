"""The analysis of a mission over all its paths, in a process of its own."""

import asyncio
import os

from loky import ProcessPoolExecutor
from loky.backend.context import LokyContext
from loky.process_executor import BrokenProcessPool

from argo_compiler.analysis import Analysis, analyse
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Model
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.il import Mission
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.planning.site_warnings import unseen_from_poses
from argo_env.worker_processes import end_with_parent
from argo_planner.service.processes.context import CONTEXT
from argo_planner.use_cases.checking import MOST_PLACES


class AnalysisFound(Model):
    """What the analysis of a revision has found."""

    revision: int
    analysis: Analysis | None = None
    """without the witnesses; None: there is none, and `problem` says why"""
    problem: str | None = None


class Analyst:
    """Analyses missions of one site. Holds a process, which opens the site once."""

    def __init__(self, site: OpenedSite) -> None:
        self._site = site.reference
        self._pool = _pool()

    async def analyse(self, mission: Mission, revision: int) -> AnalysisFound:
        """The analysis of a mission, and of which revision it is."""
        for _ in range(2):  # once more in a new process
            pool = self._pool
            try:
                # The first process begins when its modules are loaded, which takes seconds.
                job = await asyncio.to_thread(pool.submit, _analysed, self._site, mission, revision)
                return await asyncio.wrap_future(job)
            except BrokenProcessPool:
                problem = "the process that analyses it has died"
                pool.shutdown(wait=False)
                if pool is self._pool:  # another analysis may have replaced it meanwhile
                    self._pool = _pool()
            except OSError as error:
                problem = f"the process that analyses it can't begin: {error.strerror}"
        return AnalysisFound(revision=revision, problem=problem)

    def close(self) -> None:
        """Ends the process, whatever it does."""
        self._pool.shutdown(wait=True, kill_workers=True)


def _pool() -> ProcessPoolExecutor:
    # The pool of Python 3.11 may take a job while it breaks, and never end it: loky's does not.
    context = LokyContext()
    context.Process = CONTEXT.Process
    return ProcessPoolExecutor(
        1, context=context, initializer=end_with_parent, initargs=(os.getpid(),)
    )


def _analysed(reference: str, mission: Mission, revision: int) -> AnalysisFound:
    try:
        site = open_site(reference)
        if has_errors(check(mission, site.catalog)):
            return AnalysisFound(revision=revision, problem="the mission has errors")
        places = len({task.pose for task in mission.tasks if task.pose is not None})
        travel = None if places > MOST_PLACES else site.travel
        found = analyse(mission, site.catalog, travel)
        unseen = tuple(unseen_from_poses(mission, site))
    except ArgoError as error:
        return AnalysisFound(revision=revision, problem=str(error))
    told = found.model_copy(
        update={"witnesses": None, "diagnostics": (*found.diagnostics, *unseen)}
    )
    return AnalysisFound(revision=revision, analysis=told)
