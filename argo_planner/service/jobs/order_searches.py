"""Searches of a service for the best orders of missions."""

from collections.abc import Callable
from datetime import datetime

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_planner.service.jobs.job import OrderJob
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_search import search_order
from argo_planner.service.processes.job_process import JobProcess

MOST_SEARCHES = 2
"""searches that run at the same time"""


class OrderSearches:
    """Searches for the best orders of missions on one site, as jobs."""

    def __init__(
        self, site: str, jobs: Jobs, new_id: Callable[[], str], clock: Callable[[], datetime]
    ) -> None:
        """Create a collection of searches on the site that the reference `site` opens."""
        self._site = site
        self._jobs = jobs
        self._new_id = new_id
        self._clock = clock

    def start(
        self,
        plan: str,
        revision: int,
        mission: Mission,
        requirements: Requirements,
        time_limit: float,
        author: str,
        solvers: tuple[str, ...] = (),
    ) -> OrderJob:
        """Start a search of at most `time_limit` s, and return its job.

        `solvers` of installed packages take part besides Argo's own.

        Raises Conflict if MOST_SEARCHES searches are running.
        """
        if len(self._jobs.running(OrderJob)) >= MOST_SEARCHES:
            raise Conflict(
                f"{MOST_SEARCHES} searches are running: wait for one of them, or cancel it"
            )
        job = OrderJob(
            id=self._new_id(), mission=plan, revision=revision, author=author, begun=self._clock()
        )
        self._jobs.start(
            job, JobProcess(search_order, self._site, mission, requirements, time_limit, solvers)
        )
        return job

    def job_and_new_mission(self, id: str) -> tuple[OrderJob, Mission]:
        """Return the job of a search, and the mission in the order that it has found.

        Raises NotFound if there is no such job or it is no search, Conflict if it has found no
        order.
        """
        job = self._jobs.job(id)
        if not isinstance(job, OrderJob):
            raise NotFound(f"job {id} is not a search for an order")
        if job.found is None or job.found.mission is None:
            raise Conflict(f"job {id} is {job.state}, and has found no order")
        return job, job.found.mission
