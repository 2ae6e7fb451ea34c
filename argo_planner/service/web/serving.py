"""The service from its beginning to its end."""

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

from argo_compiler.base.errors import Unavailable
from argo_env.planning.opening import OpenedSite
from argo_planner.service.evaluations.evaluations import Evaluations
from argo_planner.service.jobs.analysis import Analyst
from argo_planner.service.jobs.job import Job
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_searches import OrderSearches
from argo_planner.service.rooms.rooms import PlanRooms
from argo_planner.service.runs.host import AfterRestart, RunHost
from argo_planner.service.storage.folder import PlanFolder
from argo_planner.service.web.access import TokenBook
from argo_planner.service.web.app import Opened, make_app
from argo_planner.service.web.connections import raise_file_limit, server_options
from argo_planner.service.web.guard import Doors, Guard
from argo_planner.service.web.requests import PlanningService
from argo_planner.service.world.kept import KeptObstacles


@dataclass(frozen=True)
class ServiceOrder:
    """What is to be served, and to whom."""

    plans: PlanFolder
    site: OpenedSite
    tokens: TokenBook
    doors: Doors
    after_restart: AfterRestart = AfterRestart.WAIT
    """what becomes of a run that was under way when the service was killed"""
    foxglove: int | None = None
    """the port at which runs are shown live on this machine; None: they are not"""


def open_folder(path: Path) -> PlanFolder:
    """The folder of the plans. Raises what `PlanFolder` raises."""
    return PlanFolder(path, partial(secrets.token_hex, 6))


def opened_service(
    plans: PlanFolder,
    site: OpenedSite,
    after_restart: AfterRestart = AfterRestart.WAIT,
    foxglove: int | None = None,
) -> Opened:
    """What opens the service with the plans of a folder, and closes both again."""

    @asynccontextmanager
    async def opened() -> AsyncIterator[PlanningService]:
        analyst = Analyst(site)
        try:
            rooms = PlanRooms(plans, site.catalog, analyst, _now)

            def tell(job: Job) -> None:
                if (room := rooms.find_open(job.mission)) is not None:
                    room.publish_job(job)

            new_id = partial(secrets.token_hex, 6)
            jobs = Jobs(tell)
            orders = OrderSearches(site.reference, jobs, new_id, _now)
            evaluations = Evaluations(plans.path / "evaluations", jobs, new_id, _now)
            runs = RunHost(plans.path / "runs", after_restart, _now, foxglove)
            obstacles = KeptObstacles(plans.path)
            await runs.open()
            await evaluations.open()
            thread = ThreadPoolExecutor(1)
            try:
                yield PlanningService(
                    site=site,
                    folder=plans.path,
                    rooms=rooms,
                    jobs=jobs,
                    orders=orders,
                    evaluations=evaluations,
                    runs=runs,
                    obstacles=obstacles,
                    site_thread=thread,
                )
            finally:
                thread.shutdown(wait=False, cancel_futures=True)
                await runs.close()
                await jobs.close()
                await rooms.close()
        finally:
            analyst.close()

    return opened


def listen(host: str, port: int) -> socket.socket:
    """A socket at the address; port 0 takes a free one. Raises Unavailable if it can't be had."""
    try:
        family = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family, backlog=1024)
    except OSError as error:
        raise Unavailable(
            f"{host}:{port}: can't be listened at: {error.strerror}; choose another port"
        ) from None


def serve(order: ServiceOrder, listening: socket.socket) -> None:
    """Serves at a socket until a signal ends it."""
    raise_file_limit()
    app = make_app(opened_service(order.plans, order.site, order.after_restart, order.foxglove))
    guard = Guard(app, order.tokens, order.doors)
    uvicorn.Server(uvicorn.Config(guard, **server_options())).run(sockets=[listening])


def _now() -> datetime:
    return datetime.now(UTC)
