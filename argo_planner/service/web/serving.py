"""Start and end of the service: its parts, its socket and its server."""

import secrets
import socket
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import uvicorn

from argo_compiler.base.errors import Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_env.planning.opening import OpenedSite
from argo_planner.service.drafts.drafts import Drafts
from argo_planner.service.evaluations.evaluations import Evaluations
from argo_planner.service.jobs.analysis import Analyst
from argo_planner.service.jobs.imports import Imports
from argo_planner.service.jobs.job import Job
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_searches import OrderSearches
from argo_planner.service.rooms.rooms import PlanRooms
from argo_planner.service.runs.host import AfterRestart, RunHost
from argo_planner.service.storage.draft_folder import DraftFolder
from argo_planner.service.storage.folder import PlanFolder
from argo_planner.service.web.access import TokenBook
from argo_planner.service.web.app import OpenService, make_app
from argo_planner.service.web.connections import raise_file_limit_for_connections, server_options
from argo_planner.service.web.guard import Guard, GuardSettings
from argo_planner.service.web.requests import PlanningService
from argo_planner.service.world.obstacle_store import ObstacleStore
from argo_planner.use_cases.extensions import usable_extensions


@dataclass(frozen=True)
class ServiceSpec:
    """Options of the service: missions, obstacles, site, tokens and access."""

    plans: PlanFolder
    obstacles: ObstacleStore
    site: OpenedSite
    tokens: TokenBook
    guard: GuardSettings
    after_restart: AfterRestart = AfterRestart.WAIT
    """treatment of a run that was running when the service was killed"""
    foxglove: int | None = None
    """port of this machine at which Foxglove shows runs live; None: not shown"""


def open_plan_folder(path: Path) -> PlanFolder:
    """Open a folder of mission plans. Raises the errors of `PlanFolder`."""
    return PlanFolder(path, partial(secrets.token_hex, 6))


def make_service_opener(
    plans: PlanFolder,
    obstacles: ObstacleStore,
    site: OpenedSite,
    after_restart: AfterRestart = AfterRestart.WAIT,
    foxglove: int | None = None,
) -> OpenService:
    """Return a function that makes a context manager, which opens the service and closes it.

    `after_restart` and `foxglove` are explained in `ServiceSpec`.
    """

    @asynccontextmanager
    async def open_service() -> AsyncIterator[PlanningService]:
        analyst = Analyst(site)
        try:
            rooms = PlanRooms(plans, site.catalog, analyst, _now)

            def publish_job(job: Job) -> None:
                if (room := rooms.find_open(job.mission)) is not None:
                    room.publish_job(job)

            new_id = partial(secrets.token_hex, 6)
            jobs = Jobs(publish_job)
            orders = OrderSearches(site.reference, plans.path / "orders", jobs, new_id, _now)
            evaluations = Evaluations(plans.path / "evaluations", jobs, new_id, _now)
            runs = RunHost(plans.path / "runs", after_restart, _now, foxglove)
            await runs.open()
            await evaluations.open()
            await orders.open()
            scripts = Imports(site.reference)
            drafts = Drafts(DraftFolder(plans.path / "drafts", new_id), scripts, _now)
            await drafts.open()
            thread = ThreadPoolExecutor(1)
            try:
                yield PlanningService(
                    site=site,
                    folder=plans.path,
                    rooms=rooms,
                    jobs=jobs,
                    orders=orders,
                    imports=Imports(site.reference),
                    scripts=scripts,
                    drafts=drafts,
                    evaluations=evaluations,
                    runs=runs,
                    obstacles=obstacles,
                    extensions=usable_extensions(),
                    site_thread=thread,
                )
            finally:
                thread.shutdown(wait=False, cancel_futures=True)
                await runs.close()
                await jobs.kill_running()
                await evaluations.close()
                await orders.close()
                await rooms.close()
        finally:
            analyst.close()

    return open_service


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens at an address; port 0 takes a free port. Raises Unavailable."""
    try:
        family = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family, backlog=1024)
    except OSError as error:
        raise Unavailable(
            Message(
                "the service can't listen at {host}:{port}: {reason}; choose another "
                "address or port",
                host=host,
                port=port,
                reason=reason_text(error),
            )
        ) from None


def serve(spec: ServiceSpec, listening: socket.socket) -> None:
    """Run the service at a listening socket; return after a signal has ended it."""
    raise_file_limit_for_connections()
    open_service = make_service_opener(
        spec.plans, spec.obstacles, spec.site, spec.after_restart, spec.foxglove
    )
    app = make_app(open_service)
    guard = Guard(app, spec.tokens, spec.guard)
    uvicorn.Server(uvicorn.Config(guard, **server_options())).run(sockets=[listening])


def _now() -> datetime:
    return datetime.now(UTC)
